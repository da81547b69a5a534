//! From the words of the command line to a scene with its environment, animation and camera.

use crate::arguments::View;
use crate::failure::{Failure, Outcome};
use kajo_lab::Look;
use kajo_scene::{LoadOptions, Scene, SceneError, Snapshot};
use kajo_units::Seconds;

/// Loads a scene.
///
/// # Errors
/// What the importers report, by [`failure`].
pub fn load(reference: &str, options: &LoadOptions) -> Outcome<Scene> {
    kajo_scene::load(reference, options).map_err(failure)
}

/// Loads the scene with the environment and the animation that were asked for.
///
/// # Errors
/// Those of [`load`].
pub fn load_scene(reference: &str, view: &View) -> Outcome<Scene> {
    load(reference, &LoadOptions { environment: view.env.clone(), animation: view.animation.clone() })
}

/// Words that name nothing are wrong usage; everything else is a failure.
pub fn failure(error: SceneError) -> Failure {
    match error {
        SceneError::UnknownBuiltin { .. } | SceneError::UnknownName { .. } => Failure::Usage(error.into()),
        _ => error.into(),
    }
}

/// The scene at a time, and which of its cameras is meant.
///
/// # Errors
/// A camera that does not exist is wrong usage.
pub fn snapshot(scene: &Scene, view: &View, time: f64) -> Outcome<(Snapshot, usize)> {
    let mut snapshot = Snapshot::new(scene, Seconds(time as f32));
    let camera = view.camera.as_deref().map_or(Ok(0), |word| snapshot.find_camera(word));
    let camera = camera.map_err(|unknown| failure(SceneError::UnknownName { scene: scene.name.clone(), unknown }))?;
    if let Some(look) = look(view) {
        snapshot.cameras[camera] = look.place(&snapshot.cameras[camera]);
    }
    Ok((snapshot, camera))
}

/// Where the camera is put, when the words say so.
pub fn look(view: &View) -> Option<Look> {
    let (from, at) = view.look_from.zip(view.look_at)?;
    Some(Look { from, at, fov: view.fov.map(|degrees| degrees as f32) })
}

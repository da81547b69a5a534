//! From the words of the command line to a scene with its environment, animation and camera.

use crate::arguments::View;
use crate::failure::{Failure, Outcome};
use glam::UVec2;
use kajo_scene::{LoadOptions, PlacedCamera, Projection, Scene, SceneError, Snapshot};
use kajo_units::Seconds;
use std::path::Path;

/// Rows of an image whose size was not asked for.
const DEFAULT_ROWS: u32 = 720;

/// Shape of an image whose camera has none.
const DEFAULT_ASPECT: f32 = 16.0 / 9.0;

/// Loads a scene; an environment file replaces its own.
///
/// # Errors
/// What the importers report; a built-in scene that does not exist is wrong usage.
pub fn load(reference: &str, environment: Option<&Path>) -> Outcome<Scene> {
    let options = LoadOptions { environment: environment.map(Path::to_path_buf) };
    kajo_scene::load(reference, &options).map_err(|error| match error {
        SceneError::UnknownBuiltin { .. } => Failure::Usage(error.into()),
        _ => error.into(),
    })
}

/// Loads the scene with the environment and the animation that were asked for.
///
/// # Errors
/// Those of [`load`]; an animation that does not exist is wrong usage.
pub fn load_scene(reference: &str, view: &View) -> Outcome<Scene> {
    let mut scene = load(reference, view.env.as_deref())?;
    if let Some(word) = &view.animation {
        let names: Vec<&str> = scene.animations.iter().map(|animation| animation.name.as_str()).collect();
        scene.animation = choose("animation", word, &names)?;
    }
    Ok(scene)
}

/// The scene at a time, and which of its cameras is meant.
///
/// # Errors
/// A camera that does not exist is wrong usage.
pub fn snapshot(scene: &Scene, view: &View, time: f64) -> Outcome<(Snapshot, usize)> {
    let snapshot = Snapshot::new(scene, Seconds(time as f32));
    let names: Vec<&str> = snapshot.cameras.iter().map(|placed| placed.camera.name.as_str()).collect();
    let camera = view.camera.as_deref().map_or(Ok(0), |word| choose("camera", word, &names))?;
    Ok((snapshot, camera))
}

/// The size asked for, or 720 rows in the camera's shape.
pub fn image_size(asked: Option<UVec2>, camera: &PlacedCamera) -> UVec2 {
    asked.unwrap_or_else(|| {
        let aspect = match camera.camera.projection {
            Projection::Perspective { aspect, .. } => aspect.unwrap_or(DEFAULT_ASPECT),
            Projection::Orthographic { xmag, ymag } => xmag.0 / ymag.0,
        };
        let columns = (DEFAULT_ROWS as f32 * aspect).round().clamp(1.0, 4.0 * DEFAULT_ROWS as f32);
        UVec2::new(columns as u32, DEFAULT_ROWS)
    })
}

/// The index of the thing called `word`; a number is an index where nothing is called so.
fn choose(what: &str, word: &str, names: &[&str]) -> Outcome<usize> {
    if let Some(index) = names.iter().position(|name| *name == word) {
        return Ok(index);
    }
    if let Some(index) = word.parse().ok().filter(|index| *index < names.len()) {
        return Ok(index);
    }
    if names.is_empty() {
        return Err(Failure::usage(format!("no {what} `{word}`: the scene has none")));
    }
    let list: Vec<String> = names.iter().enumerate().map(|(index, name)| format!("{index} {name:?}")).collect();
    let advice = nearest(word, names).map_or_else(String::new, |name| format!(", did you mean {name:?}?"));
    Err(Failure::usage(format!("no {what} `{word}`{advice}; there are: {}", list.join(", "))))
}

/// The name that a mistyped word most likely meant.
pub fn nearest<'a>(word: &str, names: &[&'a str]) -> Option<&'a str> {
    let score = |name: &str| strsim::jaro_winkler(&word.to_lowercase(), &name.to_lowercase());
    names.iter().copied().map(|name| (score(name), name)).filter(|(s, _)| *s >= 0.75).max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, n)| n)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_come_before_numbers() {
        let names = ["main", "0"];
        assert_eq!(choose("camera", "0", &names).ok(), Some(1));
        assert_eq!(choose("camera", "main", &names).ok(), Some(0));
        assert!(choose("camera", "2", &names).is_err());
    }

    #[test]
    fn a_slip_is_answered_with_the_nearest_name() {
        let Err(Failure::Usage(error)) = choose("camera", "maim", &["main"]) else { panic!("accepted") };
        assert!(error.to_string().contains("did you mean \"main\"?"), "{error}");
    }
}

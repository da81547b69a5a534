//! A scene as it is compared: at one time, from one camera, at one size.

use crate::experiment::slug;
use crate::{CompareOptions, LabError};
use glam::{UVec2, Vec3};
use kajo_path_tracer::{CameraChoice, Tracer};
use kajo_scene::framing::bounds;
use kajo_scene::{LoadOptions, Scene, SceneError, Snapshot, load};
use kajo_units::Seconds;

/// A scene, ready for both renderers.
pub struct Subject {
    /// As the user named it.
    pub name: String,
    /// For folders; different for every scene of a comparison.
    pub slug: String,
    /// The scene.
    pub scene: Scene,
    /// At the time that is compared.
    pub snapshot: Snapshot,
    /// Index of the camera.
    pub camera: usize,
    /// Size of the images, px.
    pub size: UVec2,
    /// Role ambient visibility: how far a surface blocks, m.
    pub ambient_distance: f32,
}

impl Subject {
    /// Loads scene `index` of the options.
    ///
    /// # Errors
    /// Scenes that cannot be loaded, cameras and animations that are not there.
    pub fn load(options: &CompareOptions, index: usize) -> Result<Self, LabError> {
        let name = options.scenes[index].clone();
        let scene = load(&name, &LoadOptions { environment: options.environment.clone(), animation: options.animation.clone() })?;
        let mut snapshot = Snapshot::new(&scene, Seconds(options.time as f32));
        let camera = options.camera.as_deref().map_or(Ok(0), |word| snapshot.find_camera(word));
        let camera = camera.map_err(|unknown| SceneError::UnknownName { scene: name.clone(), unknown })?;
        if let Some(look) = options.look {
            snapshot.cameras[camera] = look.place(&snapshot.cameras[camera]);
        }
        let size = options.size.unwrap_or_else(|| snapshot.cameras[camera].camera.default_image_size());
        let ambient_distance = options.ambient_distance.unwrap_or_else(|| ambient_distance(bounds(&snapshot.meshes, &snapshot.instances)));
        let stem = name.rsplit(['/', '\\']).next().unwrap_or(&name);
        Ok(Self { slug: format!("{}-{}", index + 1, slug(stem)), name, scene, snapshot, camera, size, ambient_distance })
    }

    /// The judge's view of it.
    ///
    /// # Errors
    /// Scenes that the tracer refuses.
    pub fn tracer(&self) -> Result<Tracer, LabError> {
        Ok(Tracer::new(&self.scene, self.snapshot.clone())?)
    }

    /// Size, camera and seed.
    pub fn tracer_settings(&self, options: &CompareOptions) -> kajo_path_tracer::Settings {
        kajo_path_tracer::Settings {
            size: self.size,
            camera: CameraChoice::Index(self.camera),
            seed: options.seed,
            ambient_distance: self.ambient_distance,
            ..kajo_path_tracer::Settings::default()
        }
    }
}

/// Role ambient visibility: how far surfaces block where nobody says so. A tenth of the diagonal of the scene's box, to two digits, m.
pub fn ambient_distance([low, high]: [Vec3; 2]) -> f32 {
    let length = f64::from(low.distance(high)) * 0.1;
    let digit = 10f64.powf(length.log10().floor() - 1.0);
    let rounded = ((length / digit).round() * digit) as f32;
    // A scene that is one point.
    if rounded > 0.0 && rounded.is_finite() { rounded } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn options(scene: &str) -> CompareOptions {
        CompareOptions { scenes: vec![scene.into()], ..CompareOptions::default() }
    }

    #[test]
    fn a_scene_is_loaded_with_its_camera_and_a_size() {
        let subject = Subject::load(&options("builtin:shadows"), 0).unwrap();
        assert_eq!((subject.size.y, subject.camera, subject.slug.as_str()), (720, 0, "1-builtin-shadows"));
    }

    #[test]
    fn the_ambient_distance_is_asked_for_or_grows_with_the_scene() {
        let of = |ambient_distance| {
            let options = CompareOptions { ambient_distance, ..options("builtin:cornell") };
            let subject = Subject::load(&options, 0).unwrap();
            assert_eq!(subject.tracer_settings(&options).ambient_distance, subject.ambient_distance);
            subject.ambient_distance
        };
        assert_eq!(of(Some(0.25)), 0.25);
        let [low, high] = [Vec3::new(1.0, 2.0, 3.0), Vec3::new(1.0, 2.0, 15.34)];
        assert_eq!(
            (ambient_distance([low, high]), ambient_distance([low * 1000.0, high * 1000.0]), ambient_distance([low, low])),
            (1.2, 1200.0, 1.0)
        );
        assert!(of(None) > 0.0);
    }

    #[test]
    fn a_camera_is_put_where_it_is_told() {
        let look = crate::Look { from: glam::Vec3::new(1.0, 2.0, 3.0), at: glam::Vec3::ZERO, fov: None };
        let subject = Subject::load(&CompareOptions { look: Some(look), ..options("builtin:shadows") }, 0).unwrap();
        assert_eq!(subject.snapshot.cameras[0].world_from_view.w_axis.truncate(), look.from);
    }

    #[test]
    fn names_that_are_not_there_are_told_with_those_that_are() {
        let error = |change: &dyn Fn(&mut CompareOptions)| {
            let mut o = options("builtin:shadows");
            change(&mut o);
            Subject::load(&o, 0).map(|_| ()).unwrap_err().to_string()
        };
        assert!(error(&|o| o.camera = Some("side".into())).contains("builtin:shadows: no camera is called \"side\"; there are: "));
        assert!(error(&|o| o.animation = Some("run".into())).contains("no animation is called \"run\"; there are none"));
        assert!(error(&|o| o.scenes[0] = "builtin:nowhere".into()).contains("nowhere"));
    }
}

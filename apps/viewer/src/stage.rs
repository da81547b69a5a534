//! What is looked at: a loaded scene, the scene at one moment, and one shot of it.

use glam::{UVec2, Vec3};
use kajo_scene::{LoadOptions, PlacedCamera, Scene, Snapshot, framing, load};
use kajo_units::Seconds;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Where a scene comes from, as the command line says it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Source {
    /// A file, or `builtin:NAME`.
    pub reference: String,
    /// Replaces the scene's environment.
    pub environment: Option<PathBuf>,
}

/// A loaded scene.
#[derive(Debug)]
pub(crate) struct Stage {
    /// Where it comes from.
    pub source: Source,
    /// The scene.
    pub scene: Scene,
    /// Length of the animation that plays, s; 0 without one.
    pub duration: f32,
    serial: u64,
}

/// A stage at one time, without the lights that are switched off: what both renderers see.
#[derive(Debug)]
pub(crate) struct Moment {
    /// The scene.
    pub stage: Arc<Stage>,
    /// At the time.
    pub snapshot: Snapshot,
    /// Smallest and largest corner of what is placed.
    pub bounds: [Vec3; 2],
    serial: u64,
}

/// A moment from one camera at one size.
#[derive(Clone, Debug)]
pub(crate) struct Shot {
    /// What is seen.
    pub moment: Arc<Moment>,
    /// From where.
    pub camera: PlacedCamera,
    /// Of the picture, px.
    pub size: UVec2,
}

/// A number that nothing else has.
pub(crate) fn serial() -> u64 {
    static NEXT: AtomicU64 = AtomicU64::new(1);
    NEXT.fetch_add(1, Ordering::Relaxed)
}

impl Stage {
    /// Loads a scene.
    ///
    /// # Errors
    /// What the importers report, in one sentence.
    pub fn load(source: &Source) -> Result<Self, String> {
        let options = LoadOptions { environment: source.environment.clone(), animation: None };
        let scene = load(&source.reference, &options).map_err(|error| sentence(&error))?;
        let ends = scene.animations.get(scene.animation).into_iter().flat_map(|animation| &animation.channels);
        let duration = ends.filter_map(|channel| channel.times.last()).copied().fold(0.0, f32::max);
        Ok(Self { source: source.clone(), scene, duration, serial: serial() })
    }
}

impl Moment {
    /// Evaluates the scene at `time`; `dark`: indices of the analytic lights that are switched off.
    pub fn new(stage: &Arc<Stage>, time: f32, dark: &BTreeSet<usize>) -> Self {
        let mut snapshot = Snapshot::new(&stage.scene, Seconds(time));
        let bounds = framing::bounds(&snapshot.meshes, &snapshot.instances);
        let lit = std::mem::take(&mut snapshot.lights).into_iter().enumerate();
        snapshot.lights = lit.filter(|(index, _)| !dark.contains(index)).map(|(_, light)| light).collect();
        Self { stage: stage.clone(), snapshot, bounds, serial: serial() }
    }

    /// True for the same evaluation.
    pub fn is(&self, other: &Self) -> bool {
        self.serial == other.serial
    }

    /// True for moments of the same loaded scene.
    pub fn same_stage(&self, other: &Self) -> bool {
        self.stage.serial == other.stage.serial
    }
}

impl PartialEq for Shot {
    fn eq(&self, other: &Self) -> bool {
        let lens = self.camera.camera == other.camera.camera && self.camera.world_from_view == other.camera.world_from_view;
        lens && self.size == other.size && self.moment.is(&other.moment)
    }
}

/// What a file that is dropped on the window is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// A scene.
    Scene,
    /// An environment for the scene that is there.
    Environment,
}

impl Kind {
    /// By the ending of the name.
    pub fn of(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "gltf" | "glb" | "obj" | "toml" => Some(Self::Scene),
            "hdr" | "exr" => Some(Self::Environment),
            _ => None,
        }
    }
}

/// An error with its causes, each said once.
pub(crate) fn sentence(error: &dyn std::error::Error) -> String {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        let more = error.to_string();
        if !text.contains(&more) {
            text = format!("{text}: {more}");
        }
        cause = error.source();
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stage(reference: &str) -> Arc<Stage> {
        Arc::new(Stage::load(&Source { reference: reference.into(), environment: None }).unwrap())
    }

    #[test]
    fn lights_that_are_switched_off_are_not_there() {
        let stage = stage("builtin:shadows");
        let all = Moment::new(&stage, 0.0, &BTreeSet::new());
        assert!(all.snapshot.lights.len() > 1);
        let without = Moment::new(&stage, 0.0, &BTreeSet::from([0]));
        let names = |moment: &Moment| moment.snapshot.lights.iter().map(|l| l.light.name.clone()).collect::<Vec<_>>();
        assert_eq!(names(&without), names(&all)[1..]);
        assert!(!all.is(&without) && all.same_stage(&without));
    }

    #[test]
    fn shots_differ_by_camera_size_and_moment() {
        let moment = Arc::new(Moment::new(&stage("builtin:cornell"), 0.0, &BTreeSet::new()));
        let shot = Shot { moment: moment.clone(), camera: moment.snapshot.cameras[0].clone(), size: UVec2::new(8, 8) };
        assert!(shot == shot.clone());
        assert!(shot != Shot { size: UVec2::new(8, 9), ..shot.clone() });
        let mut moved = shot.clone();
        moved.camera.world_from_view.w_axis.x += 0.1;
        assert!(shot != moved);
        let later = Arc::new(Moment::new(&moment.stage, 0.0, &BTreeSet::new()));
        assert!(shot != Shot { moment: later, ..shot.clone() }, "evaluated anew");
    }

    #[test]
    fn files_are_told_apart_by_their_ending() {
        let kind = |name: &str| Kind::of(Path::new(name));
        assert_eq!(
            [kind("a/B.GLB"), kind("x.kajo.toml"), kind("sky.EXR")],
            [Some(Kind::Scene), Some(Kind::Scene), Some(Kind::Environment)]
        );
        assert_eq!([kind("a.png"), kind("README"), kind("x.")], [None; 3]);
    }

    #[test]
    fn an_animation_has_a_length_and_a_broken_file_a_sentence() {
        assert!(stage("builtin:moving").duration > 0.0 && stage("builtin:cornell").duration == 0.0);
        let broken = Stage::load(&Source { reference: "/no/such/scene.glb".into(), environment: None }).unwrap_err();
        assert!(broken.contains("/no/such/scene.glb"), "{broken}");
    }
}

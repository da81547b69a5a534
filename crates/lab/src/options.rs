//! What to compare, and the command that says it.

use crate::Look;
use glam::UVec2;
use kajo_scene::Culling;
use std::path::PathBuf;

/// What `kajo compare` was asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct CompareOptions {
    /// Files, or `builtin:NAME`.
    pub scenes: Vec<String>,
    /// Folder of the report.
    pub output: PathBuf,
    /// Ids of roles; empty: every role that has techniques.
    pub roles: Vec<String>,
    /// `ID[:param=value,…]`; empty: every technique of the roles with its defaults.
    pub techniques: Vec<String>,
    /// Size of the images, px; `None`: 720 rows in the camera's shape.
    pub size: Option<UVec2>,
    /// When the reference is good enough.
    pub reference: ReferenceStop,
    /// Timed frames of each technique.
    pub frames: u32,
    /// Seeds of each technique.
    pub repeat: u32,
    /// Frames of each moving sequence, for flicker, lag and ghosts; 0: none. Each needs a reference of its own.
    pub temporal: u32,
    /// Most that a frame may cost, ms.
    pub budget_ms: Option<f64>,
    /// Camera by name or index; `None`: the first.
    pub camera: Option<String>,
    /// Where the camera is put instead of its place in the scene.
    pub look: Option<Look>,
    /// Environment that replaces the scene's.
    pub environment: Option<PathBuf>,
    /// Time of the animation, s.
    pub time: f64,
    /// Animation by name or index; `None`: the first.
    pub animation: Option<String>,
    /// Role ambient visibility: how far a surface blocks, m; `None`: a tenth of the scene's diagonal.
    pub ambient_distance: Option<f32>,
    /// Instances that rays of the techniques do not meet; the reference has all.
    pub ray_culling: Culling,
    /// Seed of the reference, and first seed of the techniques.
    pub seed: u64,
    /// Threads of the reference; `None`: all.
    pub threads: Option<usize>,
}

/// When the reference is good enough.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ReferenceStop {
    /// After so many samples per pixel.
    Spp(u32),
    /// At this relative standard error.
    Noise(f32),
}

impl Default for CompareOptions {
    fn default() -> Self {
        Self {
            scenes: vec![],
            output: PathBuf::new(),
            roles: vec![],
            techniques: vec![],
            size: None,
            reference: ReferenceStop::Spp(256),
            frames: 10,
            repeat: 4,
            temporal: 0,
            budget_ms: None,
            camera: None,
            look: None,
            environment: None,
            time: 0.0,
            animation: None,
            ambient_distance: None,
            ray_culling: Culling::Off,
            seed: 0,
            threads: None,
        }
    }
}

impl CompareOptions {
    /// The command line that repeats the comparison, every value written out. Threads are left out: they change no result.
    pub fn command(&self) -> String {
        let mut words = vec!["kajo".to_owned(), "compare".to_owned()];
        words.extend(self.scenes.iter().cloned());
        let mut flag = |name: &str, value: String| words.extend([name.to_owned(), value]);
        flag("-o", self.output.display().to_string());
        if !self.roles.is_empty() {
            flag("--role", self.roles.join(","));
        }
        self.techniques.iter().for_each(|t| flag("--technique", t.clone()));
        if let Some(size) = self.size {
            flag("--size", format!("{}x{}", size.x, size.y));
        }
        match self.reference {
            ReferenceStop::Spp(spp) => flag("--reference-spp", spp.to_string()),
            ReferenceStop::Noise(error) => flag("--reference-noise", error.to_string()),
        }
        flag("--frames", self.frames.to_string());
        flag("--repeat", self.repeat.to_string());
        if self.temporal > 0 {
            flag("--temporal", self.temporal.to_string());
        }
        if let Some(budget) = self.budget_ms {
            flag("--budget-ms", budget.to_string());
        }
        if let Some(camera) = &self.camera {
            flag("--camera", camera.clone());
        }
        if let Some(Look { from, at, fov }) = self.look {
            flag("--look-from", format!("{},{},{}", from.x, from.y, from.z));
            flag("--look-at", format!("{},{},{}", at.x, at.y, at.z));
            fov.into_iter().for_each(|degrees| flag("--fov", degrees.to_string()));
        }
        if let Some(environment) = &self.environment {
            flag("--env", environment.display().to_string());
        }
        if self.time != 0.0 {
            flag("--frame", self.time.to_string());
        }
        if let Some(animation) = &self.animation {
            flag("--animation", animation.clone());
        }
        if let Some(distance) = self.ambient_distance {
            flag("--ambient-distance", distance.to_string());
        }
        if self.ray_culling != Culling::Off {
            flag("--ray-culling", self.ray_culling.to_string());
        }
        flag("--seed", self.seed.to_string());
        if self.techniques.is_empty() {
            words.push("--all".into());
        }
        words.iter().map(|word| quoted(word)).collect::<Vec<_>>().join(" ")
    }
}

/// A word as a POSIX shell takes it.
pub fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./:=,+@%".contains(c);
    if !word.is_empty() && word.chars().all(plain) { word.to_owned() } else { format!("'{}'", word.replace('\'', r"'\''")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn command_says_everything_that_decides_the_result() {
        let options = CompareOptions {
            scenes: vec!["builtin:shadows".into(), "my scene's.glb".into()],
            output: "report".into(),
            roles: vec!["direct-visibility".into()],
            techniques: vec!["shadow/map:resolution=512".into(), "shadow/none".into()],
            size: Some(UVec2::new(320, 180)),
            reference: ReferenceStop::Noise(0.01),
            budget_ms: Some(2.5),
            time: 0.5,
            ray_culling: Culling::SolidAngle(0.001),
            look: Some(Look { from: glam::Vec3::new(-1.0, 2.5, 3.0), at: glam::Vec3::ZERO, fov: Some(40.0) }),
            ..CompareOptions::default()
        };
        assert_eq!(
            options.command(),
            r"kajo compare builtin:shadows 'my scene'\''s.glb' -o report --role direct-visibility --technique shadow/map:resolution=512 --technique shadow/none --size 320x180 --reference-noise 0.01 --frames 10 --repeat 4 --budget-ms 2.5 --look-from -1,2.5,3 --look-at 0,0,0 --fov 40 --frame 0.5 --ray-culling solid-angle:0.001 --seed 0"
        );
        assert!(CompareOptions { scenes: vec!["a".into()], output: "o".into(), ..CompareOptions::default() }.command().ends_with("--all"));
    }
}

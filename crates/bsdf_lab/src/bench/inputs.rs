//! Pairs of directions that calls go round.

use glam::Vec3;
use kajo_bsdf::models::V3;
use kajo_sampling::Rng;

/// Pairs handed over at once; with their values they lie in the first cache.
pub const BLOCK: usize = 1024;

/// How many blocks are different: each pairs the same lights with other viewers.
const BLOCKS: usize = 64;

/// Viewers move on by this many from block to block.
const STEP: usize = BLOCK / BLOCKS;

/// Directions above the surface, uniform in solid angle.
pub struct Inputs {
    lights: Vec<Vec3>,
    viewers: Vec<Vec3>,
}

impl Inputs {
    /// The same every time.
    #[allow(clippy::new_without_default, reason = "numbers are drawn: that should be seen")]
    pub fn new() -> Self {
        let mut rng = Rng::new(34);
        let mut direction = || {
            let v = V3::<f64>::from_angles(rng.next_f64().acos(), std::f64::consts::TAU * rng.next_f64());
            Vec3::new(v.x as f32, v.y as f32, v.z as f32)
        };
        let lights = (0..BLOCK).map(|_| direction()).collect();
        let mut viewers: Vec<Vec3> = (0..BLOCK).map(|_| direction()).collect();
        viewers.extend_from_within(..);
        Self { lights, viewers }
    }

    /// How many pairs are different.
    pub fn pairs(&self) -> usize {
        BLOCKS * BLOCK
    }

    /// Lights and viewers of a block; blocks repeat.
    pub fn block(&self, index: u64) -> (&[Vec3], &[Vec3]) {
        let first = index as usize % BLOCKS * STEP;
        (&self.lights, &self.viewers[first..first + BLOCK])
    }
}

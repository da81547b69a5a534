//! The fourth channel of the image.

use crate::Steps;
use crate::environment::KdSampler;
use crate::environment::block::pixel;
use glam::{UVec2, Vec2};

/// The density of every pixel: on a GPU the unused alpha channel of the environment, so that the read of the radiance brings it along. Read
/// with nearest filtering.    \[Ergun15] chapter 6
#[derive(Clone, Debug)]
pub struct AlphaPlane {
    size: UVec2,
    /// `height × width`, row-major, per unit area of (u, v): constant inside of a block.
    densities: Vec<f32>,
}

impl AlphaPlane {
    /// The plane of a sampler.
    pub fn new(sampler: &KdSampler) -> Self {
        let size = sampler.size();
        let mut densities = vec![0.0; size.element_product() as usize];
        for (index, block) in sampler.blocks().iter().enumerate() {
            let density = sampler.density(index);
            for y in usize::from(block.y0)..usize::from(block.y1) {
                let row = y * size.x as usize;
                densities[row + usize::from(block.x0)..row + usize::from(block.x1)].fill(density);
            }
        }
        Self { size, densities }
    }

    /// Density per unit area at a point of [0, 1)².
    #[inline]
    pub fn density(&self, uv: Vec2) -> f32 {
        self.density_counted(uv, &mut ())
    }

    /// [`Self::density`], counting the reads.
    #[inline]
    pub fn density_counted(&self, uv: Vec2, steps: &mut impl Steps) -> f32 {
        let at = pixel(uv, self.size);
        steps.step();
        self.densities[at.y as usize * self.size.x as usize + at.x as usize]
    }

    /// Memory, bytes; none where it fills a channel that is there anyway.
    pub fn bytes(&self) -> usize {
        size_of_val(self.densities.as_slice())
    }
}

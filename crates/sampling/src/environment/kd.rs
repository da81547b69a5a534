//! The sampler by blocks: one formula, one read.

use super::{Block, BlockTree, Criterion, DensityImage, EnvironmentError, ReciprocalLaw};
use crate::Steps;
use glam::{UVec2, Vec2};

/// Draws points of an environment: a block by the fitted law, then a uniform point of the block. O(1) whatever their number.
///
/// ```text
/// p(u, v) = f(i) · w h / A_i,   A_i the pixels of block i of w × h                  [Ergun15] chapter 6
/// ```
///
/// f is the fitted law and never the share of the light it was fitted to, so that the density is the one that is drawn from. It is positive
/// everywhere.
#[derive(Clone, Debug)]
pub struct KdSampler {
    size: UVec2,
    law: ReciprocalLaw,
    /// Largest share first.
    blocks: Vec<Block>,
}

impl KdSampler {
    /// Pixels to a block at which the light of real environments is still well described.
    pub const DEFAULT_COMPRESSION: u32 = 170;

    /// The sampler of `count` blocks of an image.
    ///
    /// # Errors
    /// [`EnvironmentError::Blocks`].
    pub fn new(image: &DensityImage, count: usize) -> Result<Self, EnvironmentError> {
        Ok(Self::from_tree(&BlockTree::new(image, count, Criterion::default())?))
    }

    /// The sampler of the leaves of a tree.
    pub fn from_tree(tree: &BlockTree) -> Self {
        let ranked: Vec<_> = tree.ranked_leaves().into_iter().map(|leaf| tree.nodes()[leaf as usize]).collect();
        let total: f64 = ranked.iter().map(|leaf| leaf.share).sum();
        let shares: Vec<f64> = ranked.iter().map(|leaf| leaf.share / total).collect();
        Self { size: tree.size(), law: ReciprocalLaw::fit(&shares), blocks: ranked.iter().map(|leaf| leaf.block).collect() }
    }

    /// Number of blocks of the preset 1 : 170 for an image of that size.
    pub fn default_count(size: UVec2) -> usize {
        (size.element_product() / Self::DEFAULT_COMPRESSION).max(1) as usize
    }

    /// A point in [0, 1)² and its density per unit area; `xi` chooses the block, `u` the place in it.
    #[inline]
    pub fn sample(&self, xi: f64, u: Vec2) -> (Vec2, f32) {
        self.sample_counted(xi, u, &mut ())
    }

    /// [`Self::sample`], counting the reads.
    #[inline]
    pub fn sample_counted(&self, xi: f64, u: Vec2, steps: &mut impl Steps) -> (Vec2, f32) {
        let index = self.law.index(xi);
        steps.step();
        let block = self.blocks[index];
        (block.point(u, self.size), self.density_of(index, block))
    }

    /// Density per unit area of (u, v) in block `index`, constant over it.
    pub fn density(&self, index: usize) -> f32 {
        self.density_of(index, self.blocks[index])
    }

    #[inline]
    fn density_of(&self, index: usize, block: Block) -> f32 {
        (self.law.pmf(index) * f64::from(self.size.element_product()) / f64::from(block.area())) as f32
    }

    /// Width and height of the image, px.
    pub fn size(&self) -> UVec2 {
        self.size
    }

    /// The law of the index.
    pub fn law(&self) -> &ReciprocalLaw {
        &self.law
    }

    /// The blocks, by index.
    pub fn blocks(&self) -> &[Block] {
        &self.blocks
    }

    /// Memory that sampling reads from, bytes.
    pub fn bytes(&self) -> usize {
        size_of::<Self>() + size_of_val(self.blocks.as_slice())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Rng;
    use crate::environment::block::pixel;
    use crate::environment::stratum;
    use crate::environment::test_maps::{all_maps, sunny};
    use crate::statistics::chi_square_p_value;

    fn sampler(size: UVec2, luminance: &[f32], blocks: usize) -> KdSampler {
        KdSampler::new(&DensityImage::from_luminance(size, luminance).unwrap(), blocks).unwrap()
    }

    const DRAWS: u32 = 1_000_000;

    /// p-value of a million indices, drawn by the numbers of `xi`, against a law.
    fn p_value(sampler: &KdSampler, law: &ReciprocalLaw, mut xi: impl FnMut(u32) -> f64) -> f64 {
        let mut counts = vec![0.0; law.len()];
        (0..DRAWS).for_each(|k| counts[sampler.law.index(xi(k))] += 1.0);
        let expected: Vec<f64> = (0..law.len()).map(|i| law.pmf(i) * f64::from(DRAWS)).collect();
        chi_square_p_value(&counts, &expected, 0)
    }

    #[test]
    fn block_indices_follow_the_fitted_law_and_a_planted_fault_is_seen() {
        for (name, size, luminance) in all_maps() {
            let sampler = sampler(size, &luminance, 771);
            let mut rng = Rng::new(81);
            let p = p_value(&sampler, &sampler.law, |_| rng.next_1d().into());
            assert!(p > 0.01, "{name}: {p}");
            let wrong = ReciprocalLaw::new(771, sampler.law.u() * 1.3);
            assert!(p_value(&sampler, &wrong, |_| rng.next_1d().into()) < 1e-6, "{name}: another law passes");
        }
    }

    #[test]
    fn points_lie_in_their_block_and_the_density_is_that_of_the_block() {
        let (size, luminance) = sunny(510, 254);
        let sampler = sampler(size, &luminance, 3084);
        let mut rng = Rng::new(82);
        for _ in 0..100_000 {
            let xi = rng.next_f64();
            let (point, density) = sampler.sample(xi, rng.next_2d());
            let index = sampler.law.index(xi);
            assert!(sampler.blocks[index].contains(pixel(point, size)), "{point} of {:?}", sampler.blocks[index]);
            assert_eq!(density, sampler.density(index));
        }
        for (index, block) in sampler.blocks.iter().enumerate() {
            for corner in [0.0, crate::bits::ONE_MINUS_EPSILON] {
                assert!(block.contains(pixel(block.point(Vec2::splat(corner), size), size)), "block {index}");
            }
        }
    }

    #[test]
    fn a_sample_takes_one_read_whatever_the_number_of_blocks() {
        let (size, luminance) = sunny(512, 256);
        let image = DensityImage::from_luminance(size, &luminance).unwrap();
        for blocks in [256, 1024, 4096, 16_384] {
            let sampler = KdSampler::new(&image, blocks).unwrap();
            let (mut reads, mut rng) = (0u64, Rng::new(83));
            for _ in 0..1000 {
                sampler.sample_counted(rng.next_f64(), rng.next_2d(), &mut reads);
            }
            assert_eq!((sampler.blocks.len(), reads), (blocks, 1000));
            assert_eq!(sampler.bytes() - size_of::<KdSampler>(), 8 * blocks);
        }
    }

    /// The baseline: inversion of the cumulative distribution of all pixels.
    #[test]
    fn inverting_the_cumulative_distribution_draws_pixels_by_their_share_and_a_planted_fault_is_seen() {
        for (name, size, luminance) in all_maps() {
            let image = DensityImage::from_luminance(size, &luminance).unwrap();
            let weights: Vec<f32> = image.shares().iter().map(|&f| f as f32).collect();
            let baseline = crate::Piecewise2d::new(&weights, size.x as usize, size.y as usize).unwrap();
            let (mut rng, mut counts) = (Rng::new(86), vec![0.0; weights.len()]);
            for _ in 0..DRAWS {
                let at = pixel(baseline.sample(rng.next_2d()).0, size);
                counts[(at.y * size.x + at.x) as usize] += 1.0;
            }
            let mut expected: Vec<f64> = image.shares().iter().map(|f| f * f64::from(DRAWS)).collect();
            let p = chi_square_p_value(&counts, &expected, 0);
            assert!(p > 0.01, "{name}: {p}");
            expected.rotate_left(1);
            assert!(chi_square_p_value(&counts, &expected, 0) < 1e-6, "{name}: shifted by a pixel");
        }
    }

    /// Variance over 64 estimates of the irradiance of a surface, each of 64 samples, averaged over a picture of 42 orientations.
    fn mean_variance(sampler: &KdSampler, luminance: &[f32], mut xi: impl FnMut(u32, &mut Rng) -> f64) -> f64 {
        const SAMPLES: u32 = 64;
        let size = sampler.size;
        let mut rng = Rng::new(84);
        let direction = |p: Vec2| {
            let (phi, theta) = (p.x * std::f32::consts::TAU, p.y * std::f32::consts::PI);
            glam::Vec3::new(phi.cos() * theta.sin(), theta.cos(), phi.sin() * theta.sin())
        };
        let normals: Vec<_> =
            (0..42).map(|i| direction(Vec2::new((i % 7) as f32 + 0.5, (i / 7) as f32 + 0.5) / Vec2::new(7.0, 6.0))).collect();
        let mut moments = vec![crate::statistics::Moments::default(); normals.len()];
        for _ in 0..64 {
            let mut irradiance = vec![0.0f64; normals.len()];
            for k in 0..SAMPLES {
                let (point, density) = sampler.sample(xi(k, &mut rng), rng.next_2d());
                let pixel = pixel(point, size);
                let sin_theta = (point.y * std::f32::consts::PI).sin();
                let value = luminance[(pixel.y * size.x + pixel.x) as usize] * 2.0 * std::f32::consts::PI.powi(2) * sin_theta / density;
                let wi = direction(point);
                irradiance.iter_mut().zip(&normals).for_each(|(e, n)| *e += f64::from(value * n.dot(wi).max(0.0) / SAMPLES as f32));
            }
            moments.iter_mut().zip(irradiance).for_each(|(m, e)| m.add(e));
        }
        moments.iter().map(|m| m.variance()).sum::<f64>() / moments.len() as f64
    }

    #[test]
    fn strata_lower_the_variance_and_keep_the_law() {
        for (name, size, luminance) in all_maps() {
            let sampler = sampler(size, &luminance, 256);
            let plain = mean_variance(&sampler, &luminance, |_, rng| rng.next_f64());
            let stratified = mean_variance(&sampler, &luminance, |k, rng| stratum(k, 64, rng.next_1d()));
            assert!(stratified < plain, "{name}: {stratified} and {plain}");
            let mut rng = Rng::new(85);
            let p = p_value(&sampler, &sampler.law, |k| stratum(k % 64, 64, rng.next_1d()));
            assert!(p > 0.01, "{name}: {p}");
            let once = p_value(&sampler, &sampler.law, |k| stratum(k % 63, 64, rng.next_1d()));
            assert!(once < 1e-6, "{name}: a stratum left out is not seen");
        }
    }
}

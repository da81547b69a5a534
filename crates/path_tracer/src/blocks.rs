//! The variance of a pixel's mean, measured between blocks of consecutive samples.
//!
//! Quasi-random samples of one pixel are not independent, so their sample variance divided by n says nothing about the mean but
//! that it is better than that. Blocks of 2^k consecutive samples are each a well-spread set of their own, and the scatter of the
//! means of B such blocks, divided by B, bounds the variance of the mean of all: exactly for independent samples, from above for
//! scrambled nets, whose blocks fill each other's gaps (negative correlation). Between 4 and 8 blocks are kept, so that their
//! size grows with n and with it the gain of the point set.    \[Owen97] for the variance of scrambled nets

/// Blocks kept; the size of a block doubles when all are full.
pub(crate) const BLOCKS: usize = 8;

/// Sums of one channel's samples in at most [`BLOCKS`] blocks of equal size. The number of samples is the film's, not stored here.
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(transparent)]
pub(crate) struct BlockSums([f32; BLOCKS]);

/// Samples in each block after `n` samples.
fn block_size(n: u32) -> u32 {
    n.div_ceil(BLOCKS as u32).next_power_of_two()
}

/// Two-sided 95 % quantile of Student's t with `blocks − 1` degrees of freedom.    \[Student08]
const STUDENT_T_95: [f32; BLOCKS + 1] = [f32::INFINITY, f32::INFINITY, 12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365];

impl BlockSums {
    /// Adds sample number `i`, counted from 0; samples come in order.
    #[inline]
    pub(crate) fn add(&mut self, i: u32, value: f32) {
        let size = block_size(i + 1);
        if i > 0 && size > block_size(i) {
            let old = self.0;
            self.0 = [0.0; BLOCKS];
            for (sum, pair) in self.0.iter_mut().zip(old.chunks_exact(2)) {
                *sum = pair[0] + pair[1];
            }
        }
        self.0[(i / size) as usize] += value;
    }

    /// Variance of the mean of the first `n` samples; infinite for fewer than two blocks.
    pub(crate) fn variance_of_mean(&self, n: u32) -> f32 {
        let size = block_size(n);
        let full = (n / size) as usize;
        if full < 2 {
            return f32::INFINITY;
        }
        let mean = |sum: f32| f64::from(sum) / f64::from(size);
        let center = self.0[..full].iter().map(|&s| mean(s)).sum::<f64>() / full as f64;
        let scatter = self.0[..full].iter().map(|&s| (mean(s) - center).powi(2)).sum::<f64>() / (full - 1) as f64;
        (scatter * f64::from(size) / f64::from(n)) as f32
    }

    /// Factor from the standard error to the half width of the 95 % confidence interval after `n` samples.
    pub(crate) fn confidence_factor(n: u32) -> f32 {
        STUDENT_T_95[(n / block_size(n.max(1))) as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::UVec2;
    use kajo_sampling::{Sampler, SamplerKind};

    /// Estimated and true variance of the mean of f over `n` samples, averaged over pixels; the mean of f is `mean`.
    fn variances(kind: SamplerKind, n: u32, mean: f64, f: impl Fn(f32, f32) -> f32) -> (f64, f64) {
        let pixels = 4096;
        let (mut estimated, mut truth) = (0.0, 0.0);
        for pixel in 0..pixels {
            let (mut blocks, mut sum) = (BlockSums::default(), 0.0f64);
            for i in 0..n {
                let p = Sampler::new(kind, 1, UVec2::new(pixel % 64, pixel / 64), i).next_2d();
                blocks.add(i, f(p.x, p.y));
                sum += f64::from(f(p.x, p.y));
            }
            estimated += f64::from(blocks.variance_of_mean(n)) / f64::from(pixels);
            truth += (sum / f64::from(n) - mean).powi(2) / f64::from(pixels);
        }
        (estimated, truth)
    }

    #[test]
    fn variance_is_unbiased_for_independent_samples() {
        for n in [2, 7, 8, 9, 31, 64] {
            let (estimated, truth) = variances(SamplerKind::Independent, n, 0.25, |x, y| x * y);
            assert!((estimated / truth - 1.0).abs() < 0.1, "n = {n}: {estimated} for {truth}");
        }
    }

    #[test]
    fn variance_is_a_bound_for_sobol_samples_and_closer_than_the_sample_variance() {
        for n in [16, 64, 256] {
            let (estimated, truth) = variances(SamplerKind::Sobol, n, 0.5, |x, y| f32::from(u8::from(x + 0.7 * y < 0.85)));
            let independent = 0.25 / f64::from(n);
            assert!(estimated > truth && estimated < 0.7 * independent, "n = {n}: {truth} < {estimated} < {independent}");
        }
    }

    #[test]
    fn blocks_hold_every_sample_at_every_count() {
        let mut blocks = BlockSums::default();
        for i in 0..1000 {
            blocks.add(i, 1.0 + i as f32);
            let n = i + 1;
            assert_eq!(blocks.0.iter().sum::<f32>(), (n * (n + 1) / 2) as f32);
            assert!((n / block_size(n)) as usize <= BLOCKS && (n < 4 || n / block_size(n) >= 4));
        }
    }

    #[test]
    fn variance_of_one_sample_is_unknown_and_of_a_constant_is_zero() {
        let mut blocks = BlockSums::default();
        blocks.add(0, 3.0);
        assert_eq!(blocks.variance_of_mean(1), f32::INFINITY);
        (1..100).for_each(|i| blocks.add(i, 3.0));
        assert_eq!(blocks.variance_of_mean(100), 0.0);
    }
}

//! What a random technique makes of the same picture with other random numbers.

use crate::error::check;
use crate::{MetricsError, REL_MSE_EPSILON};
use kajo_image::Image;
use kajo_units::LinearRgb;

/// The noise of one run, from the scatter of several.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Scatter {
    /// Unbiased variance of one run, as a mean over pixels and channels: the MSE of a run of an unbiased technique.
    pub variance: f64,
    /// The same of s² / (x̄² + ε): the relative MSE, ε being [`REL_MSE_EPSILON`].
    pub relative: f64,
}

/// Scatter of K independent runs about their mean.
///
/// ```text
/// s² = Σ (x − x̄)² / (K − 1)
/// ```
///
/// # Errors
/// Fewer than two runs, sizes that differ, NaN.
pub fn scatter(runs: &[Image<LinearRgb>]) -> Result<Scatter, MetricsError> {
    let [first, _, ..] = runs else { return Err(MetricsError::TooFewRepeats { got: runs.len() }) };
    runs.iter().try_for_each(|run| check("image", run, first))?;
    let (mut variance, mut relative) = (0.0, 0.0);
    for pixel in 0..first.pixels().len() {
        for channel in 0..3 {
            let (mean, spread) = moments(runs, pixel, channel);
            variance += spread;
            relative += spread / (mean * mean + REL_MSE_EPSILON);
        }
    }
    let n = (3 * first.pixels().len()) as f64;
    Ok(Scatter { variance: variance / n, relative: relative / n })
}

/// Mean and unbiased variance over the runs of one channel of one pixel.
pub(crate) fn moments(runs: &[Image<LinearRgb>], pixel: usize, channel: usize) -> (f64, f64) {
    let k = runs.len() as f64;
    let values = runs.iter().map(|run| f64::from(run.pixels()[pixel][channel]));
    let mean = values.clone().sum::<f64>() / k;
    (mean, values.map(|v| (v - mean).powi(2)).sum::<f64>() / (k - 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_images::{scene, with_noise};
    use glam::UVec2;

    /// Noise of 0.1 on grey of 0.5: variance 0.01, relative 0.01/(0.25 + ε); twice the noise has four times the variance.
    #[test]
    fn planted_noise_is_recovered() {
        let truth = scene(UVec2::splat(64), 0.0).map(|_| LinearRgb::splat(0.5));
        let of = |noise| scatter(&[0, 1, 2, 3].map(|seed| with_noise(&truth, noise, seed))).unwrap();
        let Scatter { variance, relative } = of(0.1);
        assert!((variance / 0.01 - 1.0).abs() < 0.03, "{variance}");
        assert!((relative / (0.01 / (0.25 + REL_MSE_EPSILON)) - 1.0).abs() < 0.06, "{relative}");
        assert!((of(0.2).variance / variance - 4.0).abs() < 0.2);
        assert_eq!(scatter(&[truth.clone(), truth.clone()]), Ok(Scatter { variance: 0.0, relative: 0.0 }));
        assert_eq!(scatter(std::slice::from_ref(&truth)), Err(MetricsError::TooFewRepeats { got: 1 }));
        let small = scene(UVec2::splat(8), 0.0);
        assert!(matches!(scatter(&[truth, small]), Err(MetricsError::SizeMismatch { .. })));
    }
}

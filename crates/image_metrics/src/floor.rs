//! What the reference's own noise allows to be said.
//!
//! A reference R estimates the truth with a known variance per pixel. An image that equals the truth still shows MSE = mean var(R): the
//! floor. Two images are told apart only when the difference of their errors exceeds what that noise does to it.

use crate::MetricsError;
use crate::error::{check, check_size};
use kajo_image::Image;
use kajo_units::LinearRgb;

/// √(mean variance): the RMSE that a perfect image has against this reference. `variance`: of the reference's pixel means.
pub fn rmse_floor(variance: &Image<LinearRgb>) -> f64 {
    let sum: f64 = variance.pixels().iter().map(|v| (0..3).map(|c| f64::from(v[c].max(0.0))).sum::<f64>()).sum();
    (sum / (3 * variance.pixels().len()).max(1) as f64).sqrt()
}

/// Whether an image with `mse` differs from the truth at all: MSE above the floor by more than `sigmas` of its own standard error.
///
/// For an exact image, e² of a pixel is var·χ²₁, so MSE has mean floor² and variance 2 Σ var² / n²; the channels of a pixel count as
/// fully correlated, which errs on the side of "not distinguishable".
///
/// # Errors
/// Sizes that differ, NaN.
pub fn is_above_floor(
    image: &Image<LinearRgb>,
    reference: &Image<LinearRgb>,
    variance: &Image<LinearRgb>,
    sigmas: f64,
) -> Result<bool, MetricsError> {
    check_size("variance", variance.size(), reference.size())?;
    let mse = crate::mse(image, reference)?;
    let pixels = variance.pixels();
    let sum_of_squares: f64 = pixels.iter().map(|v| (f64::from(v.0.max(glam::Vec3::ZERO).element_sum()) / 3.0).powi(2)).sum();
    let standard_error = (2.0 * sum_of_squares).sqrt() / pixels.len() as f64;
    // Rounding of f32 pixels: two exact ways to the same value differ by an ulp or two.
    let rounding = 4.0 * f64::from(f32::EPSILON).powi(2) * mean_square(reference);
    Ok(mse > rmse_floor(variance).powi(2) + sigmas * standard_error + rounding)
}

fn mean_square(image: &Image<LinearRgb>) -> f64 {
    image.pixels().iter().map(|p| f64::from(p.0.length_squared()) / 3.0).sum::<f64>() / image.pixels().len() as f64
}

/// MSE(a) − MSE(b), and the standard error that the reference's noise gives it.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct MseDifference {
    /// Negative when `a` is better.
    pub value: f64,
    /// One standard deviation.
    pub standard_error: f64,
}

impl MseDifference {
    /// How many standard errors apart; 0 for equal images, infinite for images that differ against an exact reference.
    pub fn sigmas(&self) -> f64 {
        if self.value == 0.0 { 0.0 } else { self.value.abs() / self.standard_error }
    }
}

/// Compares two images with one reference.
///
/// (A−R)² − (B−R)² = (A−B)(A+B−2R) is linear in R, so its variance is exactly Σ 4 (A−B)² var(R) / n² over the pixels; the channels of a
/// pixel count as fully correlated.
///
/// # Errors
/// Sizes that differ, NaN.
pub fn mse_difference(
    a: &Image<LinearRgb>,
    b: &Image<LinearRgb>,
    reference: &Image<LinearRgb>,
    variance: Option<&Image<LinearRgb>>,
) -> Result<MseDifference, MetricsError> {
    check("first image", a, reference)?;
    check("second image", b, reference)?;
    let n = a.pixels().len() as f64;
    let value = crate::mse(a, reference)? - crate::mse(b, reference)?;
    let Some(variance) = variance else { return Ok(MseDifference { value, standard_error: 0.0 }) };
    check_size("variance", variance.size(), reference.size())?;
    let sum: f64 = (0..a.pixels().len())
        .map(|i| {
            let deviation = |c: usize| f64::from((a.pixels()[i][c] - b.pixels()[i][c]).abs() * variance.pixels()[i][c].max(0.0).sqrt());
            (2.0 * (0..3).map(deviation).sum::<f64>() / 3.0).powi(2)
        })
        .sum();
    Ok(MseDifference { value, standard_error: sum.sqrt() / n })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_images::{scene, with_noise};
    use glam::UVec2;

    const SIGMA: f32 = 0.05;

    fn setup(seed: u64) -> (Image<LinearRgb>, Image<LinearRgb>, Image<LinearRgb>) {
        let truth = scene(UVec2::new(64, 64), 0.0);
        let reference = with_noise(&truth, SIGMA, seed);
        let variance = truth.map(|_| LinearRgb::splat(SIGMA * SIGMA));
        (truth, reference, variance)
    }

    #[test]
    fn the_truth_is_not_above_the_floor_and_a_small_fault_is() {
        for seed in 0..20 {
            let (truth, reference, variance) = setup(seed);
            assert!((rmse_floor(&variance) - f64::from(SIGMA)).abs() < 1e-6);
            assert!(!is_above_floor(&truth, &reference, &variance, 3.0).unwrap(), "seed {seed}");
            let fault = truth.map(|p| *p + LinearRgb::splat(0.03));
            assert!(is_above_floor(&fault, &reference, &variance, 3.0).unwrap(), "seed {seed}");
        }
    }

    #[test]
    fn an_exact_reference_tells_everything_apart_but_rounding() {
        let truth = scene(UVec2::new(16, 16), 0.0);
        let none = truth.map(|_| LinearRgb::BLACK);
        assert!(!is_above_floor(&truth, &truth, &none, 3.0).unwrap());
        assert!(!is_above_floor(&truth.map(|p| *p * (1.0 + f32::EPSILON)), &truth, &none, 3.0).unwrap());
        assert!(is_above_floor(&truth.map(|p| *p * 1.0001), &truth, &none, 3.0).unwrap());
    }

    /// The standard error predicts the spread over independent references.
    #[test]
    fn standard_error_of_a_difference_is_its_spread() {
        let truth = scene(UVec2::new(48, 48), 0.0);
        let (a, b) = (truth.map(|p| *p * 1.1), truth.map(|p| *p + LinearRgb::splat(0.04)));
        let runs: Vec<MseDifference> = (0..400)
            .map(|seed| {
                let reference = with_noise(&truth, SIGMA, 1000 + seed);
                let variance = truth.map(|_| LinearRgb::splat(SIGMA * SIGMA));
                mse_difference(&a, &b, &reference, Some(&variance)).unwrap()
            })
            .collect();
        let mean = runs.iter().map(|d| d.value).sum::<f64>() / 400.0;
        let spread = (runs.iter().map(|d| (d.value - mean).powi(2)).sum::<f64>() / 399.0).sqrt();
        // Channels of these references are independent, so the stated error is an upper bound within √3.
        let stated = runs[0].standard_error;
        assert!(spread < 1.1 * stated && spread > 0.9 * stated / 3f64.sqrt(), "{spread} for {stated}");
    }

    #[test]
    fn planted_winner_is_found() {
        let (truth, reference, variance) = setup(7);
        let (good, bad) = (truth.map(|p| *p * 1.01), truth.map(|p| *p * 1.3));
        let d = mse_difference(&good, &bad, &reference, Some(&variance)).unwrap();
        assert!(d.value < 0.0 && d.sigmas() > 5.0);
        let same = mse_difference(&good, &good, &reference, Some(&variance)).unwrap();
        assert_eq!((same.value, same.sigmas()), (0.0, 0.0));
    }
}

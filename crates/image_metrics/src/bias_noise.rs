//! Error of a random technique, split: what more samples would remove, and what they would not.

use crate::MetricsError;
use crate::error::{check, check_size};
use crate::scatter::moments;
use kajo_image::Image;
use kajo_units::LinearRgb;

/// The two parts of an error, each as a root mean square in the unit of the pixels.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct BiasNoise {
    /// √max(0, bias²): what averaging runs would not remove.
    pub bias: f64,
    /// √(mean variance of one run).
    pub noise: f64,
    /// The smallest bias that this many runs and this reference can show: √(mean s²/K + mean var R).
    pub bias_floor: f64,
    /// bias² before the clamp at 0, in its own standard errors for a technique without bias: above 4 there is a bias.
    pub bias_sigmas: f64,
}

/// Squared relative rounding of a pixel that two renderers computed in `f32` in two ways: with exact images it alone gives a scale.
const ROUNDING: f64 = 1e-12;

/// Splits the error of K independent runs against a reference, over pixels and channels.
///
/// ```text
/// noise² = mean s²,   s² the unbiased variance over runs
/// bias²  = mean (X̄ − R)² − mean s²/K − mean var(R)
/// ```
///
/// The two subtractions remove what the noise of the mean and of the reference add to the first term, so bias² has the right
/// expectation; it may come out below 0, which is then 0.
///
/// Without bias, (X̄ − R)² of a pixel has variance 2v² with v = s²/K + var(R), and s²/K has variance 2 (s²/K)²/(K − 1); the channels of a
/// pixel count as fully correlated. Their sum over pixels is the standard error of [`BiasNoise::bias_sigmas`].
///
/// # Errors
/// Fewer than two runs, sizes that differ, NaN.
pub fn bias_noise(
    runs: &[Image<LinearRgb>],
    reference: &Image<LinearRgb>,
    variance: Option<&Image<LinearRgb>>,
) -> Result<BiasNoise, MetricsError> {
    if runs.len() < 2 {
        return Err(MetricsError::TooFewRepeats { got: runs.len() });
    }
    runs.iter().try_for_each(|run| check("image", run, reference))?;
    if let Some(variance) = variance {
        check_size("variance", variance.size(), reference.size())?;
    }
    let k = runs.len() as f64;
    let (mut squared, mut within, mut of_reference, mut uncertainty) = (0.0, 0.0, 0.0, 0.0);
    for (i, r) in reference.pixels().iter().enumerate() {
        let (mut of_mean, mut total) = (0.0, ROUNDING * f64::from(r.0.length_squared()));
        for c in 0..3 {
            let (mean, spread) = moments(runs, i, c);
            let known = variance.map_or(0.0, |v| f64::from(v.pixels()[i][c].max(0.0)));
            within += spread;
            of_reference += known;
            squared += (mean - f64::from(r[c])).powi(2);
            of_mean += spread / k;
            total += spread / k + known;
        }
        uncertainty += 2.0 * total * total + 2.0 * of_mean * of_mean / (k - 1.0);
    }
    let n = (3 * reference.pixels().len()) as f64;
    let floor = (within / k + of_reference) / n;
    let excess = squared / n - floor;
    let bias_sigmas = if excess == 0.0 { 0.0 } else { excess / (uncertainty.sqrt() / n) };
    Ok(BiasNoise { bias: excess.max(0.0).sqrt(), noise: (within / n).sqrt(), bias_floor: floor.sqrt(), bias_sigmas })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_images::{scene, with_noise};
    use glam::UVec2;

    /// bias 0.05 and noise 0.1 planted; both come back, also through a noisy reference.
    #[test]
    fn planted_bias_and_noise_are_recovered() {
        let truth = scene(UVec2::new(96, 96), 0.0);
        let biased = truth.map(|p| *p + LinearRgb::new(0.05, -0.05, 0.05));
        let runs: Vec<_> = (0..8).map(|seed| with_noise(&biased, 0.1, seed)).collect();
        let reference = with_noise(&truth, 0.04, 99);
        let variance = truth.map(|_| LinearRgb::splat(0.04 * 0.04));
        let split = bias_noise(&runs, &reference, Some(&variance)).unwrap();
        assert!((split.bias - 0.05).abs() < 0.002, "{split:?}");
        assert!((split.noise - 0.1).abs() < 0.002, "{split:?}");
        // Without its variance the reference's noise counts as bias: the naive number is wrong by 28 %.
        assert!(bias_noise(&runs, &reference, None).unwrap().bias > 0.06);
    }

    #[test]
    fn an_unbiased_technique_shows_almost_none() {
        let truth = scene(UVec2::new(96, 96), 0.0);
        let runs: Vec<_> = (0..8).map(|seed| with_noise(&truth, 0.1, seed)).collect();
        let split = bias_noise(&runs, &truth, None).unwrap();
        assert!(split.bias < 0.3 * split.bias_floor, "{split:?}");
    }

    /// Visibility of a penumbra: shares of 16 shadow rays, often all lit. Its noise is far from normal and must not look like a bias.
    #[test]
    fn binary_noise_is_not_called_bias_and_a_planted_bias_is() {
        let size = UVec2::new(96, 96);
        let truth = Image::from_fn(size, |x, _| LinearRgb::splat((0.9 + x as f32 / 900.0).min(1.0)));
        let take = |seed: u64, shift: f32| {
            let mut random = crate::test_images::Random(seed);
            truth.map(|p| {
                let lit = (0..16).filter(|_| random.uniform() < p[0] - shift).count();
                LinearRgb::splat(lit as f32 / 16.0)
            })
        };
        for trial in 0..10 {
            let split = |shift| bias_noise(&[0, 1, 2, 3].map(|seed| take(100 * trial + seed, shift)), &truth, None).unwrap();
            assert!(split(0.0).bias_sigmas < 4.0, "{:?}", split(0.0));
            assert!(split(0.03).bias_sigmas > 4.0, "{:?}", split(0.03));
        }
    }

    #[test]
    fn a_deterministic_technique_is_all_bias() {
        let truth = scene(UVec2::new(16, 16), 0.0);
        let run = truth.map(|p| *p + LinearRgb::splat(0.25));
        let split = bias_noise(&[run.clone(), run], &truth, None).unwrap();
        assert!((split.bias - 0.25).abs() < 1e-6 && split.noise == 0.0 && split.bias_sigmas > 100.0);
        let exact = bias_noise(&[truth.clone(), truth.clone()], &truth, None).unwrap();
        assert_eq!(exact.bias_sigmas, 0.0);
    }

    #[test]
    fn one_run_is_refused() {
        let truth = scene(UVec2::new(16, 16), 0.0);
        assert_eq!(bias_noise(std::slice::from_ref(&truth), &truth, None), Err(MetricsError::TooFewRepeats { got: 1 }));
    }
}

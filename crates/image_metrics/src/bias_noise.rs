//! Error of a random technique, split: what more samples would remove, and what they would not.

use crate::MetricsError;
use crate::error::{check, check_size};
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
}

/// Splits the error of K independent runs against a reference, over pixels and channels.
///
///     noise² = mean s²,   s² the unbiased variance over runs
///     bias²  = mean (X̄ − R)² − mean s²/K − mean var(R)
///
/// The two subtractions remove what the noise of the mean and of the reference add to the first term, so bias² has the right
/// expectation; it may come out below 0, which is then 0.
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
    let (mut squared, mut within, mut of_reference) = (0.0, 0.0, 0.0);
    for (i, r) in reference.pixels().iter().enumerate() {
        for c in 0..3 {
            let values = runs.iter().map(|run| f64::from(run.pixels()[i][c]));
            let mean = values.clone().sum::<f64>() / k;
            within += values.map(|v| (v - mean).powi(2)).sum::<f64>() / (k - 1.0);
            squared += (mean - f64::from(r[c])).powi(2);
            of_reference += variance.map_or(0.0, |v| f64::from(v.pixels()[i][c].max(0.0)));
        }
    }
    let n = (3 * reference.pixels().len()) as f64;
    let floor = (within / k + of_reference) / n;
    Ok(BiasNoise { bias: (squared / n - floor).max(0.0).sqrt(), noise: (within / n).sqrt(), bias_floor: floor.sqrt() })
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

    #[test]
    fn a_deterministic_technique_is_all_bias() {
        let truth = scene(UVec2::new(16, 16), 0.0);
        let run = truth.map(|p| *p + LinearRgb::splat(0.25));
        let split = bias_noise(&[run.clone(), run], &truth, None).unwrap();
        assert!((split.bias - 0.25).abs() < 1e-6 && split.noise == 0.0);
    }

    #[test]
    fn one_run_is_refused() {
        let truth = scene(UVec2::new(16, 16), 0.0);
        assert_eq!(bias_noise(std::slice::from_ref(&truth), &truth, None), Err(MetricsError::TooFewRepeats { got: 1 }));
    }
}

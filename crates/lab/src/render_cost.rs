//! What a picture of the path tracer costs, and how noisy it is for that: samples and rays a second, and the efficiency of the whole.
//!
//! The same picture is rendered several times with other random numbers. Their scatter is the noise of one of them, without knowing the true picture; against a reference
//! the error counts instead, which has a bias in it, too.

use crate::LabError;
use cpu_time::ProcessTime;
use kajo_image::Image;
use kajo_image_metrics::{MetricsError, mse, rel_mse, scatter};
use kajo_path_tracer::{Control, Settings, Stop, Tracer, render};
use kajo_units::LinearRgb;

/// Time and error of one picture, by [`render_cost`].
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct RenderCost {
    /// Width, px.
    pub width: u32,
    /// Height, px.
    pub height: u32,
    /// Samples per pixel.
    pub spp: u32,
    /// Wall-clock time, s: the least of the repeats, since other work only ever adds to it.
    pub seconds: f64,
    /// Time of all processors, s: the least of the repeats.
    pub cpu_seconds: f64,
    /// Samples a second of wall-clock time.
    pub samples_per_s: f64,
    /// Rays a second of wall-clock time.
    pub rays_per_s: f64,
    /// Rays a sample.
    pub rays_per_sample: f64,
    /// Mean squared error of one picture over pixels and channels.
    pub mse: f64,
    /// The same, each pixel's over the square of its value (+ 0.01).    \[Rousselle11] section 5
    pub rel_mse: f64,
    /// 1 / (seconds · mse): twice as high is as good as a machine twice as fast. It does not depend on the samples per pixel, as far as the error falls as 1/spp.
    pub efficiency: f64,
    /// Samples that were NaN or infinite and count as black.
    pub invalid_samples: u64,
}

/// Renders `repeat` pictures with the seeds from that of `settings` on, in the current rayon pool. `None` when `control` ends it.
///
/// # Errors
/// Settings that the tracer refuses; a reference of another size, or fewer than two repeats without one ([`LabError::Metrics`]).
pub fn render_cost(
    tracer: &Tracer,
    settings: &Settings,
    spp: u32,
    repeat: u32,
    reference: Option<&Image<LinearRgb>>,
    control: &dyn Control,
) -> Result<Option<RenderCost>, LabError> {
    let mut takes: Vec<Image<LinearRgb>> = Vec::new();
    let (mut seconds, mut cpu_seconds) = (f64::INFINITY, f64::INFINITY);
    let (mut samples, mut rays, mut invalid_samples) = (0, 0, 0);
    for take in 0..repeat {
        let settings = Settings { seed: settings.seed.wrapping_add(take.into()), ..settings.clone() };
        let start = ProcessTime::try_now().ok();
        let film = render(tracer, &settings, Stop::at_spp(spp), None, control)?;
        let cpu = start.and_then(|start| start.try_elapsed().ok());
        let frame = film.develop();
        if frame.spp < spp {
            return Ok(None);
        }
        seconds = seconds.min(frame.seconds);
        cpu_seconds = cpu_seconds.min(cpu.map_or(f64::NAN, |cpu| cpu.as_secs_f64()));
        samples += frame.samples;
        rays += frame.rays;
        invalid_samples += frame.invalid_samples;
        takes.push(frame.beauty().clone());
    }
    let failed = |source| LabError::Metrics { what: "the benchmark".into(), source };
    let (mse, rel_mse) = match reference {
        Some(reference) => errors(&takes, reference),
        None => scatter(&takes).map(|scatter| (scatter.variance, scatter.relative)),
    }
    .map_err(failed)?;
    let per_take = |count: u64| count as f64 / f64::from(repeat);
    Ok(Some(RenderCost {
        width: settings.size.x,
        height: settings.size.y,
        spp,
        seconds,
        cpu_seconds,
        samples_per_s: per_take(samples) / seconds,
        rays_per_s: per_take(rays) / seconds,
        rays_per_sample: rays as f64 / samples as f64,
        mse,
        rel_mse,
        efficiency: 1.0 / (seconds * mse),
        invalid_samples,
    }))
}

/// Mean over the takes of MSE and relMSE against a reference.
fn errors(takes: &[Image<LinearRgb>], reference: &Image<LinearRgb>) -> Result<(f64, f64), MetricsError> {
    let mut sum = (0.0, 0.0);
    for take in takes {
        sum.0 += mse(take, reference)?;
        sum.1 += rel_mse(take, reference)?;
    }
    let n = takes.len() as f64;
    Ok((sum.0 / n, sum.1 / n))
}

/// The exponent b of y = a xᵇ by least squares over (ln x, ln y): 1 for cost in proportion, 0 for none, 0.5 for the square root.
///
/// `None` for fewer than two different x, or a number that has no logarithm.
pub fn exponent(points: &[(f64, f64)]) -> Option<f64> {
    let logs: Vec<(f64, f64)> = points.iter().map(|(x, y)| (x.ln(), y.ln())).collect();
    // The variance of equal numbers is rounding, not 0.
    let differ = logs.windows(2).any(|pair| pair[0].0 != pair[1].0);
    if !differ || logs.iter().any(|(x, y)| !x.is_finite() || !y.is_finite()) {
        return None;
    }
    let n = logs.len() as f64;
    let mean = logs.iter().fold((0.0, 0.0), |sum, (x, y)| (sum.0 + x / n, sum.1 + y / n));
    let (mut covariance, mut variance) = (0.0, 0.0);
    for (x, y) in logs {
        covariance += (x - mean.0) * (y - mean.1);
        variance += (x - mean.0) * (x - mean.0);
    }
    Some(covariance / variance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::UVec2;
    use kajo_path_tracer::uncontrolled;
    use kajo_sampling::{Rng, SamplerKind};
    use kajo_scene::{LoadOptions, Snapshot, load};
    use kajo_units::Seconds;

    fn cornell() -> Tracer {
        let scene = load("builtin:cornell", &LoadOptions::default()).unwrap();
        Tracer::new(&scene, Snapshot::new(&scene, Seconds(0.0))).unwrap()
    }

    fn settings() -> Settings {
        Settings { size: UVec2::splat(32), max_depth: 3, sampler: SamplerKind::Independent, ..Settings::default() }
    }

    /// 0.1² planted on a picture: it comes back, alone and against the truth; a planted bias shows against the truth alone.
    #[test]
    fn planted_noise_and_bias_are_recovered() {
        let size = UVec2::splat(64);
        let truth = Image::from_pixels(size, vec![LinearRgb::splat(0.5); 64 * 64]);
        let mut rng = Rng::new(5);
        let mut uniform = || (rng.next_1d() - 0.5) * 0.1 * 12f32.sqrt();
        let takes: Vec<_> = (0..4).map(|_| truth.map(|p| *p + LinearRgb::new(uniform(), uniform(), uniform()))).collect();
        assert!((scatter(&takes).unwrap().variance / 0.01 - 1.0).abs() < 0.03);
        assert!((errors(&takes, &truth).unwrap().0 / 0.01 - 1.0).abs() < 0.03);
        let brighter = truth.map(|p| *p + LinearRgb::splat(0.1));
        assert!((errors(&takes, &brighter).unwrap().0 / 0.02 - 1.0).abs() < 0.03);
    }

    /// On a real rendering the scatter of the seeds is the error against a far better picture; four times the samples have a quarter of it.
    #[test]
    fn scatter_is_the_error_against_a_reference_and_falls_with_samples() {
        let tracer = cornell();
        let reference = render(&tracer, &Settings { seed: 1000, ..settings() }, Stop::at_spp(1024), None, &uncontrolled).unwrap().develop();
        let cost = |spp, reference| render_cost(&tracer, &settings(), spp, 24, reference, &uncontrolled).unwrap().unwrap();
        let (alone, against) = (cost(8, None), cost(8, Some(reference.beauty())));
        assert!((alone.mse / against.mse - 1.0).abs() < 0.12, "{alone:?} {against:?}");
        assert!((alone.rel_mse / against.rel_mse - 1.0).abs() < 0.12, "{alone:?} {against:?}");
        let four = cost(32, None);
        assert!((alone.mse / four.mse / 4.0 - 1.0).abs() < 0.12, "{} {}", alone.mse, four.mse);
        assert!(alone.seconds > 0.0 && alone.rays_per_sample > 2.0 && alone.invalid_samples == 0);
        assert!((alone.efficiency * alone.seconds * alone.mse - 1.0).abs() < 1e-9);
        assert!((alone.samples_per_s * alone.seconds / f64::from(32 * 32 * 8) - 1.0).abs() < 1e-9);
    }

    #[test]
    fn exponents_of_powers_are_exact_and_what_has_none_is_refused() {
        let power = |b: f64| [1.0f64, 10.0, 300.0].map(|x| (x, 7.0 * x.powf(b)));
        for b in [-1.0, 0.0, 0.5, 1.0, 2.0] {
            assert!((exponent(&power(b)).unwrap() - b).abs() < 1e-12, "{b}");
        }
        assert_eq!(exponent(&[(1.0, 2.0)]), None);
        assert_eq!(exponent(&[(5.0, 1.0), (5.0, 2.0), (5.0, 9.0)]), None);
        assert_eq!(exponent(&[(1.0, 2.0), (2.0, 0.0)]), None);
        assert_eq!(exponent(&[]), None);
    }
}

//! The integration experiments M-01 to M-06: what estimators must do on integrals with known answers.
//!
//! F = ∫₀¹ x² dx = 1/3 throughout. "Within four standard errors" is the tolerance for means; seeds are fixed.

use crate::statistics::Moments;
use crate::warp::{cosine_hemisphere, cosine_hemisphere_pdf, uniform_hemisphere, uniform_hemisphere_pdf};
use crate::{Rng, balance_heuristic};

const N: usize = 1_000_000;
const THIRD: f64 = 1.0 / 3.0;

fn moments(seed: u64, estimate: impl Fn(&mut Rng) -> f64) -> Moments {
    let mut rng = Rng::new(seed);
    (0..N).map(|_| estimate(&mut rng)).collect()
}

fn is_mean(m: &Moments, exact: f64) -> bool {
    (m.mean() - exact).abs() < 4.0 * m.standard_error()
}

fn is_variance(m: &Moments, exact: f64) -> bool {
    (m.variance() / exact - 1.0).abs() < 0.02
}

/// Row M-01.
#[test]
fn the_estimator_is_unbiased_with_the_exact_variance() {
    let m = moments(1, |rng| rng.next_f64().powi(2));
    assert!(is_mean(&m, THIRD) && is_variance(&m, 4.0 / 45.0), "{m:?}");
    assert!(!is_mean(&m, THIRD * 1.01) && !is_variance(&m, 4.0 / 45.0 * 1.05), "the checks can fail");
}

/// Slope of log RMSE over log N for the mean of Π (x_d² + 2/3) = 1, 256 runs a size.
///
/// The constant keeps the variance of the product finite-sized in 8 dimensions (0.98); Π x_d² alone has 109, and its RMSE over
/// so few runs is itself too noisy for a slope.
fn slope(dimensions: i32) -> f64 {
    let sizes = [16usize, 64, 256, 1024, 4096, 16384, 65536];
    let points: Vec<(f64, f64)> = sizes
        .iter()
        .map(|&n| {
            let squared: f64 = (0..256)
                .map(|run| {
                    let mut rng = Rng::new(1000 * run + n as u64);
                    let mut value = || (0..dimensions).map(|_| rng.next_f64().powi(2) + 2.0 * THIRD).product::<f64>();
                    ((0..n).map(|_| value()).sum::<f64>() / n as f64 - 1.0).powi(2)
                })
                .sum();
            ((n as f64).ln(), 0.5 * (squared / 256.0).ln())
        })
        .collect();
    let k = points.len() as f64;
    let (mx, my) = (points.iter().map(|p| p.0).sum::<f64>() / k, points.iter().map(|p| p.1).sum::<f64>() / k);
    points.iter().map(|p| (p.0 - mx) * (p.1 - my)).sum::<f64>() / points.iter().map(|p| (p.0 - mx).powi(2)).sum::<f64>()
}

/// Row M-02.
#[test]
fn error_falls_as_the_square_root_of_n_in_1_and_8_dimensions() {
    for dimensions in [1, 8] {
        let slope = slope(dimensions);
        assert!((slope + 0.5).abs() < 0.05, "{dimensions} dimensions: slope {slope}");
    }
}

/// Row M-03.
#[test]
fn the_ideal_pdf_has_no_variance() {
    let mut rng = Rng::new(3);
    for _ in 0..10_000 {
        // p = 3 x², x = ∛(1 − u): never zero.
        let x = (1.0 - rng.next_f64()).cbrt();
        assert!((x * x / (3.0 * x * x) - THIRD).abs() < 1e-6);
        // Lambert under constant radiance: f cos θ / p with f = ρ/π, ρ = 0.7.
        let d = cosine_hemisphere(rng.next_2d());
        assert!((0.7 / std::f32::consts::PI * d.z / cosine_hemisphere_pdf(d) - 0.7).abs() < 1e-6);
    }
    let m = moments(4, |rng| {
        let d = uniform_hemisphere(rng.next_2d());
        f64::from(d.z / std::f32::consts::PI / uniform_hemisphere_pdf(d))
    });
    assert!(is_mean(&m, 1.0) && is_variance(&m, THIRD), "relative variance 1/3: {m:?}");
}

/// Row M-04.
#[test]
fn a_pdf_that_misses_part_of_the_integrand_is_found_biased() {
    let half = moments(5, |rng| {
        let x = 0.5 + 0.5 * rng.next_f64();
        x * x / 2.0
    });
    assert!(is_mean(&half, 7.0 / 24.0) && !is_mean(&half, THIRD), "{half:?}");
    let wide = moments(6, |rng| {
        let x = 2.0 * rng.next_f64();
        if x <= 1.0 { x * x / 0.5 } else { 0.0 }
    });
    assert!(is_mean(&wide, THIRD), "{wide:?}");
}

/// Row M-05: p = 1.5 − x; exact variance ∫ x⁴/(1.5 − x) dx − 1/9.
#[test]
fn a_poor_pdf_is_worse_than_uniform() {
    let m = moments(7, |rng| {
        let x = 1.5 - (2.25 - 2.0 * rng.next_f64()).sqrt();
        x * x / (1.5 - x)
    });
    assert!(is_mean(&m, THIRD) && is_variance(&m, 0.2006), "{m:?}");
    assert!(m.variance() > 2.0 * 4.0 / 45.0);
}

/// Row M-06, the one-dimensional part: p₁ = 1, p₂ = 2x, one sample each.
#[test]
fn the_balance_heuristic_combines_two_strategies() {
    let m = moments(8, |rng| {
        let (x1, x2) = (rng.next_f64(), (1.0 - rng.next_f64()).sqrt());
        let weight = |p: f64, q: f64| f64::from(balance_heuristic(p as f32, q as f32));
        weight(1.0, 2.0 * x1) * x1 * x1 + weight(2.0 * x2, 1.0) * x2 * x2 / (2.0 * x2)
    });
    assert!(is_mean(&m, THIRD) && is_variance(&m, 0.01876), "{m:?}");
}

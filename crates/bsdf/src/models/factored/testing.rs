//! What the tests of both models use.

use super::{Factored, Grid, ViewWeights};
use crate::models::testing::{assert_finite, assert_samples_follow, extreme_pair, fault, sampled_albedo};
use crate::models::{Hemisphere, Reflectance, V3};
use glam::DVec3;

/// Few nodes: isotropic and grey, or not.
pub const SMALL: [Grid; 2] =
    [Grid { theta_h: 9, phi_h: 8, theta_o: 5, phi_o: 1, channels: 1 }, Grid { theta_h: 9, phi_h: 8, theta_o: 5, phi_o: 6, channels: 3 }];

/// Pseudo-random numbers in [low, 1).
pub fn random(count: usize, low: f32, seed: u64) -> Vec<f32> {
    let mut rng = kajo_sampling::Rng::new(seed);
    (0..count).map(|_| low + (1.0 - low) * rng.next_1d()).collect()
}

/// Asserts that numbers are finite, that samples follow the density, and that value and density give the albedo of quadrature.
#[track_caller]
pub fn assert_sampled<W: ViewWeights>(model: &Factored<W>) {
    if let Some(fault) = fault(model, 50_000) {
        panic!("{fault}");
    }
    let mut rng = kajo_sampling::Rng::new(4);
    for k in 0..20_000 {
        let (wi, wo) = extreme_pair(&mut rng, k);
        assert_finite(model, wi, wo);
    }
    for (theta, phi) in [(0.0, 0.0), (40.0, 20.0), (75.0, 200.0)] {
        assert_samples_follow(model, theta, phi);
        let wo = DVec3::from(V3::from_angles(f64::to_radians(theta), f64::to_radians(phi)));
        let quadrature = Hemisphere::new(300, 480).integrate(|wi| model.f_cos(wi, wo).x);
        let (mean, error) = sampled_albedo(model, theta, phi, 20_000);
        assert!((mean - quadrature).abs() < 4.0 * error + 1e-3 * quadrature, "{theta}°: {mean} ± {error}, quadrature {quadrature}");
    }
}

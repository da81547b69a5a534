//! Cloth: inverted-Gaussian-like "Charlie" distribution of upright fibres with its fitted masking.

use crate::tables::{self, place};
use std::f32::consts::PI;

/// α below which a fibre lobe is too narrow to be integrated; perceptual roughness 0.1.
pub const SHEEN_MIN_ALPHA: f32 = 0.01;

/// Charlie distribution D(m) = (2 + 1/α) sin^(1/α) θm / 2π.    \[Estevez17] eq. 2
///
/// Unit: 1/sr, ∫ D cos θ = 1.
#[inline]
pub fn sheen_d(alpha: f32, n_dot_m: f32) -> f32 {
    let inv = 1.0 / alpha;
    let sin2 = (1.0 - n_dot_m * n_dot_m).max(0.0);
    (2.0 + inv) * sin2.powf(0.5 * inv) / (2.0 * PI)
}

/// Λ(θ) of the Charlie distribution, a fit: exp L(cos) below 60°, mirrored above.    \[Estevez17] eqs. 3, 4 and table 1
#[inline]
pub fn sheen_lambda(alpha: f32, cos_theta: f32) -> f32 {
    let t = (1.0 - alpha) * (1.0 - alpha);
    let mix = |rough: f32, smooth: f32| rough + t * (smooth - rough);
    let (a, b) = (mix(21.5473, 25.3245), mix(3.82987, 3.32435));
    let (c, d, e) = (mix(0.19823, 0.16801), mix(-1.97760, -1.27393), mix(-4.32054, -4.85967));
    // A cosine that rounding left above 1 would be the power of a negative number.
    let l = |x: f32| a / (1.0 + b * x.max(0.0).powf(c)) + d * x + e;
    if cos_theta < 0.5 { l(cos_theta).exp() } else { (2.0 * l(0.5) - l(1.0 - cos_theta)).exp() }
}

/// V = 1 / ((1 + Λ(o) + Λ(i)) 4 cos θo cos θi).    KHR_materials_sheen, "Sheen visibility"
#[inline]
pub fn sheen_visibility(alpha: f32, n_dot_o: f32, n_dot_i: f32) -> f32 {
    let lambda = 1.0 + sheen_lambda(alpha, n_dot_o) + sheen_lambda(alpha, n_dot_i);
    1.0 / (lambda * 4.0 * n_dot_o * n_dot_i).max(1e-7)
}

/// Directional albedo of a white sheen layer, from [`tables::SHEEN_ALBEDO`].
///
/// # Surprises
/// Above 1 for α below 0.05 near the horizon, because the masking is a fit; [`crate::Bsdf`] divides the lobe by it there.
#[inline]
pub fn sheen_albedo(alpha: f32, cos_theta: f32) -> f32 {
    let (c, tc) = place(cos_theta.max(0.0).sqrt(), tables::SHEEN_COS_NODES);
    let (r, tr) = place(alpha.max(0.0).sqrt(), tables::SHEEN_ROUGHNESS_NODES);
    let k = r * tables::SHEEN_COS_NODES + c;
    let t = &tables::SHEEN_ALBEDO;
    let low = t[k] + tc * (t[k + 1] - t[k]);
    let high = t[k + tables::SHEEN_COS_NODES] + tc * (t[k + tables::SHEEN_COS_NODES + 1] - t[k + tables::SHEEN_COS_NODES]);
    (low + tr * (high - low)) * tables::SHEEN_TABLE_SCALE
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tables::quadrature;
    use kajo_sampling::Rng;

    #[test]
    fn distribution_is_normalised() {
        for alpha in [0.01, 0.1, 0.5, 1.0] {
            let n = 20_000;
            let sum: f64 = (0..n)
                .map(|i| {
                    let c = (f64::from(i) + 0.5) / f64::from(n);
                    f64::from(sheen_d(alpha, c as f32)) * c * std::f64::consts::TAU / f64::from(n)
                })
                .sum();
            assert!((sum - 1.0).abs() < 1e-3, "alpha {alpha}: {sum}");
        }
    }

    #[test]
    fn masking_is_continuous_where_its_two_branches_meet() {
        for alpha in [0.01, 0.3, 1.0] {
            assert!((sheen_lambda(alpha, 0.499_99) / sheen_lambda(alpha, 0.500_01) - 1.0).abs() < 1e-3);
        }
    }

    #[test]
    fn a_cosine_rounded_above_one_is_one() {
        let above = f32::from_bits(1.0f32.to_bits() + 1);
        assert!((sheen_visibility(0.5, above, 0.7) / sheen_visibility(0.5, 1.0, 0.7) - 1.0).abs() < 1e-3);
    }

    #[test]
    fn sheen_table_is_its_integral() {
        let mut rng = Rng::new(6);
        for _ in 0..200 {
            let (c, r) = (0.1 + 0.9 * rng.next_1d(), 0.3 + 0.7 * rng.next_1d());
            let error = (sheen_albedo(r * r, c) - quadrature::sheen_albedo(c, r * r, 128)).abs();
            assert!(error < 0.01, "cos {c}, roughness {r}: {error}");
        }
    }
}

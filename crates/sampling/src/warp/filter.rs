//! Reconstruction filters as densities: offsets drawn from them need no weights.

use super::to_unit;
use glam::Vec2;
use std::f32::consts::TAU;

/// Offset of the tent filter of this radius: p(x) = (1 − |x|/r) / r on [−r, r].
#[inline]
pub fn tent(u: f32, radius: f32) -> f32 {
    if u < 0.5 { radius * ((2.0 * u).sqrt() - 1.0) } else { radius * (1.0 - (2.0 - 2.0 * u).sqrt()) }
}

/// Density of [`tent`].
#[inline]
pub fn tent_pdf(x: f32, radius: f32) -> f32 {
    (1.0 - x.abs() / radius).max(0.0) / radius
}

/// The inverse of [`tent`].
pub fn tent_inverse(x: f32, radius: f32) -> f32 {
    let t = (1.0 - (x / radius).abs()).max(0.0);
    to_unit(if x < 0.0 { 0.5 * t * t } else { 1.0 - 0.5 * t * t })
}

/// Two independent standard normal numbers: r = √(−2 ln(1 − u)), φ = 2π v.    \[Box58]
#[inline]
pub fn normal_2d(u: Vec2) -> Vec2 {
    (-2.0 * (-u.x).ln_1p()).sqrt() * Vec2::from_angle(TAU * u.y)
}

/// Density of [`normal_2d`]: exp(−|x|²/2) / 2π.
#[inline]
pub fn normal_2d_pdf(x: Vec2) -> f32 {
    (-0.5 * x.length_squared()).exp() / TAU
}

/// The inverse of [`normal_2d`].
pub fn normal_2d_inverse(x: Vec2) -> Vec2 {
    Vec2::new(to_unit(-(-0.5 * x.length_squared()).exp_m1()), to_unit((x.to_angle() / TAU).rem_euclid(1.0)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Rng;
    use crate::statistics::Moments;

    #[test]
    fn tent_has_the_variance_of_two_boxes_and_its_inverse_returns() {
        let n = 10_000;
        let mut moments = Moments::default();
        for i in 0..n {
            let u = (i as f32 + 0.5) / n as f32;
            let x = tent(u, 1.5);
            assert!((tent_inverse(x, 1.5) - u).abs() < 1e-5, "{u}");
            moments.add(f64::from(x));
        }
        assert!(moments.mean().abs() < 1e-4 && (moments.variance() - 1.5 * 1.5 / 6.0).abs() < 1e-3, "{moments:?}");
        let integral: f32 = (0..1000).map(|i| tent_pdf(-1.5 + 3.0 * (i as f32 + 0.5) / 1000.0, 1.5) * 0.003).sum();
        assert!((integral - 1.0).abs() < 1e-4);
    }

    #[test]
    fn normal_numbers_have_unit_variance_and_their_inverse_returns() {
        let mut rng = Rng::new(21);
        let (mut x, mut product) = (Moments::default(), Moments::default());
        for _ in 0..100_000 {
            let u = rng.next_2d();
            let n = normal_2d(u);
            assert!(n.is_finite() && normal_2d_inverse(n).abs_diff_eq(u, 1e-4), "{u}");
            x.add(f64::from(n.x));
            product.add(f64::from(n.x * n.y));
        }
        assert!(x.mean().abs() < 4.0 * x.standard_error() && (x.variance() - 1.0).abs() < 0.02);
        assert!(product.mean().abs() < 4.0 * product.standard_error());
        assert!(normal_2d(Vec2::splat(crate::bits::ONE_MINUS_EPSILON)).is_finite());
        let integral: f32 = (0..100 * 100)
            .map(|i| {
                normal_2d_pdf(Vec2::new(-6.0 + 12.0 * ((i % 100) as f32 + 0.5) / 100.0, -6.0 + 12.0 * ((i / 100) as f32 + 0.5) / 100.0))
            })
            .sum::<f32>()
            * 0.12
            * 0.12;
        assert!((integral - 1.0).abs() < 1e-3, "{integral}");
    }
}

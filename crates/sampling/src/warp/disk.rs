//! The unit disc.

use super::to_unit;
use glam::Vec2;
use std::f32::consts::{FRAC_1_PI, FRAC_PI_4};

/// Square to unit disc by concentric squares to concentric circles: uniform, keeps neighbours together.    \[Shirley97]
#[inline(always)]
pub fn concentric_disk(u: Vec2) -> Vec2 {
    let p = 2.0 * u - Vec2::ONE;
    if p == Vec2::ZERO {
        return Vec2::ZERO;
    }
    // Along the greater axis; along the other by the angle from it.
    if p.x.abs() > p.y.abs() {
        let (sin, cos) = sin_cos_of_eighth(FRAC_PI_4 * (p.y / p.x));
        p.x * Vec2::new(cos, sin)
    } else {
        let (sin, cos) = sin_cos_of_eighth(FRAC_PI_4 * (p.x / p.y));
        p.y * Vec2::new(sin, cos)
    }
}

/// Sine and cosine for |φ| ≤ π/4: their series up to φ⁹ and φ⁸, which end there to single precision.
#[inline(always)]
fn sin_cos_of_eighth(phi: f32) -> (f32, f32) {
    let s = phi * phi;
    let sin = 1.0 + s * (-1.0 / 6.0 + s * (1.0 / 120.0 + s * (-1.0 / 5040.0 + s * (1.0 / 362_880.0))));
    let cos = 1.0 + s * (-0.5 + s * (1.0 / 24.0 + s * (-1.0 / 720.0 + s * (1.0 / 40_320.0))));
    (phi * sin, cos)
}

/// The point of the square that [`concentric_disk`] sends to `p`.
pub fn concentric_disk_inverse(p: Vec2) -> Vec2 {
    let r = p.length();
    if r == 0.0 {
        return Vec2::splat(0.5);
    }
    let q = if p.x.abs() > p.y.abs() {
        let r = r.copysign(p.x);
        Vec2::new(r, r * (p.y / p.x).atan() / FRAC_PI_4)
    } else {
        let r = r.copysign(p.y);
        Vec2::new(r * (p.x / p.y).atan() / FRAC_PI_4, r)
    };
    let u = 0.5 * (q + Vec2::ONE);
    Vec2::new(to_unit(u.x), to_unit(u.y))
}

/// Density per unit area of [`concentric_disk`]: 1/π on the disc.
#[inline]
pub fn concentric_disk_pdf_area(p: Vec2) -> f32 {
    if p.length_squared() <= 1.0 { FRAC_1_PI } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Rng;
    use crate::statistics::chi_square_p_value;

    #[test]
    fn sine_and_cosine_are_those_of_the_library() {
        for i in -1000..=1000 {
            let phi = FRAC_PI_4 * i as f32 / 1000.0;
            let ((sin, cos), (s, c)) = (sin_cos_of_eighth(phi), phi.sin_cos());
            assert!((sin - s).abs() < 1.5e-7 && (cos - c).abs() < 1.5e-7, "{phi}: {sin} {cos} instead of {s} {c}");
        }
    }

    #[test]
    fn disc_is_uniform_and_inverse_returns() {
        let mut rng = Rng::new(4);
        let mut counts = vec![0.0; 20 * 20];
        for _ in 0..100_000 {
            let u = rng.next_2d();
            let p = concentric_disk(u);
            assert!(p.length() <= 1.0 + 1e-6);
            assert!(concentric_disk_inverse(p).abs_diff_eq(u, 1e-5));
            let ring = ((p.length_squared() * 20.0) as usize).min(19);
            let sector = ((p.to_angle() / std::f32::consts::TAU).rem_euclid(1.0) * 20.0) as usize;
            counts[ring * 20 + sector.min(19)] += 1.0;
        }
        assert!(chi_square_p_value(&counts, &vec![250.0; 400], 0) > 1e-3);
        assert_eq!(concentric_disk(Vec2::splat(0.5)), Vec2::ZERO);
        assert_eq!((concentric_disk_pdf_area(Vec2::ZERO), concentric_disk_pdf_area(Vec2::ONE)), (FRAC_1_PI, 0.0));
    }
}

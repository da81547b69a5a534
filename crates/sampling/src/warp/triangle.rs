//! Points of a triangle.

use super::to_unit;
use glam::{Vec2, Vec3};

/// Uniform barycentric coordinates by folding the square along its diagonal: low distortion, no square root.    \[Heitz19]
#[inline]
pub fn triangle_barycentrics(u: Vec2) -> Vec3 {
    let (b0, b1) = if u.y > u.x {
        let b0 = 0.5 * u.x;
        (b0, u.y - b0)
    } else {
        let b1 = 0.5 * u.y;
        (u.x - b1, b1)
    };
    Vec3::new(b0, b1, (1.0 - b0 - b1).max(0.0))
}

/// The inverse of [`triangle_barycentrics`].
pub fn triangle_barycentrics_inverse(b: Vec3) -> Vec2 {
    let (x, y) = if b.y > b.x { (2.0 * b.x, b.y + b.x) } else { (b.x + b.y, 2.0 * b.y) };
    Vec2::new(to_unit(x), to_unit(y))
}

/// Density per unit area: 1 / A. Zero for a triangle without area.
#[inline]
pub fn triangle_pdf_area(a: Vec3, b: Vec3, c: Vec3) -> f32 {
    let double_area = (b - a).cross(c - a).length();
    if double_area > 0.0 { 2.0 / double_area } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Rng;

    #[test]
    fn triangle_points_are_uniform_and_inverse_returns() {
        let mut rng = Rng::new(2);
        let mut moments = [0.0f64; 4];
        let n = 100_000;
        for _ in 0..n {
            let u = rng.next_2d();
            let b = triangle_barycentrics(u);
            assert!(b.min_element() >= 0.0 && (b.element_sum() - 1.0).abs() < 1e-6);
            assert!(triangle_barycentrics_inverse(b).abs_diff_eq(u, 1e-6));
            for (m, x) in moments.iter_mut().zip([b.x, b.y, b.z, b.x * b.y]) {
                *m += f64::from(x) / f64::from(n);
            }
        }
        // E b = 1/3 with variance 1/18, E b₀b₁ = 1/12; four standard errors.
        let tolerance = 4.0 * (1.0f64 / 18.0 / f64::from(n)).sqrt();
        assert!(moments[..3].iter().all(|m| (m - 1.0 / 3.0).abs() < tolerance), "{moments:?}");
        assert!((moments[3] - 1.0 / 12.0).abs() < tolerance, "{moments:?}");
        assert_eq!(triangle_pdf_area(Vec3::ZERO, Vec3::X, Vec3::Y), 2.0);
        assert_eq!(triangle_pdf_area(Vec3::ZERO, Vec3::X, Vec3::X), 0.0);
    }
}

//! Halton and Hammersley points: radical inverses in prime bases.

use crate::bits::ONE_MINUS_EPSILON;
use glam::Vec2;

/// Mirrors the digits of `index` in `base` (2 or more) at the radix point: Φ_b(Σ d_k b^k) = Σ d_k b^(−k−1), in [0, 1).    \[Halton64]
pub fn radical_inverse(base: u32, mut index: u32) -> f32 {
    let inv_base = 1.0 / f64::from(base);
    let (mut digits, mut scale) = (0u64, 1.0f64);
    while index > 0 {
        digits = digits * u64::from(base) + u64::from(index % base);
        scale *= inv_base;
        index /= base;
    }
    ((digits as f64 * scale) as f32).min(ONE_MINUS_EPSILON)
}

/// Point `index` of the Halton sequence in bases 2 and 3. Start at 1: point 0 is the corner (0, 0).    \[Halton64]
pub fn halton_2d(index: u32) -> Vec2 {
    Vec2::new(radical_inverse(2, index), radical_inverse(3, index))
}

/// Point `index` of `count` (> 0) Hammersley points (i / N, Φ₂(i)).    \[Niederreiter92] section 3.1
pub fn hammersley_2d(index: u32, count: u32) -> Vec2 {
    Vec2::new((index as f32 / count as f32).min(ONE_MINUS_EPSILON), radical_inverse(2, index))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Row M-14.
    #[test]
    fn first_eight_halton_points() {
        let expected = [
            (0.5, 0.333_333_3),
            (0.25, 0.666_666_7),
            (0.75, 0.111_111_1),
            (0.125, 0.444_444_4),
            (0.625, 0.777_777_8),
            (0.375, 0.222_222_2),
            (0.875, 0.555_555_6),
            (0.0625, 0.888_888_9),
        ];
        for (i, (x, y)) in expected.into_iter().enumerate() {
            assert!(halton_2d(i as u32 + 1).abs_diff_eq(Vec2::new(x, y), 1e-6), "point {}", i + 1);
        }
    }

    #[test]
    fn radical_inverse_stays_in_the_unit_interval() {
        for base in [2, 3, 5, 7, 97] {
            for index in [0, 1, base - 1, 12_345, u32::MAX] {
                assert!((0.0..1.0).contains(&radical_inverse(base, index)), "base {base}, index {index}");
            }
        }
    }

    #[test]
    fn hammersley_points_fill_every_row_and_column() {
        let mut rows = [false; 32];
        let mut columns = [false; 32];
        for i in 0..32 {
            let p = hammersley_2d(i, 32);
            columns[(p.x * 32.0) as usize] = true;
            rows[(p.y * 32.0) as usize] = true;
        }
        assert!(rows.iter().chain(&columns).all(|&seen| seen));
    }
}

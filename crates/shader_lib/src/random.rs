//! Random numbers of the real-time techniques: the twin of `shader_lib::random`, equal to the last bit.

use glam::{UVec2, Vec2};
use kajo_sampling::{hash_u32, unit_f32};

/// 32 random bits: the coordinates hashed one after the other, each keyed by the ones before.    \[Jarzynski20] section 4.2
pub fn hash_pixel(pixel: UVec2, frame: u32, dimension: u32) -> u32 {
    let x = hash_u32(pixel.x.wrapping_add(0x6b61_6a6f));
    let y = hash_u32(pixel.y.wrapping_add(x));
    let frame = hash_u32(frame.wrapping_add(y));
    hash_u32(dimension.wrapping_add(frame))
}

/// Uniform in [0, 1).
pub fn random_1d(pixel: UVec2, frame: u32, dimension: u32) -> f32 {
    unit_f32(hash_pixel(pixel, frame, dimension))
}

/// Uniform in [0, 1)²; takes one dimension, the second number comes from hashing the first.
pub fn random_2d(pixel: UVec2, frame: u32, dimension: u32) -> Vec2 {
    let bits = hash_pixel(pixel, frame, dimension);
    Vec2::new(unit_f32(bits), unit_f32(hash_u32(bits ^ 0x9e37_79b9)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_sampling::statistics::chi_square_p_value;

    /// Joint histogram of two numbers over pixels and frames, 16 × 16 cells.
    fn joint_p_value(pair: impl Fn(UVec2, u32) -> Vec2) -> f64 {
        let mut counts = vec![0.0; 256];
        for i in 0..1u32 << 16 {
            let p = pair(UVec2::new(i & 63, (i >> 6) & 63), i >> 12);
            counts[(p.x * 16.0) as usize * 16 + (p.y * 16.0) as usize] += 1.0;
        }
        chi_square_p_value(&counts, &[256.0; 256], 0)
    }

    #[test]
    fn pixels_frames_and_dimensions_are_independent() {
        assert!(joint_p_value(|pixel, frame| random_2d(pixel, frame, 0)) > 1e-3);
        assert!(joint_p_value(|pixel, frame| Vec2::new(random_1d(pixel, frame, 0), random_1d(pixel, frame, 1))) > 1e-3);
        assert!(joint_p_value(|pixel, frame| Vec2::new(random_1d(pixel, frame, 0), random_1d(pixel + UVec2::X, frame, 0))) > 1e-3);
        assert!(joint_p_value(|pixel, frame| Vec2::new(random_1d(pixel, frame, 3), random_1d(pixel + UVec2::Y, frame, 3))) > 1e-3);
        assert!(joint_p_value(|pixel, frame| Vec2::new(random_1d(pixel, frame, 0), random_1d(pixel, frame + 1, 0))) > 1e-3);
    }

    #[test]
    fn planted_fault_a_number_is_not_independent_of_itself() {
        assert!(joint_p_value(|pixel, frame| Vec2::splat(random_1d(pixel, frame, 0))) < 1e-12);
    }
}

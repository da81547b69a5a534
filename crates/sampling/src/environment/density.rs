//! The density image: how much light each pixel of a latitude-longitude environment sends.

use super::EnvironmentError;
use crate::distribution::clean;
use glam::UVec2;
use std::f64::consts::PI;

/// Share of the light in each pixel, `height × width`, row-major, sum 1.
///
/// ```text
/// f_ij = Y_ij sin θ_j / Σ Y sin θ,   θ_j = π (j + ½) / h                            [Ergun15] chapter 6
/// ```
///
/// `Y` is luminance in any unit; values that are negative or not finite count as 0. The integral of sin θ over a row is proportional to
/// sin θ_j at its centre, so the shares are exact for radiance that is constant in each pixel.
#[derive(Clone, Debug)]
pub struct DensityImage {
    size: UVec2,
    shares: Vec<f64>,
}

impl DensityImage {
    /// Largest side, px: corners of blocks are 16-bit numbers.
    pub const MAX_SIDE: u32 = u16::MAX as u32;

    /// The shares of an image of luminance.
    ///
    /// # Errors
    /// [`EnvironmentError::Size`] and [`EnvironmentError::Black`].
    pub fn from_luminance(size: UVec2, luminance: &[f32]) -> Result<Self, EnvironmentError> {
        Self::from_fn(size, luminance, |row| sin_theta(row, size.y))
    }

    /// The shares of weights that hold the factor sin θ already, such as a grid of ∫ Y sin θ dθ.
    ///
    /// # Errors
    /// Those of [`Self::from_luminance`].
    pub fn from_weights(size: UVec2, weights: &[f32]) -> Result<Self, EnvironmentError> {
        Self::from_fn(size, weights, |_| 1.0)
    }

    fn from_fn(size: UVec2, values: &[f32], factor: impl Fn(u32) -> f64) -> Result<Self, EnvironmentError> {
        let UVec2 { x: width, y: height } = size;
        let side = 1..=Self::MAX_SIDE;
        if !side.contains(&width) || !side.contains(&height) || values.len() != width as usize * height as usize {
            return Err(EnvironmentError::Size { width, height, pixels: values.len(), max: Self::MAX_SIDE });
        }
        let rows = values.chunks_exact(width as usize).zip(0..height);
        let mut shares: Vec<f64> = rows.flat_map(|(row, j)| row.iter().map(move |&v| (v, j))).map(|(v, j)| clean(v) * factor(j)).collect();
        // Row by row, so that the error of the sum does not grow with the number of pixels.
        let total: f64 = shares.chunks_exact(width as usize).map(|row| row.iter().sum::<f64>()).sum();
        if total <= 0.0 {
            return Err(EnvironmentError::Black);
        }
        shares.iter_mut().for_each(|share| *share /= total);
        Ok(Self { size, shares })
    }

    /// Width and height, px.
    pub fn size(&self) -> UVec2 {
        self.size
    }

    /// All shares.
    pub fn shares(&self) -> &[f64] {
        &self.shares
    }

    /// Share of the pixel in column `x` of row `y`.
    pub fn share(&self, x: u32, y: u32) -> f64 {
        self.shares[y as usize * self.size.x as usize + x as usize]
    }
}

/// sin θ at the centre of a row of an image with `rows` rows.
pub(crate) fn sin_theta(row: u32, rows: u32) -> f64 {
    ((f64::from(row) + 0.5) / f64::from(rows) * PI).sin()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::environment::test_maps::{all_maps, sunny};

    #[test]
    fn shares_sum_to_one() {
        for (name, size, luminance) in all_maps() {
            let density = DensityImage::from_luminance(size, &luminance).unwrap();
            let sum: f64 = density.shares().iter().sum();
            assert!((sum - 1.0).abs() < 1e-9, "{name}: {sum}");
        }
    }

    #[test]
    fn shares_of_a_constant_map_follow_the_sine_of_the_row() {
        let size = UVec2::new(32, 16);
        let density = DensityImage::from_luminance(size, &[3.0; 512]).unwrap();
        for y in 0..16 {
            let expected = sin_theta(y, 16) / (5.5 * PI / 16.0).sin();
            for x in 0..32 {
                assert!((density.share(x, y) / density.share(7, 5) / expected - 1.0).abs() < 1e-6, "({x}, {y})");
            }
        }
        // The other way in, by weights that hold ∫ sin θ dθ, is the same.
        let weight = |y: u32| ((f64::from(y) / 16.0 * PI).cos() - (f64::from(y + 1) / 16.0 * PI).cos()) as f32;
        let weights: Vec<f32> = (0..512).map(|i| weight(i / 32)).collect();
        let weighted = DensityImage::from_weights(size, &weights).unwrap();
        assert!(density.shares().iter().zip(weighted.shares()).all(|(a, b)| (a / b - 1.0).abs() < 1e-5));
    }

    /// Largest relative difference between a map and what its shares say of it.
    fn recovery_error(luminance: &[f32], density: &DensityImage) -> f64 {
        let size = density.size();
        let recovered: Vec<f64> = (0..size.y).flat_map(|y| (0..size.x).map(move |x| density.share(x, y) / sin_theta(y, size.y))).collect();
        let scale = luminance.iter().map(|&v| f64::from(v)).sum::<f64>() / recovered.iter().sum::<f64>();
        recovered.iter().zip(luminance).map(|(r, &v)| (r * scale / f64::from(v) - 1.0).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn dividing_by_the_sine_recovers_the_map_and_a_planted_fault_is_seen() {
        let (size, mut luminance) = sunny(128, 64);
        let density = DensityImage::from_luminance(size, &luminance).unwrap();
        assert!(recovery_error(&luminance, &density) < 1e-9);
        assert!(recovery_error(&luminance, &DensityImage::from_weights(size, &luminance).unwrap()) > 0.1, "the sine left out");
        luminance.swap(100, 4000);
        assert!(recovery_error(&luminance, &density) > 0.1, "two pixels exchanged");
    }

    #[test]
    fn wrong_images_are_refused() {
        let size = |w, h| UVec2::new(w, h);
        for (size, values) in [(size(0, 1), 0), (size(1, 0), 0), (size(2, 2), 3), (size(65_536, 1), 65_536)] {
            let result = DensityImage::from_luminance(size, &vec![1.0; values]);
            assert!(matches!(result, Err(EnvironmentError::Size { .. })), "{size}");
        }
        assert_eq!(DensityImage::from_luminance(size(2, 1), &[0.0, -1.0]).unwrap_err(), EnvironmentError::Black);
        let odd = DensityImage::from_luminance(size(4, 1), &[f32::NAN, 1.0, f32::INFINITY, -2.0]).unwrap();
        assert_eq!(odd.shares(), [0.0, 1.0, 0.0, 0.0]);
    }
}

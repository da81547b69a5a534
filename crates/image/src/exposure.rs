//! Automatic exposure.

use crate::Image;
use kajo_units::LinearRgb;

/// Reflectance of middle grey, which the average of a picture is brought to.
const MIDDLE_GREY: f32 = 0.18;

/// Shares of the darkest and of the brightest lit pixels that do not count: shadows and lamps say little about a picture's exposure.
const TRIM: (f32, f32) = (0.1, 0.1);

/// Exposure in stops that brings the trimmed geometric mean of the luminance to middle grey.
/// ```text
/// stops = log₂ 0.18 − mean(log₂ Y)                    [Reinhard02] section 3.1, trimmed
/// ```
///
/// Pixels without light (Y = 0) and non-finite ones do not count; an image of nothing else gives 0.
pub fn auto_exposure(image: &Image<LinearRgb>) -> f32 {
    let mut logs: Vec<f32> =
        image.pixels().iter().map(|pixel| pixel.luminance()).filter(|y| *y > 0.0 && y.is_finite()).map(f32::log2).collect();
    logs.sort_by(f32::total_cmp);
    let count = logs.len() as f32;
    let kept = &logs[(count * TRIM.0) as usize..logs.len() - (count * TRIM.1) as usize];
    if kept.is_empty() {
        return 0.0;
    }
    let mean = kept.iter().map(|log| f64::from(*log)).sum::<f64>() / kept.len() as f64;
    MIDDLE_GREY.log2() - mean as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::UVec2;

    fn uniform(value: f32) -> Image<LinearRgb> {
        Image::from_fn(UVec2::new(10, 10), |_, _| LinearRgb::splat(value))
    }

    #[test]
    fn uniform_images_become_middle_grey() {
        for value in [1e-4, 0.18, 1.0, 5000.0] {
            assert!((value * auto_exposure(&uniform(value)).exp2() - 0.18).abs() < 1e-4);
        }
    }

    #[test]
    fn a_few_lamps_and_nan_change_nothing() {
        let mut image = uniform(0.5);
        *image.get_mut(3, 3) = LinearRgb::splat(1e6);
        *image.get_mut(4, 3) = LinearRgb::splat(f32::NAN);
        assert!((auto_exposure(&image) - auto_exposure(&uniform(0.5))).abs() < 1e-4);
    }

    #[test]
    fn black_is_left_alone() {
        assert_eq!(auto_exposure(&uniform(0.0)), 0.0);
    }
}

//! Errors that are sums over pixels, in linear light, over all three channels.

use crate::MetricsError;
use crate::error::check;
use kajo_image::Image;
use kajo_units::LinearRgb;

/// ε of [`rel_mse`]: keeps black pixels of the reference from ruling the mean.    \[Rousselle11] section 5
pub const REL_MSE_EPSILON: f64 = 0.01;

/// MSE = mean over pixels and channels of (I − R)².
///
/// # Errors
/// Sizes that differ, NaN.
pub fn mse(image: &Image<LinearRgb>, reference: &Image<LinearRgb>) -> Result<f64, MetricsError> {
    check("image", image, reference)?;
    Ok(mean(image, reference, |i, r| (i - r) * (i - r)))
}

/// √MSE, in the unit of the pixels.
///
/// # Errors
/// Those of [`mse`].
pub fn rmse(image: &Image<LinearRgb>, reference: &Image<LinearRgb>) -> Result<f64, MetricsError> {
    mse(image, reference).map(f64::sqrt)
}

/// relMSE = mean over pixels and channels of (I − R)² / (R² + ε), ε = [`REL_MSE_EPSILON`].    \[Rousselle11] section 5
///
/// # Errors
/// Those of [`mse`].
pub fn rel_mse(image: &Image<LinearRgb>, reference: &Image<LinearRgb>) -> Result<f64, MetricsError> {
    check("image", image, reference)?;
    Ok(mean(image, reference, |i, r| (i - r) * (i - r) / (r * r + REL_MSE_EPSILON)))
}

/// PSNR = 10 log₁₀(peak² / MSE), dB; infinite for equal images.
///
/// # Errors
/// Those of [`mse`].
pub fn psnr(image: &Image<LinearRgb>, reference: &Image<LinearRgb>, peak: f64) -> Result<f64, MetricsError> {
    mse(image, reference).map(|mse| 10.0 * (peak * peak / mse).log10())
}

/// Σ I / Σ R over luminance: above 1 the image is too bright, below 1 too dark, negative when they differ in sign. `None` for a black
/// reference.
///
/// # Errors
/// Those of [`mse`].
pub fn mean_ratio(image: &Image<LinearRgb>, reference: &Image<LinearRgb>) -> Result<Option<f64>, MetricsError> {
    check("image", image, reference)?;
    let sum = |image: &Image<LinearRgb>| image.pixels().iter().map(|p| f64::from(p.luminance())).sum::<f64>();
    let reference = sum(reference);
    Ok((reference != 0.0).then(|| sum(image) / reference))
}

/// Per pixel √(mean over channels of (I − R)²).
///
/// # Errors
/// Those of [`mse`].
pub fn error_image(image: &Image<LinearRgb>, reference: &Image<LinearRgb>) -> Result<Image<f32>, MetricsError> {
    check("image", image, reference)?;
    let pixels = image.pixels().iter().zip(reference.pixels()).map(|(i, r)| ((*i - *r).0.length_squared() / 3.0).sqrt());
    Ok(Image::from_pixels(image.size(), pixels.collect()))
}

fn mean(image: &Image<LinearRgb>, reference: &Image<LinearRgb>, term: impl Fn(f64, f64) -> f64) -> f64 {
    let pixels = image.pixels().iter().zip(reference.pixels());
    let sum: f64 = pixels.map(|(i, r)| (0..3).map(|c| term(f64::from(i[c]), f64::from(r[c]))).sum::<f64>()).sum();
    sum / (3 * image.pixels().len()) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_images::{scene, with_noise};
    use glam::UVec2;

    fn flat(v: f32) -> Image<LinearRgb> {
        Image::from_fn(UVec2::new(4, 3), |_, _| LinearRgb::splat(v))
    }

    #[test]
    fn closed_forms_on_flat_images() {
        let (a, b) = (flat(0.75), flat(0.5));
        assert_eq!(mse(&a, &b), Ok(0.0625));
        assert_eq!(rmse(&a, &b), Ok(0.25));
        assert!((rel_mse(&a, &b).unwrap() - 0.0625 / 0.26).abs() < 1e-12);
        assert!((psnr(&a, &b, 1.0).unwrap() - 12.041_199_826_559_25).abs() < 1e-9);
        assert!((mean_ratio(&a, &b).unwrap().unwrap() - 1.5).abs() < 1e-9);
        assert_eq!(mean_ratio(&a, &flat(0.0)), Ok(None));
        assert_eq!(error_image(&a, &b).unwrap(), Image::from_pixels(UVec2::new(4, 3), vec![0.25; 12]));
    }

    #[test]
    fn equal_images_have_no_error() {
        assert_eq!(rmse(&flat(3.0), &flat(3.0)), Ok(0.0));
        assert_eq!(psnr(&flat(3.0), &flat(3.0), 1.0), Ok(f64::INFINITY));
    }

    /// Row GI-51: an image with noise of known σ has PSNR −20 log₁₀ σ.
    #[test]
    fn known_noise_has_the_analytic_psnr() {
        let reference = scene(UVec2::new(256, 256), 0.0);
        for (seed, sigma) in [(1, 0.02f32), (2, 0.1)] {
            let measured = psnr(&with_noise(&reference, sigma, seed), &reference, 1.0).unwrap();
            let expected = -20.0 * f64::from(sigma).log10();
            assert!((measured - expected).abs() < 0.05, "{measured} dB for {expected} dB");
        }
    }

    #[test]
    fn planted_faults_are_seen() {
        let reference = scene(UVec2::new(64, 48), 0.0);
        let swapped = reference.map(|p| LinearRgb::new(p[2], p[1], p[0]));
        let scaled = reference.map(|p| *p * 1.1);
        assert!(rmse(&swapped, &reference).unwrap() > 0.1);
        assert!(rel_mse(&swapped, &reference).unwrap() > 0.1);
        assert!(psnr(&swapped, &reference, 1.0).unwrap() < 20.0);
        assert!((mean_ratio(&scaled, &reference).unwrap().unwrap() - 1.1).abs() < 1e-6);
        assert!(error_image(&swapped, &reference).unwrap().pixels().iter().any(|&e| e > 0.3));
    }
}

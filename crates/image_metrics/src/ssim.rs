//! Structural similarity.

use crate::MetricsError;
use crate::error::check;
use kajo_image::Image;
use kajo_units::LinearRgb;
use rayon::prelude::*;

const RADIUS: usize = 5;
const SIGMA: f64 = 1.5;
const C1: f64 = 0.01 * 0.01;
const C2: f64 = 0.03 * 0.03;

/// Mean SSIM of the luminance of two pictures with channel values in [0, 1] (see [`View::picture`](crate::View::picture)).
///
/// ```text
/// SSIM = (2 μx μy + C1)(2 σxy + C2) / ((μx² + μy² + C1)(σx² + σy² + C2))          [Wang04] eq. 13
/// ```
///
/// Gaussian window 11×11, σ = 1.5, weights of sum 1, C1 = 0.01², C2 = 0.03², mean over the windows that lie inside the picture.
/// `None` when the picture is smaller than a window. 1 for equal pictures.
///
/// # Errors
/// Sizes that differ, NaN.
pub fn ssim(image: &Image<LinearRgb>, reference: &Image<LinearRgb>) -> Result<Option<f64>, MetricsError> {
    check("image", image, reference)?;
    let (width, height) = (image.width() as usize, image.height() as usize);
    if width < 2 * RADIUS + 1 || height < 2 * RADIUS + 1 {
        return Ok(None);
    }
    let kernel = kernel();
    let pair = |i: usize| {
        let (x, y) = (f64::from(image.pixels()[i].luminance()), f64::from(reference.pixels()[i].luminance()));
        [x, y, x * x, y * y, x * y]
    };
    let inner = width - 2 * RADIUS;
    // Window sums along rows, for every row, then along columns.
    let rows: Vec<[f64; 5]> = (0..height)
        .into_par_iter()
        .flat_map_iter(|row| (0..inner).map(move |x| weighted(&kernel, |k| pair(row * width + x + k))))
        .collect();
    let row_sums: Vec<f64> = (0..height - 2 * RADIUS)
        .into_par_iter()
        .map(|y| (0..inner).map(|x| similarity(weighted(&kernel, |k| rows[(y + k) * inner + x]))).sum())
        .collect();
    Ok(Some(row_sums.iter().sum::<f64>() / (inner * (height - 2 * RADIUS)) as f64))
}

fn kernel() -> [f64; 2 * RADIUS + 1] {
    let raw: [f64; 2 * RADIUS + 1] = std::array::from_fn(|i| (-0.5 * ((i as f64 - RADIUS as f64) / SIGMA).powi(2)).exp());
    raw.map(|w| w / raw.iter().sum::<f64>())
}

fn weighted(kernel: &[f64; 2 * RADIUS + 1], value: impl Fn(usize) -> [f64; 5]) -> [f64; 5] {
    kernel.iter().enumerate().fold([0.0; 5], |mut sum, (k, w)| {
        sum.iter_mut().zip(value(k)).for_each(|(s, v)| *s += w * v);
        sum
    })
}

fn similarity([x, y, xx, yy, xy]: [f64; 5]) -> f64 {
    let (var_x, var_y, cov) = (xx - x * x, yy - y * y, xy - x * y);
    (2.0 * x * y + C1) * (2.0 * cov + C2) / ((x * x + y * y + C1) * (var_x + var_y + C2))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_images::{scene, with_noise};
    use glam::UVec2;

    /// The definition, window by window.
    fn direct(a: &Image<LinearRgb>, b: &Image<LinearRgb>) -> f64 {
        let kernel = kernel();
        let (mut sum, mut n) = (0.0, 0.0);
        for y in 0..a.height() as usize - 10 {
            for x in 0..a.width() as usize - 10 {
                let window = |f: &dyn Fn(f64, f64) -> f64| {
                    let mut sum = 0.0;
                    for (v, wv) in kernel.iter().enumerate() {
                        for (u, wu) in kernel.iter().enumerate() {
                            let at = |i: &Image<LinearRgb>| f64::from(i.get((x + u) as u32, (y + v) as u32).luminance());
                            sum += wu * wv * f(at(a), at(b));
                        }
                    }
                    sum
                };
                let (ma, mb) = (window(&|a, _| a), window(&|_, b| b));
                let (va, vb) = (window(&|a, _| (a - ma).powi(2)), window(&|_, b| (b - mb).powi(2)));
                let cov = window(&|a, b| (a - ma) * (b - mb));
                sum += (2.0 * ma * mb + 1e-4) * (2.0 * cov + 9e-4) / ((ma * ma + mb * mb + 1e-4) * (va + vb + 9e-4));
                n += 1.0;
            }
        }
        sum / n
    }

    #[test]
    fn separable_form_is_the_definition() {
        let (a, b) = (scene(UVec2::new(31, 23), 0.0), scene(UVec2::new(31, 23), 2.0));
        let noisy = with_noise(&b, 0.05, 3);
        assert!((ssim(&a, &noisy).unwrap().unwrap() - direct(&a, &noisy)).abs() < 1e-9);
    }

    #[test]
    fn equal_is_one_and_contrast_changes_have_the_closed_form() {
        let a = scene(UVec2::new(40, 30), 0.0);
        assert!((ssim(&a, &a).unwrap().unwrap() - 1.0).abs() < 1e-12);
        // Flat pictures: only the luminance term is left.
        let (x, y) = (a.map(|_| LinearRgb::splat(0.25)), a.map(|_| LinearRgb::splat(0.75)));
        let expected = (2.0 * 0.25 * 0.75 + 1e-4) / (0.0625 + 0.5625 + 1e-4);
        assert!((ssim(&x, &y).unwrap().unwrap() - expected).abs() < 1e-6);
    }

    #[test]
    fn smaller_than_a_window_has_no_value() {
        let a = scene(UVec2::new(10, 30), 0.0);
        assert_eq!(ssim(&a, &a), Ok(None));
    }

    #[test]
    fn planted_faults_are_seen() {
        let a = scene(UVec2::new(64, 48), 0.0);
        let worst = ssim(&a.map(|p| LinearRgb::WHITE - *p), &a).unwrap().unwrap();
        let shifted = ssim(&scene(UVec2::new(64, 48), 4.0), &a).unwrap().unwrap();
        let noisy = ssim(&with_noise(&a, 0.2, 1), &a).unwrap().unwrap();
        assert!(worst < 0.5 && shifted < 0.97 && noisy < 0.5, "{worst} {shifted} {noisy}");
    }
}

//! Do two noisy estimates agree?

use crate::MetricsError;
use crate::error::{check, check_size};
use kajo_image::Image;
use kajo_units::LinearRgb;
use statrs::function::erf::erfc;

/// Side of the blocks, px.
const BLOCK: u32 = 8;
/// Relative rounding of a pixel that was summed in `f32`.
const ROUNDING: f64 = 1e-6;

/// Outcome of [`z_test`]. Shares are over all values (pixel × channel, block × channel).
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct ZTest {
    /// The k of the shares.
    pub sigmas: f64,
    /// Share of values with |z| > k.
    pub share: f64,
    /// Share that normal noise alone gives: 2 (1 − Φ(k)).
    pub expected_share: f64,
    /// Share of 8×8 blocks with |z| > k.
    pub block_share: f64,
    /// Largest |z| of a block.
    pub max_block_z: f64,
    /// Probability that the largest |z| of that many blocks is at least as large when both images agree (Šidák).
    pub p_value: f64,
}

/// Per pixel and channel z = (a − b) / √(var a + var b), variances of the pixels' means.
///
/// Pixel noise is rarely normal; the sum over an 8×8 block is much nearer to it, and shows a small common offset 8 times sooner. The
/// verdict therefore uses the blocks: [`ZTest::p_value`].
///
/// # Errors
/// Sizes that differ, NaN.
pub fn z_test(
    (a, var_a): (&Image<LinearRgb>, &Image<LinearRgb>),
    (b, var_b): (&Image<LinearRgb>, &Image<LinearRgb>),
    sigmas: f64,
) -> Result<ZTest, MetricsError> {
    check("image", a, b)?;
    check("image's variance", var_a, b)?;
    check_size("reference's variance", var_b.size(), b.size())?;
    let terms = |x: u32, y: u32, c: usize| {
        let (va, vb) = (f64::from(a.get(x, y)[c]), f64::from(b.get(x, y)[c]));
        let rounding = (ROUNDING * va.abs().max(vb.abs())).powi(2);
        (va - vb, f64::from(var_a.get(x, y)[c].max(0.0)) + f64::from(var_b.get(x, y)[c].max(0.0)) + rounding)
    };
    let (mut beyond, mut blocks, mut blocks_beyond, mut max_block_z) = (0u64, 0u64, 0u64, 0f64);
    let (width, height) = (a.width(), a.height());
    for (by, bx) in (0..height).step_by(BLOCK as usize).flat_map(|y| (0..width).step_by(BLOCK as usize).map(move |x| (y, x))) {
        for c in 0..3 {
            let (mut difference, mut variance) = (0.0, 0.0);
            for (x, y) in (by..(by + BLOCK).min(height)).flat_map(|y| (bx..(bx + BLOCK).min(width)).map(move |x| (x, y))) {
                let (d, v) = terms(x, y, c);
                beyond += u64::from(z(d, v) > sigmas);
                difference += d;
                variance += v;
            }
            let block_z = z(difference, variance);
            blocks += 1;
            blocks_beyond += u64::from(block_z > sigmas);
            max_block_z = max_block_z.max(block_z);
        }
    }
    let n = f64::from(width) * f64::from(height) * 3.0;
    Ok(ZTest {
        sigmas,
        share: beyond as f64 / n,
        expected_share: two_sided(sigmas),
        block_share: blocks_beyond as f64 / blocks as f64,
        max_block_z,
        p_value: at_least_one(two_sided(max_block_z), blocks as f64),
    })
}

fn z(difference: f64, variance: f64) -> f64 {
    if difference == 0.0 { 0.0 } else { difference.abs() / variance.sqrt() }
}

/// P(|Z| > z) of a standard normal.
fn two_sided(z: f64) -> f64 {
    erfc(z / std::f64::consts::SQRT_2)
}

/// 1 − (1 − p)ⁿ without cancellation.
fn at_least_one(p: f64, n: f64) -> f64 {
    -(n * (-p).ln_1p()).exp_m1()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_images::{scene, with_noise};
    use glam::UVec2;

    fn flat(like: &Image<LinearRgb>, sigma: f32) -> Image<LinearRgb> {
        like.map(|_| LinearRgb::splat(sigma * sigma))
    }

    #[test]
    fn two_estimates_of_one_truth_agree_with_the_expected_share() {
        let truth = scene(UVec2::new(128, 128), 0.0);
        let test =
            z_test((&with_noise(&truth, 0.1, 1), &flat(&truth, 0.1)), (&with_noise(&truth, 0.05, 2), &flat(&truth, 0.05)), 2.0).unwrap();
        assert!((test.share - test.expected_share).abs() < 0.004 && (test.expected_share - 0.0455).abs() < 1e-4, "{test:?}");
        assert!(test.p_value > 0.01, "{test:?}");
    }

    /// An offset of half a pixel's σ is nothing for a pixel and 4 σ for a block.
    #[test]
    fn planted_offset_in_one_block_is_found_by_the_blocks() {
        let truth = scene(UVec2::new(128, 128), 0.0);
        let mut shifted = truth.clone();
        for (x, y) in (64..72).flat_map(|x| (32..40).map(move |y| (x, y))) {
            *shifted.get_mut(x, y) += LinearRgb::new(0.0, 0.1, 0.0);
        }
        let test = z_test((&with_noise(&shifted, 0.1, 1), &flat(&truth, 0.1)), (&truth, &flat(&truth, 0.0)), 3.0).unwrap();
        assert!(test.p_value < 1e-3 && test.max_block_z > 5.0, "{test:?}");
    }

    #[test]
    fn exact_images_agree_up_to_rounding_only() {
        let truth = scene(UVec2::new(20, 12), 0.0);
        let none = flat(&truth, 0.0);
        assert_eq!(z_test((&truth, &none), (&truth, &none), 3.0).unwrap().p_value, 1.0);
        let off = truth.map(|p| *p * 1.001);
        assert!(z_test((&off, &none), (&truth, &none), 3.0).unwrap().p_value < 1e-12);
    }
}

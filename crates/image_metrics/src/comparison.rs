//! Every number about an image and its reference.

use crate::flip::{self, PIXELS_PER_DEGREE};
use crate::{MetricsError, View, is_above_floor, mean_ratio, mse, psnr, rel_mse, rmse_floor, ssim};
use kajo_image::Image;
use kajo_units::LinearRgb;

/// How to compare.
#[derive(Clone, Copy, Debug)]
pub struct ComparisonOptions<'a> {
    /// The picture that PSNR, SSIM and ꟻLIP see.
    pub view: View,
    /// Whether to compute HDR-ꟻLIP: for scene-referred light.
    pub hdr: bool,
    /// For ꟻLIP.
    pub pixels_per_degree: f32,
    /// Variance of the reference's pixels, when it is an estimate.
    pub reference_variance: Option<&'a Image<LinearRgb>>,
    /// How many standard errors above the floor count as an error.
    pub sigmas: f64,
}

impl Default for ComparisonOptions<'_> {
    fn default() -> Self {
        Self { view: View::default(), hdr: false, pixels_per_degree: PIXELS_PER_DEGREE, reference_variance: None, sigmas: 3.0 }
    }
}

/// The errors of an image. The field names are the keys of `report.json` and of `kajo metrics --json`.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Comparison {
    /// √(mean (I − R)²) over pixels and channels, linear light.
    pub rmse: f64,
    /// Its square.
    pub mse: f64,
    /// See [`rel_mse`](crate::rel_mse).
    pub rel_mse: f64,
    /// PSNR of the [`View`]'s picture, peak 1, dB. `null`: infinite, the pictures are equal.
    pub psnr: Option<f64>,
    /// −20 log₁₀ RMSE, dB: peak 1 in linear light, nothing clamped. `null`: infinite.
    pub psnr_linear: Option<f64>,
    /// See [`ssim`](crate::ssim), of the [`View`]'s picture. `null`: smaller than 11×11 px.
    pub ssim: Option<f64>,
    /// Mean ꟻLIP of the [`View`]'s light.
    pub flip: f64,
    /// Mean HDR-ꟻLIP; absent when not asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub flip_hdr: Option<f64>,
    /// See [`mean_ratio`](crate::mean_ratio). `null`: the reference is black.
    pub mean_ratio: Option<f64>,
    /// Every pixel is equal.
    pub identical: bool,
    /// RMSE that a perfect image has against this reference; absent for an exact reference.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rmse_floor: Option<f64>,
    /// False: the image cannot be told from the truth with this reference; see [`is_above_floor`](crate::is_above_floor).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub distinguishable: Option<bool>,
    /// The picture that PSNR, SSIM and ꟻLIP saw.
    pub view: View,
}

impl Comparison {
    /// Compares `image` with `reference`, and gives the ꟻLIP map (the HDR one when asked for).
    ///
    /// # Errors
    /// Sizes that differ, NaN.
    pub fn new(
        image: &Image<LinearRgb>,
        reference: &Image<LinearRgb>,
        options: &ComparisonOptions,
    ) -> Result<(Self, Image<f32>), MetricsError> {
        let mse = mse(image, reference)?;
        let (picture, reference_picture) = (options.view.picture(image), options.view.picture(reference));
        let map = flip::flip(&options.view.light(image), &options.view.light(reference), options.pixels_per_degree)?;
        let hdr_map = options.hdr.then(|| flip::flip_hdr(image, reference, options.pixels_per_degree)).transpose()?;
        let variance = options.reference_variance;
        let finite = |db: f64| db.is_finite().then_some(db);
        let comparison = Self {
            rmse: mse.sqrt(),
            mse,
            rel_mse: rel_mse(image, reference)?,
            psnr: finite(psnr(&picture, &reference_picture, 1.0)?),
            psnr_linear: finite(-10.0 * mse.log10()),
            ssim: ssim(&picture, &reference_picture)?,
            flip: flip::mean(&map),
            flip_hdr: hdr_map.as_ref().map(flip::mean),
            mean_ratio: mean_ratio(image, reference)?,
            identical: image == reference,
            rmse_floor: variance.map(rmse_floor),
            distinguishable: variance.map(|v| is_above_floor(image, reference, v, options.sigmas)).transpose()?,
            view: options.view,
        };
        Ok((comparison, hdr_map.unwrap_or(map)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_images::{scene, with_noise};
    use glam::UVec2;

    #[test]
    fn equal_images_have_null_psnr_and_say_identical() {
        let image = scene(UVec2::new(24, 24), 0.0);
        let (comparison, map) = Comparison::new(&image, &image, &ComparisonOptions { hdr: true, ..Default::default() }).unwrap();
        let json = serde_json::to_value(&comparison).unwrap();
        assert_eq!((json["rmse"].as_f64(), json["flip"].as_f64(), json["flip_hdr"].as_f64()), (Some(0.0), Some(0.0), Some(0.0)));
        assert!(json["psnr"].is_null() && json["identical"] == true && (json["ssim"].as_f64().unwrap() - 1.0).abs() < 1e-12);
        assert!(map.pixels().iter().all(|&e| e == 0.0));
    }

    #[test]
    fn json_has_the_keys_of_the_contract() {
        let image = scene(UVec2::new(24, 24), 0.0);
        let (comparison, _) = Comparison::new(&with_noise(&image, 0.1, 1), &image, &ComparisonOptions::default()).unwrap();
        let json = serde_json::to_value(&comparison).unwrap();
        for key in ["rmse", "rel_mse", "psnr", "ssim", "flip", "mean_ratio"] {
            assert!(json[key].is_f64(), "{key}");
        }
    }

    #[test]
    fn planted_swap_of_channels_and_a_noisy_reference_are_told_apart() {
        let truth = scene(UVec2::new(48, 48), 0.0);
        let reference = with_noise(&truth, 0.02, 3);
        let variance = truth.map(|_| LinearRgb::splat(0.0004));
        let options = ComparisonOptions { reference_variance: Some(&variance), ..Default::default() };
        let of = |image: &Image<LinearRgb>| Comparison::new(image, &reference, &options).unwrap().0;
        assert_eq!(of(&truth).distinguishable, Some(false));
        let swapped = of(&truth.map(|p| LinearRgb::new(p[1], p[0], p[2])));
        assert_eq!(swapped.distinguishable, Some(true));
        assert!(swapped.flip > of(&truth).flip + 0.1);
    }
}

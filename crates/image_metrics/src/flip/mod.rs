//! ꟻLIP: the difference a viewer sees when two pictures alternate in place.    \[Andersson20], \[Andersson21]
//!
//! Colours are filtered by the eye's contrast sensitivity and compared in a Hunt-adjusted L*a*b* space (HyAB distance); edges and points
//! are compared apart, and raise the colour difference: ΔE = ΔE_c^(1 − ΔE_f). Per pixel 0 (equal) to 1 (opposite).

mod color;
mod filter;
mod hdr;

pub use hdr::{HdrExposures, flip_hdr};

use crate::MetricsError;
use crate::error::check;
use color::{hunt_lab, hyab, opponent_from_linear};
use filter::{FeatureFilter, SpatialFilter};
use kajo_image::Image;
use kajo_units::LinearRgb;
use rayon::prelude::*;

/// Pixels per degree of a 0.7 m wide 3840 px display seen from 0.7 m.    \[Andersson20] section 5
pub const PIXELS_PER_DEGREE: f32 = 67.020_64;

/// Exponents and breakpoints of the maps to [0, 1].    \[Andersson20] table 1, sections 4.3 and 4.4
const Q_COLOR: f32 = 0.7;
const P_COLOR: f32 = 0.4;
const P_TARGET: f32 = 0.95;
const Q_FEATURE: f32 = 0.5;

/// The ꟻLIP map of two pictures in linear light, clamped to [0, 1] (an 8-bit picture: decode it first). `height × width`, each in [0, 1].
///
/// # Errors
/// Sizes that differ, NaN.
pub fn flip(image: &Image<LinearRgb>, reference: &Image<LinearRgb>, pixels_per_degree: f32) -> Result<Image<f32>, MetricsError> {
    check("image", image, reference)?;
    let opponent = |image: &Image<LinearRgb>| image.map(|p| opponent_from_linear(p.0.clamp(glam::Vec3::ZERO, glam::Vec3::ONE)));
    let (image, reference) = (opponent(image), opponent(reference));
    let spatial = SpatialFilter::new(pixels_per_degree);
    let feature = FeatureFilter::new(pixels_per_degree);
    let (seen, seen_reference) = (spatial.apply(&image), spatial.apply(&reference));
    let (features, features_reference) = (feature.apply(&image), feature.apply(&reference));
    let largest = largest_color_difference();
    let pixels = (0..image.pixels().len())
        .into_par_iter()
        .map(|i| {
            let color = color_difference(hyab(hunt_lab(seen.pixels()[i]), hunt_lab(seen_reference.pixels()[i])), largest);
            let [edge, point] = features.pixels()[i];
            let [edge_reference, point_reference] = features_reference.pixels()[i];
            let strongest = (edge - edge_reference).abs().max((point - point_reference).abs());
            // eq. 16 and 17
            let feature = (std::f32::consts::FRAC_1_SQRT_2 * strongest).powf(Q_FEATURE);
            color.powf(1.0 - feature)
        })
        .collect();
    Ok(Image::from_pixels(reference.size(), pixels))
}

/// The mean of a ꟻLIP map: the one number its authors advise.
pub fn mean(map: &Image<f32>) -> f64 {
    map.pixels().iter().map(|&e| f64::from(e)).sum::<f64>() / map.pixels().len().max(1) as f64
}

/// HyAB^q of green and blue, the largest distance in the sRGB cube.    \[Andersson20] section 4.3
fn largest_color_difference() -> f32 {
    let lab = |rgb| hunt_lab(opponent_from_linear(rgb));
    hyab(lab(glam::Vec3::Y), lab(glam::Vec3::Z)).powf(Q_COLOR)
}

/// Distances up to 0.4 of the largest take up [0, 0.95].    \[Andersson20] eq. 12
fn color_difference(distance: f32, largest: f32) -> f32 {
    let (d, knee) = (distance.powf(Q_COLOR), P_COLOR * largest);
    if d < knee { d * P_TARGET / knee } else { P_TARGET + (d - knee) / (largest - knee) * (1.0 - P_TARGET) }
}

#[cfg(test)]
mod tests;

//! HDR-ꟻLIP: the largest ꟻLIP over the exposures a viewer might choose.    \[Andersson21]

use super::flip;
use crate::MetricsError;
use crate::error::check;
use kajo_image::Image;
use kajo_units::LinearRgb;

/// Luminance after tone mapping that fixes the range of exposures.    \[Andersson21] section 3.1
const TARGET: f32 = 0.85;
/// More steps than any display and scene need: 1e-12 to 1 is 40 stops.
const MAX_EXPOSURES: usize = 40;

/// The exposures of an HDR comparison, in stops.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct HdrExposures {
    /// Maps the brightest pixel of the reference to 0.85.
    pub start: f32,
    /// Maps the median of the reference to 0.85.
    pub stop: f32,
    /// How many, evenly from start to stop.
    pub count: usize,
}

impl HdrExposures {
    /// From the luminance of the reference.    \[Andersson21] section 3.1
    ///
    /// Deviation: the median is over pixels with light; in the paper's form a picture that is half black has an infinite exposure.
    pub fn of(reference: &Image<LinearRgb>) -> Self {
        let mut lit: Vec<f32> = reference.pixels().iter().map(|p| p.luminance()).filter(|&y| y > 0.0).collect();
        if lit.is_empty() {
            return Self { start: 0.0, stop: 0.0, count: 1 };
        }
        lit.sort_by(f32::total_cmp);
        let middle = lit.len() / 2;
        let median = if lit.len().is_multiple_of(2) { 0.5 * (lit[middle - 1] + lit[middle]) } else { lit[middle] };
        let at_target = inverse_tone_map(TARGET);
        let (start, stop) = ((at_target / lit[lit.len() - 1]).log2(), (at_target / median).log2());
        Self { start, stop, count: ((stop - start).ceil() as usize).clamp(2, MAX_EXPOSURES) }
    }

    /// Each exposure, stops.
    pub fn stops(&self) -> impl Iterator<Item = f32> + '_ {
        let step = if self.count > 1 { (self.stop - self.start) / (self.count - 1) as f32 } else { 0.0 };
        (0..self.count).map(move |i| self.start + step * i as f32)
    }
}

/// The HDR-ꟻLIP map: per pixel the largest ꟻLIP of both images exposed, tone mapped (a fit of ACES) and clamped, over
/// [`HdrExposures::of`] the reference.    \[Andersson21] section 3
///
/// # Errors
/// Sizes that differ, NaN.
pub fn flip_hdr(image: &Image<LinearRgb>, reference: &Image<LinearRgb>, pixels_per_degree: f32) -> Result<Image<f32>, MetricsError> {
    check("image", image, reference)?;
    let mut largest = image.map(|_| 0f32);
    for stop in HdrExposures::of(reference).stops() {
        let displayed = |image: &Image<LinearRgb>| image.map(|p| LinearRgb((p.0 * stop.exp2()).to_array().map(tone_map).into()));
        let map = flip(&displayed(image), &displayed(reference), pixels_per_degree)?;
        largest.pixels_mut().iter_mut().zip(map.pixels()).for_each(|(l, &e)| *l = l.max(e));
    }
    Ok(largest)
}

/// Numerator and denominator of the tone map, (a x² + b x + c), with the pre-exposure 0.6 inside.    \[Andersson21] section 3.2
const NUMERATOR: [f32; 3] = [0.36 * 2.51, 0.6 * 0.03, 0.0];
const DENOMINATOR: [f32; 3] = [0.36 * 2.43, 0.6 * 0.59, 0.14];

fn tone_map(x: f32) -> f32 {
    // Far above the shoulder the quotient is its limit; squares of larger values would be infinite.
    let x = x.clamp(0.0, 1e9);
    let value = |[a, b, c]: [f32; 3]| (a * x + b) * x + c;
    (value(NUMERATOR) / value(DENOMINATOR)).clamp(0.0, 1.0)
}

/// The x > 0 with `tone_map(x) = y`: the larger root of a quadratic.
fn inverse_tone_map(y: f32) -> f32 {
    let [a, b, c]: [f32; 3] = std::array::from_fn(|i| NUMERATOR[i] - y * DENOMINATOR[i]);
    (-b + (b * b - 4.0 * a * c).sqrt()) / (2.0 * a)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flip::{PIXELS_PER_DEGREE, mean};
    use crate::test_images::{scene, with_noise};
    use glam::UVec2;

    #[test]
    fn inverse_of_the_tone_map() {
        for y in [0.1, 0.5, 0.85] {
            assert!((tone_map(inverse_tone_map(y)) - y).abs() < 1e-5);
        }
    }

    #[test]
    fn exposures_span_from_brightest_to_median_a_stop_apart_at_most() {
        let image = Image::from_fn(UVec2::new(10, 10), |x, _| LinearRgb::splat(2f32.powi(x as i32)));
        let exposures = HdrExposures::of(&image);
        let median = 0.5 * (16.0 + 32.0);
        assert!((exposures.stop - exposures.start - (512.0f32 / median).log2()).abs() < 1e-4, "{exposures:?}");
        assert_eq!(exposures.count, 5);
        let stops: Vec<f32> = exposures.stops().collect();
        assert!((stops[0] - exposures.start).abs() < 1e-6 && (stops[4] - exposures.stop).abs() < 1e-4);
        assert!((tone_map(512.0 * stops[0].exp2()) - 0.85).abs() < 1e-4 && (tone_map(median * stops[4].exp2()) - 0.85).abs() < 1e-3);
    }

    /// The definition: a pixel's value is the largest of the LDR maps.
    #[test]
    fn is_the_largest_of_the_ldr_maps() {
        let reference = scene(UVec2::new(32, 24), 0.0).map(|p| *p * 40.0);
        let image = with_noise(&reference, 2.0, 1);
        let map = flip_hdr(&image, &reference, PIXELS_PER_DEGREE).unwrap();
        let mut largest = vec![0f32; 32 * 24];
        for stop in HdrExposures::of(&reference).stops() {
            let show = |i: &Image<LinearRgb>| i.map(|p| LinearRgb((p.0 * 2f32.powf(stop)).to_array().map(tone_map).into()));
            let ldr = flip(&show(&image), &show(&reference), PIXELS_PER_DEGREE).unwrap();
            largest.iter_mut().zip(ldr.pixels()).for_each(|(l, e)| *l = l.max(*e));
        }
        map.pixels().iter().zip(&largest).for_each(|(a, b)| assert!((a - b).abs() < 1e-4));
    }

    /// A fault that 8 bits would clamp away: highlights ten times too bright.
    #[test]
    fn planted_fault_in_the_highlights_is_seen() {
        let reference = Image::from_fn(UVec2::new(32, 32), |x, y| LinearRgb::splat(if x > 20 && y > 20 { 100.0 } else { 0.2 }));
        let image = reference.map(|p| if p[0] > 1.0 { *p * 0.1 } else { *p });
        let hdr = mean(&flip_hdr(&image, &reference, PIXELS_PER_DEGREE).unwrap());
        assert_eq!(mean(&flip(&image, &reference, PIXELS_PER_DEGREE).unwrap()), 0.0);
        assert!(hdr > 0.05, "{hdr}");
    }

    #[test]
    fn black_and_half_black_references_have_finite_exposures() {
        let black = Image::from_fn(UVec2::new(8, 8), |_, _| LinearRgb::BLACK);
        assert_eq!(mean(&flip_hdr(&black, &black, PIXELS_PER_DEGREE).unwrap()), 0.0);
        let sparse = Image::from_fn(UVec2::new(8, 8), |x, y| LinearRgb::splat(if x + y == 0 { 3.0 } else { 0.0 }));
        assert!(mean(&flip_hdr(&black, &sparse, PIXELS_PER_DEGREE).unwrap()) > 0.0);
    }
}

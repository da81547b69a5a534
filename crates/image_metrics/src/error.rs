//! What makes two images incomparable.

use glam::UVec2;
use kajo_image::Image;
use kajo_units::LinearRgb;

/// A comparison that has no meaning.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MetricsError {
    /// Two sizes.
    #[error("the {what} has {}x{} px but the reference has {}x{} px; render both at one size", got.x, got.y, reference.x, reference.y)]
    SizeMismatch {
        /// Which image.
        what: &'static str,
        /// Its size.
        got: UVec2,
        /// The reference's size.
        reference: UVec2,
    },
    /// No pixels.
    #[error("the images have no pixels")]
    Empty,
    /// NaN or infinity.
    #[error("the {what} has {count} pixels that are NaN or infinite, the first at column {x}, row {y}; find their cause before comparing")]
    NotFinite {
        /// Which image.
        what: &'static str,
        /// How many pixels.
        count: usize,
        /// Column of the first.
        x: u32,
        /// Row of the first.
        y: u32,
    },
    /// Statistics of one run.
    #[error("noise shows between runs: at least 2 are needed, got {got}; raise --repeat")]
    TooFewRepeats {
        /// Number of runs.
        got: usize,
    },
}

/// Both images have one size, some pixels, and only finite values.
pub(crate) fn check(what: &'static str, image: &Image<LinearRgb>, reference: &Image<LinearRgb>) -> Result<(), MetricsError> {
    check_size(what, image.size(), reference.size())?;
    check_finite(what, image)?;
    check_finite("reference", reference)
}

pub(crate) fn check_size(what: &'static str, got: UVec2, reference: UVec2) -> Result<(), MetricsError> {
    if got != reference {
        return Err(MetricsError::SizeMismatch { what, got, reference });
    }
    if got.min_element() == 0 { Err(MetricsError::Empty) } else { Ok(()) }
}

fn check_finite(what: &'static str, image: &Image<LinearRgb>) -> Result<(), MetricsError> {
    let mut bad = image.pixels().iter().enumerate().filter(|(_, p)| !p.is_finite()).map(|(i, _)| i);
    let Some(first) = bad.next() else { return Ok(()) };
    let (x, y) = (first as u32 % image.width(), first as u32 / image.width());
    Err(MetricsError::NotFinite { what, count: 1 + bad.count(), x, y })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_and_nan_are_named() {
        let a = Image::from_fn(UVec2::new(3, 2), |_, _| LinearRgb::WHITE);
        let b = Image::from_fn(UVec2::new(2, 3), |_, _| LinearRgb::WHITE);
        assert!(check("image", &a, &b).unwrap_err().to_string().contains("3x2 px but the reference has 2x3"));
        let mut c = a.clone();
        *c.get_mut(2, 1) = LinearRgb::new(0.0, f32::NAN, 0.0);
        assert_eq!(check("image", &a, &c), Err(MetricsError::NotFinite { what: "reference", count: 1, x: 2, y: 1 }));
        let empty = Image::from_pixels(UVec2::ZERO, vec![]);
        assert_eq!(check("image", &empty, &empty), Err(MetricsError::Empty));
    }
}

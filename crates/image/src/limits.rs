//! Sizes are checked before memory is taken for them.

use crate::ImageError;
use glam::UVec2;

/// Longest side, px: four times the largest texture any GPU takes.
pub const MAX_SIDE: u32 = 65_536;
/// Most pixels: 3.2 GB of RGB float; beyond it one picture does not fit a desktop's memory with its layers.
pub const MAX_PIXELS: u64 = 1 << 28;

/// # Errors
/// [`ImageError::Size`] for an empty image and for one over [`MAX_SIDE`] or [`MAX_PIXELS`].
pub fn check_size(size: UVec2) -> Result<(), ImageError> {
    check_size_within(size, MAX_PIXELS)
}

/// [`check_size`] with another limit on the pixels, at most [`MAX_PIXELS`].
pub(crate) fn check_size_within(size: UVec2, max_pixels: u64) -> Result<(), ImageError> {
    let max_pixels = max_pixels.min(MAX_PIXELS);
    let fits = size.min_element() > 0 && size.max_element() <= MAX_SIDE && u64::from(size.x) * u64::from(size.y) <= max_pixels;
    if fits { Ok(()) } else { Err(ImageError::Size { size, max_side: MAX_SIDE, max_pixels }) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn empty_and_huge_sizes_are_refused_with_both_limits() {
        for size in [UVec2::ZERO, UVec2::new(0, 5), UVec2::new(100_000, 100_000), UVec2::new(1, 65_537), UVec2::splat(65_536)] {
            let message = check_size(size).unwrap_err().to_string();
            assert!(message.contains(&format!("{}x{}", size.x, size.y)) && message.contains("65536"), "{message}");
        }
        for size in [UVec2::ONE, UVec2::new(65_536, 4096), UVec2::new(16_384, 16_384)] {
            check_size(size).unwrap();
        }
    }
}

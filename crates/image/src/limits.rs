//! Sizes are checked before memory is taken for them.

use crate::ImageError;
use glam::UVec2;
use std::path::Path;

/// Longest side, px: four times the largest texture any GPU takes.
pub const MAX_SIDE: u32 = 65_536;
/// Most pixels: 3.2 GB of RGB float; beyond it one picture does not fit a desktop's memory with its layers.
pub const MAX_PIXELS: u64 = 1 << 28;

/// # Errors
/// [`ImageError::Size`] for an empty image and for one over [`MAX_SIDE`] or [`MAX_PIXELS`].
pub fn check_size(size: UVec2) -> Result<(), ImageError> {
    if fits(size, MAX_PIXELS) { Ok(()) } else { Err(ImageError::Size { size, max_side: MAX_SIDE, max_pixels: MAX_PIXELS }) }
}

/// [`check_size`] of the picture that a file declares, with another limit on the pixels, at most [`MAX_PIXELS`].
pub(crate) fn check_declared(path: &Path, size: UVec2, max_pixels: u64) -> Result<(), ImageError> {
    let max_pixels = max_pixels.min(MAX_PIXELS);
    if fits(size, max_pixels) { Ok(()) } else { Err(ImageError::TooLarge { path: path.into(), size, max_side: MAX_SIDE, max_pixels }) }
}

fn fits(size: UVec2, max_pixels: u64) -> bool {
    size.min_element() > 0 && size.max_element() <= MAX_SIDE && u64::from(size.x) * u64::from(size.y) <= max_pixels
}

/// True for a JPEG of `bytes` bytes that cannot hold the `size` it declares: decoders fill what is missing with grey.
///
/// The component with the finest samples has a block for each 8 × 8 px, and a block takes at least the one bit of its mean: 512 px a byte.
pub fn jpeg_is_cut_short(bytes: usize, size: UVec2) -> bool {
    u64::from(size.x) * u64::from(size.y) > 512 * bytes as u64
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

//! Radiance HDR (RGBE): 8 bits a channel and a shared exponent, about 1 % precise.

use crate::{Image, ImageError, check_size, write_atomic};
use image::codecs::hdr::HdrEncoder;
use kajo_units::LinearRgb;
use std::path::Path;

/// Writes `image`, linear RGB, as Radiance HDR. Negative channels become 0: the format has no sign.
///
/// # Errors
/// NaN or infinite pixels, sizes outside the limits, and those of [`write_atomic`].
pub fn write_hdr(path: &Path, image: &Image<LinearRgb>) -> Result<(), ImageError> {
    check_size(image.size())?;
    let count = image.pixels().iter().filter(|p| !p.is_finite()).count();
    if count > 0 {
        return Err(ImageError::NotFinite { path: path.to_path_buf(), format: "Radiance HDR", count });
    }
    let pixels: Vec<_> = image.pixels().iter().map(|p| image::Rgb(p.0.max(glam::Vec3::ZERO).to_array())).collect();
    let mut bytes = Vec::new();
    HdrEncoder::new(&mut bytes)
        .encode(&pixels, image.width() as usize, image.height() as usize)
        .map_err(|e| ImageError::from_write(path, 0, std::io::Error::other(e)))?;
    write_atomic(path, &bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::read_image;
    use glam::UVec2;

    #[test]
    fn round_trips_to_one_percent_over_twelve_decades() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.hdr");
        let image = Image::from_fn(UVec2::new(13, 5), |x, y| LinearRgb::splat(10f32.powi(x as i32 - 6)) * (1.0 + 0.1 * y as f32));
        write_hdr(&path, &image).unwrap();
        let back = read_image(&path).unwrap();
        assert_eq!(back.size(), image.size());
        for (a, b) in back.pixels().iter().zip(image.pixels()) {
            assert!((a.0 - b.0).abs().max_element() <= 0.01 * b[0], "{a:?} for {b:?}");
        }
    }

    #[test]
    fn nan_is_refused_with_its_count() {
        let image = Image::from_pixels(UVec2::new(2, 1), vec![LinearRgb::splat(f32::NAN), LinearRgb::WHITE]);
        let error = write_hdr(Path::new("unused.hdr"), &image).unwrap_err().to_string();
        assert!(error.contains("1 pixels") && error.contains(".exr"), "{error}");
    }
}

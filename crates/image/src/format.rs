//! One call to write a picture in the format its name asks for.

use crate::{ExrFile, Image, ImageError, Layer, write_hdr, write_png};
use kajo_units::{LinearRgb, Srgb8};
use std::collections::BTreeMap;
use std::path::Path;

/// What a file could not hold as it was.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[must_use = "pixels that were not stored as they are deserve a warning"]
pub struct Written {
    /// Pixels that were NaN or infinite and were stored as magenta (PNG).
    pub not_finite: usize,
    /// Pixels with a channel outside [0, 1] that were clamped (PNG).
    pub clamped: usize,
}

/// The colour that stands for NaN and infinity in a PNG: no light looks like it.
const NOT_FINITE: Srgb8 = Srgb8([255, 0, 255]);

/// Writes linear RGB as `.exr` (float, NaN kept), `.hdr` or `.png` (sRGB-encoded and clamped, no tone map), by the file's extension.
///
/// # Errors
/// An unknown extension, and those of the format's own writer.
pub fn write_image(path: &Path, image: &Image<LinearRgb>, metadata: &BTreeMap<String, String>) -> Result<Written, ImageError> {
    match extension(path).as_str() {
        "exr" => {
            let mut file = ExrFile::new(image.size());
            file.layers.push(Layer::color("", image));
            file.metadata = metadata.clone();
            file.write(path)?;
            Ok(Written::default())
        }
        "hdr" => write_hdr(path, image).map(|()| Written::default()),
        "png" => {
            let mut written = Written::default();
            let encoded = image.map(|&pixel| encode(pixel, &mut written));
            write_png(path, &encoded, metadata)?;
            Ok(written)
        }
        _ => Err(ImageError::UnknownFormat { path: path.to_path_buf(), writing: true }),
    }
}

fn encode(pixel: LinearRgb, written: &mut Written) -> Srgb8 {
    if !pixel.is_finite() {
        written.not_finite += 1;
        return NOT_FINITE;
    }
    if pixel.0.min_element() < 0.0 || pixel.max_component() > 1.0 {
        written.clamped += 1;
    }
    pixel.to_srgb8()
}

pub(crate) fn extension(path: &Path) -> String {
    path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::read_image;
    use glam::UVec2;

    #[test]
    fn png_counts_what_it_cannot_hold() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.PNG");
        let pixels = vec![LinearRgb::splat(f32::NAN), LinearRgb::splat(2.0), LinearRgb::new(-1.0, 0.5, 0.5), LinearRgb::splat(0.5)];
        let written = write_image(&path, &Image::from_pixels(UVec2::new(2, 2), pixels), &BTreeMap::new()).unwrap();
        assert_eq!(written, Written { not_finite: 1, clamped: 2 });
        assert_eq!(read_image(&path).unwrap().get(0, 0).to_srgb8(), NOT_FINITE);
    }

    #[test]
    fn exr_keeps_nan_and_infinity() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.exr");
        let pixels = vec![LinearRgb::new(f32::NAN, f32::INFINITY, -0.0), LinearRgb::new(1e30, -3.0, 1e-40)];
        let written = write_image(&path, &Image::from_pixels(UVec2::new(2, 1), pixels.clone()), &BTreeMap::new()).unwrap();
        assert_eq!(written, Written::default());
        for (a, b) in read_image(&path).unwrap().pixels().iter().zip(&pixels) {
            assert_eq!(a.0.to_array().map(f32::to_bits), b.0.to_array().map(f32::to_bits));
        }
    }

    #[test]
    fn unknown_extension_names_the_known_ones() {
        let image = Image::from_pixels(UVec2::ONE, vec![LinearRgb::WHITE]);
        let error = write_image(Path::new("a.bmp"), &image, &BTreeMap::new()).unwrap_err().to_string();
        assert!(error.contains("a.bmp") && error.ends_with("known for writing: exr, hdr, png"), "{error}");
    }
}

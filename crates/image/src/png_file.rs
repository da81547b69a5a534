//! PNG: 8-bit sRGB pictures with text metadata.

use crate::{Image, ImageError, check_size, write_atomic};
use kajo_units::Srgb8;
use std::collections::BTreeMap;
use std::path::Path;

/// The bytes of a PNG file with `metadata` as text chunks (keyword → UTF-8 text), and the sRGB chunk.
///
/// # Errors
/// Sizes outside the limits; a keyword that PNG does not take (1 to 79 Latin-1 characters).
pub fn encode_png(image: &Image<Srgb8>, metadata: &BTreeMap<String, String>) -> Result<Vec<u8>, ImageError> {
    check_size(image.size())?;
    let failed = |e: png::EncodingError| ImageError::from_write(Path::new("a PNG"), 0, std::io::Error::other(e));
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, image.width(), image.height());
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::RelativeColorimetric);
    encoder.set_compression(png::Compression::Balanced);
    for (keyword, text) in metadata {
        encoder.add_itxt_chunk(keyword.clone(), text.clone()).map_err(failed)?;
    }
    let mut writer = encoder.write_header().map_err(failed)?;
    writer.write_image_data(bytemuck::cast_slice(image.pixels())).map_err(failed)?;
    writer.finish().map_err(failed)?;
    Ok(bytes)
}

/// Writes `image` as PNG, see [`encode_png`].
///
/// # Errors
/// Those of [`encode_png`] and [`write_atomic`].
pub fn write_png(path: &Path, image: &Image<Srgb8>, metadata: &BTreeMap<String, String>) -> Result<(), ImageError> {
    write_atomic(path, &encode_png(image, metadata)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::read_image;
    use glam::UVec2;

    #[test]
    fn all_256_levels_and_the_metadata_round_trip() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.png");
        let image = Image::from_fn(UVec2::new(256, 3), |x, y| Srgb8([x as u8, 255 - x as u8, y as u8]));
        let metadata = BTreeMap::from([("Software".to_owned(), "Kajo".to_owned()), ("scene".to_owned(), "Älvängen → 1".to_owned())]);
        write_png(&path, &image, &metadata).unwrap();
        assert_eq!(read_image(&path).unwrap().map(|p| p.to_srgb8()), image);
        let reader = png::Decoder::new(std::io::BufReader::new(std::fs::File::open(&path).unwrap())).read_info().unwrap();
        let texts: BTreeMap<_, _> = reader.info().utf8_text.iter().map(|t| (t.keyword.clone(), t.get_text().unwrap())).collect();
        assert_eq!(texts, metadata);
    }

    #[test]
    fn an_empty_picture_is_refused() {
        let empty = Image::from_pixels(UVec2::ZERO, vec![]);
        assert!(matches!(encode_png(&empty, &BTreeMap::new()), Err(ImageError::Size { .. })));
    }
}

//! Any picture to linear RGB.

use crate::limits::{check_declared, jpeg_is_cut_short};
use crate::{ExrFile, Image, ImageError, MAX_PIXELS, MAX_SIDE, read_file};
use glam::{UVec2, Vec3};
use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader, Limits};
use kajo_units::{LinearRgb, linear_from_srgb};
use std::io::Cursor;
use std::path::Path;

/// Reads EXR, Radiance HDR, PNG, JPEG or WebP to linear RGB; the content decides the format, not the name.
///
/// 8- and 16-bit files are sRGB-encoded (their gamma and colour profile chunks are not read); grey fills all channels. Alpha: an 8-
/// or 16-bit picture is laid over black in linear light; EXR colour is already multiplied by alpha and taken as it is.
///
/// # Errors
/// A missing or malformed file, an unknown format, a size outside the limits (checked before memory is taken), an EXR without colour.
pub fn read_image(path: &Path) -> Result<Image<LinearRgb>, ImageError> {
    let bytes = read_file(path).map_err(|reason| ImageError::Read { path: path.to_path_buf(), reason })?;
    decode_image(path, &bytes)
}

/// [`read_image`] of bytes in memory; `path` only names them in messages.
///
/// # Errors
/// Those of [`read_image`].
pub fn decode_image(path: &Path, bytes: &[u8]) -> Result<Image<LinearRgb>, ImageError> {
    decode_image_within(path, bytes, MAX_PIXELS)
}

/// [`decode_image`] that refuses more than `max_pixels`, at most [`MAX_PIXELS`]: a file of a few bytes can declare all of them.
///
/// # Errors
/// Those of [`read_image`].
pub fn decode_image_within(path: &Path, bytes: &[u8], max_pixels: u64) -> Result<Image<LinearRgb>, ImageError> {
    if bytes.is_empty() {
        return Err(ImageError::Empty { path: path.to_path_buf() });
    }
    if ExrFile::recognises(bytes) {
        return ExrFile::decode_within(path, bytes, max_pixels)?.into_color(path);
    }
    let mut reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format().expect("reading from memory");
    let (format, name) = match reader.format() {
        Some(ImageFormat::Png) => (ImageFormat::Png, "PNG"),
        Some(ImageFormat::Jpeg) => (ImageFormat::Jpeg, "JPEG"),
        Some(ImageFormat::Hdr) => (ImageFormat::Hdr, "Radiance HDR"),
        Some(ImageFormat::WebP) => (ImageFormat::WebP, "WebP"),
        _ => return Err(ImageError::UnknownFormat { path: path.to_path_buf(), writing: false }),
    };
    reader.set_format(format);
    // The default limit of 512 MiB would refuse large environments; ours are the sides and the area, checked on the header.
    reader.limits(Limits::no_limits());
    let malformed = |e: image::ImageError| ImageError::Malformed { path: path.to_path_buf(), format: name, reason: e.to_string() };
    let decoder = reader.into_decoder().map_err(malformed)?;
    let (width, height) = decoder.dimensions();
    let size = UVec2::new(width, height);
    check_declared(path, size, max_pixels)?;
    if format == ImageFormat::Jpeg && jpeg_is_cut_short(bytes.len(), size) {
        let reason = format!("it is cut short: {} bytes cannot hold {width}x{height} px", bytes.len());
        return Err(ImageError::Malformed { path: path.to_path_buf(), format: name, reason });
    }
    let decoded = DynamicImage::from_decoder(decoder).map_err(malformed)?;
    Ok(to_linear(decoded))
}

fn to_linear(decoded: DynamicImage) -> Image<LinearRgb> {
    debug_assert!(decoded.width() <= MAX_SIDE && u64::from(decoded.width()) * u64::from(decoded.height()) <= MAX_PIXELS);
    let size = UVec2::new(decoded.width(), decoded.height());
    let pixels = match decoded {
        DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_) => {
            // Float files are the large ones: their values become pixels where they lie.
            let values = decoded.into_rgb32f().into_raw();
            bytemuck::try_cast_vec(values).unwrap_or_else(|(_, values)| bytemuck::pod_collect_to_vec(&values))
        }
        DynamicImage::ImageLuma16(_) | DynamicImage::ImageLumaA16(_) | DynamicImage::ImageRgb16(_) | DynamicImage::ImageRgba16(_) => {
            let table: Vec<f32> = (0..=u16::MAX).map(|v| linear_from_srgb(f32::from(v) / 65_535.0)).collect();
            let over_black =
                |[r, g, b, a]: [u16; 4]| Vec3::from_array([r, g, b].map(|c| table[usize::from(c)])) * (f32::from(a) / 65_535.0);
            decoded.into_rgba16().pixels().map(|p| LinearRgb(over_black(p.0))).collect()
        }
        _ => {
            let table: Vec<f32> = (0..=u8::MAX).map(|v| linear_from_srgb(f32::from(v) / 255.0)).collect();
            let over_black = |[r, g, b, a]: [u8; 4]| Vec3::from_array([r, g, b].map(|c| table[usize::from(c)])) * (f32::from(a) / 255.0);
            decoded.into_rgba8().pixels().map(|p| LinearRgb(over_black(p.0))).collect()
        }
    };
    Image::from_pixels(size, pixels)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn encoded(image: &DynamicImage, format: ImageFormat) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        image.write_to(&mut bytes, format).unwrap();
        bytes.into_inner()
    }

    #[test]
    fn a_limit_on_pixels_holds_for_every_format() {
        let picture = |format| {
            let mut bytes = Cursor::new(Vec::new());
            image::RgbImage::new(8, 4).write_to(&mut bytes, format).unwrap();
            bytes.into_inner()
        };
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.exr");
        let mut exr = ExrFile::new(UVec2::new(8, 4));
        exr.layers.push(crate::Layer::color("", &Image::from_fn(UVec2::new(8, 4), |_, _| LinearRgb::WHITE)));
        exr.write(&path).unwrap();
        for bytes in [picture(ImageFormat::Png), picture(ImageFormat::Jpeg), std::fs::read(&path).unwrap()] {
            assert_eq!(decode_image_within(Path::new("a"), &bytes, 32).unwrap().size(), UVec2::new(8, 4));
            let message = decode_image_within(Path::new("a"), &bytes, 31).unwrap_err().to_string();
            assert!(message.contains("8x4") && message.contains("31 px"), "{message}");
        }
    }

    #[test]
    fn sixteen_bit_grey_and_alpha_become_linear_over_black() {
        let mut source = image::ImageBuffer::<image::LumaA<u16>, _>::new(2, 1);
        source.put_pixel(0, 0, image::LumaA([65_535, 32_768]));
        source.put_pixel(1, 0, image::LumaA([30_000, 65_535]));
        let read = decode_image(Path::new("a"), &encoded(&source.into(), ImageFormat::Png)).unwrap();
        assert!((read.get(0, 0)[2] - 0.500_008).abs() < 1e-6);
        let expected = linear_from_srgb(30_000.0 / 65_535.0);
        assert_eq!(read.get(1, 0), &LinearRgb::splat(expected));
    }

    #[test]
    fn a_jpeg_too_short_for_its_size_is_refused_and_the_shortest_whole_one_is_read() {
        let mut bytes = encoded(&image::GrayImage::new(2048, 2048).into(), ImageFormat::Jpeg);
        assert_eq!(decode_image(Path::new("a"), &bytes).unwrap().size(), UVec2::splat(2048));
        bytes.truncate(2048 * 2048 / 512 - 1);
        let message = decode_image(Path::new("a"), &bytes).unwrap_err().to_string();
        assert_eq!(message, "a is not a readable JPEG image: it is cut short: 8191 bytes cannot hold 2048x2048 px");
    }

    #[test]
    fn jpeg_is_read_in_srgb() {
        let source = image::RgbImage::from_pixel(16, 16, image::Rgb([188, 188, 188]));
        let read = decode_image(Path::new("a"), &encoded(&source.into(), ImageFormat::Jpeg)).unwrap();
        assert!((read.get(8, 8)[0] - 0.5).abs() < 0.01, "{:?}", read.get(8, 8));
    }

    #[test]
    fn garbage_truncation_and_absence_are_told_apart() {
        assert!(matches!(decode_image(Path::new("a"), b"hello"), Err(ImageError::UnknownFormat { .. })));
        assert_eq!(decode_image(Path::new("a"), b"").unwrap_err().to_string(), "a is empty");
        let mut png = encoded(&image::RgbImage::new(64, 64).into(), ImageFormat::Png);
        png.truncate(png.len() / 2);
        assert!(matches!(decode_image(Path::new("a"), &png), Err(ImageError::Malformed { format: "PNG", .. })));
        let error = read_image(Path::new("/no/such.png")).unwrap_err().to_string();
        assert!(error.starts_with("cannot read /no/such.png: "), "{error}");
    }

    #[test]
    fn a_header_that_claims_ten_billion_pixels_is_refused_before_allocation() {
        let mut png = encoded(&image::RgbImage::new(1, 1).into(), ImageFormat::Png);
        let claim = 100_000u32.to_be_bytes();
        png[16..20].copy_from_slice(&claim);
        png[20..24].copy_from_slice(&claim);
        let crc = crc32(&png[12..29]);
        png[29..33].copy_from_slice(&crc.to_be_bytes());
        assert!(matches!(decode_image(Path::new("a"), &png), Err(ImageError::TooLarge { size, .. }) if size == UVec2::splat(100_000)));
    }

    fn crc32(bytes: &[u8]) -> u32 {
        !bytes
            .iter()
            .fold(!0u32, |crc, &byte| (0..8).fold(crc ^ u32::from(byte), |crc, _| (crc >> 1) ^ (0xedb8_8320 & 0u32.wrapping_sub(crc & 1))))
    }

    #[test]
    fn environment_asset_reads_as_radiance() {
        let Some(path) = asset("env/spiaggia_di_mondello_1k.hdr") else { return };
        let read = read_image(&path).unwrap();
        assert_eq!(read.size(), UVec2::new(1024, 512));
        assert!(read.pixels().iter().all(|p| p.is_finite()) && read.pixels().iter().any(|p| p.max_component() > 10.0));
    }

    fn asset(name: &str) -> Option<std::path::PathBuf> {
        let root = std::env::var_os("KAJO_ASSETS")
            .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/assets"), std::path::PathBuf::from);
        let path = root.join(name);
        if !path.exists() {
            eprintln!("skipped: {} is absent; set KAJO_ASSETS", path.display());
            return None;
        }
        Some(path)
    }
}

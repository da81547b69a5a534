//! PNG, JPEG and WebP.

use super::Encoded;
use crate::limits::Budget;
use crate::{SceneError, Texels};
use glam::UVec2;
use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader, Limits};
use kajo_image::jpeg_is_cut_short;
use std::io::Cursor;

/// Beyond the image itself decoders keep little; more is a file that unpacks without end, such as a colour profile of zeros.
const MAX_DECODER_BYTES: u64 = 2 << 30;

/// Width, height and texels; 16-bit PNGs keep their depth.
pub fn decode(encoded: &Encoded<'_>, budget: &Budget) -> Result<(u32, u32, Texels), SceneError> {
    let mut reader = ImageReader::new(Cursor::new(encoded.bytes)).with_guessed_format().map_err(|error| encoded.invalid(error))?;
    let format = reader.format();
    match format {
        Some(ImageFormat::Png | ImageFormat::Jpeg | ImageFormat::WebP) => {}
        _ if encoded.bytes.is_empty() => return Err(encoded.invalid("the image is empty")),
        _ => return Err(encoded.invalid("the image is none of PNG, JPEG, WebP and KTX 2")),
    }
    let mut limits = Limits::default();
    limits.max_alloc = Some(budget.limits.bytes.min(MAX_DECODER_BYTES));
    reader.limits(limits);
    let decoder = reader.into_decoder().map_err(|error| encoded.invalid(error))?;
    let (width, height) = decoder.dimensions();
    let deep = decoder.color_type().bytes_per_pixel() / decoder.color_type().channel_count() > 1;
    encoded.claim(budget, width, height, if deep { 8 } else { 4 })?;
    if format == Some(ImageFormat::Jpeg) && jpeg_is_cut_short(encoded.bytes.len(), UVec2::new(width, height)) {
        return Err(encoded.invalid(format!("the JPEG is cut short: {} bytes cannot hold {width} × {height} px", encoded.bytes.len())));
    }
    let image = DynamicImage::from_decoder(decoder).map_err(|error| encoded.invalid(error))?;
    let texels =
        if deep { Texels::Rgba16(texels(image.into_rgba16().into_raw())) } else { Texels::Rgba8(texels(image.into_rgba8().into_raw())) };
    Ok((width, height, texels))
}

/// Four channels a texel, where they lie if their memory allows it.
fn texels<T: bytemuck::Pod>(channels: Vec<T>) -> Vec<[T; 4]> {
    bytemuck::try_cast_vec(channels).unwrap_or_else(|(_, channels)| bytemuck::pod_collect_to_vec(&channels))
}

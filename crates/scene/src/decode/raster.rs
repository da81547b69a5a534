//! PNG, JPEG and WebP.

use super::Encoded;
use crate::limits::Budget;
use crate::{SceneError, Texels};
use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader, Limits};
use std::io::Cursor;

/// Beyond the image itself decoders keep little; more is a file that unpacks without end, such as a colour profile of zeros.
const MAX_DECODER_BYTES: u64 = 8 << 30;

/// Width, height and texels; 16-bit PNGs keep their depth.
pub fn decode(encoded: &Encoded<'_>, budget: &Budget) -> Result<(u32, u32, Texels), SceneError> {
    let mut reader = ImageReader::new(Cursor::new(encoded.bytes)).with_guessed_format().map_err(|error| encoded.invalid(error))?;
    match reader.format() {
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
    let image = DynamicImage::from_decoder(decoder).map_err(|error| encoded.invalid(error))?;
    let texels = if deep {
        Texels::Rgba16(image.into_rgba16().pixels().map(|pixel| pixel.0).collect())
    } else {
        Texels::Rgba8(image.into_rgba8().pixels().map(|pixel| pixel.0).collect())
    };
    Ok((width, height, texels))
}

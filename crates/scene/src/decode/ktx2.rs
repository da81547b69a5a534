//! KTX 2: plain texels, optionally compressed by Zstandard, and Basis Universal.    [KTX2]
//!
//! The first mip level of a two-dimensional image is read; the smaller ones are the renderer's to make.

use super::Encoded;
use crate::limits::Budget;
use crate::{SceneError, Texels};
use ktx2::{Format, Reader, SupercompressionScheme};
use std::borrow::Cow;
use std::io::Read;

/// The first bytes of a file.
pub const MAGIC: [u8; 12] = *b"\xabKTX 20\xbb\r\n\x1a\n";

/// How the numbers of a plain format are stored.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Number {
    Unorm8,
    Unorm16,
    Float16,
    Float32,
}

impl Number {
    fn size(self) -> usize {
        match self {
            Self::Unorm8 => 1,
            Self::Unorm16 | Self::Float16 => 2,
            Self::Float32 => 4,
        }
    }
}

/// Width, height and texels of the first level.
pub fn decode(encoded: &Encoded<'_>, budget: &Budget) -> Result<(u32, u32, Texels), SceneError> {
    let unsupported = |what: String| SceneError::Unsupported {
        file: encoded.file.into(),
        feature: format!("{} ({what})", encoded.place),
        advice: "convert it to a two-dimensional KTX 2 with Basis Universal (UASTC, ETC1S) or plain texels, or to PNG".into(),
    };
    let reader = Reader::new(encoded.bytes).map_err(|error| encoded.invalid(format!("the KTX 2 file is damaged: {error}")))?;
    let header = reader.header();
    let (width, height) = (header.pixel_width, header.pixel_height);
    if header.pixel_depth > 0 || header.layer_count > 1 || header.face_count != 1 {
        return Err(unsupported("a KTX 2 volume, array or cube map".into()));
    }
    let level = reader.levels().next().ok_or_else(|| encoded.invalid("the KTX 2 file has no level"))?;

    let Some(format) = header.format else {
        return Err(unsupported("a KTX 2 file without a format".into()));
    };
    let (number, channels, reversed) = plain(format).ok_or_else(|| unsupported(format!("a KTX 2 file in the format {format:?}")))?;
    encoded.claim(budget, width, height, if number == Number::Unorm8 { 4 } else { 4 * number.size().max(2) as u64 })?;
    let length = width as usize * height as usize * channels * number.size();
    let bytes = match header.supercompression_scheme {
        None => Cow::Borrowed(level.data),
        Some(SupercompressionScheme::Zstandard) => Cow::Owned(inflate(level.data, length).map_err(|error| encoded.invalid(error))?),
        Some(scheme) => return Err(unsupported(format!("a KTX 2 file with plain texels compressed by {scheme:?}"))),
    };
    if bytes.len() != length {
        return Err(encoded.invalid(format!("the KTX 2 level has {} bytes instead of {length}", bytes.len())));
    }
    Ok((width, height, unpack(&bytes, number, channels, reversed)))
}

/// The numbers of a plain colour format, how many a texel has, and whether blue comes first.
fn plain(format: Format) -> Option<(Number, usize, bool)> {
    Some(match format {
        Format::R8_UNORM | Format::R8_SRGB => (Number::Unorm8, 1, false),
        Format::R8G8_UNORM | Format::R8G8_SRGB => (Number::Unorm8, 2, false),
        Format::R8G8B8_UNORM | Format::R8G8B8_SRGB => (Number::Unorm8, 3, false),
        Format::B8G8R8_UNORM | Format::B8G8R8_SRGB => (Number::Unorm8, 3, true),
        Format::R8G8B8A8_UNORM | Format::R8G8B8A8_SRGB => (Number::Unorm8, 4, false),
        Format::B8G8R8A8_UNORM | Format::B8G8R8A8_SRGB => (Number::Unorm8, 4, true),
        Format::R16_UNORM => (Number::Unorm16, 1, false),
        Format::R16G16_UNORM => (Number::Unorm16, 2, false),
        Format::R16G16B16_UNORM => (Number::Unorm16, 3, false),
        Format::R16G16B16A16_UNORM => (Number::Unorm16, 4, false),
        Format::R16_SFLOAT => (Number::Float16, 1, false),
        Format::R16G16_SFLOAT => (Number::Float16, 2, false),
        Format::R16G16B16_SFLOAT => (Number::Float16, 3, false),
        Format::R16G16B16A16_SFLOAT => (Number::Float16, 4, false),
        Format::R32_SFLOAT => (Number::Float32, 1, false),
        Format::R32G32_SFLOAT => (Number::Float32, 2, false),
        Format::R32G32B32_SFLOAT => (Number::Float32, 3, false),
        Format::R32G32B32A32_SFLOAT => (Number::Float32, 4, false),
        _ => return None,
    })
}

/// RGBA from `channels` numbers a texel; missing colours are 0, missing alpha is 1.
fn unpack(bytes: &[u8], number: Number, channels: usize, reversed: bool) -> Texels {
    let stride = channels * number.size();
    fn rgba<T: Copy>(texel: &[u8], size: usize, [zero, one]: [T; 2], reversed: bool, read: impl Fn(&[u8]) -> T) -> [T; 4] {
        let mut rgba = [zero, zero, zero, one];
        for (channel, bytes) in rgba.iter_mut().zip(texel.chunks_exact(size)) {
            *channel = read(bytes);
        }
        if reversed {
            rgba.swap(0, 2);
        }
        rgba
    }
    let finite = |value: f32| if value.is_finite() { value } else { 0.0 };
    let texels = bytes.chunks_exact(stride);
    match number {
        Number::Unorm8 => Texels::Rgba8(texels.map(|t| rgba(t, 1, [0, 255], reversed, |b| b[0])).collect()),
        Number::Unorm16 => {
            Texels::Rgba16(texels.map(|t| rgba(t, 2, [0, u16::MAX], reversed, |b| u16::from_le_bytes([b[0], b[1]]))).collect())
        }
        Number::Float16 => Texels::Rgba32F(
            texels.map(|t| rgba(t, 2, [0.0, 1.0], reversed, |b| finite(half::f16::from_le_bytes([b[0], b[1]]).to_f32()))).collect(),
        ),
        Number::Float32 => Texels::Rgba32F(
            texels.map(|t| rgba(t, 4, [0.0, 1.0], reversed, |b| finite(f32::from_le_bytes([b[0], b[1], b[2], b[3]])))).collect(),
        ),
    }
}

/// Decompresses a Zstandard frame that must hold exactly `length` bytes; never produces more than one byte beyond.
fn inflate(frame: &[u8], length: usize) -> Result<Vec<u8>, String> {
    let broken = |error: &dyn std::fmt::Display| format!("the Zstandard data of the KTX 2 file is damaged: {error}");
    let decoder = ruzstd::decoding::StreamingDecoder::new(frame).map_err(|error| broken(&error))?;
    let mut bytes = Vec::new();
    decoder.take(length as u64 + 1).read_to_end(&mut bytes).map_err(|error| broken(&error))?;
    Ok(bytes)
}

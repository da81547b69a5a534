//! KTX 2: plain texels, optionally compressed by Zstandard, and Basis Universal.    [KTX2]
//!
//! The first mip level of a two-dimensional image is read; the smaller ones are the renderer's to make.

use super::bits::Malformed;
use super::etc1s::Codebooks;
use super::{Encoded, uastc};
use crate::limits::Budget;
use crate::{SceneError, Texels};
use ktx2::{ColorModel, Format, Reader, SupercompressionScheme};
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
        let texels = match (reader.color_model(), header.supercompression_scheme) {
            (Some(ColorModel::ETC1S), Some(SupercompressionScheme::BasisLZ)) => {
                encoded.claim(budget, width, height, 4)?;
                etc1s(reader.supercompression_global_data(), header.level_count.max(1), level.data, width, height)
                    .map_err(|problem| encoded.invalid(format!("the BasisLZ data of the KTX 2 file is damaged: {problem}")))?
            }
            (Some(ColorModel::UASTC), None | Some(SupercompressionScheme::Zstandard)) => {
                encoded.claim(budget, width, height, 4)?;
                let blocks = u64::from(width.div_ceil(4)) * u64::from(height.div_ceil(4));
                let bytes =
                    level_bytes(header.supercompression_scheme, level.data, blocks as usize * 16).map_err(|e| encoded.invalid(e))?;
                uastc_texels(&bytes, width as usize, height as usize)
                    .ok_or_else(|| encoded.invalid("the KTX 2 file has bits that are no UASTC block"))?
            }
            (model, scheme) => return Err(unsupported(format!("a KTX 2 file with the colour model {model:?} compressed by {scheme:?}"))),
        };
        return Ok((width, height, Texels::Rgba8(texels)));
    };
    let (number, channels, reversed) = plain(format).ok_or_else(|| unsupported(format!("a KTX 2 file in the format {format:?}")))?;
    encoded.claim(budget, width, height, if number == Number::Unorm8 { 4 } else { 4 * number.size().max(2) as u64 })?;
    let length = width as usize * height as usize * channels * number.size();
    if let Some(scheme) = header.supercompression_scheme.filter(|&scheme| scheme != SupercompressionScheme::Zstandard) {
        return Err(unsupported(format!("a KTX 2 file with plain texels compressed by {scheme:?}")));
    }
    let bytes = level_bytes(header.supercompression_scheme, level.data, length).map_err(|error| encoded.invalid(error))?;
    Ok((width, height, unpack(&bytes, number, channels, reversed)))
}

/// The bytes of a level, decompressed where it is; exactly `length` of them.
fn level_bytes(scheme: Option<SupercompressionScheme>, data: &[u8], length: usize) -> Result<Cow<'_, [u8]>, String> {
    let bytes = if scheme.is_some() { Cow::Owned(inflate(data, length)?) } else { Cow::Borrowed(data) };
    if bytes.len() == length { Ok(bytes) } else { Err(format!("the KTX 2 level has {} bytes instead of {length}", bytes.len())) }
}

/// An image of ETC1S blocks; its alpha is the green of a second slice.
fn etc1s(global: &[u8], images: u32, level: &[u8], width: u32, height: u32) -> Result<Vec<[u8; 4]>, Malformed> {
    const OUTSIDE: Malformed = "a slice lies outside its level";
    let (books, slices) = Codebooks::read(global, images as usize)?;
    let (width, height) = (width as usize, height as usize);
    let mut texels = vec![[255; 4]; width * height];
    let color = level.get(slices.color).ok_or(OUTSIDE)?;
    books.decode(color, width, height, |texel, [r, g, b]| texels[texel] = [r, g, b, 255])?;
    if !slices.alpha.is_empty() {
        let alpha = level.get(slices.alpha).ok_or(OUTSIDE)?;
        books.decode(alpha, width, height, |texel, [_, g, _]| texels[texel][3] = g)?;
    }
    Ok(texels)
}

/// An image of UASTC blocks, row by row.
fn uastc_texels(blocks: &[u8], width: usize, height: usize) -> Option<Vec<[u8; 4]>> {
    let mut texels = vec![[0; 4]; width * height];
    for (index, block) in blocks.chunks_exact(16).enumerate() {
        let block = uastc::decode_block(block.try_into().expect("chunks of 16"))?;
        let (left, top) = (index % width.div_ceil(4) * 4, index / width.div_ceil(4) * 4);
        for (y, row) in (top..height.min(top + 4)).zip(block.chunks_exact(4)) {
            for (x, texel) in (left..width.min(left + 4)).zip(row) {
                texels[y * width + x] = *texel;
            }
        }
    }
    Some(texels)
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

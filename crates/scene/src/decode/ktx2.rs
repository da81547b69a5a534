//! KTX 2: plain texels, optionally compressed by Zstandard, and Basis Universal.    \[KTX2]
//!
//! The first mip level of a two-dimensional image is read; the smaller ones are the renderer's to make.

use super::Encoded;
use super::bits::Malformed;
use super::etc1s::Codebooks;
use super::ktx2_container::{Container, Supercompression};
use super::ktx2_metadata::Metadata;
use super::uastc::decode_block;
use crate::limits::Budget;
use crate::{SceneError, Texels};
use ktx2::{ColorModel, Format};
use std::borrow::Cow;
use std::io::Read;

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

    /// Bytes of a decoded texel.
    fn texel_size(self) -> u64 {
        match self {
            Self::Unorm8 => 4,
            Self::Unorm16 => 8,
            Self::Float16 | Self::Float32 => 16,
        }
    }
}

/// Width, height and texels of the first level, and the number of levels.
pub fn decode(encoded: &Encoded<'_>, budget: &Budget) -> Result<((u32, u32, Texels), u32), SceneError> {
    let unsupported = |what: String| SceneError::Unsupported {
        file: encoded.file.into(),
        feature: format!("{} ({what})", encoded.place),
        advice: "convert it to a two-dimensional KTX 2 with Basis Universal (UASTC, ETC1S) or plain texels, or to PNG".into(),
    };
    let damaged = |problem: Malformed| encoded.invalid(format!("the KTX 2 file is damaged: {problem}"));
    let container = Container::read(encoded.bytes).map_err(damaged)?;
    let Container { width, height, supercompression, .. } = container;
    if !container.is_flat {
        return Err(unsupported("a KTX 2 volume, array or cube map".into()));
    }
    let metadata = Metadata::read(container.metadata).map_err(damaged)?;
    let mut texels = match (container.format, container.color_model, supercompression) {
        (None, Some(ColorModel::ETC1S), Supercompression::BasisLz) => {
            encoded.claim(budget, width, height, 4)?;
            Texels::Rgba8(etc1s(&container).map_err(damaged)?)
        }
        (None, Some(ColorModel::UASTC), Supercompression::None | Supercompression::Zstandard) => {
            encoded.claim(budget, width, height, 4)?;
            let blocks = width.div_ceil(4) as usize * height.div_ceil(4) as usize;
            let bytes = level_bytes(&container, 16 * blocks).map_err(|error| encoded.invalid(error))?;
            Texels::Rgba8(uastc(&bytes, width as usize, height as usize).ok_or_else(|| damaged("its bits are no UASTC blocks"))?)
        }
        (Some(format), _, Supercompression::None | Supercompression::Zstandard) => {
            let (number, channels, reversed) =
                plain(format).ok_or_else(|| unsupported(format!("a KTX 2 file in the format {format:?}")))?;
            encoded.claim(budget, width, height, number.texel_size())?;
            let length = width as usize * height as usize * channels * number.size();
            let bytes = level_bytes(&container, length).map_err(|error| encoded.invalid(error))?;
            unpack(&bytes, number, channels, reversed)
        }
        (format, model, scheme) => {
            return Err(unsupported(format!(
                "a KTX 2 file in the format {format:?} with colour model {model:?} and compression {scheme:?}"
            )));
        }
    };
    metadata.apply(&mut texels, width as usize);
    Ok(((width, height, texels), container.levels))
}

/// The bytes of a level, decompressed where it is; exactly `length` of them.
fn level_bytes<'a>(container: &Container<'a>, length: usize) -> Result<Cow<'a, [u8]>, String> {
    let compressed = container.supercompression == Supercompression::Zstandard;
    let bytes = if compressed { Cow::Owned(inflate(container.level, length)?) } else { Cow::Borrowed(container.level) };
    if bytes.len() == length { Ok(bytes) } else { Err(format!("the KTX 2 level has {} bytes instead of {length}", bytes.len())) }
}

/// An image of ETC1S blocks; its alpha is the green of a second slice.
fn etc1s(container: &Container<'_>) -> Result<Vec<[u8; 4]>, Malformed> {
    const OUTSIDE: Malformed = "a slice lies outside its level";
    let Container { global, level, .. } = container;
    let (books, slices) = Codebooks::read(global, container.levels as usize)?;
    let (width, height) = (container.width as usize, container.height as usize);
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
fn uastc(blocks: &[u8], width: usize, height: usize) -> Option<Vec<[u8; 4]>> {
    let mut texels = vec![[0; 4]; width * height];
    for (index, block) in blocks.chunks_exact(16).enumerate() {
        let block = decode_block(block.try_into().expect("chunks of 16"))?;
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

//! The container of KTX 2: where the first level lies, and what it is.    \[KTX2], section 3
//!
//! Only what one two-dimensional image needs is read, and nothing outside the file.

use super::bits::Malformed;
use ktx2::{ColorModel, Format};

/// The first bytes of a file.
pub const MAGIC: [u8; 12] = *b"\xabKTX 20\xbb\r\n\x1a\n";

/// How a level is compressed on top of its format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Supercompression {
    None,
    BasisLz,
    Zstandard,
    /// A scheme that is not read, by its number.
    Other(u32),
}

/// A file with its parts found.
pub struct Container<'a> {
    /// `None` for Basis Universal.
    pub format: Option<Format>,
    pub width: u32,
    pub height: u32,
    /// False for volumes, arrays and cube maps.
    pub is_flat: bool,
    /// Number of mip levels.
    pub levels: u32,
    pub supercompression: Supercompression,
    pub color_model: Option<ColorModel>,
    /// Keys and values.
    pub metadata: &'a [u8],
    /// Data that all levels share.
    pub global: &'a [u8],
    /// The first level, as stored.
    pub level: &'a [u8],
}

impl<'a> Container<'a> {
    /// Finds the parts of a file that begins with [`MAGIC`].
    pub fn read(file: &'a [u8]) -> Result<Self, Malformed> {
        let word = |at: usize| file.get(at..at + 4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]])).ok_or("it is truncated");
        let long = |at: usize| Ok::<_, Malformed>(u64::from(word(at)?) | u64::from(word(at + 4)?) << 32);
        let part = |offset: u64, length: u64| {
            let range = usize::try_from(offset).ok()?..usize::try_from(offset.checked_add(length)?).ok()?;
            file.get(range)
        };
        let descriptor = part(word(48)?.into(), word(52)?.into()).ok_or("its data format descriptor lies outside the file")?;
        // The size of the descriptor, then the head of its first block, which ends with the colour model.
        let color_model = *descriptor.get(12).ok_or("its data format descriptor is too short")?;
        Ok(Self {
            format: Format::new(word(12)?),
            width: word(20)?,
            height: word(24)?,
            is_flat: word(28)? == 0 && word(32)? <= 1 && word(36)? == 1,
            levels: word(40)?.max(1),
            supercompression: match word(44)? {
                0 => Supercompression::None,
                1 => Supercompression::BasisLz,
                2 => Supercompression::Zstandard,
                other => Supercompression::Other(other),
            },
            color_model: ColorModel::new(color_model),
            metadata: part(word(56)?.into(), word(60)?.into()).ok_or("its key/value data lies outside the file")?,
            global: part(long(64)?, long(72)?).ok_or("its global data lies outside the file")?,
            level: part(long(80)?, long(88)?).ok_or("its first level lies outside the file")?,
        })
    }
}

//! What the key/value data of a KTX 2 file says about its texels: which way rows and columns run, and where channels come from.
//! \[KTX2], section 5
//!
//! glTF allows only the values that change nothing, but a file that says otherwise means it.

use super::bits::Malformed;
use crate::Texels;

/// The metadata that change a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Metadata {
    /// Columns run to the left: `KTXorientation` begins with `l`.
    mirrored: bool,
    /// Rows run upwards: `KTXorientation` goes on with `u`.
    upside_down: bool,
    /// `KTXswizzle`: for each channel the place of its source in red, green, blue, alpha, zero, one.
    swizzle: Option<[usize; 4]>,
}

impl Metadata {
    /// Reads the pairs of keys and values; those of other keys say nothing about texels.
    pub fn read(mut pairs: &[u8]) -> Result<Self, Malformed> {
        const SHORT: Malformed = "its key/value data is truncated";
        let mut metadata = Self::default();
        while !pairs.is_empty() {
            let (length, rest) = pairs.split_first_chunk().ok_or(SHORT)?;
            let length = u32::from_le_bytes(*length) as usize;
            let pair = rest.get(..length).ok_or(SHORT)?;
            // The padding behind the last pair may be missing.
            pairs = rest.get(length.next_multiple_of(4)..).unwrap_or_default();
            let end = pair.iter().position(|&byte| byte == 0).ok_or("a key of its key/value data does not end")?;
            let value = pair[end + 1..].strip_suffix(b"\0").unwrap_or(&pair[end + 1..]);
            match &pair[..end] {
                b"KTXorientation" => (metadata.mirrored, metadata.upside_down) = orientation(value)?,
                b"KTXswizzle" => metadata.swizzle = Some(swizzle(value)?),
                _ => {}
            }
        }
        Ok(metadata)
    }

    /// The texels as they are meant, in an image of `width` columns.
    pub fn apply(self, texels: &mut Texels, width: usize) {
        match texels {
            Texels::Rgba8(texels) => self.apply_to(texels, width, [0, u8::MAX]),
            Texels::Rgba16(texels) => self.apply_to(texels, width, [0, u16::MAX]),
            Texels::Rgba32F(texels) => self.apply_to(texels, width, [0.0, 1.0]),
            Texels::Rgb32F(_) => unreachable!("KTX 2 files are decoded with alpha"),
        }
    }

    fn apply_to<T: Copy>(self, texels: &mut [[T; 4]], width: usize, [zero, one]: [T; 2]) {
        // Reversing the whole image turns both axes.
        if self.upside_down {
            texels.reverse();
        }
        if self.upside_down != self.mirrored {
            texels.chunks_exact_mut(width).for_each(<[_]>::reverse);
        }
        if let Some(swizzle) = self.swizzle {
            for texel in texels {
                let [r, g, b, a] = *texel;
                *texel = swizzle.map(|source| [r, g, b, a, zero, one][source]);
            }
        }
    }
}

fn orientation(value: &[u8]) -> Result<(bool, bool), Malformed> {
    let [x @ (b'r' | b'l'), y @ (b'd' | b'u')] = value else { return Err("its KTXorientation is none of rd, ld, ru and lu") };
    Ok((*x == b'l', *y == b'u'))
}

fn swizzle(value: &[u8]) -> Result<[usize; 4], Malformed> {
    const WRONG: Malformed = "its KTXswizzle is not four of the letters r, g, b, a, 0 and 1";
    let letters: &[u8; 4] = value.try_into().map_err(|_| WRONG)?;
    let mut sources = [0; 4];
    for (source, letter) in sources.iter_mut().zip(letters) {
        *source = b"rgba01".iter().position(|known| known == letter).ok_or(WRONG)?;
    }
    Ok(sources)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pair(key: &str, value: &str) -> Vec<u8> {
        let text = format!("{key}\0{value}\0");
        let mut bytes = (text.len() as u32).to_le_bytes().to_vec();
        bytes.extend(text.bytes());
        bytes.resize(bytes.len().next_multiple_of(4), 0);
        bytes
    }

    fn applied(key: &str, value: &str) -> Vec<[u8; 4]> {
        let mut texels = Texels::Rgba8((0..6).map(|n| [n, 10 + n, 20 + n, 30 + n]).collect());
        let other = pair("KTXwriter", "a test");
        Metadata::read(&[other.as_slice(), &pair(key, value)].concat()).unwrap().apply(&mut texels, 3);
        let Texels::Rgba8(texels) = texels else { panic!("8 bits") };
        texels
    }

    #[test]
    fn orientation_turns_rows_and_columns() {
        let order = |value| applied("KTXorientation", value).iter().map(|texel| texel[0]).collect::<Vec<_>>();
        assert_eq!(order("rd"), [0, 1, 2, 3, 4, 5]);
        assert_eq!(order("ru"), [3, 4, 5, 0, 1, 2]);
        assert_eq!(order("ld"), [2, 1, 0, 5, 4, 3]);
        assert_eq!(order("lu"), [5, 4, 3, 2, 1, 0]);
    }

    #[test]
    fn swizzle_moves_channels_and_knows_zero_and_one() {
        assert_eq!(applied("KTXswizzle", "rgba")[1], [1, 11, 21, 31]);
        assert_eq!(applied("KTXswizzle", "rrrg")[1], [1, 1, 1, 11]);
        assert_eq!(applied("KTXswizzle", "b0a1")[1], [21, 0, 31, 255]);
    }

    #[test]
    fn other_values_and_broken_pairs_are_refused() {
        for (key, value) in [("KTXorientation", "du"), ("KTXorientation", ""), ("KTXswizzle", "rgb"), ("KTXswizzle", "rgbx")] {
            assert!(Metadata::read(&pair(key, value)).is_err(), "{key} {value}");
        }
        let whole = pair("KTXorientation", "ru");
        assert!(Metadata::read(&whole[..whole.len() - 4]).is_err());
        assert!(Metadata::read(&[3, 0, 0, 0, b'a', b'b', b'c']).is_err(), "a key without an end");
    }
}

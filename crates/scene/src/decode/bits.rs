//! Bits and Huffman codes of the BasisLZ streams.    \[KTX2], "BasisLZ bitstream specification"

/// What is wrong with a stream.
pub type Malformed = &'static str;

/// Bits of a stream, least significant first. Beyond the end there are zeros; [`Bits::check`] tells that they were read.
pub struct Bits<'a> {
    bytes: &'a [u8],
    next: usize,
}

impl<'a> Bits<'a> {
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, next: 0 }
    }

    /// The next bit.
    pub fn bit(&mut self) -> u32 {
        let byte = self.bytes.get(self.next / 8).copied().unwrap_or(0);
        let bit = (byte >> (self.next % 8)) & 1;
        self.next += 1;
        u32::from(bit)
    }

    /// The next `count` bits, at most 32.
    pub fn take(&mut self, count: u32) -> u32 {
        (0..count).fold(0, |value, at| value | (self.bit() << at))
    }

    /// A number in groups of `group` bits, each followed by a bit that says whether another one follows.
    pub fn variable(&mut self, group: u32) -> u32 {
        let mut value = 0;
        for shift in (0..32).step_by(group as usize) {
            value |= self.take(group) << shift;
            if self.bit() == 0 {
                break;
            }
        }
        value
    }

    /// An error when more bits were read than there are.
    pub fn check(&self) -> Result<(), Malformed> {
        if self.next <= self.bytes.len() * 8 { Ok(()) } else { Err("the stream is truncated") }
    }
}

const LONGEST_CODE: usize = 16;

/// A canonical Huffman code.
#[derive(Default)]
pub struct Huffman {
    /// Number of codes of each length.
    counts: [u32; LONGEST_CODE + 1],
    /// Symbols by length, then by value.
    symbols: Vec<u16>,
}

impl Huffman {
    /// The code in which symbol i has a code of `lengths[i]` bits; 0 for symbols that do not occur.
    fn new(lengths: &[u8]) -> Result<Self, Malformed> {
        let mut code = Self::default();
        let mut order: Vec<u16> = (0..lengths.len() as u16).filter(|&symbol| lengths[usize::from(symbol)] > 0).collect();
        order.sort_by_key(|&symbol| lengths[usize::from(symbol)]);
        for &symbol in &order {
            code.counts[usize::from(lengths[usize::from(symbol)])] += 1;
        }
        // Kraft's sum in units of the longest code: a complete code fills it, a code of one symbol need not.
        let sum: u32 = code.counts.iter().enumerate().map(|(length, count)| count << (LONGEST_CODE - length)).sum();
        if sum != 1 << LONGEST_CODE && order.len() != 1 {
            return Err("a Huffman code is not complete");
        }
        code.symbols = order;
        Ok(code)
    }

    /// Reads a code: run-length coded lengths, themselves in a Huffman code.
    pub fn read(bits: &mut Bits<'_>) -> Result<Self, Malformed> {
        /// The order in which the lengths of length codes are stored.
        const ORDER: [usize; 21] = [17, 18, 19, 20, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15, 16];
        let symbols = bits.take(14) as usize;
        if symbols == 0 {
            return Ok(Self::default());
        }
        let stored = bits.take(5) as usize;
        if stored == 0 || stored > ORDER.len() {
            return Err("a Huffman code has no lengths");
        }
        let mut lengths_of_lengths = [0; ORDER.len()];
        for &symbol in &ORDER[..stored] {
            lengths_of_lengths[symbol] = bits.take(3) as u8;
        }
        let length_code = Self::new(&lengths_of_lengths)?;
        let mut lengths = Vec::with_capacity(symbols);
        while lengths.len() < symbols {
            let (length, run) = match length_code.symbol(bits)? {
                length @ 0..=16 => (length as u8, 1),
                17 => (0, bits.take(3) + 3),
                18 => (0, bits.take(7) + 11),
                repeat => {
                    let previous = lengths.last().copied().filter(|&length| length > 0).ok_or("a Huffman code repeats no length")?;
                    (previous, if repeat == 19 { bits.take(2) + 3 } else { bits.take(7) + 7 })
                }
            };
            lengths.resize(lengths.len() + run as usize, length);
        }
        bits.check()?;
        if lengths.len() == symbols { Self::new(&lengths) } else { Err("a Huffman code has too many lengths") }
    }

    /// The next symbol.
    pub fn symbol(&self, bits: &mut Bits<'_>) -> Result<u32, Malformed> {
        let (mut code, mut first, mut before) = (0, 0, 0);
        for &count in &self.counts[1..] {
            code = code << 1 | bits.bit();
            first <<= 1;
            if code - first < count {
                return Ok(u32::from(self.symbols[(before + code - first) as usize]));
            }
            first += count;
            before += count;
        }
        Err("a Huffman code does not occur")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_come_least_significant_first_and_end_in_zeros() {
        let mut bits = Bits::new(&[0b1010_0110, 0x01]);
        assert_eq!([bits.take(3), bits.take(5), bits.take(4)], [0b110, 0b10100, 1]);
        assert!(bits.check().is_ok());
        assert_eq!(bits.take(8), 0);
        assert!(bits.check().is_err());
    }

    #[test]
    fn variable_numbers_continue_while_their_bit_says_so() {
        // 0b0101 and more, then 0b0011 and no more: 5 + 3 · 16
        let mut bits = Bits::new(&[0b0111_0101, 0]);
        assert_eq!(bits.variable(4), 5 + 3 * 16);
    }

    /// Lengths 1, 2, 3, 3: codes 0, 10, 110, 111, first bit first.
    #[test]
    fn canonical_codes_are_decoded() {
        let code = Huffman::new(&[3, 1, 0, 2, 3]).unwrap();
        let mut bits = Bits::new(&[0b1101_1010, 0b1]); // from the right: 0, 10, 110, 111
        let symbols: Vec<u32> = (0..4).map(|_| code.symbol(&mut bits).unwrap()).collect();
        assert_eq!(symbols, [1, 3, 0, 4]);
    }

    #[test]
    fn codes_that_are_not_complete_are_refused() {
        assert!(Huffman::new(&[2, 2, 2]).is_err());
        assert!(Huffman::new(&[1, 1, 1]).is_err());
        assert!(Huffman::new(&[0, 1]).is_ok(), "but one symbol may stand alone");
    }
}

//! UASTC blocks: 4 × 4 texels in 16 bytes, in one of 19 modes.    \[KDF], "UASTC compressed texture image format"
//!
//! Two to six end colours, each texel between a pair of them by its weight. Texels belong to up to three subsets by a pattern of ASTC;
//! some modes have a second plane of weights for one channel.

/// How end colours are stored: plain bits, or bits below a digit of base 3 or 5.    \[KDF], "Endpoint unquantization" of ASTC
#[derive(Clone, Copy)]
struct Range {
    bits: u32,
    base: u32,
}

const BITS_8: Range = Range { bits: 8, base: 1 };
const BITS_5: Range = Range { bits: 5, base: 1 };
const BITS_4: Range = Range { bits: 4, base: 1 };
const TRITS_192: Range = Range { bits: 6, base: 3 };
const TRITS_48: Range = Range { bits: 4, base: 3 };
const TRITS_12: Range = Range { bits: 2, base: 3 };
const QUINTS_160: Range = Range { bits: 5, base: 5 };
const QUINTS_40: Range = Range { bits: 3, base: 5 };

/// What a mode stores.
struct Mode {
    /// The prefix that names the mode, and its length.
    code: (u128, u32),
    /// Hints for re-encoding, which are skipped.
    hint_bits: u32,
    channels: usize,
    range: Range,
    weight_bits: u32,
    layout: Layout,
}

/// How texels choose end colours and weights.
#[derive(Clone, Copy, PartialEq)]
enum Layout {
    /// One colour for all, nothing else.
    Solid,
    /// One pair of end colours.
    Single,
    /// One pair, and a second plane of weights for a channel that the block names.
    Planes,
    /// One pair, and a second plane of weights for alpha.
    AlphaPlane,
    /// Several pairs; a pattern of ASTC says which texel has which.
    Subsets { count: usize, index_bits: u32, seeds: &'static [u16] },
}

const TWO: Layout = Layout::Subsets {
    count: 2,
    index_bits: 5,
    seeds: &[
        28, 20, 16, 29, 91, 9, 107, 72, 149, 204, 50, 114, 496, 17, 78, 39, 252, 828, 43, 156, 116, 210, 476, 273, 684, 359, 246, 195, 694,
        524,
    ],
};
const TWO_OF_THREE: Layout = Layout::Subsets {
    count: 2,
    index_bits: 5,
    seeds: &[36, 48, 61, 137, 161, 183, 226, 281, 302, 307, 479, 495, 593, 594, 605, 799, 812, 988, 993],
};
const THREE: Layout = Layout::Subsets { count: 3, index_bits: 4, seeds: &[260, 74, 32, 156, 183, 15, 745, 0, 335, 902, 254] };

const fn mode(code: (u128, u32), hint_bits: u32, channels: usize, range: Range, weight_bits: u32, layout: Layout) -> Mode {
    Mode { code, hint_bits, channels, range, weight_bits, layout }
}

const MODES: [Mode; 19] = [
    mode((0x01, 4), 15, 3, TRITS_192, 4, Layout::Single),
    mode((0x35, 6), 15, 3, BITS_8, 2, Layout::Single),
    mode((0x1d, 5), 15, 3, BITS_4, 3, TWO),
    mode((0x03, 5), 15, 3, TRITS_12, 2, THREE),
    mode((0x13, 5), 15, 3, QUINTS_40, 2, TWO),
    mode((0x0b, 5), 15, 3, BITS_8, 3, Layout::Single),
    mode((0x1b, 5), 15, 3, QUINTS_160, 2, Layout::Planes),
    mode((0x07, 5), 15, 3, QUINTS_40, 2, TWO_OF_THREE),
    mode((0x17, 5), 0, 4, BITS_8, 0, Layout::Solid),
    mode((0x0f, 5), 23, 4, BITS_4, 2, TWO),
    mode((0x02, 3), 17, 4, TRITS_48, 4, Layout::Single),
    mode((0x00, 2), 17, 4, TRITS_48, 2, Layout::Planes),
    mode((0x06, 3), 17, 4, TRITS_192, 3, Layout::Single),
    mode((0x1f, 5), 23, 4, BITS_8, 1, Layout::Planes),
    mode((0x0d, 5), 23, 4, BITS_8, 2, Layout::Single),
    mode((0x05, 7), 23, 2, BITS_8, 4, Layout::Single),
    mode((0x15, 6), 23, 2, BITS_8, 2, TWO),
    mode((0x25, 6), 23, 2, BITS_8, 2, Layout::AlphaPlane),
    mode((0x09, 4), 15, 3, BITS_5, 5, Layout::Single),
];

/// The bits of a block, least significant first.
struct Bits(u128);

impl Bits {
    fn take(&mut self, count: u32) -> u32 {
        let value = self.0 & ((1 << count) - 1);
        self.0 >>= count;
        value as u32
    }
}

/// The 16 texels of a block, row by row; `None` for bits that are no block.
pub fn decode_block(block: [u8; 16]) -> Option<[[u8; 4]; 16]> {
    let mut bits = Bits(u128::from_le_bytes(block));
    let mode = MODES.iter().find(|mode| bits.0 & ((1 << mode.code.1) - 1) == mode.code.0)?;
    bits.take(mode.code.1);
    bits.0 >>= mode.hint_bits;

    let (subsets, pattern) = match mode.layout {
        Layout::Solid => return Some([[0; 4].map(|_: u8| bits.take(8) as u8); 16]),
        Layout::Subsets { count, index_bits, seeds } => (count, pattern(*seeds.get(bits.take(index_bits) as usize)?, count)),
        _ => (1, [0; 16]),
    };
    let second_plane = match mode.layout {
        Layout::Planes => Some(bits.take(2) as usize),
        Layout::AlphaPlane => Some(3),
        _ => None,
    };
    let ends = end_colors(&mut bits, mode, subsets);

    let mut texels = [[0; 4]; 16];
    let mut seen = [false; 3];
    for (texel, subset) in texels.iter_mut().zip(pattern) {
        // The first texel of a subset has the highest bit of its weight left out: it is 0.
        let stored_bits = mode.weight_bits - u32::from(!std::mem::replace(&mut seen[subset], true));
        let weight = weight(bits.take(stored_bits), mode.weight_bits);
        let second = if second_plane.is_some() { self::weight(bits.take(stored_bits), mode.weight_bits) } else { weight };
        for (channel, value) in texel.iter_mut().enumerate() {
            let weight = if second_plane == Some(channel) { second } else { weight };
            *value = interpolate(ends[subset][0][channel], ends[subset][1][channel], weight);
        }
    }
    Some(texels)
}

/// The pairs of end colours; channel by channel, the lower and the upper one.
fn end_colors(bits: &mut Bits, mode: &Mode, subsets: usize) -> [[[u8; 4]; 2]; 3] {
    let Range { bits: low_bits, base } = mode.range;
    let count = 2 * mode.channels * subsets;
    let mut digits = [0; 18];
    if base > 1 {
        // Five digits of base 3 in 8 bits, or three of base 5 in 7; fewer at the end take only the bits they need.
        let (group, sizes): (usize, &[u32]) = if base == 3 { (5, &[2, 4, 5, 7, 8]) } else { (3, &[3, 5, 7]) };
        for digits in digits[..count].chunks_mut(group) {
            let mut packed = bits.take(sizes[digits.len() - 1]);
            for digit in digits {
                *digit = packed % base;
                packed /= base;
            }
        }
    }
    let mut values = [0; 18];
    for (value, digit) in values[..count].iter_mut().zip(digits) {
        *value = unquantize(bits.take(low_bits), digit, mode.range);
    }
    let mut ends = [[[255; 4]; 2]; 3];
    for (pair, values) in ends.iter_mut().zip(values[..count].chunks_exact(2 * mode.channels)) {
        for (end, color) in pair.iter_mut().enumerate() {
            for (channel, values) in values.chunks_exact(2).enumerate() {
                color[channel] = values[end];
            }
            if mode.channels == 2 {
                *color = [color[0], color[0], color[0], color[1]]; // luminance and alpha
            }
        }
    }
    ends
}

/// A stored number as 8 bits.    \[KDF], table of "Endpoint unquantization" of ASTC
fn unquantize(bits: u32, digit: u32, range: Range) -> u8 {
    let high = bits >> 1;
    let (spread, factor) = match (range.base, range.bits) {
        (1, width) => return replicate(bits, width, 8) as u8,
        (3, 2) => (high * 0b1_0001_0110, 93),
        (3, 4) => (high << 6 | high, 22),
        (3, _) => (high << 4 | high >> 4, 5),
        (_, 3) => (high << 7 | high << 1 | high >> 1, 26),
        (_, _) => (high << 5 | high >> 3, 6),
    };
    let inverted = if bits & 1 == 1 { 0x1ff } else { 0 };
    let value = (digit * factor + spread) ^ inverted;
    ((inverted & 0x80) | (value >> 2)) as u8
}

/// `width` bits repeated from the top to fill `target` bits, at most 8.
fn replicate(value: u32, width: u32, target: u32) -> u32 {
    let repeated = (0..16u32).step_by(width as usize).fold(0, |sum, _| sum << width | value);
    let total = 16u32.div_ceil(width) * width;
    repeated >> (total - target) & ((1 << target) - 1)
}

/// A stored weight as 0 … 64.
fn weight(value: u32, width: u32) -> u32 {
    let weight = replicate(value, width, 6);
    weight + u32::from(weight > 32)
}

/// Between two end values, in 16 bits.
fn interpolate(low: u8, high: u8, weight: u32) -> u8 {
    let [low, high] = [low, high].map(|end| u32::from(end) * 257);
    ((low * (64 - weight) + high * weight + 32) >> 14) as u8
}

/// The subset of each texel of a 4 × 4 block in pattern `seed` of ASTC.    \[KDF], "Partition pattern generation" of ASTC
fn pattern(seed: u16, subsets: usize) -> [usize; 16] {
    let mut number = u32::from(seed) + (subsets as u32 - 1) * 1024;
    number ^= number >> 15;
    number = number.wrapping_sub(number << 17);
    number = number.wrapping_add(number << 7);
    number = number.wrapping_add(number << 4);
    number ^= number >> 5;
    number = number.wrapping_add(number << 16);
    number ^= number >> 7;
    number ^= number >> 3;
    number ^= number << 6;
    number ^= number >> 17;

    let squared = |shift: u32| (number >> shift & 15).pow(2);
    let (first, second) = if seed & 1 == 1 {
        (if seed & 2 == 2 { 4 } else { 5 }, if subsets == 3 { 6 } else { 5 })
    } else {
        (if subsets == 3 { 6 } else { 5 }, if seed & 2 == 2 { 4 } else { 5 })
    };
    let factors: [[u32; 2]; 3] = [0, 8, 16].map(|shift| [squared(shift) >> first, squared(shift + 4) >> second]);
    std::array::from_fn(|texel| {
        // Blocks of fewer than 31 texels are taken at twice their coordinates.
        let (x, y) = (2 * (texel as u32 % 4), 2 * (texel as u32 / 4));
        let sum = |subset: usize, shift: u32| (factors[subset][0] * x + factors[subset][1] * y + (number >> shift)) & 63;
        let [a, b, c] = [sum(0, 14), sum(1, 10), if subsets == 3 { sum(2, 6) } else { 0 }];
        if a >= b && a >= c {
            0
        } else if b >= c {
            1
        } else {
            2
        }
    })
}

//! Integer hashes and bit tricks that every random stream is made of.

/// The largest `f32` below one.
pub(crate) const ONE_MINUS_EPSILON: f32 = 1.0 - f32::EPSILON / 2.0;

/// The largest `f64` below one.
pub(crate) const BELOW_ONE: f64 = 1.0 - f64::EPSILON / 2.0;

/// Maps 32 random bits to [0, 1): the upper 24 bits, which an `f32` holds exactly.
#[inline]
pub fn unit_f32(bits: u32) -> f32 {
    (bits >> 8) as f32 * (1.0 / (1u32 << 24) as f32)
}

/// Mixes 32 bits, a bijection.    \[Wellons18] `lowbias32`
#[inline]
pub fn hash_u32(mut x: u32) -> u32 {
    x ^= x >> 16;
    x = x.wrapping_mul(0x7feb_352d);
    x ^= x >> 15;
    x = x.wrapping_mul(0x846c_a68b);
    x ^ (x >> 16)
}

/// Mixes 64 bits, a bijection: the output function of SplitMix64.    \[Steele14] section 5
#[inline]
pub fn hash_u64(mut x: u64) -> u64 {
    x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// Owen scrambling of a point given with its bits reversed: each bit is flipped by a hash of the seed and the bits below it.
///
/// \[Burley20] section 3 with the multipliers of \[Vegdahl21]
#[inline]
pub(crate) fn scramble_reversed(mut x: u32, seed: u32) -> u32 {
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul((seed >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^ x.wrapping_mul(0x53a2_2864)
}

/// Nested uniform (Owen) scrambling of a 32-bit fraction: each bit is flipped by a hash of the seed and the bits above it.
///
/// A bijection that keeps every aligned power-of-two interval together, so nets stay nets.    \[Owen95], \[Burley20] listing 3
#[inline]
pub fn nested_uniform_scramble(x: u32, seed: u32) -> u32 {
    scramble_reversed(x.reverse_bits(), seed).reverse_bits()
}

/// Interleaves the bits of `x` (even places) and `y` (odd places): the order of pixels along the Z curve.    \[Morton66]
#[inline]
pub fn morton_2d(x: u32, y: u32) -> u64 {
    spread(x) | (spread(y) << 1)
}

/// Moves bit i to place 2 i.
#[inline]
fn spread(x: u32) -> u64 {
    let mut x = u64::from(x);
    x = (x | (x << 16)) & 0x0000_ffff_0000_ffff;
    x = (x | (x << 8)) & 0x00ff_00ff_00ff_00ff;
    x = (x | (x << 4)) & 0x0f0f_0f0f_0f0f_0f0f;
    x = (x | (x << 2)) & 0x3333_3333_3333_3333;
    (x | (x << 1)) & 0x5555_5555_5555_5555
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_f32_stays_below_one() {
        assert_eq!(unit_f32(0), 0.0);
        assert_eq!(unit_f32(u32::MAX), 1.0 - 1.0 / 16_777_216.0);
    }

    #[test]
    fn scrambling_keeps_aligned_blocks_together() {
        for seed in [1, 77, 0xdead_beef] {
            let blocks: Vec<u32> = (0..64u32).map(|i| nested_uniform_scramble(i << 20, seed) >> 26).collect();
            assert!(blocks.iter().all(|&b| b == blocks[0]), "64 points of one block of 2^26 stay in one block");
            let mut all: Vec<u32> = (0..64u32).map(|i| nested_uniform_scramble(i << 26, seed) >> 26).collect();
            all.sort_unstable();
            assert_eq!(all, (0..64).collect::<Vec<_>>(), "one point falls in each of the 64 blocks");
        }
    }

    #[test]
    fn morton_interleaves() {
        assert_eq!(morton_2d(0b11, 0b00), 0b0101);
        assert_eq!(morton_2d(0b00, 0b11), 0b1010);
        assert_eq!(morton_2d(u32::MAX, 0), 0x5555_5555_5555_5555);
    }
}

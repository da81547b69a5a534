//! The first three dimensions of Sobol's sequence.
//!
//! Dimension one is the bit reversal of the index. Dimension two multiplies the index by Pascal's triangle modulo 2, which is
//! the five-fold Kronecker power of [[1, 1], [0, 1]] and therefore a butterfly of five masked shifts. Dimension three takes its
//! matrix from a table, a byte of the index at a time.

use crate::bits::{scramble_reversed, unit_f32};
use glam::Vec2;

/// Pascal's matrix modulo 2 applied to the bits of `index`; the second Sobol coordinate with its bits reversed.    \[Ahmed24]
#[inline]
pub(crate) fn pascal(mut index: u32) -> u32 {
    index ^= (index >> 16) & 0x0000_ffff;
    index ^= (index >> 8) & 0x00ff_00ff;
    index ^= (index >> 4) & 0x0f0f_0f0f;
    index ^= (index >> 2) & 0x3333_3333;
    index ^ ((index >> 1) & 0x5555_5555)
}

/// XOR of the direction numbers of dimension three, bits reversed, for each value of each byte of the index.
static THIRD: [[u32; 256]; 4] = third_dimension();

/// Primitive polynomial x² + x + 1, m = 1, 3: m_k = 2 m_{k−1} ⊕ 4 m_{k−2} ⊕ m_{k−2}, v_k = m_k 2^(32−k).    \[Joe08]
const fn third_dimension() -> [[u32; 256]; 4] {
    let mut reversed = [0u32; 32];
    let (mut older, mut newer) = (1u32, 3u32);
    let mut k = 0;
    while k < 32 {
        // older = m_{k+1}; as a fraction its lowest bit stands k + 1 places behind the point.
        reversed[k] = (older << (31 - k)).reverse_bits();
        let next = (newer << 1) ^ (older << 2) ^ older;
        older = newer;
        newer = next;
        k += 1;
    }
    let mut table = [[0u32; 256]; 4];
    let mut byte = 0;
    while byte < 4 {
        let mut value = 0;
        while value < 256 {
            let mut bit = 0;
            while bit < 8 {
                if value >> bit & 1 == 1 {
                    table[byte][value] ^= reversed[8 * byte + bit];
                }
                bit += 1;
            }
            value += 1;
        }
        byte += 1;
    }
    table
}

/// The third Sobol coordinate with its bits reversed.
#[inline]
fn third(index: u32) -> u32 {
    let [a, b, c, d] = index.to_le_bytes().map(usize::from);
    THIRD[0][a] ^ THIRD[1][b] ^ THIRD[2][c] ^ THIRD[3][d]
}

/// Point `index` of the two-dimensional Sobol sequence, a (0, 2)-sequence in base 2.    \[Sobol67]
#[inline]
pub fn sobol_2d(index: u32) -> Vec2 {
    Vec2::new(unit_f32(index.reverse_bits()), unit_f32(pascal(index).reverse_bits()))
}

/// [`sobol_2d`] with independent Owen scrambling of both coordinates.    \[Burley20]
#[inline]
pub(crate) fn sobol_2d_scrambled(index: u32, seed_x: u32, seed_y: u32) -> Vec2 {
    Vec2::new(unit_f32(scramble_reversed(index, seed_x).reverse_bits()), unit_f32(scramble_reversed(pascal(index), seed_y).reverse_bits()))
}

/// The third coordinate beside the two of [`sobol_2d_scrambled`]; by itself as well stratified as they are.
#[inline]
pub(crate) fn sobol_third_scrambled(index: u32, seed: u32) -> f32 {
    unit_f32(scramble_reversed(third(index), seed).reverse_bits())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Table 1 of the sequence as printed in many places: (0, 0), (1/2, 1/2), (1/4, 3/4), (3/4, 1/4), …
    #[test]
    fn first_points_are_those_of_sobol() {
        let expected = [(0.0, 0.0), (0.5, 0.5), (0.25, 0.75), (0.75, 0.25), (0.125, 0.625), (0.625, 0.125), (0.375, 0.375), (0.875, 0.875)];
        for (i, (x, y)) in expected.into_iter().enumerate() {
            assert_eq!(sobol_2d(i as u32), Vec2::new(x, y), "point {i}");
        }
    }

    /// Counts points per elementary interval of every shape; a (0, m, 2)-net has exactly one in each.
    fn is_net(points: &[Vec2]) -> bool {
        let m = points.len().ilog2();
        (0..=m).all(|bits_x| {
            let (nx, ny) = (1u32 << bits_x, 1u32 << (m - bits_x));
            let mut seen = vec![false; points.len()];
            points.iter().all(|p| {
                let cell = (p.y * ny as f32) as u32 * nx + (p.x * nx as f32) as u32;
                !std::mem::replace(&mut seen[cell as usize], true)
            })
        })
    }

    #[test]
    fn every_aligned_block_is_a_net_before_and_after_scrambling() {
        for block in [0u32, 3, 1000] {
            let plain: Vec<Vec2> = (0..256).map(|i| sobol_2d(block * 256 + i)).collect();
            assert!(is_net(&plain), "block {block}");
            let scrambled: Vec<Vec2> = (0..256).map(|i| sobol_2d_scrambled(block * 256 + i, 0x1234_5678, 0x9abc_def0)).collect();
            assert!(is_net(&scrambled), "scrambled block {block}");
        }
    }

    /// v = 1/2, 3/4, 3/8 for the lowest three bits; the plain binary index, not its Gray code.
    #[test]
    fn third_dimension_is_sobols_and_pairs_well_with_the_others() {
        let unscrambled = |i: u32| unit_f32(third(i).reverse_bits());
        let expected = [0.0, 0.5, 0.75, 0.25, 0.375, 0.875, 0.625, 0.125];
        for (i, e) in expected.into_iter().enumerate() {
            assert_eq!(unscrambled(i as u32), e, "point {i}");
        }
        // 4 × 4 × 4 cells: 64 points in three dimensions are not a perfect net, but no cell gets more than 4 of them.
        let mut cells = [0; 64];
        for i in 0..64 {
            let p = sobol_2d(i);
            cells[(p.x * 4.0) as usize * 16 + (p.y * 4.0) as usize * 4 + (unscrambled(i) * 4.0) as usize] += 1;
        }
        assert!(cells.iter().all(|&n| n <= 4), "{cells:?}");
    }

    #[test]
    fn planted_fault_the_net_check_sees_one_moved_point() {
        let mut points: Vec<Vec2> = (0..256).map(sobol_2d).collect();
        points[17] = points[18];
        assert!(!is_net(&points));
    }
}

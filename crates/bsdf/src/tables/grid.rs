//! Tables of several dimensions, multilinear between nodes that are equally spaced in [0, 1] along every axis.

use super::place;

/// Numbers of nodes along the axes, fastest axis first.
#[derive(Clone, Copy, Debug)]
pub struct Grid<const D: usize>(pub [usize; D]);

/// A table as it stands in its file: little-endian 16-bit fractions of one.
#[derive(Clone, Copy, Debug)]
pub struct Fractions(pub(super) &'static [u8]);

impl Fractions {
    /// Number `i`.
    #[inline]
    pub fn get(self, i: usize) -> f32 {
        super::fraction(self.0, i)
    }

    /// All numbers.
    pub fn iter(self) -> impl Iterator<Item = f32> {
        (0..self.0.len() / 2).map(move |i| self.get(i))
    }
}

impl<const D: usize> Grid<D> {
    /// Nodes of the whole grid.
    pub const fn size(self) -> usize {
        let (mut product, mut axis) = (1, 0);
        while axis < D {
            product *= self.0[axis];
            axis += 1;
        }
        product
    }

    /// Coordinates of node `index`.
    pub fn position(self, mut index: usize) -> [f32; D] {
        self.0.map(|nodes| {
            let i = index % nodes;
            index /= nodes;
            i as f32 / (nodes - 1) as f32
        })
    }

    /// Calls `visit` with index and weight of the 2^D nodes around `position`, coordinates in [0, 1].
    #[inline]
    pub fn corners(self, position: [f32; D], mut visit: impl FnMut(usize, f32)) {
        let (mut base, mut stride) = (0, 1);
        let (mut strides, mut weights) = ([0; D], [0.0; D]);
        for axis in 0..D {
            let (node, weight) = place(position[axis], self.0[axis]);
            base += node * stride;
            (strides[axis], weights[axis]) = (stride, weight);
            stride *= self.0[axis];
        }
        for corner in 0..1usize << D {
            let (mut index, mut weight) = (base, 1.0);
            for axis in 0..D {
                let above = corner >> axis & 1 == 1;
                index += if above { strides[axis] } else { 0 };
                weight *= if above { weights[axis] } else { 1.0 - weights[axis] };
            }
            visit(index, weight);
        }
    }

    /// The table that `at` reads, interpolated.
    #[inline]
    pub fn interpolate(self, at: impl Fn(usize) -> f32, position: [f32; D]) -> f32 {
        let mut sum = 0.0;
        self.corners(position, |index, weight| sum += weight * at(index));
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn interpolation_is_exact_for_multilinear_functions() {
        let grid = Grid([3, 5, 2]);
        let f = |[x, y, z]: [f32; 3]| 0.5 + x - 2.0 * y + 3.0 * x * y * z;
        let table: Vec<f32> = (0..grid.size()).map(|i| f(grid.position(i))).collect();
        for p in [[0.0, 0.0, 0.0], [1.0, 1.0, 1.0], [0.3, 0.7, 0.2], [0.9, 0.05, 0.6]] {
            // Within a cell the function is multilinear because it is so everywhere.
            assert!((grid.interpolate(|i| table[i], p) - f(p)).abs() < 1e-5, "{p:?}");
        }
    }
}

//! Sums over rectangles of an image in constant time.

use super::{Block, DensityImage};

/// Summed-area tables of f and f², in double precision.    \[Crow84]
pub(super) struct SummedArea {
    stride: usize,
    /// (height + 1) × (width + 1) sums over everything above and to the left.
    table: Vec<[f64; 2]>,
}

impl SummedArea {
    pub fn new(image: &DensityImage) -> Self {
        let (width, stride) = (image.size().x as usize, image.size().x as usize + 1);
        let mut table = vec![[0.0; 2]; stride * (image.size().y as usize + 1)];
        for (y, row) in image.shares().chunks_exact(width).enumerate() {
            let mut left = [0.0; 2];
            for (x, &f) in row.iter().enumerate() {
                left = [left[0] + f, left[1] + f * f];
                let above = table[y * stride + x + 1];
                table[(y + 1) * stride + x + 1] = [above[0] + left[0], above[1] + left[1]];
            }
        }
        Self { stride, table }
    }

    /// Σ f and Σ f² over a block.
    #[inline]
    pub fn sums(&self, block: Block) -> [f64; 2] {
        let Block { x0, y0, x1, y1 } = block;
        let at = |x: u16, y: u16| self.table[y as usize * self.stride + x as usize];
        let (a, b, c, d) = (at(x0, y0), at(x1, y0), at(x0, y1), at(x1, y1));
        [d[0] - c[0] - b[0] + a[0], d[1] - c[1] - b[1] + a[1]]
    }

    /// Bound on the rounding error of Σ f² over any block: differences of numbers as large as the sum over the image.
    pub fn noise(&self) -> f64 {
        1e-12 * self.table[self.table.len() - 1][1]
    }
}

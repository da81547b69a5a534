//! Images as planes of floats with a border, so that windows and patches reach beyond the picture without a question.

use glam::{UVec2, Vec3};

/// Planes of one size. Pixels beyond the picture repeat its border.
pub(crate) struct Planes {
    pub size: UVec2,
    border: usize,
    stride: usize,
    rows: usize,
    data: Vec<f32>,
}

impl Planes {
    /// Room for `count` planes. `size` is padded to multiples of `tile`, and `border` px stand around that.
    pub(crate) fn new(size: UVec2, border: usize, tile: UVec2, count: usize) -> Self {
        let padded = ((size + tile - 1) / tile * tile).as_usizevec2() + 2 * border;
        let data = Vec::with_capacity(padded.element_product() * count);
        Self { size, border, stride: padded.x, rows: padded.y, data }
    }

    /// Number of planes.
    pub(crate) fn count(&self) -> usize {
        self.data.len() / (self.stride * self.rows)
    }

    /// Adds a plane.
    pub(crate) fn push(&mut self, value: impl Fn(u32, u32) -> f32) {
        let last = self.size - 1;
        for row in 0..self.rows {
            let y = row.saturating_sub(self.border).min(last.y as usize) as u32;
            let begin = self.data.len();
            self.data.resize(begin + self.border, value(0, y));
            self.data.extend((0..self.size.x).map(|x| value(x, y)));
            self.data.resize(begin + self.stride, value(last.x, y));
        }
    }

    /// Adds three planes.
    pub(crate) fn push_rgb(&mut self, value: impl Fn(u32, u32) -> Vec3) {
        for channel in 0..3 {
            self.push(|x, y| value(x, y)[channel]);
        }
    }

    /// `length` pixels of a plane from column `x` of row `y` on; both may lie in the border.
    #[inline(always)]
    pub(crate) fn row(&self, plane: usize, x: i32, y: i32, length: usize) -> &[f32] {
        let (x, y) = ((x + self.border as i32) as usize, (y + self.border as i32) as usize);
        &self.data[(plane * self.rows + y) * self.stride + x..][..length]
    }
}

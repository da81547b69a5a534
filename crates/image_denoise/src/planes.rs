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
    /// `size` is padded to multiples of `tile`, and `border` px stand around that.
    pub(crate) fn new(size: UVec2, border: usize, tile: UVec2) -> Self {
        let padded = ((size + tile - 1) / tile * tile).as_usizevec2() + 2 * border;
        Self { size, border, stride: padded.x, rows: padded.y, data: Vec::new() }
    }

    /// Number of planes.
    pub(crate) fn count(&self) -> usize {
        self.data.len() / (self.stride * self.rows)
    }

    /// Adds a plane.
    pub(crate) fn push(&mut self, value: impl Fn(u32, u32) -> f32) {
        let last = self.size - 1;
        self.data.reserve(self.stride * self.rows);
        for row in 0..self.rows {
            let y = row.saturating_sub(self.border).min(last.y as usize) as u32;
            let begin = self.data.len();
            self.data.extend((0..self.size.x).map(|x| value(x, y)));
            let (first, end) = (self.data[begin], self.data[begin + last.x as usize]);
            self.data.splice(begin..begin, std::iter::repeat_n(first, self.border));
            self.data.resize(begin + self.stride, end);
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

//! Rectangles of pixels.

use glam::{UVec2, Vec2};

/// Columns x0 ≤ x < x1 of rows y0 ≤ y < y1 of an image. 8 bytes.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the corners, px")]
pub struct Block {
    pub x0: u16,
    pub y0: u16,
    pub x1: u16,
    pub y1: u16,
}

impl Block {
    /// All of an image whose sides are 16-bit numbers.
    pub(crate) fn whole(size: UVec2) -> Self {
        Self { x0: 0, y0: 0, x1: size.x as u16, y1: size.y as u16 }
    }

    /// Width and height, px.
    pub fn size(self) -> UVec2 {
        UVec2::new((self.x1 - self.x0).into(), (self.y1 - self.y0).into())
    }

    /// Number of pixels.
    pub fn area(self) -> u32 {
        self.size().element_product()
    }

    /// Whether it holds a pixel.
    pub fn contains(self, pixel: UVec2) -> bool {
        let range = |low: u16, high: u16| u32::from(low)..u32::from(high);
        range(self.x0, self.x1).contains(&pixel.x) && range(self.y0, self.y1).contains(&pixel.y)
    }

    /// The parts before and behind the plane `at`, which must lie inside.
    pub fn split(self, Split { axis, at }: Split) -> (Self, Self) {
        match axis {
            Axis::X => (Self { x1: at, ..self }, Self { x0: at, ..self }),
            Axis::Y => (Self { y1: at, ..self }, Self { y0: at, ..self }),
        }
    }

    /// Point of an image of `size` px, both coordinates in [0, 1), that lies at `u` in [0, 1)² of the block.
    #[inline]
    pub(crate) fn point(self, u: Vec2, size: UVec2) -> Vec2 {
        let along = |low: u16, high: u16, u: f32, size: u32| {
            let (low, high, size) = (f32::from(low), f32::from(high), size as f32);
            // Rounding must not move the point into a neighbour: stay two units in the last place inside.
            let ends = (low / size * (1.0 + 2.0 * f32::EPSILON), high / size * (1.0 - 2.0 * f32::EPSILON));
            ((low + u * (high - low)) / size).clamp(ends.0, ends.1)
        };
        Vec2::new(along(self.x0, self.x1, u.x, size.x), along(self.y0, self.y1, u.y, size.y))
    }
}

/// Pixel of an image of `size` px that holds a point; points outside of [0, 1) belong to the nearest edge.
#[inline]
pub(crate) fn pixel(point: Vec2, size: UVec2) -> UVec2 {
    (point.max(Vec2::ZERO) * size.as_vec2()).as_uvec2().min(size - 1)
}

/// Direction across a plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names say it")]
pub enum Axis {
    X,
    Y,
}

/// A plane between columns or rows: what is below `at` lies before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the doc comment of the struct says it")]
pub struct Split {
    pub axis: Axis,
    pub at: u16,
}

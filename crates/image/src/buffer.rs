//! A rectangle of pixels.

use glam::UVec2;

/// `height × width` pixels, row-major, top row first.
#[derive(Clone, Debug, PartialEq)]
pub struct Image<T> {
    size: UVec2,
    pixels: Vec<T>,
}

impl<T> Image<T> {
    /// Takes `pixels`, row-major, top row first.
    ///
    /// # Panics
    /// When `pixels` does not have `size.x × size.y` elements.
    pub fn from_pixels(size: UVec2, pixels: Vec<T>) -> Self {
        assert_eq!(pixels.len(), size.x as usize * size.y as usize, "an image of {size} px");
        Self { size, pixels }
    }

    /// Every pixel from its column and row.
    pub fn from_fn(size: UVec2, mut pixel: impl FnMut(u32, u32) -> T) -> Self {
        // Memory is taken once: the length of a flattened iterator is unknown to `collect`, which would grow and copy.
        let mut pixels = Vec::with_capacity(size.x as usize * size.y as usize);
        for y in 0..size.y {
            pixels.extend((0..size.x).map(|x| pixel(x, y)));
        }
        Self { size, pixels }
    }

    /// Width and height, px.
    pub fn size(&self) -> UVec2 {
        self.size
    }

    /// Width, px.
    pub fn width(&self) -> u32 {
        self.size.x
    }

    /// Height, px.
    pub fn height(&self) -> u32 {
        self.size.y
    }

    /// The pixels, row-major.
    pub fn pixels(&self) -> &[T] {
        &self.pixels
    }

    /// The pixels, row-major.
    pub fn pixels_mut(&mut self) -> &mut [T] {
        &mut self.pixels
    }

    /// The pixels, row-major, without a copy.
    pub fn into_pixels(self) -> Vec<T> {
        self.pixels
    }

    /// Applies `f` to every pixel.
    pub fn map<U>(&self, f: impl FnMut(&T) -> U) -> Image<U> {
        Image { size: self.size, pixels: self.pixels.iter().map(f).collect() }
    }

    /// The pixel in column `x` and row `y`.
    pub fn get(&self, x: u32, y: u32) -> &T {
        &self.pixels[self.index(x, y)]
    }

    /// The pixel in column `x` and row `y`.
    pub fn get_mut(&mut self, x: u32, y: u32) -> &mut T {
        let index = self.index(x, y);
        &mut self.pixels[index]
    }

    fn index(&self, x: u32, y: u32) -> usize {
        debug_assert!(x < self.size.x && y < self.size.y, "pixel ({x}, {y}) of {}", self.size);
        y as usize * self.size.x as usize + x as usize
    }
}

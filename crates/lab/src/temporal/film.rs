//! Frames of a sequence side by side, where the picture flickers most.

use glam::UVec2;
use kajo_image::Image;
use kajo_image_metrics::{Palette, crop, heat_map, worst_crops};
use kajo_units::{LinearRgb, Srgb8};

/// Side of the part of each frame that is shown, px.
const SIDE: u32 = 40;

/// Most frames that are shown; of longer sequences some between the first and the last are left out.
const MOST: usize = 8;

/// Between frames, px.
const GAP: u32 = 2;

/// Seen on light and on dark pages.
const GAP_COLOR: Srgb8 = Srgb8([128; 3]);

/// Mean difference over the channels of two colours in [0, 1] that has the brightest colour.
pub const FULL_SCALE: f32 = 0.5;

/// A strip of film.
#[derive(Clone, Debug)]
pub struct Film {
    /// What moves.
    pub motion: &'static str,
    /// Column and row of the corner of the part that is shown.
    pub at: [u32; 2],
    /// Numbers of the frames that are shown, from 1.
    pub frames: Vec<usize>,
    /// A column for each of them: the technique, the reference, and how far they are apart, below each other.
    pub image: Image<Srgb8>,
}

impl Film {
    /// From frames and references as a display shows them, in [0, 1], and from what each pixel flickers. Images may be several of the size of the latter below each
    /// other: their mean is shown. `None` where nothing flickers.
    pub fn new(motion: &'static str, images: &[Image<LinearRgb>], references: &[Image<LinearRgb>], flicker: &Image<f32>) -> Option<Self> {
        let square = *worst_crops(flicker, SIDE, 1).first()?;
        let frames = evenly(images.len());
        let cells: Vec<[Image<Srgb8>; 3]> = frames
            .iter()
            .map(|&frame| {
                let [image, reference] = [images, references].map(|list| crop(&mean_of_parts(&list[frame], flicker.size()), &square));
                let apart = Image::from_fn(image.size(), |x, y| (*image.get(x, y) - *reference.get(x, y)).0.abs().element_sum() / 3.0);
                [image.map(|c| c.to_srgb8()), reference.map(|c| c.to_srgb8()), heat_map(&apart, FULL_SCALE, Palette::Magma)]
            })
            .collect();
        let step = square.side + GAP;
        let size = UVec2::new(frames.len() as u32, 3) * step - GAP;
        let image = Image::from_fn(size, |x, y| {
            let (u, v) = (x % step, y % step);
            if u.max(v) < square.side { *cells[(x / step) as usize][(y / step) as usize].get(u, v) } else { GAP_COLOR }
        });
        Some(Self { motion, at: [square.x, square.y], frames: frames.iter().map(|frame| frame + 1).collect(), image })
    }
}

/// At most [`MOST`] of `count` frames, the first and the last among them.
fn evenly(count: usize) -> Vec<usize> {
    if count <= MOST { (0..count).collect() } else { (0..MOST).map(|i| i * (count - 1) / (MOST - 1)).collect() }
}

fn mean_of_parts(image: &Image<LinearRgb>, size: UVec2) -> Image<LinearRgb> {
    let parts = image.height() / size.y;
    Image::from_fn(size, |x, y| (0..parts).map(|part| *image.get(x, y + part * size.y)).sum::<LinearRgb>() * (1.0 / parts as f32))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two lights below each other, of which one flashes in one place: the strip shows that place, and the difference where it is.
    #[test]
    fn a_strip_shows_where_it_flickers_and_how_far_it_is_off() {
        let size = UVec2::new(100, 60);
        let lit = |x: u32, y: u32| (70..74).contains(&x) && (20..24).contains(&y);
        let frame = |flash: bool| Image::from_fn(UVec2::new(100, 120), |x, y| LinearRgb::splat(if flash && lit(x, y) { 1.0 } else { 0.0 }));
        let references = vec![frame(false); 20];
        let images: Vec<_> = (0..20).map(|i| frame(i == 19)).collect();
        let flicker = Image::from_fn(size, |x, y| if lit(x, y) { 0.1 } else { 0.0 });
        let film = Film::new("light", &images, &references, &flicker).unwrap();
        assert_eq!(film.frames, [1, 3, 6, 9, 11, 14, 17, 20]);
        assert_eq!(film.image.size(), UVec2::new(8 * 42 - 2, 3 * 42 - 2));
        let (u, v) = (72 - film.at[0], 22 - film.at[1]);
        assert!(u < SIDE && v < SIDE, "{:?}", film.at);
        let pixel = |column: u32, row: u32| *film.image.get(column * 42 + u, row * 42 + v);
        assert_eq!(pixel(7, 0), LinearRgb::splat(0.5).to_srgb8());
        assert_eq!(pixel(7, 2), Palette::Magma.color(0.5 / FULL_SCALE));
        for (column, row) in [(0, 0), (6, 0), (7, 1)] {
            assert_eq!(pixel(column, row), Srgb8([0; 3]));
        }
        assert_eq!(pixel(6, 2), Palette::Magma.color(0.0));
        assert!(Film::new("light", &references, &references, &flicker.map(|_| 0.0)).is_none());
    }

    #[test]
    fn small_images_are_shown_whole() {
        let images = [Image::from_fn(UVec2::new(8, 5), |x, _| LinearRgb::splat(x as f32 / 7.0))];
        let film = Film::new("camera", &images, &images, &Image::from_fn(UVec2::new(8, 5), |_, _| 1.0)).unwrap();
        assert_eq!((film.image.size(), film.frames), (UVec2::new(5, 19), vec![1]));
    }
}

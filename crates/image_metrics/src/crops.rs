//! Where an image fails most.

use kajo_image::Image;

/// A square of an image.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Crop {
    /// Left column.
    pub x: u32,
    /// Top row.
    pub y: u32,
    /// Side, px.
    pub side: u32,
    /// Mean of the error inside.
    pub mean: f64,
}

/// The `count` squares of side `side` with the largest mean error that do not overlap, worst first. `error`: any error per pixel, ≥ 0.
/// Squares without error are left out; a smaller image gives one square of its shorter side.
pub fn worst_crops(error: &Image<f32>, side: u32, count: usize) -> Vec<Crop> {
    let side = side.min(error.width()).min(error.height());
    if side == 0 {
        return vec![];
    }
    let (columns, rows) = (error.width() - side + 1, error.height() - side + 1);
    let sums = summed_area(error);
    let stride = error.width() as usize + 1;
    let mean = |x: u32, y: u32| {
        let at = |x: u32, y: u32| sums[y as usize * stride + x as usize];
        (at(x + side, y + side) - at(x, y + side) - at(x + side, y) + at(x, y)) / f64::from(side * side)
    };
    let mut squares: Vec<Crop> =
        (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y))).map(|(x, y)| Crop { x, y, side, mean: mean(x, y) }).collect();
    squares.sort_by(|a, b| b.mean.total_cmp(&a.mean));
    // Sums of small values next to large ones leave rounding; a square of nothing else is no failure.
    let least = squares.first().map_or(0.0, |s| s.mean * 1e-9);
    let mut chosen: Vec<Crop> = Vec::new();
    for square in squares {
        if chosen.len() == count || square.mean <= least {
            break;
        }
        if chosen.iter().all(|c| c.x.abs_diff(square.x) >= side || c.y.abs_diff(square.y) >= side) {
            chosen.push(square);
        }
    }
    chosen
}

/// The pixels inside `square`.
pub fn crop<T: Copy>(image: &Image<T>, square: &Crop) -> Image<T> {
    Image::from_fn(glam::UVec2::splat(square.side), |x, y| *image.get(square.x + x, square.y + y))
}

/// `(height + 1) × (width + 1)` sums of all pixels above and left.
fn summed_area(image: &Image<f32>) -> Vec<f64> {
    let stride = image.width() as usize + 1;
    let mut sums = vec![0.0; stride * (image.height() as usize + 1)];
    for y in 0..image.height() as usize {
        let mut row = 0.0;
        for x in 0..image.width() as usize {
            row += f64::from(*image.get(x as u32, y as u32));
            sums[(y + 1) * stride + x + 1] = sums[y * stride + x + 1] + row;
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::UVec2;

    #[test]
    fn planted_failures_are_found_in_order_without_overlap() {
        let error = Image::from_fn(UVec2::new(100, 60), |x, y| match (x, y) {
            (70..78, 10..18) => 1.0,
            (5..13, 40..48) => 0.5,
            _ => 0.0,
        });
        let found = worst_crops(&error, 8, 5);
        assert_eq!((found[0].x, found[0].y, found[0].mean), (70, 10, 1.0));
        assert_eq!((found[1].x, found[1].y, found[1].mean), (5, 40, 0.5));
        assert_eq!(found.len(), 2, "nothing else fails: {found:?}");
        assert!(crop(&error, &found[1]).pixels().iter().all(|&e| e == 0.5));
    }

    #[test]
    fn perfect_and_tiny_images_are_fine() {
        assert!(worst_crops(&Image::from_fn(UVec2::new(9, 9), |_, _| 0.0), 4, 3).is_empty());
        let tiny = worst_crops(&Image::from_fn(UVec2::new(2, 3), |_, _| 1.0), 64, 3);
        assert_eq!((tiny.len(), tiny[0].side), (1, 2));
    }
}

//! Errors of shadows, apart for the border, where any rasterisation differs, and for the rest, where none may.

use crate::error::check_size;
use crate::{MetricsError, ShadowClass};
use kajo_image::Image;

/// How a visibility image compares with its reference.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct ShadowBorder {
    /// Pixels in the reference's penumbra or within 1 px of a change between umbra, penumbra and lit.
    pub border_pixels: u64,
    /// Mean |V − R| of the border pixels; 0 when there are none.
    pub border_error: f64,
    /// All other pixels.
    pub off_border_pixels: u64,
    /// Those of them on the wrong side of one half.
    pub off_border_mismatches: u64,
    /// Their share of the off-border pixels.
    pub off_border_mismatch: f64,
    /// Mean distance, px, between the contours V = ½ and R = ½, each measured from the other; `None` when only one of them has any.
    pub border_px: Option<f64>,
}

/// Compares visibility V with R, both in [0, 1]; only pixels where `mask` is true count (those that show a surface).
///
/// # Errors
/// Sizes that differ, no pixels.
pub fn shadow_border(image: &Image<f32>, reference: &Image<f32>, mask: Option<&Image<bool>>) -> Result<ShadowBorder, MetricsError> {
    check_size("image", image.size(), reference.size())?;
    if let Some(mask) = mask {
        check_size("mask", mask.size(), reference.size())?;
    }
    let counts = |x: u32, y: u32| mask.is_none_or(|m| *m.get(x, y));
    let mut result = ShadowBorder {
        border_pixels: 0,
        border_error: 0.0,
        off_border_pixels: 0,
        off_border_mismatches: 0,
        off_border_mismatch: 0.0,
        border_px: None,
    };
    for (x, y) in (0..image.height()).flat_map(|y| (0..image.width()).map(move |x| (x, y))).filter(|&(x, y)| counts(x, y)) {
        let (v, r) = (*image.get(x, y), *reference.get(x, y));
        if is_border(reference, &counts, x, y) {
            result.border_pixels += 1;
            result.border_error += f64::from((v - r).abs());
        } else {
            result.off_border_pixels += 1;
            result.off_border_mismatches += u64::from((v > 0.5) != (r > 0.5));
        }
    }
    result.border_error /= result.border_pixels.max(1) as f64;
    result.off_border_mismatch = result.off_border_mismatches as f64 / result.off_border_pixels.max(1) as f64;
    result.border_px = contour_distance(&contour(image, &counts), &contour(reference, &counts));
    Ok(result)
}

/// Distance of each pixel to the border of the reference's shadows, px: 0 on it, infinite where there is none.
///
/// # Errors
/// Sizes that differ.
pub fn border_distance(reference: &Image<f32>, mask: Option<&Image<bool>>) -> Result<Image<f32>, MetricsError> {
    if let Some(mask) = mask {
        check_size("mask", mask.size(), reference.size())?;
    }
    let counts = |x: u32, y: u32| mask.is_none_or(|m| *m.get(x, y));
    Ok(distance_to(&Image::from_fn(reference.size(), |x, y| counts(x, y) && is_border(reference, &counts, x, y))))
}

/// Distance of each pixel to the nearest one of a set, px: 0 in it, infinite where it is empty.
pub fn distance_to(set: &Image<bool>) -> Image<f32> {
    if !set.pixels().contains(&true) {
        return set.map(|_| f32::INFINITY);
    }
    let squared = squared_distances(&Contour { width: set.width() as usize, on: set.pixels().to_vec() });
    Image::from_pixels(set.size(), squared.into_iter().map(|d| d.sqrt() as f32).collect())
}

/// The border runs between pixels, so a centre within 1 px of it has a neighbour of another zone.
fn is_border(reference: &Image<f32>, counts: &impl Fn(u32, u32) -> bool, x: u32, y: u32) -> bool {
    let own = ShadowClass::of(*reference.get(x, y));
    let columns = x.saturating_sub(1)..=(x + 1).min(reference.width() - 1);
    let rows = y.saturating_sub(1)..=(y + 1).min(reference.height() - 1);
    own == ShadowClass::Penumbra
        || rows
            .flat_map(|v| columns.clone().map(move |u| (u, v)))
            .any(|(u, v)| counts(u, v) && ShadowClass::of(*reference.get(u, v)) != own)
}

/// Midpoints between neighbours on different sides of one half, on a grid of half pixels: `(2 height + 1) × (2 width + 1)`.
struct Contour {
    width: usize,
    on: Vec<bool>,
}

fn contour(image: &Image<f32>, counts: &impl Fn(u32, u32) -> bool) -> Contour {
    let (w, h) = (image.width(), image.height());
    let width = 2 * w as usize + 1;
    let mut on = vec![false; width * (2 * h as usize + 1)];
    let side = |x, y| *image.get(x, y) > 0.5;
    for (x, y) in (0..h).flat_map(|y| (0..w).map(move |x| (x, y))).filter(|&(x, y)| counts(x, y)) {
        let (column, row) = (2 * x as usize + 1, 2 * y as usize + 1);
        if x + 1 < w && counts(x + 1, y) && side(x, y) != side(x + 1, y) {
            on[row * width + column + 1] = true;
        }
        if y + 1 < h && counts(x, y + 1) && side(x, y) != side(x, y + 1) {
            on[(row + 1) * width + column] = true;
        }
    }
    Contour { width, on }
}

/// The larger of the two one-sided mean distances, px: neither a missing piece nor an extra one can hide.
fn contour_distance(a: &Contour, b: &Contour) -> Option<f64> {
    let (any_a, any_b) = (a.on.contains(&true), b.on.contains(&true));
    match (any_a, any_b) {
        (false, false) => Some(0.0),
        (true, true) => Some(mean_distance(a, b).max(mean_distance(b, a))),
        _ => None,
    }
}

fn mean_distance(from: &Contour, to: &Contour) -> f64 {
    let squared = squared_distances(to);
    let (sum, n) = from.on.iter().zip(&squared).filter(|(on, _)| **on).fold((0.0, 0u64), |(s, n), (_, d)| (s + d.sqrt(), n + 1));
    0.5 * sum / n as f64
}

/// Exact squared Euclidean distance to the contour: a lower envelope of parabolas along columns, then along rows.    \[Felzenszwalb12]
fn squared_distances(contour: &Contour) -> Vec<f64> {
    let (width, height) = (contour.width, contour.on.len() / contour.width);
    let far = ((width + height) as f64).powi(2);
    let mut field: Vec<f64> = contour.on.iter().map(|&on| if on { 0.0 } else { far }).collect();
    let mut line = Vec::new();
    for x in 0..width {
        line.clear();
        line.extend((0..height).map(|y| field[y * width + x]));
        lower_envelope(&line).into_iter().enumerate().for_each(|(y, d)| field[y * width + x] = d);
    }
    for row in field.chunks_mut(width) {
        let transformed = lower_envelope(row);
        row.copy_from_slice(&transformed);
    }
    field
}

/// min over q of (p − q)² + f(q), for every p.
fn lower_envelope(f: &[f64]) -> Vec<f64> {
    // Parabolas of the envelope and where each begins.
    let mut apex: Vec<usize> = Vec::with_capacity(f.len());
    let mut begin: Vec<f64> = Vec::with_capacity(f.len());
    let key = |q: usize| f[q] + (q * q) as f64;
    for q in 0..f.len() {
        let mut crossing = f64::NEG_INFINITY;
        while let Some(&last) = apex.last() {
            crossing = (key(q) - key(last)) / (2 * (q - last)) as f64;
            if crossing > begin[apex.len() - 1] {
                break;
            }
            apex.pop();
            begin.pop();
            crossing = f64::NEG_INFINITY;
        }
        apex.push(q);
        begin.push(crossing);
    }
    let mut k = 0;
    (0..f.len())
        .map(|p| {
            while k + 1 < apex.len() && begin[k + 1] < p as f64 {
                k += 1;
            }
            (p as f64 - apex[k] as f64).powi(2) + f[apex[k]]
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_images::Random;
    use glam::UVec2;

    fn half_plane(edge: f32) -> Image<f32> {
        Image::from_fn(UVec2::new(60, 40), |x, _| if x as f32 + 0.5 < edge { 0.0 } else { 1.0 })
    }

    #[test]
    fn equal_shadows_have_no_mismatch_and_two_border_columns() {
        let r = shadow_border(&half_plane(20.0), &half_plane(20.0), None).unwrap();
        assert_eq!((r.border_pixels, r.off_border_mismatches, r.border_error, r.border_px), (80, 0, 0.0, Some(0.0)));
    }

    #[test]
    fn a_shadow_moved_by_one_pixel_is_a_border_error_only() {
        let r = shadow_border(&half_plane(21.0), &half_plane(20.0), None).unwrap();
        assert_eq!((r.off_border_mismatches, r.border_error, r.border_px), (0, 0.5, Some(1.0)));
    }

    #[test]
    fn planted_light_leak_and_moved_shadow_are_off_border_mismatches() {
        let mut leak = half_plane(20.0);
        *leak.get_mut(5, 5) = 1.0;
        let r = shadow_border(&leak, &half_plane(20.0), None).unwrap();
        assert_eq!(r.off_border_mismatches, 1);
        assert!((r.off_border_mismatch - 1.0 / (60.0 * 40.0 - 80.0)).abs() < 1e-12);
        let moved = shadow_border(&half_plane(25.0), &half_plane(20.0), None).unwrap();
        assert_eq!((moved.off_border_mismatches, moved.border_px), (4 * 40, Some(5.0)));
        let missing = shadow_border(&half_plane(0.0), &half_plane(20.0), None).unwrap();
        assert_eq!((missing.off_border_mismatches, missing.border_px), (19 * 40, None));
    }

    #[test]
    fn penumbra_is_border_and_masked_pixels_do_not_count() {
        let soft = Image::from_fn(UVec2::new(60, 40), |x, _| ((x as f32 - 20.0) / 10.0).clamp(0.0, 1.0));
        let r = shadow_border(&half_plane(25.0), &soft, None).unwrap();
        assert_eq!((r.border_pixels, r.off_border_mismatches), (11 * 40, 0));
        let mask = Image::from_fn(UVec2::new(60, 40), |x, _| x >= 30);
        let masked = shadow_border(&half_plane(20.0), &half_plane(60.0), Some(&mask)).unwrap();
        assert_eq!((masked.off_border_pixels, masked.off_border_mismatches, masked.border_pixels), (30 * 40, 30 * 40, 0));
    }

    #[test]
    fn the_border_is_as_far_as_it_lies() {
        let far = border_distance(&half_plane(20.0), None).unwrap();
        assert_eq!([0, 18, 19, 20, 21, 59].map(|x| *far.get(x, 7)), [19.0, 1.0, 0.0, 0.0, 1.0, 39.0]);
        let mask = half_plane(0.0).map(|_| false);
        assert!(border_distance(&half_plane(20.0), Some(&mask)).unwrap().pixels().iter().all(|d| d.is_infinite()));
    }

    #[test]
    fn distance_transform_equals_brute_force() {
        let mut random = Random(5);
        let contour = Contour { width: 23, on: (0..23 * 17).map(|_| random.uniform() < 0.03).collect() };
        let fast = squared_distances(&contour);
        for (i, &d) in fast.iter().enumerate() {
            let distance = |j: usize| ((i % 23).abs_diff(j % 23).pow(2) + (i / 23).abs_diff(j / 23).pow(2)) as f64;
            let nearest = (0..contour.on.len()).filter(|&j| contour.on[j]).map(distance).fold(f64::INFINITY, f64::min);
            assert_eq!(d, nearest);
        }
    }
}

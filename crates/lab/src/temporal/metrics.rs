//! Flicker, ghost and progress, from images alone.

use super::track::{Track, at};
use glam::UVec2;
use kajo_image::Image;
use kajo_units::LinearRgb;

/// Mean over channels.
fn mean_of(v: LinearRgb) -> f64 {
    f64::from(v.0.element_sum()) / 3.0
}

/// Mean over pixels and channels of (a − b)².
pub fn mean_square(a: &Image<LinearRgb>, b: &Image<LinearRgb>) -> f64 {
    let sum: f64 = a.pixels().iter().zip(b.pixels()).map(|(a, b)| mean_of((*a - *b) * (*a - *b))).sum();
    sum / a.pixels().len() as f64
}

/// Change from frame to frame beyond that of the references.
pub struct Flicker {
    /// See the module above. `None` without a pixel that was seen twice.
    pub mean: Option<f64>,
    /// What each pixel adds to it.
    pub map: Image<f32>,
}

impl Flicker {
    /// `tracks` has one entry less than the images, which may be several of its size below each other.
    pub fn new(images: &[Image<LinearRgb>], references: &[Image<LinearRgb>], tracks: &[Track]) -> Self {
        let (mut sum, mut count) = (0.0, 0u64);
        let size = tracks.first().map_or(UVec2::ZERO, Image::size);
        let mut map = vec![0.0; size.element_product() as usize];
        for (t, track) in tracks.iter().enumerate() {
            let (now, before) = (&images[t + 1], &images[t]);
            let (reference, reference_before) = (&references[t + 1], &references[t]);
            let parts = now.height() / size.y;
            for part in 0..parts {
                let top = part * size.y;
                for (pixel, (x, y)) in (0..size.y).flat_map(|y| (0..size.x).map(move |x| (x, y))).enumerate() {
                    let Some(then) = *track.get(x, y) else { continue };
                    let change = |now: &Image<LinearRgb>, before: &Image<LinearRgb>| {
                        mean_of(LinearRgb((*now.get(x, y + top) - at(before, then, top, size)).0.abs()))
                    };
                    let beyond = (change(now, before) - change(reference, reference_before)).max(0.0);
                    sum += beyond;
                    count += 1;
                    map[pixel] += beyond as f32;
                }
            }
        }
        Self { mean: (count > 0).then(|| sum / count as f64), map: Image::from_pixels(size, map) }
    }
}

/// Smallest share of the references' brightness by which a pixel must change to count.
const CHANGED: f64 = 1e-4;

/// Standard deviations of the references' noise by which a pixel must change to count.
const SIGMAS: f64 = 3.0;

/// Share of the frame before that is in the picture, where the reference changes: see the module above. What errors have in common with the frame before and with the frame after
/// alike is no memory, and cancels. The noise of the references is in the divisor alone, where their `variances` take it out. 0 for what is negative; `None` where nothing
/// changes, or without three frames.
pub fn ghost(images: &[Image<LinearRgb>], references: &[Image<LinearRgb>], variances: Option<&[Image<LinearRgb>]>) -> Option<f64> {
    let (mut product, mut square) = (0.0, 0.0);
    let count = references.iter().map(|r| r.pixels().len()).sum::<usize>().max(1) as f64;
    let bright = references.iter().flat_map(|r| r.pixels()).map(|p| mean_of(*p)).sum::<f64>() / count;
    let last = images.len().saturating_sub(1);
    for (t, image) in images.iter().enumerate().filter(|(t, _)| (1..last).contains(t)) {
        for (i, pixel) in image.pixels().iter().enumerate() {
            let [past, now, next] = [t - 1, t, t + 1].map(|t| references[t].pixels()[i]);
            let change = past - next;
            let size = mean_of(change * change);
            let noise = |t: usize| variances.map_or(0.0, |v| mean_of(v[t].pixels()[i]).max(0.0));
            let noise = noise(t - 1) + noise(t + 1);
            if size.sqrt() > CHANGED * bright && size > SIGMAS * SIGMAS * noise {
                product += mean_of((*pixel - now) * change);
                square += size - noise;
            }
        }
    }
    (square > 0.0).then(|| (2.0 * product / square).max(0.0))
}

/// How far a picture has come from one state to another, by projection on the way between them:
///
/// ```text
/// r = ⟨I − A', B − A⟩ / ⟨B' − A', B − A⟩
/// ```
///
/// A and A', B and B' are two pictures each of the states, with noise of their own, so that none of it adds up. `None` where the states do not differ by more
/// than [`SIGMAS`] standard deviations of what noise alone makes of the denominator, which are told by its pixels.
pub fn progress(image: &Image<LinearRgb>, [a, a2]: &[Image<LinearRgb>; 2], [b, b2]: &[Image<LinearRgb>; 2]) -> Option<f64> {
    let (mut way, mut whole, mut size, mut spread) = (0.0, 0.0, 0.0, 0.0);
    for i in 0..image.pixels().len() {
        let [image, a, a2, b, b2] = [image, a, a2, b, b2].map(|picture| picture.pixels()[i]);
        let direction = b - a;
        way += mean_of((image - a2) * direction);
        let product = mean_of((b2 - a2) * direction);
        whole += product;
        spread += product * product;
        size += mean_of(direction * direction);
    }
    // Pictures that differ by noise alone point nowhere.
    (whole > 0.05 * size && whole > SIGMAS * spread.sqrt()).then(|| way / whole)
}

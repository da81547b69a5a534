//! A denoiser for previews: takes the noise out of a path-traced picture of few samples, and some truth with it.
//!
//! Each pixel becomes the value of a weighted least-squares plane through its neighbourhood. The weights say which neighbours are alike once their noise
//! is allowed for (non-local means \[Buades05], with the distance of \[Rousselle12]); the plane runs over features that a path tracer knows almost without
//! noise (base colour, shading normal, depth), so that textures and edges of objects survive \[Bitterli16]. Shadows and reflections have no feature: they
//! survive as far as they stand out of the noise.
//!
//! The answer is biased and its error unknown: it is for looking at, never for judging others.
//!
//! # Deviations
//! Of \[Bitterli16] this keeps one pass, one bandwidth and one picture: filtering two halves of the samples by each other's weights, which undoes the
//! correlation of weights and noise, took three times as long and had more error (docs/performance.md).

mod error;
mod patches;
mod planes;
mod regression;
mod tile;

pub use error::DenoiseError;

use glam::{UVec2, Vec3};
use kajo_image::Image;
use kajo_units::LinearRgb;
use planes::Planes;
use rayon::prelude::*;
use regression::FEATURES;
use tile::Tile;

/// A noisy picture and what is known of its pixels. All images have one size.
#[derive(Clone, Copy, Debug)]
pub struct Input<'a> {
    /// The mean of each pixel's samples, W/(m² sr).
    pub color: &'a Image<LinearRgb>,
    /// The part of it that comes straight from emitters and the background, W/(m² sr): it stays as it is. Mostly it has no noise but that of edges; seen
    /// through blended surfaces, motion blur or depth of field it has, and keeps it.
    pub emission: &'a Image<LinearRgb>,
    /// Variance of the mean. Where it is infinite, as that of one sample is, the scatter of the neighbours stands for it.
    pub variance: &'a Image<LinearRgb>,
    /// Share of the samples that hit a surface, [0, 1].
    pub coverage: &'a Image<f32>,
    /// Base colour of the first hit, [0, 1]; the mean over samples that hit, like the next two.
    pub albedo: &'a Image<LinearRgb>,
    /// Shading normal of the first hit, world space.
    pub normal: &'a Image<Vec3>,
    /// Distance of the first hit, m; 0 without a hit.
    pub depth: &'a Image<f32>,
}

/// Pixels are scaled to this brightness where they are above: their squares and sums stay finite.
const BRIGHTEST: f32 = 1e15;
/// Variance that counts, at most, after scaling: sums of it stay finite.
const MAX_VARIANCE: f64 = 1e35;

/// What each plane holds.
mod plane {
    pub(crate) const COLOR: usize = 0;
    pub(crate) const VARIANCE: usize = 3;
    pub(crate) const FEATURE: usize = 4;
}

/// The picture without its noise. Equal bit for bit on every processor and at any number of threads (those of the current rayon pool).
///
/// # Errors
/// [`DenoiseError::Empty`] without pixels, [`DenoiseError::Size`] for images of different sizes, [`DenoiseError::NotFinite`] for a number that is NaN or
/// infinite and for a variance that is NaN or negative.
pub fn denoise(input: &Input) -> Result<Image<LinearRgb>, DenoiseError> {
    check(input)?;
    let scale = scale(input);
    let planes = planes(input, scale);
    let size = input.color.size();
    let tiles: Vec<Tile> = Tile::cover(size).collect();
    let filtered: Vec<_> = tiles.par_iter().map(|&tile| tile::filter(&planes, tile)).collect();
    let mut image = input.color.clone();
    for (tile, pixels) in tiles.iter().zip(&filtered) {
        for (row, y) in pixels.chunks_exact(Tile::WIDTH).zip(tile.y as u32..size.y) {
            let begin = y as usize * size.x as usize + tile.x as usize;
            let length = row.len().min(size.x as usize - tile.x as usize);
            for ((out, reflected), emission) in
                image.pixels_mut()[begin..].iter_mut().zip(&row[..length]).zip(&input.emission.pixels()[begin..])
            {
                *out = *reflected / scale + *emission;
            }
        }
    }
    Ok(image)
}

fn check(input: &Input) -> Result<(), DenoiseError> {
    let expected = input.color.size();
    if expected.min_element() == 0 {
        return Err(DenoiseError::Empty);
    }
    for (what, got) in [
        ("emission", input.emission.size()),
        ("variance", input.variance.size()),
        ("coverage", input.coverage.size()),
        ("albedo", input.albedo.size()),
        ("normal", input.normal.size()),
        ("depth", input.depth.size()),
    ] {
        if got != expected {
            return Err(DenoiseError::Size { what, got, expected });
        }
    }
    for (what, finite) in [
        ("color", input.color.pixels().iter().all(|c| c.is_finite())),
        ("emission", input.emission.pixels().iter().all(|c| c.is_finite())),
        ("variance", input.variance.pixels().iter().all(|v| !v.0.is_nan() && v.0.min_element() >= 0.0)),
        ("coverage", input.coverage.pixels().iter().all(|c| c.is_finite())),
        ("albedo", input.albedo.pixels().iter().all(|c| c.is_finite())),
        ("normal", input.normal.pixels().iter().all(|n| n.is_finite())),
        ("depth", input.depth.pixels().iter().all(|d| d.is_finite())),
    ] {
        if !finite {
            return Err(DenoiseError::NotFinite { what });
        }
    }
    Ok(())
}

/// A power of two, 1 for all pictures of common brightness.
fn scale(input: &Input) -> f32 {
    let size = input.color.size();
    let pixels = (0..size.y).flat_map(|y| (0..size.x).map(move |x| (x, y)));
    let brightest = pixels.map(|(x, y)| reflected(input, x, y).abs().max_element()).fold(0.0, f32::max);
    if brightest > BRIGHTEST { (BRIGHTEST / brightest).log2().floor().exp2() } else { 1.0 }
}

/// Features are means over all samples, as reflected light is: where a surface covers half of a pixel, both are halved and the plane still holds.
fn planes(input: &Input, scale: f32) -> Planes {
    let count = plane::FEATURE + FEATURES;
    let mut planes = Planes::new(input.color.size(), tile::RADIUS as usize + patches::PATCH, Tile::SIZE, count);
    planes.push_rgb(|x, y| reflected(input, x, y) * scale);
    let variance = known_variance(input, scale);
    planes.push(|x, y| smooth(&variance, x, y));
    let covered = |x, y| *input.coverage.get(x, y);
    planes.push_rgb(|x, y| input.albedo.get(x, y).0 * covered(x, y));
    planes.push_rgb(|x, y| *input.normal.get(x, y) * covered(x, y));
    let per_meter = depth_scale(input.depth);
    planes.push(|x, y| input.depth.get(x, y) * per_meter * covered(x, y));
    debug_assert_eq!(planes.count(), count);
    planes
}

/// What the pixel sees of light that bounced.
fn reflected(input: &Input, x: u32, y: u32) -> Vec3 {
    input.color.get(x, y).0 - input.emission.get(x, y).0
}

/// Depth relative to its mean, so that it has the size of the other features.
fn depth_scale(depth: &Image<f32>) -> f32 {
    let hits = depth.pixels().iter().filter(|&&d| d > 0.0);
    let (sum, count) = hits.fold((0.0f64, 0.0f64), |(sum, count), &d| (sum + f64::from(d), count + 1.0));
    if sum > 0.0 { (count / sum) as f32 } else { 1.0 }
}

/// Variance of the reflected light of each pixel, summed over the channels and scaled. That of the picture has the variance of emission in it: where a pixel sees
/// a lamp or the sky, the scatter of reflected light around bounds it.
fn known_variance(input: &Input, scale: f32) -> Image<f32> {
    Image::from_fn(input.color.size(), |x, y| {
        let variance = f64::from(input.variance.get(x, y).0.element_sum());
        let bounded = !variance.is_finite() || !input.emission.get(x, y).is_black();
        let variance = if bounded { variance.min(scatter(input, x, y)) } else { variance };
        (variance * f64::from(scale).powi(2)).min(MAX_VARIANCE) as f32
    })
}

/// Pixels within `radius`, as far as the picture goes.
fn around(size: UVec2, x: u32, y: u32, radius: u32) -> impl Iterator<Item = (u32, u32)> {
    let (right, bottom) = ((x + radius).min(size.x - 1), (y + radius).min(size.y - 1));
    (y.saturating_sub(radius)..=bottom).flat_map(move |y| (x.saturating_sub(radius)..=right).map(move |x| (x, y)))
}

/// Variance of reflected light among the 25 pixels around, summed over the channels.
fn scatter(input: &Input, x: u32, y: u32) -> f64 {
    let (mut count, mut sum, mut squares) = (0.0, glam::DVec3::ZERO, glam::DVec3::ZERO);
    for (x, y) in around(input.color.size(), x, y, 2) {
        let value = reflected(input, x, y).as_dvec3();
        count += 1.0;
        sum += value;
        squares += value * value;
    }
    ((squares - sum * sum / count).element_sum() / f64::max(count - 1.0, 1.0)).max(0.0)
}

/// Half the pixel's own variance, half the mean around it: a handful of samples knows its variance badly.
fn smooth(variance: &Image<f32>, x: u32, y: u32) -> f32 {
    let (mut sum, mut count) = (0.0, 0.0);
    for (x, y) in around(variance.size(), x, y, 1) {
        sum += variance.get(x, y);
        count += 1.0;
    }
    0.5 * variance.get(x, y) + 0.5 * sum / count
}

#[cfg(test)]
mod tests;

//! The eye's low-pass and the detectors of edges and points, as separable convolutions. Borders repeat the edge pixel.

use glam::{Vec2, Vec3};
use kajo_image::Image;
use rayon::prelude::*;
use std::f32::consts::PI;
use std::ops::{Add, Mul};

/// Contrast sensitivity as Gaussians a √(π/b) exp(−π² d²/b), d in degrees: achromatic, red-green, and blue-yellow as a sum of two.
///     \[Andersson20] table 1
const ACHROMATIC: (f32, f32) = (1.0, 0.0047);
const RED_GREEN: (f32, f32) = (1.0, 0.0053);
const BLUE_YELLOW: [(f32, f32); 2] = [(34.1, 0.04), (13.5, 0.025)];
/// Width of an edge detector's Gaussian, degrees.    \[Andersson20] section 4.4
const EDGE_WIDTH: f32 = 0.082;

/// Contrast sensitivity filters. A Gaussian of d² = x² + y² is a product of two; blue-yellow is a sum of two such products, so four 1D
/// kernels serve (the weights of each pair are (achromatic, red-green) and the two of blue-yellow).
pub struct SpatialFilter {
    radius: usize,
    achromatic_red_green: Vec<Vec2>,
    blue_yellow: Vec<Vec2>,
}

impl SpatialFilter {
    /// For a display of that many pixels per degree; the radius is 3 σ of the widest Gaussian.
    pub fn new(pixels_per_degree: f32) -> Self {
        let widest = BLUE_YELLOW[0].1;
        let radius = (3.0 * (widest / (2.0 * PI * PI)).sqrt() * pixels_per_degree).ceil() as usize;
        let degrees = |i: usize| (i as f32 - radius as f32) / pixels_per_degree;
        let gaussian = |d: f32, b: f32| (-PI * PI * d * d / b).exp();
        let indices = 0..2 * radius + 1;
        let first: Vec<Vec2> =
            indices.clone().map(degrees).map(|d| Vec2::new(gaussian(d, ACHROMATIC.1), gaussian(d, RED_GREEN.1))).collect();
        // √ of the amplitude in each direction gives the amplitude in 2D; single Gaussians lose theirs in the normalisation.
        let amplitude = |(a, b): (f32, f32)| (a * (PI / b).sqrt()).sqrt();
        let second: Vec<Vec2> =
            indices.map(degrees).map(|d| Vec2::from(BLUE_YELLOW.map(|(a, b)| amplitude((a, b)) * gaussian(d, b)))).collect();
        let sum: Vec2 = first.iter().sum();
        let second_sum = second.iter().sum::<Vec2>().length();
        Self {
            radius,
            achromatic_red_green: first.into_iter().map(|w| w / sum).collect(),
            blue_yellow: second.into_iter().map(|w| w / second_sum).collect(),
        }
    }

    /// Filters a YyCxCz image.
    pub fn apply(&self, image: &Image<Vec3>) -> Image<Vec3> {
        let rows = convolve(image, self.radius, Axis::X, |k, p: Vec3| {
            let (a, b) = (self.achromatic_red_green[k], self.blue_yellow[k]);
            Channels([a.x * p.x, a.y * p.y, b.x * p.z, b.y * p.z])
        });
        convolve(&rows, self.radius, Axis::Y, |k, Channels([y, cx, z1, z2])| {
            let (a, b) = (self.achromatic_red_green[k], self.blue_yellow[k]);
            Channels([a.x * y, a.y * cx, b.x * z1, b.y * z2])
        })
        .map(|&Channels([y, cx, z1, z2])| Vec3::new(y, cx, z1 + z2))
    }
}

/// First and second derivatives of a Gaussian, which detect edges and points.
pub struct FeatureFilter {
    radius: usize,
    /// Gaussian, first derivative, second derivative.
    weights: Vec<Vec3>,
}

impl FeatureFilter {
    /// For a display of that many pixels per degree.
    pub fn new(pixels_per_degree: f32) -> Self {
        let sigma = 0.5 * EDGE_WIDTH * pixels_per_degree;
        let radius = (3.0 * sigma).ceil() as usize;
        let raw: Vec<Vec3> = (0..2 * radius + 1)
            .map(|i| {
                let x = i as f32 - radius as f32;
                let g = (-x * x / (2.0 * sigma * sigma)).exp();
                Vec3::new(g, -x * g, (x * x / (sigma * sigma) - 1.0) * g)
            })
            .collect();
        // The Gaussian sums to 1; the positive and the negative weights of each derivative to 1 and −1.
        let positive: Vec3 = raw.iter().map(|w| w.max(Vec3::ZERO)).sum();
        let negative: Vec3 = raw.iter().map(|w| (-*w).max(Vec3::ZERO)).sum();
        let weights = raw.into_iter().map(|w| w / Vec3::select(w.cmpgt(Vec3::ZERO), positive, negative.max(Vec3::splat(1e-20)))).collect();
        Self { radius, weights }
    }

    /// [edge, point] strength per pixel of the achromatic channel scaled to [0, 1].    \[Andersson20] eq. 14 and 15
    pub fn apply(&self, image: &Image<Vec3>) -> Image<[f32; 2]> {
        let rows = convolve(image, self.radius, Axis::X, |k, p: Vec3| {
            let (w, y) = (self.weights[k], (p.x + 16.0) / 116.0);
            Channels([w.x * y, w.y * y, w.z * y, 0.0])
        });
        convolve(&rows, self.radius, Axis::Y, |k, Channels([g, d, dd, _])| {
            let w = self.weights[k];
            Channels([w.x * d, w.y * g, w.x * dd, w.z * g])
        })
        .map(|&Channels([dx, dy, ddx, ddy])| [dx.hypot(dy), ddx.hypot(ddy)])
    }
}

enum Axis {
    X,
    Y,
}

/// Sums of a convolution.
#[derive(Clone, Copy, Default)]
struct Channels([f32; 4]);

impl Add for Channels {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i] + other.0[i]))
    }
}

impl Mul<f32> for Channels {
    type Output = Self;
    fn mul(self, factor: f32) -> Self {
        Self(self.0.map(|v| v * factor))
    }
}

/// Σ over k of `term(k, pixel at offset k − radius along the axis)`.
fn convolve<T: Copy + Sync>(image: &Image<T>, radius: usize, axis: Axis, term: impl Fn(usize, T) -> Channels + Sync) -> Image<Channels> {
    let (width, height) = (image.width() as usize, image.height() as usize);
    let mut out = vec![Channels::default(); width * height];
    out.par_chunks_mut(width).enumerate().for_each(|(y, row)| {
        for (x, out) in row.iter_mut().enumerate() {
            *out = (0..2 * radius + 1).fold(Channels::default(), |sum, k| {
                let at = |center: usize, size: usize| (center + k).saturating_sub(radius).min(size - 1);
                let pixel = match axis {
                    Axis::X => image.pixels()[y * width + at(x, width)],
                    Axis::Y => image.pixels()[at(y, height) * width + x],
                };
                sum + term(k, pixel)
            });
        }
    });
    Image::from_pixels(image.size(), out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flip::PIXELS_PER_DEGREE;
    use glam::UVec2;

    #[test]
    fn flat_images_pass_the_eye_unchanged_and_have_no_features() {
        let flat = Image::from_fn(UVec2::new(40, 30), |_, _| Vec3::new(50.0, -20.0, 33.0));
        for p in SpatialFilter::new(PIXELS_PER_DEGREE).apply(&flat).pixels() {
            assert!((*p - Vec3::new(50.0, -20.0, 33.0)).abs().max_element() < 1e-3, "{p}");
        }
        assert!(FeatureFilter::new(PIXELS_PER_DEGREE).apply(&flat).pixels().iter().flatten().all(|&f| f < 1e-5));
    }

    #[test]
    fn a_step_from_black_to_white_is_an_edge_of_strength_one() {
        let step = Image::from_fn(UVec2::new(40, 30), |x, _| Vec3::new(if x < 20 { -16.0 } else { 100.0 }, 0.0, 0.0));
        let strongest = FeatureFilter::new(PIXELS_PER_DEGREE).apply(&step).pixels().iter().map(|f| f[0]).fold(0.0, f32::max);
        assert!((strongest - 1.0).abs() < 1e-3, "{strongest}");
    }
}

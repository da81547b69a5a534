//! Environments for tests, made of formulas.

use crate::Rng;
use glam::UVec2;

/// A bright sky over dark ground with clouds of noise, a window and a sun of 6 pixels that is 5·10⁴ times brighter than the sky.
pub(crate) fn sunny(width: u32, height: u32) -> (UVec2, Vec<f32>) {
    let mut rng = Rng::new(61);
    let pixel = |x: u32, y: u32, noise: f32| {
        let (u, v) = ((x as f32 + 0.5) / width as f32, (y as f32 + 0.5) / height as f32);
        let sky = if v < 0.5 { 1.0 + 2.0 * v + 0.3 * (u * 19.0).sin() * (v * 23.0).cos() } else { 0.2 };
        let sun = 5e4 * (-((u - 0.31).powi(2) * 4.0 + (v - 0.22).powi(2)) * 6e4).exp();
        let window = if (0.6..0.7).contains(&u) && (0.3..0.45).contains(&v) { 40.0 } else { 0.0 };
        (sky + sun + window) * (0.9 + 0.2 * noise)
    };
    let luminance = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| pixel(x, y, rng.next_1d())).collect();
    (UVec2::new(width, height), luminance)
}

/// Lamps of different sizes in a dark room with a textured wall.
pub(crate) fn lamps(width: u32, height: u32) -> (UVec2, Vec<f32>) {
    let mut rng = Rng::new(62);
    let lamps: Vec<_> = (0..12).map(|_| (rng.next_2d(), 2e-4 + 3e-3 * rng.next_1d(), 10f32.powf(1.0 + 3.0 * rng.next_1d()))).collect();
    let pixel = |x: u32, y: u32, noise: f32| {
        let (u, v) = ((x as f32 + 0.5) / width as f32, (y as f32 + 0.5) / height as f32);
        let wall = 0.05 + 0.2 * noise * (1.0 + (u * 40.0).sin() * (v * 31.0).sin());
        lamps.iter().filter(|(p, area, _)| (p.x - u).powi(2) * 4.0 + (p.y - v).powi(2) < *area).map(|lamp| lamp.2).sum::<f32>() + wall
    };
    let luminance = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| pixel(x, y, rng.next_1d())).collect();
    (UVec2::new(width, height), luminance)
}

/// The maps that claims are tested on: name, size, luminance.
pub(crate) fn all_maps() -> Vec<(&'static str, UVec2, Vec<f32>)> {
    let named = |name, (size, luminance)| (name, size, luminance);
    vec![named("sunny", sunny(512, 256)), named("lamps", lamps(512, 256)), named("small", sunny(96, 48))]
}

//! Pictures for tests: noise, and a scene-like picture with edges, gradients, small features and colour.

use glam::{UVec2, Vec3};
use kajo_image::Image;
use kajo_units::{LinearRgb, Srgb8};

/// SplitMix64: enough randomness for test pictures.
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform in [0, 1).
    pub fn uniform(&mut self) -> f32 {
        (self.bits() >> 40) as f32 / (1u64 << 24) as f32
    }

    /// Standard normal, by Box and Muller.
    pub fn normal(&mut self) -> f32 {
        let (u, v) = (1.0 - self.uniform(), self.uniform());
        (-2.0 * u.ln()).sqrt() * (std::f32::consts::TAU * v).cos()
    }
}

pub fn noise8(size: UVec2, seed: u64) -> Image<Srgb8> {
    let mut random = Random(seed);
    Image::from_fn(size, |_, _| Srgb8(random.bits().to_le_bytes()[..3].try_into().unwrap()))
}

/// Discs on a gradient with stripes, linear light in [0, 1]; `shift` moves the discs, px.
pub fn scene(size: UVec2, shift: f32) -> Image<LinearRgb> {
    Image::from_fn(size, |x, y| {
        let p = glam::Vec2::new(x as f32, y as f32) / size.as_vec2();
        let mut color = Vec3::new(0.1 + 0.6 * p.x, 0.3 + 0.3 * p.y, 0.7 - 0.5 * p.x);
        if (x / 3) % 2 == 0 && p.y > 0.75 {
            color *= 0.4;
        }
        for (i, tint) in [Vec3::new(0.9, 0.1, 0.05), Vec3::new(0.05, 0.7, 0.1), Vec3::splat(0.02)].into_iter().enumerate() {
            let center = glam::Vec2::new(0.25 + 0.25 * i as f32 + shift / size.x as f32, 0.3 + 0.1 * i as f32);
            if p.distance(center) < 0.12 {
                color = tint;
            }
        }
        LinearRgb(color)
    })
}

/// Adds normal noise of standard deviation `sigma` to every channel.
pub fn with_noise(image: &Image<LinearRgb>, sigma: f32, seed: u64) -> Image<LinearRgb> {
    let mut random = Random(seed);
    image.map(|p| LinearRgb(p.0 + sigma * Vec3::new(random.normal(), random.normal(), random.normal())))
}

//! The environment on the device: its radiance, and the same averaged with the cosine about each direction.

use crate::Error;
use glam::{UVec2, Vec2, Vec3};
use kajo_image::Image;
use kajo_render_graph::{Bindings, Device, Texture, wgpu};
use kajo_scene::{ColorSpace, Environment};
use std::f32::consts::PI;

/// Size of the averaged image: the cosine leaves nothing finer than a few degrees.
const COSINE_SIZE: UVec2 = UVec2::new(64, 32);

/// Largest size of the image that it is made of.
const SOURCE_SIZE: UVec2 = UVec2::new(128, 64);

/// Textures of the module `environment`; a black texel each where there is no image.
#[derive(Debug)]
pub(crate) struct EnvironmentMap {
    radiance: Texture,
    cosine: Texture,
    sampler: wgpu::Sampler,
}

impl EnvironmentMap {
    pub fn new(device: &Device, environment: Option<&Environment>) -> Result<Self, Error> {
        let image = environment.and_then(|environment| environment.image.as_deref());
        let size = image.map_or(UVec2::ONE, |image| UVec2::new(image.width, image.height));
        let texel = |x, y| image.map_or(Vec3::ZERO, |image| image.texel(x, y, ColorSpace::Linear).truncate().max(Vec3::ZERO));
        let cosine = match image {
            Some(_) => cosine_mean(&shrunk(size, texel, SOURCE_SIZE), COSINE_SIZE),
            None => Image::from_pixels(UVec2::ONE, vec![Vec3::ZERO]),
        };
        Ok(Self {
            radiance: upload(device, "environment", size, texel)?,
            cosine: upload(device, "environment cosine", cosine.size(), |x, y| *cosine.get(x, y))?,
            sampler: device.wgpu.create_sampler(&wgpu::SamplerDescriptor {
                label: Some("environment"),
                address_mode_u: wgpu::AddressMode::Repeat,
                address_mode_v: wgpu::AddressMode::ClampToEdge,
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                ..Default::default()
            }),
        })
    }

    pub fn bind<'a>(&'a self, bindings: Bindings<'a>) -> Bindings<'a> {
        bindings
            .with("environment_image", &self.radiance)
            .with("environment_cosine", &self.cosine)
            .with("environment_sampler", &self.sampler)
    }
}

/// The mean of each block of a grid of at most `most`; blocks are whole texels, so that nothing bright is lost between them.
fn shrunk(from: UVec2, texel: impl Fn(u32, u32) -> Vec3, most: UVec2) -> Image<Vec3> {
    let size = most.min(from);
    let bound = |i: u32, axis: usize| (u64::from(i) * u64::from(from[axis]) / u64::from(size[axis])) as u32;
    Image::from_fn(size, |x, y| {
        let (mut sum, mut weight) = (Vec3::ZERO, 0.0);
        for row in bound(y, 1)..bound(y + 1, 1) {
            let solid_angle = row_measure(row, from.y);
            for column in bound(x, 0)..bound(x + 1, 0) {
                sum += texel(column, row) * solid_angle;
                weight += solid_angle;
            }
        }
        sum / weight
    })
}

/// Solid angle of the texels of a row, up to a factor that all of them share.
fn row_measure(row: u32, rows: u32) -> f32 {
    let theta = |row: u32| row as f32 / rows as f32 * PI;
    theta(row).cos() - theta(row + 1).cos()
}

/// (1/π) ∫ L cos θ dω about the direction of each texel. The cosines are scaled so that a white image stays white.
fn cosine_mean(image: &Image<Vec3>, size: UVec2) -> Image<Vec3> {
    let direction = |x: u32, y: u32, size: UVec2| Environment::image_direction((Vec2::new(x as f32, y as f32) + 0.5) / size.as_vec2());
    let from = image.size();
    let places = (0..from.y).flat_map(|y| (0..from.x).map(move |x| (x, y)));
    let sources: Vec<(Vec3, f32, Vec3)> = places.map(|(x, y)| (direction(x, y, from), row_measure(y, from.y), *image.get(x, y))).collect();
    Image::from_fn(size, |x, y| {
        let normal = direction(x, y, size);
        let (mut sum, mut weight) = (Vec3::ZERO, 0.0);
        for (direction, measure, radiance) in &sources {
            let share = normal.dot(*direction).max(0.0) * measure;
            sum += *radiance * share;
            weight += share;
        }
        sum / weight
    })
}

/// In half floats.
fn upload(device: &Device, label: &str, size: UVec2, texel: impl Fn(u32, u32) -> Vec3) -> Result<Texture, Error> {
    device.check_size(size)?;
    let texture = device.texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba16Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let half = |c: f32| half::f16::from_f32(c.min(65504.0)).to_bits();
    let places = (0..size.y).flat_map(|y| (0..size.x).map(move |x| (x, y)));
    let halves: Vec<u16> = places.flat_map(|(x, y)| texel(x, y).extend(1.0).to_array().map(half)).collect();
    device.queue.write_texture(
        texture.wgpu.as_image_copy(),
        bytemuck::cast_slice(&halves),
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(size.x * 8), rows_per_image: None },
        texture.wgpu.size(),
    );
    Ok(texture)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::TAU;

    /// A sky that is brighter above, L = 1 + y: (1/π) ∫ L cos θ dω = 1 + 2/3 n.y.
    #[test]
    fn the_cosine_mean_of_a_gradient_is_known() {
        let sky = |_, y: u32| Vec3::splat(1.0 + ((y as f32 + 0.5) / 128.0 * PI).cos());
        let mean = cosine_mean(&shrunk(UVec2::new(256, 128), sky, SOURCE_SIZE), COSINE_SIZE);
        for y in 0..COSINE_SIZE.y {
            let expected = 1.0 + 2.0 / 3.0 * ((y as f32 + 0.5) / COSINE_SIZE.y as f32 * PI).cos();
            for x in [0, 17, 63] {
                let got = mean.get(x, y).y;
                assert!((got - expected).abs() < 2e-3, "row {y}: {got}, expected {expected}");
            }
        }
    }

    /// One bright texel of a fine image: E = L Ω cos θ wherever it is seen from.
    #[test]
    fn a_sun_of_one_texel_keeps_its_energy() {
        let size = UVec2::new(1024, 512);
        let sun = UVec2::new(700, 150);
        let sky = |x, y| if UVec2::new(x, y) == sun { Vec3::splat(1e6) } else { Vec3::ZERO };
        let mean = cosine_mean(&shrunk(size, sky, SOURCE_SIZE), COSINE_SIZE);
        let theta = |row: u32| row as f32 / size.y as f32 * PI;
        let solid_angle = (theta(sun.y).cos() - theta(sun.y + 1).cos()) * TAU / size.x as f32;
        let brightest = mean.pixels().iter().fold(0.0f32, |most, p| most.max(p.x));
        let expected = 1e6 * solid_angle / PI;
        assert!((brightest / expected - 1.0).abs() < 0.02, "{brightest}, expected {expected}");
        let dark = mean.pixels().iter().filter(|p| p.x == 0.0).count() as f32 / mean.pixels().len() as f32;
        assert!((0.4..0.6).contains(&dark), "{dark}");
    }
}

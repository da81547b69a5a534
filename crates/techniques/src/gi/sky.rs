//! Rays of the environment, chosen on the CPU by its brightness.

use glam::Vec3;
use kajo_sampling::warp::uniform_sphere;
use kajo_sampling::{Alias2d, hammersley_2d};
use kajo_scene::Environment;

/// Directions to the environment and the radiance of each over its density, as the shader reads them.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable, kajo_shader_lib::ShaderLayout)]
pub(super) struct SkyRay {
    /// Unit, towards the environment.
    pub direction: Vec3,
    pub padding_a: u32,
    /// L / p, W/m²: the mean is ∫ L dω.
    pub weight: Vec3,
    pub padding_b: u32,
}

/// `count` of them; none without an environment.
pub(super) fn sky_rays(environment: Option<&Environment>, count: u32) -> Vec<SkyRay> {
    let Some(environment) = environment.filter(|environment| environment.scale.0.max_element() > 0.0) else { return Vec::new() };
    let ray = |direction: Vec3, weight: Vec3| SkyRay { direction, weight, ..SkyRay::default() };
    let table = environment.importance().and_then(|grid| Alias2d::new(grid.pixels(), grid.size().x as usize, grid.size().y as usize));
    (0..count)
        .map(|i| {
            let u = hammersley_2d(i, count);
            match &table {
                None => {
                    let direction = uniform_sphere(u);
                    ray(direction, environment.radiance(direction).0 * (4.0 * std::f32::consts::PI))
                }
                Some(table) => {
                    let (uv, pdf_uv) = table.sample(u);
                    let pdf = environment.pdf_from_uv(pdf_uv, uv);
                    let weight = if pdf > 0.0 { environment.radiance_at(uv).0 / pdf } else { Vec3::ZERO };
                    ray(environment.direction(uv), weight)
                }
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_scene::{Texels, TextureImage};
    use kajo_units::{LinearRgb, Radians};
    use std::sync::Arc;

    /// Σ weight g(direction) / n is ∫ L g dω: of L = 1 in all directions 4π, and the same of an image that is 1 everywhere but for a bright row.
    #[test]
    fn rays_stand_for_the_light_of_the_environment() {
        let mean = |environment: &Environment| {
            let rays = sky_rays(Some(environment), 4096);
            rays.iter().map(|ray| ray.weight).sum::<Vec3>() / 4096.0
        };
        let uniform = Environment::uniform(LinearRgb::new(1.0, 2.0, 0.5));
        let sphere = 4.0 * std::f32::consts::PI;
        assert!((mean(&uniform) / sphere - Vec3::new(1.0, 2.0, 0.5)).abs().max_element() < 1e-3);
        assert!(sky_rays(None, 16).is_empty() && sky_rays(Some(&Environment::uniform(LinearRgb::BLACK)), 16).is_empty());
        let texels = (0..8 * 4).map(|i| [if i < 8 { 50.0 } else { 1.0 }; 3]).collect();
        let image = TextureImage { name: String::new(), width: 8, height: 4, texels: Texels::Rgb32F(texels) };
        let bright = Environment { image: Some(Arc::new(image)), scale: LinearRgb::WHITE, rotation: Radians(0.4) };
        let expected: f32 =
            (0..20_000).map(|i| bright.radiance(uniform_sphere(hammersley_2d(i, 20_000)))[0]).sum::<f32>() * sphere / 20_000.0;
        assert!((mean(&bright).x / expected - 1.0).abs() < 0.01, "{}, {expected}", mean(&bright).x);
    }
}

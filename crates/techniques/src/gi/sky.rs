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

//! What the lights of a scene send into it.

use glam::Vec3;
use kajo_scene::{LightShape, Scene, Snapshot};
use kajo_units::LinearRgb;
use std::f32::consts::PI;

/// A sphere around everything: its centre, world, and its radius, m.
pub(super) fn around([low, high]: [Vec3; 2]) -> (Vec3, f32) {
    (0.5 * (low + high), 0.5 * (high - low).length())
}

/// Power of each light in the order of the list on the device, W: analytic ones, then emissive meshes. Of directional lights what falls on a disc
/// of `radius`.
pub fn light_powers(scene: &Scene, snapshot: &Snapshot, radius: f32) -> Vec<LinearRgb> {
    let analytic = snapshot.lights.iter().map(|placed| {
        let world = &placed.world_from_light;
        let across = |x: f32, y: f32| world.transform_vector3(Vec3::X * x).cross(world.transform_vector3(Vec3::Y * y)).length();
        let factor = match placed.light.shape {
            LightShape::Point => 4.0 * PI,
            // The falloff is the square of a function that is linear in the cosine.
            LightShape::Spot { inner, outer } => 2.0 * PI * (1.0 - inner.0.cos() + (inner.0.cos() - outer.0.cos()) / 3.0),
            LightShape::Directional { .. } => PI * radius * radius,
            LightShape::Rectangle { width, height } => PI * across(width.0, height.0),
            LightShape::Disk { radius } => PI * PI * across(radius.0, radius.0),
            LightShape::Sphere { radius } => 4.0 * PI * PI * radius.0 * radius.0 * world.matrix3.determinant().abs().powf(2.0 / 3.0),
        };
        placed.light.emission * factor
    });
    let meshes = snapshot.emissive_meshes(scene).into_iter().map(|mesh| {
        let sides = if mesh.double_sided { 2.0 } else { 1.0 };
        mesh.radiance * (PI * mesh.area * sides)
    });
    analytic.chain(meshes).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{Affine3A, Quat, Vec2};
    use kajo_sampling::{hammersley_2d, radical_inverse};
    use kajo_scene::{Light, PlacedLight, builtin};
    use kajo_shader_lib::emission::emission_sample;
    use kajo_shader_lib::light::GpuLight;
    use kajo_units::{Meters, Radians, Seconds};

    /// The power by which paths are dealt out is the power that their rays carry.
    #[test]
    fn the_power_of_a_light_is_what_its_rays_carry() {
        let scene = builtin::load("cornell").unwrap();
        let mut snapshot = Snapshot::new(&scene, Seconds(0.0));
        let shapes = [
            LightShape::Point,
            LightShape::Spot { inner: Radians(0.3), outer: Radians(0.7) },
            LightShape::Directional { half_angle: Radians(0.05) },
            LightShape::Rectangle { width: Meters(1.0), height: Meters(0.4) },
            LightShape::Disk { radius: Meters(0.5) },
            LightShape::Sphere { radius: Meters(0.5) },
        ];
        let scale = Vec3::new(1.5, 2.0, 1.0);
        let world_from_light = Affine3A::from_scale_rotation_translation(scale, Quat::from_rotation_y(0.8), Vec3::Y);
        let light = |shape| Light { name: String::new(), shape, emission: LinearRgb::new(3.0, 2.0, 1.0) };
        snapshot.lights = shapes.into_iter().map(|shape| PlacedLight { light: light(shape), world_from_light }).collect();
        let radius = 2.0;
        for (placed, power) in snapshot.lights.iter().zip(light_powers(&scene, &snapshot, radius)) {
            let light = GpuLight::new(placed, Vec3::ZERO);
            let count = 4096;
            let flux = |i: u32| {
                let v = Vec2::new(radical_inverse(3, i), radical_inverse(5, i));
                emission_sample(&light, hammersley_2d(i, count), v, Vec3::ZERO, radius).flux
            };
            let carried = (0..count).map(flux).sum::<Vec3>() / count as f32;
            assert!((power.0 / carried - 1.0).abs().max_element() < 0.01, "{:?}: {power:?}, {carried}", placed.light.shape);
        }
    }
}

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
pub(super) fn light_powers(scene: &Scene, snapshot: &Snapshot, radius: f32) -> Vec<LinearRgb> {
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

//! The camera for scenes that have none.

use crate::{Camera, Instance, Mesh, PlacedCamera, Projection};
use glam::Vec3;
use kajo_units::{Meters, Radians};
use std::sync::Arc;

/// Smallest and largest corner of what is placed; a unit box around the origin where nothing is.
pub fn bounds(meshes: &[Arc<Mesh>], instances: &[Instance]) -> [Vec3; 2] {
    let mut low = Vec3::INFINITY;
    let mut high = Vec3::NEG_INFINITY;
    for instance in instances {
        for &position in &meshes[instance.mesh].positions {
            let world = instance.world_from_object.transform_point3(position);
            low = low.min(world);
            high = high.max(world);
        }
    }
    if low.is_finite() && high.is_finite() { [low, high] } else { [Vec3::splat(-0.5), Vec3::splat(0.5)] }
}

/// A perspective camera of 40° that sees the whole bounding sphere from the front, 20° above and 30° to the right.
pub fn default_camera([low, high]: [Vec3; 2]) -> PlacedCamera {
    let yfov = Radians::from_degrees(40.0);
    let center = low * 0.5 + high * 0.5;
    let radius = ((high - low).length() * 0.5).max(1e-3);
    let distance = radius / (yfov.0 * 0.5).sin();
    let (azimuth, elevation) = (30f32.to_radians(), 20f32.to_radians());
    let towards = Vec3::new(azimuth.sin() * elevation.cos(), elevation.sin(), azimuth.cos() * elevation.cos());
    let camera = Camera {
        name: "default".into(),
        projection: Projection::Perspective { yfov, aspect: None },
        lens_radius: Meters(0.0),
        focus_distance: Meters(distance),
        near: Meters((distance - radius) * 0.05),
    };
    PlacedCamera { camera, world_from_view: glam::camera::rh::view::look_at_mat4(center + towards * distance, center, Vec3::Y).inverse() }
}

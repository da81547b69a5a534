//! Lights as `shader_lib::light` reads them.

use crate::gpu::GpuLight;
use glam::Vec3;
use kajo_scene::{LightShape, PlacedLight};

/// Numbers of the kinds, as in `shader_lib::light`.
const POINT: u32 = 0;
const SPOT: u32 = 1;
const DIRECTIONAL: u32 = 2;
const RECTANGLE: u32 = 3;
const DISK: u32 = 4;
const SPHERE: u32 = 5;

/// A placed light, relative to the camera.
pub(crate) fn pack(placed: &PlacedLight, camera: Vec3) -> GpuLight {
    let m = placed.world_from_light;
    let [x, y, z]: [Vec3; 3] = [m.matrix3.x_axis.into(), m.matrix3.y_axis.into(), m.matrix3.z_axis.into()];
    let (mut kind, mut size, mut half_x, mut half_y) = (POINT, 0.0, Vec3::ZERO, Vec3::ZERO);
    let (mut cos_inner, mut cos_outer) = (1.0, -1.0);
    let mut direction = (-z).normalize_or(Vec3::NEG_Z);
    match placed.light.shape {
        LightShape::Point => {}
        LightShape::Spot { inner, outer } => {
            kind = SPOT;
            (cos_inner, cos_outer) = (inner.0.cos(), outer.0.cos());
        }
        LightShape::Directional { half_angle } => {
            kind = DIRECTIONAL;
            // 1 − cos α = 2 sin²(α/2), without the cancellation.
            size = 2.0 * (0.5 * half_angle.0).sin().powi(2);
        }
        LightShape::Rectangle { width, height } => {
            kind = RECTANGLE;
            (half_x, half_y) = (x * (0.5 * width.0), y * (0.5 * height.0));
        }
        LightShape::Disk { radius } => {
            kind = DISK;
            (half_x, half_y) = (x * radius.0, y * radius.0);
        }
        LightShape::Sphere { radius } => {
            kind = SPHERE;
            // The radius of the sphere of equal volume, where the node scales unevenly.
            size = radius.0 * m.matrix3.determinant().abs().cbrt();
        }
    }
    if kind == RECTANGLE || kind == DISK {
        // Perpendicular to the area also under uneven scale; a mirrored node still shines along its own −z.
        let normal = half_x.cross(half_y).normalize_or(z);
        direction = if normal.dot(z) > 0.0 { -normal } else { normal };
    }
    GpuLight {
        position: (Vec3::from(m.translation) - camera).to_array(),
        kind,
        emission: placed.light.emission.0.to_array(),
        size,
        half_x: half_x.to_array(),
        cos_inner,
        half_y: half_y.to_array(),
        cos_outer,
        direction: direction.to_array(),
        _pad: 0.0,
    }
}

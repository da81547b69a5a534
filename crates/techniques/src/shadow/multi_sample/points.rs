//! Points of a light that stand for all of it.

use glam::{Affine3A, Quat, Vec2, Vec3};
use kajo_sampling::warp::{Cone, concentric_disk, uniform_sphere};
use kajo_sampling::{Frame, hammersley_2d};
use kajo_scene::{Light, LightShape, PlacedLight};
use kajo_shader_lib::light::GpuLight;
use kajo_units::Radians;
use std::f32::consts::{FRAC_PI_2, PI};

/// `count` lights without an extent whose mean visibility is that of the light: points of an area, directions of a sun. `None` for lights that have no
/// extent.
///
/// Rectangles and disks are covered evenly, suns by solid angle. Every x sees a sphere as the disk that hides behind it; points that
/// appear evenly spread over that disk from every side lie inside the sphere with a density proportional to 1/√(R² − r²), by the inverse of Abel's
/// transform of a constant.
pub(super) fn points(placed: &PlacedLight, count: u32) -> Option<Vec<PlacedLight>> {
    let light = GpuLight::new(placed, Vec3::ZERO);
    let at = |position: Vec3| named(placed, LightShape::Point, Affine3A::from_translation(position));
    let spread = |place: &dyn Fn(Vec2) -> Vec3| (0..count).map(|i| at(place(hammersley_2d(i, count)))).collect();
    Some(match placed.light.shape {
        LightShape::Rectangle { .. } => spread(&|u| {
            let p = 2.0 * u - 1.0;
            light.position + light.half_x * p.x + light.half_y * p.y
        }),
        LightShape::Disk { .. } => spread(&|u| {
            let p = concentric_disk(u);
            light.position + light.half_x * p.x + light.half_y * p.y
        }),
        LightShape::Sphere { .. } => {
            // A third dimension: the radius, by a step that no short cycle of the other two repeats.
            let radius = |i: u32| light.size * abel_radius((0.5 + i as f32 * PLASTIC_STEP).fract());
            (0..count).map(|i| at(light.position + uniform_sphere(hammersley_2d(i, count)) * radius(i))).collect()
        }
        LightShape::Directional { half_angle } if half_angle.0 > 0.0 => {
            let basis = Frame::from_z(-light.direction);
            let cone = Cone::from_one_minus_cos(light.size);
            let sun = |i: u32| {
                let rotation = Quat::from_rotation_arc(Vec3::Z, basis.to_world(cone.sample(hammersley_2d(i, count))));
                named(placed, LightShape::Directional { half_angle: Radians(0.0) }, Affine3A::from_quat(rotation))
            };
            (0..count).map(sun).collect()
        }
        _ => return None,
    })
}

/// 1/φ₃, φ₃⁴ = φ₃ + 1.    \[Roberts18\]
const PLASTIC_STEP: f32 = 0.819_172_5;

fn named(of: &PlacedLight, shape: LightShape, world_from_light: Affine3A) -> PlacedLight {
    PlacedLight { light: Light { shape, ..of.light.clone() }, world_from_light }
}

/// The radius r in [0, 1] with ∫₀^r 4/π r² (1 − r²)^(−½) dr = u: with r = sin t, (t − sin t cos t) = u π/2. By bisection.
fn abel_radius(u: f32) -> f32 {
    let (mut low, mut high) = (0.0f32, FRAC_PI_2);
    for _ in 0..30 {
        let middle = 0.5 * (low + high);
        if middle - middle.sin() * middle.cos() < u * 0.5 * PI {
            low = middle;
        } else {
            high = middle;
        }
    }
    (0.5 * (low + high)).sin()
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_units::{LinearRgb, Meters};

    fn placed(shape: LightShape) -> PlacedLight {
        let light = Light { name: String::new(), shape, emission: LinearRgb::splat(1.0) };
        let rotation = Quat::from_rotation_x(0.4) * Quat::from_rotation_y(1.1);
        PlacedLight { light, world_from_light: Affine3A::from_rotation_translation(rotation, Vec3::new(1.0, 2.0, 3.0)) }
    }

    fn positions(shape: LightShape, count: u32) -> Vec<Vec3> {
        points(&placed(shape), count).unwrap().iter().map(|p| p.world_from_light.translation.into()).collect()
    }

    #[test]
    fn lights_without_an_extent_are_left_alone() {
        for shape in [LightShape::Point, LightShape::Directional { half_angle: Radians(0.0) }] {
            assert!(points(&placed(shape), 4).is_none());
        }
    }

    /// Seen from any side, as many points lie within half the radius as its share in the disk says, and their spread is that of a disk.
    #[test]
    fn a_sphere_looks_like_an_even_disk_from_every_side() {
        let all = positions(LightShape::Sphere { radius: Meters(2.0) }, 4096);
        for view in [Vec3::X, Vec3::new(1.0, -2.0, 0.5).normalize(), Vec3::new(0.3, 0.2, -1.0).normalize()] {
            let off = |p: &Vec3| (*p - Vec3::new(1.0, 2.0, 3.0)).reject_from_normalized(view).length();
            for share in [0.25f32, 0.5, 0.9] {
                let inside = all.iter().filter(|p| off(p) < 2.0 * share.sqrt()).count() as f32 / all.len() as f32;
                assert!((inside - share).abs() < 0.02, "{view}: {inside} within {share} of the disk");
            }
        }
    }

    #[test]
    fn areas_are_covered_evenly_and_suns_by_their_cone() {
        let all = positions(LightShape::Rectangle { width: Meters(2.0), height: Meters(1.0) }, 1024);
        let world = placed(LightShape::Point).world_from_light;
        let (x, y) = (Vec3::from(world.matrix3.x_axis), Vec3::from(world.matrix3.y_axis));
        let middle = Vec3::from(world.translation);
        let quarter = all.iter().filter(|p| (**p - middle).dot(x) > 0.0 && (**p - middle).dot(y) > 0.0).count();
        assert!((quarter as i32 - 256).abs() < 12, "{quarter}");
        assert!(all.iter().all(|p| (*p - middle).dot(x).abs() < 1.0001 && (*p - middle).dot(y).abs() < 0.5001));
        let suns = points(&placed(LightShape::Directional { half_angle: Radians(0.1) }), 64).unwrap();
        let to_sun = world.matrix3.z_axis;
        let cosine = |p: &PlacedLight| p.world_from_light.matrix3.z_axis.dot(to_sun);
        assert!(suns.iter().all(|p| cosine(p) > 0.0999f32.cos() - 1e-4 && cosine(p) <= 1.0 + 1e-5));
        assert!(suns.iter().map(cosine).fold(1.0, f32::min) < 0.09f32.cos());
    }
}

//! Lights as shaders read them, and the twin of `shader_lib::light`.

use crate::ShaderLayout;
use crate::camera::FAR;
use glam::{Vec2, Vec3};
use kajo_sampling::warp::{self, LightSphere};
use kajo_sampling::{Frame, warp::Cone};
use kajo_scene::{LightShape, PlacedLight};
use std::f32::consts::PI;

/// A light in a buffer: `Light` of `shader_lib::light`, which says what each field holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable, ShaderLayout)]
#[repr(C)]
#[allow(missing_docs, reason = "described where the shader declares it")]
pub struct GpuLight {
    pub position: Vec3,
    pub kind: u32,
    pub emission: Vec3,
    pub size: f32,
    pub half_x: Vec3,
    pub cos_inner: f32,
    pub half_y: Vec3,
    pub cos_outer: f32,
    pub direction: Vec3,
    pub unhidden: f32,
    pub first_triangle: u32,
    pub triangle_count: u32,
    pub instance: u32,
    pub double_sided: u32,
}

/// [`LightShape::Point`] in [`GpuLight::kind`].
pub const POINT: u32 = 0;
/// [`LightShape::Spot`].
pub const SPOT: u32 = 1;
/// [`LightShape::Directional`].
pub const DIRECTIONAL: u32 = 2;
/// [`LightShape::Rectangle`].
pub const RECTANGLE: u32 = 3;
/// [`LightShape::Disk`].
pub const DISK: u32 = 4;
/// [`LightShape::Sphere`].
pub const SPHERE: u32 = 5;
/// An emissive mesh, which this module knows the centre of only.
pub const MESH: u32 = 6;

/// A point of a light seen from a shaded point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightSample {
    /// Unit vector to the light.
    pub wi: Vec3,
    /// To the sampled point, m; [`FAR`] for directional lights.
    pub distance: f32,
    /// Irradiance that this sample stands for on a surface that faces it, W/m²: the mean over u of f_cos(wo, wi) · irradiance is the
    /// unshadowed reflected radiance.
    pub irradiance: Vec3,
}

impl GpuLight {
    /// Packs a placed light; positions become relative to `origin` (the camera). A sphere stays a sphere: its radius grows with the
    /// cube root of the volume that the node's scale gives.
    pub fn new(placed: &PlacedLight, origin: Vec3) -> Self {
        let world = &placed.world_from_light;
        let axis = |v: Vec3| world.transform_vector3(v);
        let shines = axis(-Vec3::Z);
        let base = Self {
            position: Vec3::from(world.translation) - origin,
            emission: placed.light.emission.0,
            direction: shines.normalize_or(-Vec3::Z),
            ..Self::default()
        };
        let flat = |kind, half: Vec2| {
            let (half_x, half_y) = (axis(Vec3::X) * half.x, axis(Vec3::Y) * half.y);
            // The normal of the plane, on the side of −z: with uneven scale it is not the image of −z.
            let normal = half_x.cross(half_y).normalize_or(base.direction);
            let direction = if normal.dot(shines) < 0.0 { -normal } else { normal };
            Self { kind, half_x, half_y, direction, ..base }
        };
        match placed.light.shape {
            LightShape::Point => Self { kind: POINT, ..base },
            LightShape::Spot { inner, outer } => Self { kind: SPOT, cos_inner: inner.0.cos(), cos_outer: outer.0.cos(), ..base },
            // 1 − cos α = 2 sin²(α/2), without the cancellation.
            LightShape::Directional { half_angle } => Self { kind: DIRECTIONAL, size: 2.0 * (0.5 * half_angle.0).sin().powi(2), ..base },
            LightShape::Rectangle { width, height } => flat(RECTANGLE, Vec2::new(width.0, height.0) * 0.5),
            LightShape::Disk { radius } => flat(DISK, Vec2::splat(radius.0)),
            LightShape::Sphere { radius } => Self { kind: SPHERE, size: radius.0 * world.matrix3.determinant().abs().cbrt(), ..base },
        }
    }
}

/// Falloff of a spot light between its cones, [0, 1]: saturate((cos θ − cos θ_o) / max(cos θ_i − cos θ_o, 0.001))².    KHR_lights_punctual
pub fn spot_falloff(cos_angle: f32, cos_inner: f32, cos_outer: f32) -> f32 {
    let t = ((cos_angle - cos_outer) / (cos_inner - cos_outer).max(0.001)).clamp(0.0, 1.0);
    t * t
}

/// A sample of the light for `u` in [0, 1)²: uniform over the area of rectangles and disks, uniform over the solid angle of spheres and
/// directional lights. The mean of the visibility of these samples is the role direct visibility.
pub fn light_sample(light: &GpuLight, point: Vec3, u: Vec2) -> LightSample {
    match light.kind {
        DIRECTIONAL => {
            let wi = Frame::from_z(-light.direction).to_world(Cone::from_one_minus_cos(light.size).sample(u));
            // E = L π sin² α is what faces it, so L Ω = E · 2 / (1 + cos α).
            LightSample { wi, distance: FAR, irradiance: light.emission * (2.0 / (2.0 - light.size)) }
        }
        RECTANGLE => area_sample(light, point, 2.0 * u - 1.0, 4.0),
        DISK => area_sample(light, point, warp::concentric_disk(u), PI),
        SPHERE => sphere_sample(light, point, u),
        _ => punctual_sample(light, point),
    }
}

/// The middle of the light with all of its power (a mesh as if it shone into all directions alike): what a technique uses that takes areas for points.
pub fn light_center(light: &GpuLight, point: Vec3) -> LightSample {
    match light.kind {
        DIRECTIONAL => LightSample { wi: -light.direction, distance: FAR, irradiance: light.emission },
        RECTANGLE => area_sample(light, point, Vec2::ZERO, 4.0),
        DISK => area_sample(light, point, Vec2::ZERO, PI),
        SPHERE => sphere_sample(light, point, Vec2::ZERO),
        _ => punctual_sample(light, point),
    }
}

/// E = I / r², times the falloff of a spot.
fn punctual_sample(light: &GpuLight, point: Vec3) -> LightSample {
    let to_light = light.position - point;
    let distance2 = to_light.length_squared().max(1.0 / FAR);
    let wi = to_light / distance2.sqrt();
    let falloff = if light.kind == SPOT { spot_falloff(-wi.dot(light.direction), light.cos_inner, light.cos_outer) } else { 1.0 };
    LightSample { wi, distance: distance2.sqrt(), irradiance: light.emission / distance2 * falloff }
}

/// A point `at` of the parallelogram or ellipse that half_x and half_y span: L A cos θ_l / r². One-sided.
fn area_sample(light: &GpuLight, point: Vec3, at: Vec2, unit_area: f32) -> LightSample {
    let to_light = light.position + light.half_x * at.x + light.half_y * at.y - point;
    let distance2 = to_light.length_squared().max(1.0 / FAR);
    let wi = to_light / distance2.sqrt();
    let area = unit_area * light.half_x.cross(light.half_y).length();
    let cos_light = (-wi.dot(light.direction)).max(0.0);
    LightSample { wi, distance: distance2.sqrt(), irradiance: light.emission * (area * cos_light / distance2) }
}

/// A direction to the sphere, L Ω. From inside every direction meets it and none of its light arrives: it shines outwards.
fn sphere_sample(light: &GpuLight, point: Vec3, u: Vec2) -> LightSample {
    let to_center = light.position - point;
    let outside2 = to_center.length_squared() - light.size * light.size;
    let sphere = LightSphere::new(point, light.position, light.size);
    let wi = sphere.sample(u);
    let along = wi.dot(to_center);
    // At the rim rounding makes the discriminant negative; the ray then touches the sphere.
    let half_chord = (along * along - outside2).max(0.0).sqrt();
    if outside2 <= 0.0 {
        return LightSample { wi, distance: along + half_chord, irradiance: Vec3::ZERO };
    }
    LightSample { wi, distance: along - half_chord, irradiance: light.emission * sphere.solid_angle() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{Affine3A, Quat};
    use kajo_sampling::hammersley_2d;
    use kajo_scene::Light;
    use kajo_units::{LinearRgb, Meters, Radians};

    fn placed(shape: LightShape, world_from_light: Affine3A) -> PlacedLight {
        PlacedLight { light: Light { name: String::new(), shape, emission: LinearRgb::new(1.0, 2.0, 3.0) }, world_from_light }
    }

    /// Above the origin, shining down.
    fn above(shape: LightShape, height: f32) -> GpuLight {
        let down = Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2);
        GpuLight::new(&placed(shape, Affine3A::from_rotation_translation(down, Vec3::Y * height)), Vec3::ZERO)
    }

    /// Irradiance at the origin on a surface with normal +y, red channel, by 4096 samples.
    fn irradiance(light: &GpuLight) -> f32 {
        let n = 4096;
        (0..n).map(|i| light_sample(light, Vec3::ZERO, hammersley_2d(i, n))).map(|s| s.irradiance.x * s.wi.y.max(0.0)).sum::<f32>()
            / n as f32
    }

    /// Row L-09: E = π L R² / (R² + h²).
    #[test]
    fn disk_of_radius_1_at_height_2_gives_pi_fifth() {
        let disk = above(LightShape::Disk { radius: Meters(1.0) }, 2.0);
        assert!((irradiance(&disk) - PI / 5.0).abs() < 1e-3, "{}", irradiance(&disk));
        let facing_away = GpuLight { direction: Vec3::Y, ..disk };
        assert_eq!(irradiance(&facing_away), 0.0);
    }

    #[test]
    fn sphere_irradiance_is_pi_l_sin2() {
        let sphere = above(LightShape::Sphere { radius: Meters(0.5) }, 2.0);
        assert!((irradiance(&sphere) - PI * 0.0625).abs() < 1e-4);
        assert_eq!(light_center(&sphere, Vec3::ZERO).distance, 1.5);
        let inside = light_sample(&sphere, Vec3::Y * 2.0, Vec2::splat(0.3));
        assert!(inside.irradiance == Vec3::ZERO && (inside.distance - 0.5).abs() < 1e-6);
    }

    #[test]
    fn directional_irradiance_is_the_emission_for_every_half_angle() {
        for half_angle in [0.0, 0.00465, 0.5] {
            let sun = above(LightShape::Directional { half_angle: Radians(half_angle) }, 5.0);
            assert!((irradiance(&sun) - 1.0).abs() < 1e-3, "{half_angle}");
        }
    }

    /// Row L-12.
    #[test]
    fn point_lights_follow_the_inverse_square_and_areas_tend_to_points() {
        let at = |height| light_sample(&above(LightShape::Point, height), Vec3::ZERO, Vec2::ZERO).irradiance.x;
        assert!((at(1.0) / at(2.0) - 4.0).abs() < 1e-5);
        let far = above(LightShape::Disk { radius: Meters(0.5) }, 10.0);
        let as_point = light_center(&far, Vec3::ZERO).irradiance.x;
        assert!((irradiance(&far) / as_point - 1.0).abs() < 0.01);
    }

    #[test]
    fn spots_fall_off_between_their_cones() {
        let spot = above(LightShape::Spot { inner: Radians(0.2), outer: Radians(0.4) }, 1.0);
        let seen_at =
            |angle: f32| light_sample(&spot, Vec3::new(angle.tan(), 0.0, 0.0), Vec2::ZERO).irradiance.x * (1.0 + angle.tan().powi(2));
        assert!((seen_at(0.1) - 1.0).abs() < 1e-4);
        assert!(seen_at(0.3) > 0.05 && seen_at(0.3) < 0.95);
        assert_eq!(seen_at(0.45), 0.0);
    }

    #[test]
    fn scale_grows_areas_and_keeps_the_side_they_shine_to() {
        let mirrored = Affine3A::from_scale(Vec3::new(-2.0, 3.0, 1.0));
        let light = GpuLight::new(&placed(LightShape::Rectangle { width: Meters(1.0), height: Meters(1.0) }, mirrored), Vec3::ZERO);
        assert_eq!(light.direction, -Vec3::Z);
        assert_eq!(4.0 * light.half_x.cross(light.half_y).length(), 6.0);
        let hidden = GpuLight::new(&placed(LightShape::Disk { radius: Meters(1.0) }, Affine3A::from_scale(Vec3::ZERO)), Vec3::ZERO);
        assert!(light_sample(&hidden, Vec3::new(0.0, 0.0, -1.0), Vec2::splat(0.2)).irradiance == Vec3::ZERO);
    }
}

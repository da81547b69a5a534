//! Light as it leaves the analytic lights: the twin of `shader_lib::emission`.

use crate::light::{DIRECTIONAL, DISK, GpuLight, POINT, RECTANGLE, SPHERE, SPOT, spot_falloff};
use glam::{Vec2, Vec3};
use kajo_sampling::Frame;
use kajo_sampling::warp::{Cone, concentric_disk, cosine_hemisphere, uniform_sphere};
use std::f32::consts::{PI, TAU};

/// A ray of light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Emission {
    /// Where it starts, m.
    pub origin: Vec3,
    /// Unit vector in which it goes.
    pub direction: Vec3,
    /// Power that it stands for, W: the mean over u and v is what the light emits; a directional light emits into the sphere.
    pub flux: Vec3,
}

/// A ray of the light for `u` (where) and `v` (whither) in [0, 1)². What directional lights send into the sphere around `center` starts on a disk that covers
/// it; meshes send nothing, for they take the scene's buffers.    \[Keller97]
pub fn emission_sample(light: &GpuLight, u: Vec2, v: Vec2, center: Vec3, radius: f32) -> Emission {
    match light.kind {
        POINT => Emission { origin: light.position, direction: uniform_sphere(v), flux: light.emission * (2.0 * TAU) },
        SPOT => {
            let local = Cone::from_one_minus_cos(1.0 - light.cos_outer).sample(v);
            let falloff = spot_falloff(local.z, light.cos_inner, light.cos_outer);
            let direction = Frame::from_z(light.direction).to_world(local);
            Emission { origin: light.position, direction, flux: light.emission * (falloff * TAU * (1.0 - light.cos_outer)) }
        }
        DIRECTIONAL => {
            let direction = Frame::from_z(light.direction).to_world(Cone::from_one_minus_cos(light.size).sample(v));
            let at = concentric_disk(u) * radius;
            let origin = center + Frame::from_z(direction).to_world(at.extend(-radius));
            // E = L π sin² α, so L Ω = E · 2 / (1 + cos α).
            Emission { origin, direction, flux: light.emission * (2.0 / (2.0 - light.size) * PI * radius * radius) }
        }
        RECTANGLE => area_emission(light, 2.0 * u - 1.0, v, 4.0),
        DISK => area_emission(light, concentric_disk(u), v, PI),
        SPHERE => {
            let normal = uniform_sphere(u);
            let direction = Frame::from_z(normal).to_world(cosine_hemisphere(v));
            let flux = light.emission * (2.0 * TAU * PI * light.size * light.size);
            Emission { origin: light.position + normal * light.size, direction, flux }
        }
        _ => Emission { origin: light.position, direction: light.direction, flux: Vec3::ZERO },
    }
}

/// From the point `at` of the parallelogram or ellipse that half_x and half_y span: π L A.
fn area_emission(light: &GpuLight, at: Vec2, v: Vec2, unit_area: f32) -> Emission {
    let area = unit_area * light.half_x.cross(light.half_y).length();
    let origin = light.position + light.half_x * at.x + light.half_y * at.y;
    let direction = Frame::from_z(light.direction).to_world(cosine_hemisphere(v));
    Emission { origin, direction, flux: light.emission * (PI * area) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::light_sample;
    use glam::{Affine3A, Quat};
    use kajo_sampling::{Rng, hammersley_2d};
    use kajo_scene::{Light, LightShape, PlacedLight};
    use kajo_units::{LinearRgb, Meters, Radians};

    const CENTER: Vec3 = Vec3::new(0.2, -0.5, 0.1);
    const RADIUS: f32 = 3.0;

    const SHAPES: [LightShape; 7] = [
        LightShape::Point,
        LightShape::Spot { inner: Radians(0.3), outer: Radians(0.7) },
        LightShape::Directional { half_angle: Radians(0.0) },
        LightShape::Directional { half_angle: Radians(0.2) },
        LightShape::Rectangle { width: Meters(1.0), height: Meters(0.4) },
        LightShape::Disk { radius: Meters(0.5) },
        LightShape::Sphere { radius: Meters(0.5) },
    ];

    /// At (0, 1.5, 0), shining down and a little aside.
    fn light(shape: LightShape) -> GpuLight {
        let rotation = Quat::from_rotation_x(-1.4) * Quat::from_rotation_y(0.2);
        let world_from_light = Affine3A::from_rotation_translation(rotation, Vec3::Y * 1.5);
        let light = Light { name: String::new(), shape, emission: LinearRgb::new(3.0, 2.0, 1.0) };
        GpuLight::new(&PlacedLight { light, world_from_light }, Vec3::ZERO)
    }

    /// Power over the emission, red channel.
    fn power(light: &GpuLight) -> f32 {
        let mut rng = Rng::new(11);
        let n = 40_000;
        (0..n).map(|_| emission_sample(light, rng.next_2d(), rng.next_2d(), CENTER, RADIUS).flux.x / light.emission.x).sum::<f32>()
            / n as f32
    }

    /// Φ = 4π I; 2π ∫ falloff sin θ dθ I; E π R²; π A L; 4π² r² L.
    #[test]
    fn the_mean_flux_is_the_power_of_the_light() {
        let [inner, outer] = [0.3f32, 0.7].map(f32::cos);
        // The square of a function that is linear in cos θ has a third of its end as its mean.
        let spot = TAU * ((1.0 - inner) + (inner - outer) / 3.0);
        let sun = 2.0 / (1.0 + 0.2f32.cos());
        let disc = PI * RADIUS * RADIUS;
        for (shape, expected) in SHAPES.into_iter().zip([2.0 * TAU, spot, disc, sun * disc, PI * 0.4, PI * PI * 0.25, PI * PI]) {
            let got = power(&light(shape));
            assert!((got / expected - 1.0).abs() < 0.01, "{shape:?}: {got}, {expected}");
        }
    }

    /// Irradiance of cells of the floor, by rays that land there and by [`light_sample`]; the largest difference over the mean.
    fn difference(light: &GpuLight, tilt: f32) -> f32 {
        const SIDE: usize = 4;
        let (low, size) = (Vec2::new(-1.2, -1.0), 2.0);
        let cell = size / SIDE as f32;
        let mut landed = [0.0f64; SIDE * SIDE];
        let n = 400_000u32;
        let mut rng = Rng::new(5);
        for _ in 0..n {
            let ray = emission_sample(light, rng.next_2d(), rng.next_2d(), CENTER, RADIUS);
            let direction = (ray.direction + Vec3::X * tilt).normalize();
            let at = ray.origin - direction * (ray.origin.y / direction.y);
            let place = ((at.truncate().with_y(at.z) - low) / cell).floor();
            if direction.y < 0.0 && place.cmpge(Vec2::ZERO).all() && place.cmplt(Vec2::splat(SIDE as f32)).all() {
                landed[place.y as usize * SIDE + place.x as usize] += f64::from(ray.flux.x) / f64::from(n);
            }
        }
        let expected: Vec<f32> = (0..SIDE * SIDE)
            .map(|i| {
                let corner = low + cell * Vec2::new((i % SIDE) as f32, (i / SIDE) as f32);
                let count = 1024;
                let sample = |k: u32| {
                    let at = corner + cell * hammersley_2d(k, count);
                    let s = light_sample(
                        light,
                        Vec3::new(at.x, 0.0, at.y),
                        Vec2::new((k as f32 * 0.618_034).fract(), (k as f32 * 0.414_21).fract()),
                    );
                    s.irradiance.x * s.wi.y.max(0.0)
                };
                (0..count).map(sample).sum::<f32>() / count as f32
            })
            .collect();
        let mean = expected.iter().sum::<f32>() / expected.len() as f32;
        let density = |i: usize| landed[i] as f32 / (cell * cell);
        (0..SIDE * SIDE).map(|i| (density(i) - expected[i]).abs() / mean).fold(0.0, f32::max)
    }

    /// Rays that land on a floor are the irradiance there: emission and illumination are one light.
    #[test]
    fn rays_that_land_are_the_irradiance() {
        for shape in SHAPES {
            let light = light(shape);
            let difference_here = difference(&light, 0.0);
            assert!(difference_here < 0.06, "{shape:?}: {difference_here}");
            let fault = difference(&light, 0.5);
            // A tilted sun gives a floor the same light.
            assert!(matches!(shape, LightShape::Directional { .. }) || fault > 0.15, "planted fault, {shape:?} tilted: {fault}");
        }
    }
}

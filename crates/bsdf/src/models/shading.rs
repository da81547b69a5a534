//! Light of discrete directions on a surface, by BRDFs and by shading functions, and classic ray tracing's picture of a sphere.
//!
//! ```text
//! L(Θ_r) = Σ_k f_r(Θ_k↔Θ_r) cos θ_k E⊥_k        a BRDF under directional lights of irradiance E⊥        (1.16)
//! L(Θ_r) = Σ_k S_r(Θ_k→Θ_r) L_k                  a shading function under lights of radiance L_k         (2.1)
//! L(Θ_r) = k_a L_a                               the stand-in for light that was reflected before        (2.3)
//! ```
//!
//! Classic ray tracing leaves π out of its lights: the two forms agree where E⊥ = π L_k.

use super::{Kind, Reflectance};
use glam::{DMat3, DVec3};
use std::f64::consts::PI;

/// A light far away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectionalLight {
    /// Unit vector towards it.
    pub direction: DVec3,
    /// L_k, the brightness that classic shading gives it.
    pub radiance: DVec3,
}

impl DirectionalLight {
    /// E⊥ = π L_k, W/m² across the beam: what makes Lambert's BRDF as bright as his shading function.
    pub fn irradiance(&self) -> DVec3 {
        self.radiance * PI
    }
}

/// Radiance that a surface sends to `wo` under lights and constant ambient radiance, all in the surface's frame. Several models are one surface:
/// their parts add, the ambient one once, however many lights there are.
pub fn classic_radiance(surface: &[&dyn Reflectance], wo: DVec3, lights: &[DirectionalLight], ambient: DVec3) -> DVec3 {
    surface.iter().fold(DVec3::ZERO, |sum, model| {
        let seen = if wo.z > 0.0 { model.ambient() * ambient } else { DVec3::ZERO };
        lights.iter().fold(sum + seen, |sum, light| {
            let arriving = match model.kind() {
                Kind::Brdf => light.irradiance(),
                Kind::Bsf => light.radiance,
            };
            sum + model.f_cos(light.direction, wo) * arriving
        })
    })
}

/// A frame around the unit vector `normal` as columns x, y, z; x is as near to east (y up × normal) as can be.
fn frame(normal: DVec3) -> DMat3 {
    let east = DVec3::Y.cross(normal);
    let x = if east.length_squared() > 1e-24 { east.normalize() } else { DVec3::X };
    DMat3::from_cols(x, normal.cross(x), normal)
}

/// Classic ray tracing of a unit sphere, seen along −z without perspective: rays, the nearest hit, [`classic_radiance`] and no interreflection.
/// `size × size` pixels, row 0 on top; pixels beside the sphere are black. Lights are in the world (y up, z to the viewer); the tangent x of the
/// surface points east.
pub fn classic_sphere(surface: &[&dyn Reflectance], lights: &[DirectionalLight], ambient: DVec3, size: usize) -> Vec<DVec3> {
    let coordinate = |i: usize| (2.0 * (i as f64 + 0.5) / size as f64) - 1.0;
    let pixel = |x: f64, y: f64| {
        let rest = 1.0 - x * x - y * y;
        if rest <= 0.0 {
            return DVec3::ZERO;
        }
        let local_from_world = frame(DVec3::new(x, y, rest.sqrt())).transpose();
        let turned: Vec<_> = lights.iter().map(|l| DirectionalLight { direction: local_from_world * l.direction, ..*l }).collect();
        classic_radiance(surface, local_from_world * DVec3::Z, &turned, ambient)
    };
    (0..size * size).map(|i| pixel(coordinate(i % size), -coordinate(i / size))).collect()
}

#[cfg(test)]
mod tests {
    use super::super::{Form, testing::model};
    use super::*;
    use std::sync::Arc;

    fn lights() -> [DirectionalLight; 2] {
        [
            DirectionalLight { direction: DVec3::new(0.5, 0.0, 0.75_f64.sqrt()), radiance: DVec3::new(1.0, 0.8, 0.6) },
            DirectionalLight { direction: DVec3::new(-0.6, 0.64, 0.48), radiance: DVec3::splat(0.3) },
        ]
    }

    fn worst(a: &[DVec3], b: &[DVec3]) -> f64 {
        a.iter().zip(b).fold(0.0, |worst, (a, b)| worst.max((*a - *b).abs().max_element()))
    }

    /// Row BR-4.
    #[test]
    fn lambert_is_the_same_picture_by_brdf_and_by_shading_function() {
        let light = &lights()[..1];
        let picture = |id: &str, kd: &str| classic_sphere(&[&*model(id, &[("kd", kd)], Form::Corrected)], light, DVec3::ZERO, 64);
        let brdf = picture("lambert", "0.8");
        assert!(worst(&brdf, &picture("lambert-bsf", "0.8")) < 1e-12);
        // A half-pixel's light is there at all, and another reflectance is another picture.
        assert!(brdf[32 * 64 + 40].x > 0.5);
        assert!(worst(&brdf, &picture("lambert-bsf", "0.79")) > 1e-3);
    }

    /// Row BR-32: each pixel is Σ S L_k written out by hand at the sphere's normal, and a second picture is bit for bit the first.
    #[test]
    fn classic_ray_tracing_is_the_sum_over_lights_and_repeats_itself() {
        let pairs = [("kd", "0.4"), ("ks", "0.4"), ("n", "50")];
        let phong = model("phong-bsf", &pairs, Form::Corrected);
        let size = 48;
        let picture = classic_sphere(&[&*phong], &lights(), DVec3::ZERO, size);
        let by_hand = |only: usize| -> Vec<DVec3> {
            let pixel = |i: usize| {
                let at = |i: usize| 2.0 * (i as f64 + 0.5) / size as f64 - 1.0;
                let (x, y) = (at(i % size), -at(i / size));
                let n = DVec3::new(x, y, (1.0 - x * x - y * y).max(0.0).sqrt());
                if n.z == 0.0 {
                    return DVec3::ZERO;
                }
                lights()[..only].iter().fold(DVec3::ZERO, |sum, light| {
                    let cos_i = n.dot(light.direction);
                    let cos_alpha = (2.0 * n * cos_i - light.direction).z;
                    let s = if cos_i > 0.0 { 0.4 * cos_i + 0.4 * cos_alpha.max(0.0).powf(50.0) } else { 0.0 };
                    sum + s * light.radiance
                })
            };
            (0..size * size).map(pixel).collect()
        };
        assert!(worst(&picture, &by_hand(2)) < 1e-12);
        assert!(worst(&picture, &by_hand(1)) > 0.1, "a missing light is noticed");
        assert_eq!(picture, classic_sphere(&[&*phong], &lights(), DVec3::ZERO, size));
    }

    /// Row BR-8.
    #[test]
    fn ambient_light_is_added_once_however_many_lights_there_are() {
        let ambient = model("ambient", &[("ka", "0.3,0.2,0.1")], Form::Corrected);
        let radiance = DVec3::new(2.0, 4.0, 8.0);
        let expected = DVec3::new(0.3, 0.2, 0.1) * radiance;
        let wo = DVec3::new(0.6, 0.0, 0.8);
        for count in 0..=2 {
            assert_eq!(classic_radiance(&[&*ambient], wo, &lights()[..count], radiance), expected);
        }
        assert_eq!(classic_radiance(&[&*ambient], -wo, &lights(), radiance), DVec3::ZERO, "seen from below");
        let lambert: Arc<_> = model("lambert", &[], Form::Corrected);
        let lit = classic_radiance(&[&*lambert], wo, &lights(), radiance);
        assert!(lit.x > 0.0);
        let both = classic_radiance(&[&*ambient, &*lambert], wo, &lights(), radiance);
        assert!((both - expected - lit).abs().max_element() < 1e-14, "{both}");
    }
}

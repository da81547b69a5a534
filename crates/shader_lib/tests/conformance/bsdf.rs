//! The lobes one by one.

use crate::compare::{Tolerance, conform};
use crate::points::unit_square;
use glam::{Vec2, Vec3};
use kajo_bsdf::{
    f0_from_ior, film_sensitivity, fresnel_dielectric, fresnel_schlick, fresnel_schlick_average, fresnel_thin_film, ggx_albedo,
    ggx_albedo_average, ggx_d, ggx_d_aniso, ggx_g1, ggx_g1_aniso, ggx_g2, ggx_multiple_scattering_color, ggx_sample_vndf, ggx_visibility,
    ggx_visibility_aniso, ggx_vndf_pdf, glass_albedo, ior_from_f0, sheen_albedo, sheen_d, sheen_lambda, sheen_visibility,
};
use kajo_sampling::{Rng, warp};
use kajo_units::Alpha;

/// A direction above the surface; every fourth one within a degree of the horizon.
pub fn above(rng: &mut Rng, index: usize) -> Vec3 {
    let d = warp::uniform_hemisphere(rng.next_2d());
    if index.is_multiple_of(4) { Vec3::new(d.x, d.y, 0.02 * rng.next_1d() + 1e-4).normalize() } else { d }
}

/// The perceptual roughness of row `index`: both ends of the range come often.
pub fn roughness(rng: &mut Rng, index: usize) -> f32 {
    match index % 8 {
        0 => 1.0,
        1 => 0.04,
        _ => rng.next_1d(),
    }
}

#[test]
fn fresnel_functions_match() {
    let shader = "import shader_lib::bsdf::fresnel::{schlick_weight, fresnel_schlick, fresnel_schlick_average, f0_from_ior, ior_from_f0, fresnel_dielectric};
        fn eval(x: array<f32, 2>) -> array<f32, 6> {
            let f0 = vec3f(0.04, x[1], 0.9);
            return array(fresnel_schlick(f0, vec3f(1.0), x[0]).y, fresnel_schlick_average(f0, vec3f(1.0)).y, f0_from_ior(1.0 + x[1]),
                ior_from_f0(0.98 * x[1]), fresnel_dielectric(x[0], 1.001 + x[1]), fresnel_dielectric(x[0], 0.4 + 0.6 * x[1]));
        }";
    let twin = |x: [f32; 2]| {
        let f0 = Vec3::new(0.04, x[1], 0.9);
        [
            fresnel_schlick(f0, Vec3::ONE, x[0]).y,
            fresnel_schlick_average(f0, Vec3::ONE).y,
            f0_from_ior(1.0 + x[1]),
            ior_from_f0(0.98 * x[1]),
            fresnel_dielectric(x[0], 1.001 + x[1]),
            fresnel_dielectric(x[0], 0.4 + 0.6 * x[1]),
        ]
    };
    // Near the critical angle g is the root of a small difference.
    conform("fresnel", shader, &unit_square(), twin, Tolerance { relative: 1e-3, absolute: 2e-5 });
}

#[test]
fn ggx_functions_match() {
    let mut rng = Rng::new(21);
    let rows: Vec<[f32; 8]> = (0..6000)
        .map(|i| {
            let (o, v, r) = (above(&mut rng, i), above(&mut rng, i / 4), roughness(&mut rng, i));
            [o.x, o.y, o.z, v.x, v.y, v.z, r * r, (r * rng.next_1d()).powi(2).max(1e-3)]
        })
        .collect();
    let shader = "import shader_lib::bsdf::microfacet::{ggx_d, ggx_d_aniso, ggx_g1, ggx_g1_aniso, ggx_g2, ggx_visibility, ggx_visibility_aniso, ggx_vndf_pdf};
        fn eval(x: array<f32, 8>) -> array<f32, 8> {
            let wo = vec3f(x[0], x[1], x[2]);
            let wi = vec3f(x[3], x[4], x[5]);
            let m = normalize(wo + wi);
            let alpha = vec2f(x[6], x[7]);
            return array(ggx_d(x[6], m.z), ggx_d_aniso(alpha, m), ggx_g1(x[6], wo.z), ggx_g1_aniso(alpha, wo), ggx_g2(x[6], wo.z, wi.z),
                ggx_visibility(x[6], wo.z, wi.z), ggx_visibility_aniso(alpha, wo, wi), ggx_vndf_pdf(alpha, wo, m));
        }";
    let twin = |x: [f32; 8]| {
        let (wo, wi) = (Vec3::new(x[0], x[1], x[2]), Vec3::new(x[3], x[4], x[5]));
        let (m, alpha, a) = ((wo + wi).normalize(), Vec2::new(x[6], x[7]), Alpha(x[6]));
        [
            ggx_d(a, m.z),
            ggx_d_aniso(alpha, m),
            ggx_g1(a, wo.z),
            ggx_g1_aniso(alpha, wo),
            ggx_g2(a, wo.z, wi.z),
            ggx_visibility(a, wo.z, wi.z),
            ggx_visibility_aniso(alpha, wo, wi),
            ggx_vndf_pdf(alpha, wo, m),
        ]
    };
    // The isotropic D forms 1 − cos²: at α = 0.0016 near the normal half an ulp of the cosine is 2 % of the lobe.
    conform("ggx", shader, &rows, twin, Tolerance { relative: 3e-2, absolute: 1e-5 });
}

#[test]
fn ggx_lobe_of_the_material_matches_closely() {
    let mut rng = Rng::new(22);
    let rows: Vec<[f32; 8]> = (0..6000)
        .map(|i| {
            let (o, v, r) = (above(&mut rng, i), above(&mut rng, i / 4), roughness(&mut rng, i));
            [o.x, o.y, o.z, v.x, v.y, v.z, (r * r).max(1e-3), (r * rng.next_1d()).powi(2).max(1e-3)]
        })
        .collect();
    let shader = "import shader_lib::bsdf::microfacet::{ggx_d_aniso, ggx_visibility_aniso, ggx_sample_vndf, ggx_vndf_pdf};
        fn eval(x: array<f32, 8>) -> array<f32, 6> {
            let wo = vec3f(x[0], x[1], x[2]);
            let wi = vec3f(x[3], x[4], x[5]);
            let alpha = vec2f(x[6], x[7]);
            let m = normalize(wo + wi);
            let s = ggx_sample_vndf(alpha, wo, vec2f(0.5 + 0.5 * x[3], 0.5 + 0.49 * x[4]));
            return array(ggx_d_aniso(alpha, m) * ggx_visibility_aniso(alpha, wo, wi) * wi.z, ggx_visibility_aniso(alpha, wo, wi),
                ggx_vndf_pdf(alpha, wo, m), s.x, s.y, s.z);
        }";
    let twin = |x: [f32; 8]| {
        let (wo, wi) = (Vec3::new(x[0], x[1], x[2]), Vec3::new(x[3], x[4], x[5]));
        let (m, alpha) = ((wo + wi).normalize(), Vec2::new(x[6], x[7]));
        let s = ggx_sample_vndf(alpha, wo, Vec2::new(0.5 + 0.5 * x[3], 0.5 + 0.49 * x[4]));
        let visibility = ggx_visibility_aniso(alpha, wo, wi);
        [ggx_d_aniso(alpha, m) * visibility * wi.z, visibility, ggx_vndf_pdf(alpha, wo, m), s.x, s.y, s.z]
    };
    conform("ggx lobe", shader, &rows, twin, Tolerance { relative: 5e-4, absolute: 1e-5 });
}

#[test]
fn albedo_tables_match() {
    let shader = "import shader_lib::bsdf::energy::{ggx_albedo, ggx_albedo_average, ggx_multiple_scattering_color, glass_albedo};
        import shader_lib::bsdf::sheen::sheen_albedo;
        fn eval(x: array<f32, 2>) -> array<f32, 7> {
            let e = ggx_albedo(x[0], x[1]);
            let average = ggx_albedo_average(x[0]);
            let color = ggx_multiple_scattering_color(vec3f(0.04, x[1], 1.0), vec3f(1.0), average.x + average.y);
            return array(e.x, e.y, average.x, average.y, color.y, sheen_albedo(x[0], x[1]), glass_albedo(x[0], x[1], 0.4 + 2.0 * x[1]));
        }";
    let twin = |x: [f32; 2]| {
        let (e, average) = (ggx_albedo(x[0], x[1]), ggx_albedo_average(x[0]));
        let color = ggx_multiple_scattering_color(Vec3::new(0.04, x[1], 1.0), Vec3::ONE, average.white());
        [e.f0, e.f90, average.f0, average.f90, color.y, sheen_albedo(x[0], x[1]), glass_albedo(x[0], x[1], 0.4 + 2.0 * x[1])]
    };
    conform("albedo", shader, &unit_square(), twin, Tolerance { relative: 2e-4, absolute: 5e-6 });
}

#[test]
fn sheen_functions_match() {
    let mut rng = Rng::new(23);
    let rows: Vec<[f32; 3]> = (0..4000).map(|_| [rng.next_1d().max(0.01), rng.next_1d(), rng.next_1d().max(1e-3)]).collect();
    let shader = "import shader_lib::bsdf::sheen::{sheen_d, sheen_lambda, sheen_visibility};
        fn eval(x: array<f32, 3>) -> array<f32, 3> {
            return array(sheen_d(x[0], x[1]), sheen_lambda(x[0], x[2]), sheen_visibility(x[0], max(x[1], 1e-3), x[2]));
        }";
    let twin = |x: [f32; 3]| [sheen_d(x[0], x[1]), sheen_lambda(x[0], x[2]), sheen_visibility(x[0], x[1].max(1e-3), x[2])];
    // sin^(1/α) with 1/α up to 100 multiplies the error of a logarithm by 50.
    conform("sheen", shader, &rows, twin, Tolerance { relative: 1e-3, absolute: 1e-5 });
}

#[test]
fn thin_film_matches() {
    let mut rng = Rng::new(24);
    let rows: Vec<[f32; 6]> = (0..4000)
        .map(|i| {
            let thickness = if i % 16 == 0 { 0.02 } else { 1200.0 * rng.next_1d() };
            [
                rng.next_1d(),
                1.0 + 1.5 * rng.next_1d(),
                thickness,
                rng.next_1d(),
                rng.next_1d(),
                if i % 2 == 0 { 0.04 } else { rng.next_1d() },
            ]
        })
        .collect();
    let shader = "import shader_lib::bsdf::thin_film::{fresnel_thin_film, film_sensitivity};
        fn eval(x: array<f32, 6>) -> array<f32, 6> {
            let f = fresnel_thin_film(x[0], x[1], x[2], vec3f(x[3], x[4], x[5]));
            let s = film_sensitivity(x[2], vec3f(0.0, 3.14159265, 1.0));
            return array(f.x, f.y, f.z, s.x, s.y, s.z);
        }";
    let twin = |x: [f32; 6]| {
        let f = fresnel_thin_film(x[0], x[1], x[2], Vec3::new(x[3], x[4], x[5]));
        let s = film_sensitivity(x[2], Vec3::new(0.0, std::f32::consts::PI, 1.0));
        [f.x, f.y, f.z, s.x, s.y, s.z]
    };
    // Cosines of phases up to 20 rad, and differences of channels: absolute, on reflectances in [0, 1].
    conform("thin film", shader, &rows, twin, Tolerance { relative: 1e-4, absolute: 3e-4 });
}

//! The layered glTF material.

use crate::bsdf::{above, roughness};
use crate::compare::{Tolerance, conform};
use glam::Vec3;
use kajo_bsdf::{Bsdf, LobeValues, MaterialParams};
use kajo_sampling::Rng;
use kajo_units::{LinearRgb, PerceptualRoughness, Radians};

/// Numbers of a row: 22 parameters, wo, wi.
const ROW: usize = 30;

const SHADER: &str = "
import shader_lib::bsdf::material::{MaterialParams, bsdf_new, bsdf_view, bsdf_f_cos, bsdf_albedo, gltf_f_cos};
fn eval(x: array<f32, 30>) -> array<f32, 15> {
    let params = MaterialParams(vec3f(x[0], x[1], x[2]), x[3], vec3f(x[4], x[5], x[6]), x[7], vec3f(x[8], x[9], x[10]), x[11],
        normalize(vec3f(x[12], x[13], 1.0)), x[14], x[15], x[16], x[17], x[18], x[19], x[20], x[21] > 0.5, x[22], 1.3, x[23], 0.0);
    let wo = vec3f(x[24], x[25], x[26]);
    let wi = vec3f(x[27], x[28], x[29]);
    let view = bsdf_view(bsdf_new(params), wo);
    let f = bsdf_f_cos(view, wi);
    let g = gltf_f_cos(params, wo, wi);
    let a = bsdf_albedo(view);
    return array(f.diffuse.x, f.diffuse.y, f.diffuse.z, f.specular.x, f.specular.y, f.specular.z, a.diffuse.x, a.diffuse.y, a.diffuse.z,
        a.specular.x, a.specular.y, a.specular.z, g.specular.x, g.specular.y, g.diffuse.z);
}";

fn params(x: &[f32; ROW]) -> MaterialParams {
    MaterialParams {
        base_color: LinearRgb::new(x[0], x[1], x[2]),
        metallic: x[3],
        specular_color: LinearRgb::new(x[4], x[5], x[6]),
        specular: x[7],
        sheen_color: LinearRgb::new(x[8], x[9], x[10]),
        sheen_roughness: PerceptualRoughness(x[11]),
        clearcoat_normal: Vec3::new(x[12], x[13], 1.0).normalize(),
        clearcoat: x[14],
        clearcoat_roughness: PerceptualRoughness(x[15]),
        roughness: PerceptualRoughness(x[16]),
        ior: x[17],
        anisotropy: x[18],
        anisotropy_rotation: Radians(x[19]),
        transmission: x[20],
        thin: x[21] > 0.5,
        iridescence: x[22],
        iridescence_ior: 1.3,
        iridescence_thickness: x[23],
        dispersion: 0.0,
    }
}

fn twin(x: [f32; ROW]) -> [f32; 15] {
    let (params, wo, wi) = (params(&x), Vec3::new(x[24], x[25], x[26]), Vec3::new(x[27], x[28], x[29]));
    let bsdf = Bsdf::new(&params);
    let (LobeValues { diffuse: d, specular: s }, a) = (bsdf.f_cos(wo, wi), bsdf.albedo(wo));
    [
        d[0],
        d[1],
        d[2],
        s[0],
        s[1],
        s[2],
        a.diffuse[0],
        a.diffuse[1],
        a.diffuse[2],
        a.specular[0],
        a.specular[1],
        a.specular[2],
        s[0],
        s[1],
        d[2],
    ]
}

/// Random materials: `layer(rng, row)` switches on what the test is about.
fn rows(seed: u64, layer: impl Fn(&mut Rng, &mut [f32; ROW])) -> Vec<[f32; ROW]> {
    let mut rng = Rng::new(seed);
    (0..3000)
        .map(|i| {
            let mut x = [0.0; ROW];
            x[..3].fill_with(|| rng.next_1d());
            x[3] = [0.0, 1.0, rng.next_1d()][i % 3];
            x[4..8].fill(1.0);
            x[16] = roughness(&mut rng, i);
            x[17] = 1.5;
            x[21] = 1.0;
            layer(&mut rng, &mut x);
            let (wo, wi) = (above(&mut rng, i), above(&mut rng, i / 4));
            x[24..27].copy_from_slice(&wo.to_array());
            x[27..30].copy_from_slice(&wi.to_array());
            x
        })
        .collect()
}

/// Values of a narrow lobe are products of large and small factors; 5e-4 of them is beyond what an image shows.
const TOLERANCE: Tolerance = Tolerance { relative: 5e-4, absolute: 2e-5 };

#[test]
fn base_matches() {
    let rows = rows(31, |rng, x| {
        x[4..8].fill_with(|| rng.next_1d());
        x[17] = 1.0 + 1.5 * rng.next_1d();
    });
    conform("material: metal and dielectric", SHADER, &rows, twin, TOLERANCE);
}

#[test]
fn anisotropy_matches() {
    let rows = rows(32, |rng, x| {
        x[18] = rng.next_1d();
        x[19] = 6.0 * rng.next_1d() - 3.0;
    });
    conform("material: anisotropy", SHADER, &rows, twin, TOLERANCE);
}

#[test]
fn coat_matches() {
    let rows = rows(33, |rng, x| {
        x[12..14].fill_with(|| 0.8 * rng.next_1d() - 0.4);
        x[14] = rng.next_1d();
        x[15] = if rng.next_1d() < 0.2 { 0.0 } else { rng.next_1d().max(0.05) };
    });
    conform("material: clear coat", SHADER, &rows, twin, TOLERANCE);
}

#[test]
fn sheen_matches() {
    let rows = rows(34, |rng, x| {
        x[8..12].fill_with(|| rng.next_1d());
    });
    conform("material: sheen", SHADER, &rows, twin, Tolerance { relative: 1e-3, absolute: 5e-5 });
}

/// Light from behind does not reach the comparison: every wi is above the surface.
#[test]
fn reflection_of_transmissive_materials_matches() {
    let rows = rows(35, |rng, x| {
        x[3] *= 0.5;
        x[17] = 1.05 + rng.next_1d();
        x[20] = rng.next_1d();
        x[21] = (rng.next_1d() < 0.5).into();
    });
    conform("material: transmission", SHADER, &rows, twin, TOLERANCE);
}

#[test]
fn iridescence_matches() {
    let rows = rows(36, |rng, x| {
        x[22] = rng.next_1d();
        x[23] = 100.0 + 500.0 * rng.next_1d();
    });
    // As thin_film_matches: differences of cosines.
    conform("material: iridescence", SHADER, &rows, twin, Tolerance { relative: 2e-3, absolute: 2e-4 });
}

#[test]
fn all_layers_together_match_from_both_sides() {
    let mut both = rows(37, |rng, x| {
        x[8..12].fill_with(|| rng.next_1d());
        x[14] = rng.next_1d();
        x[15] = rng.next_1d().max(0.05);
        x[18] = rng.next_1d();
        x[20] = rng.next_1d();
        x[22] = rng.next_1d();
        x[23] = 300.0;
    });
    for x in both.iter_mut().step_by(2) {
        x[26] = -x[26];
        x[29] = -x[29];
    }
    conform("material: all layers", SHADER, &both, twin, Tolerance { relative: 2e-3, absolute: 2e-4 });
}

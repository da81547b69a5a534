//! The layered glTF material.

use crate::bsdf::{above, roughness};
use crate::compare::{Tolerance, compare};
use crate::gpu;
use glam::Vec3;
use kajo_bsdf::{Bsdf, MaterialParams};
use kajo_render_graph::Device;
use kajo_sampling::Rng;
use kajo_units::{LinearRgb, PerceptualRoughness, Radians};

/// Numbers of a row: 22 parameters, wo, wi.
const ROW: usize = 30;

const SHADER: &str = "
import shader_lib::bsdf::material::{MaterialParams, bsdf_new, bsdf_view, bsdf_f_cos, bsdf_albedo};
fn eval(x: array<f32, 30>) -> array<f32, 12> {
    let params = MaterialParams(vec3f(x[0], x[1], x[2]), x[3], vec3f(x[4], x[5], x[6]), x[7], vec3f(x[8], x[9], x[10]), x[11],
        normalize(vec3f(x[12], x[13], 1.0)), x[14], x[15], x[16], x[17], x[18], x[19], x[20], x[21] > 0.5, x[22], 1.3, x[23], 0.0);
    let wo = vec3f(x[24], x[25], x[26]);
    let wi = vec3f(x[27], x[28], x[29]);
    let view = bsdf_view(bsdf_new(params), wo);
    let f = bsdf_f_cos(view, wi);
    let a = bsdf_albedo(view);
    return array(f.diffuse.x, f.diffuse.y, f.diffuse.z, f.specular.x, f.specular.y, f.specular.z, a.diffuse.x, a.diffuse.y, a.diffuse.z,
        a.specular.x, a.specular.y, a.specular.z);
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

fn twin(x: [f32; ROW]) -> [f32; 12] {
    let (params, wo, wi) = (params(&x), Vec3::new(x[24], x[25], x[26]), Vec3::new(x[27], x[28], x[29]));
    let bsdf = Bsdf::new(&params);
    let (f, a) = (bsdf.f_cos(wo, wi), bsdf.albedo(wo));
    let [d, s, da, sa] = [f.diffuse, f.specular, a.diffuse, a.specular].map(|color| color.0);
    [d.x, d.y, d.z, s.x, s.y, s.z, da.x, da.y, da.z, sa.x, sa.y, sa.z]
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

/// Compares one family of materials; `relative` tolerance, and a tenth of it absolute (values are albedos, or lobes over them).
fn check(device: &Device, name: &str, rows: &[[f32; ROW]], relative: f32) -> Result<(), String> {
    let gpu = gpu::evaluate(device, "material", SHADER, rows);
    let cpu: Vec<_> = rows.iter().map(|&row| twin(row)).collect();
    let tolerance = Tolerance { relative, absolute: 0.1 * relative };
    let scaled: Vec<_> = cpu.iter().map(|row| row.map(|value| value * (1.0 + 4.0 * relative))).collect();
    assert!(compare(rows, &gpu, &scaled, tolerance).is_err(), "{name}: a scaled twin passed");
    compare(rows, &gpu, &cpu, tolerance).map_err(|message| format!("{name}: {message}"))
}

/// Row `x` with isotropic facets of the same product of widths.
fn of_equal_area(mut x: [f32; ROW]) -> [f32; ROW] {
    let narrow = x[16] * x[16];
    let wide = narrow + (1.0 - narrow) * x[18] * x[18];
    (x[16], x[18]) = ((wide * narrow).powf(0.25), 0.0);
    x
}

/// Planted fault: a diffuse lobe with the energy that facets of equal area leave it.
fn check_that_energy_of_equal_area_fails(device: &Device, rows: &[[f32; ROW]]) {
    let gpu: Vec<[f32; 12]> = gpu::evaluate(device, "material", SHADER, rows);
    let wrong = |row: &[f32; ROW]| {
        let (mut out, diffuse) = (twin(*row), twin(of_equal_area(*row)));
        out[..3].copy_from_slice(&diffuse[..3]);
        out
    };
    let wrong: Vec<_> = rows.iter().map(wrong).collect();
    let tolerance = Tolerance { relative: 1e-2, absolute: 1e-3 };
    assert!(compare(rows, &gpu, &wrong, tolerance).is_err(), "the energy of equal area passed");
}

/// One test, so that its long shader is compiled once.
#[test]
fn layered_material_matches() {
    let Some(device) = gpu::device() else { return };
    let base = rows(31, |rng, x| {
        x[4..8].fill_with(|| rng.next_1d());
        x[17] = 1.0 + 1.5 * rng.next_1d();
    });
    let anisotropic_metal = rows(32, |rng, x| {
        x[3] = 1.0;
        x[18] = rng.next_1d();
        x[19] = 6.0 * rng.next_1d() - 3.0;
    });
    let coat = rows(33, |rng, x| {
        x[12..14].fill_with(|| 0.8 * rng.next_1d() - 0.4);
        x[14] = rng.next_1d();
        x[15] = if rng.next_1d() < 0.2 { 0.0 } else { rng.next_1d().max(0.05) };
    });
    let sheen = rows(34, |rng, x| x[8..12].fill_with(|| rng.next_1d()));
    // Light from behind does not reach the comparison: every wi is above the surface.
    let transmissive = rows(35, |rng, x| {
        x[3] *= 0.5;
        x[17] = 1.05 + rng.next_1d();
        x[20] = rng.next_1d();
        x[21] = (rng.next_1d() < 0.5).into();
    });
    let iridescent = rows(36, |rng, x| {
        x[22] = rng.next_1d();
        x[23] = 100.0 + 500.0 * rng.next_1d();
    });
    let mut all = rows(37, |rng, x| {
        x[8..12].fill_with(|| rng.next_1d());
        x[14] = rng.next_1d();
        x[15] = rng.next_1d().max(0.05);
        x[18] = rng.next_1d();
        x[19] = 6.0 * rng.next_1d() - 3.0;
        x[20] = rng.next_1d();
        x[22] = rng.next_1d();
        x[23] = 300.0;
    });
    // From below: a surface looks the same from both sides, and glass knows its inside.
    for x in all.iter_mut().step_by(2) {
        x[26] = -x[26];
        x[29] = -x[29];
    }
    let anisotropic_dielectric = rows(38, |rng, x| {
        x[3] = 0.0;
        x[17] = 1.0 + 1.5 * rng.next_1d();
        x[18] = rng.next_1d();
        x[19] = 6.0 * rng.next_1d() - 3.0;
    });
    let mut anisotropic_glass = rows(39, |rng, x| {
        x[3] *= 0.5;
        x[17] = 1.05 + rng.next_1d();
        x[18] = rng.next_1d();
        x[19] = 6.0 * rng.next_1d() - 3.0;
        x[20] = rng.next_1d();
        x[21] = (rng.next_1d() < 0.3).into();
    });
    for x in anisotropic_glass.iter_mut().step_by(2) {
        x[26] = -x[26];
        x[29] = -x[29];
    }
    let anisotropic_film = rows(40, |rng, x| {
        x[18] = rng.next_1d();
        x[19] = 6.0 * rng.next_1d() - 3.0;
        x[22] = rng.next_1d();
        x[23] = 100.0 + 500.0 * rng.next_1d();
    });
    let results = [
        // Values of a narrow lobe are products of large and small factors.
        check(&device, "metal and dielectric", &base, 5e-4),
        check(&device, "anisotropic metal", &anisotropic_metal, 1e-3),
        check(&device, "anisotropic dielectric", &anisotropic_dielectric, 1e-3),
        check(&device, "anisotropic glass", &anisotropic_glass, 1e-3),
        check(&device, "anisotropic film", &anisotropic_film, 5e-3),
        check(&device, "clear coat", &coat, 5e-4),
        // sin^(1/α) multiplies the error of a logarithm.
        check(&device, "sheen", &sheen, 1e-3),
        check(&device, "transmission", &transmissive, 5e-4),
        // Differences of cosines of phases; the mean of the layer's albedo is linear between nodes.
        check(&device, "iridescence", &iridescent, 5e-3),
        check(&device, "all layers", &all, 5e-3),
    ];
    check_that_energy_of_equal_area_fails(&device, &anisotropic_dielectric);
    let failures: Vec<String> = results.into_iter().filter_map(Result::err).collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

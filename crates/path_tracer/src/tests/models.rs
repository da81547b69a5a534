//! Surfaces with models of the library: row BR-31.

use super::scenes::{Stage, at, floor, render_at, sized};
use crate::{Integrator, Settings};
use glam::{DVec3, Vec3};
use kajo_bsdf::models::{Form, V3, all, find, merl, rgl};
use kajo_bsdf_lab::albedo;
use kajo_scene::{Material, ReflectanceModel, Scene};

fn material(id: &str, pairs: &[(&str, &str)]) -> Material {
    let model = ReflectanceModel::new(find(id).unwrap(), pairs, Form::Corrected).unwrap();
    model.replace_reflection(Material::default())
}

/// A floor of the material under a sky of radiance 1, seen from `degrees` off its normal along the tangent.
fn under_a_white_sky(material: Material, degrees: f32) -> Scene {
    let (sin, cos) = degrees.to_radians().sin_cos();
    Stage::default()
        .mesh(floor(), material, at(Vec3::ZERO))
        .environment(1.0)
        .orthographic(5.0 * Vec3::new(sin, cos, 0.0), Vec3::ZERO, 1.0)
        .0
}

/// Mean over all pixels and channels, and its standard error from their spread.
fn mean_and_error(scene: &Scene, settings: &Settings) -> (f64, f64) {
    let frame = render_at(scene, settings, 64);
    let values: Vec<f64> = frame.beauty().pixels().iter().map(|p| f64::from(p.0.element_sum()) / 3.0).collect();
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    (mean, (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n * (n - 1.0))).sqrt())
}

/// How far the path tracer's mean lies from quadrature for a surface seen from `degrees`, in units of what four standard errors allow.
fn off(id: &str, pairs: &[(&str, &str)], degrees: f32, integrator: Integrator) -> f64 {
    let model = find(id).unwrap().from_pairs(pairs, Form::Corrected).unwrap();
    let wo: DVec3 = V3::from_angles(f64::from(degrees).to_radians(), 0.0).into();
    let exact = albedo(&*model, wo, 1e-6).element_sum() / 3.0;
    let settings = Settings { integrator, max_depth: 1, ..sized(16, 16) };
    let (mean, error) = mean_and_error(&under_a_white_sky(material(id, pairs), degrees), &settings);
    // 1e-4 for models without noise.
    (mean - exact).abs() / (4.0 * error + 1e-4)
}

/// Row BR-31. Every model, through the path tracer with next-event estimation and without, reflects what quadrature says; 4 σ: some hundred comparisons.
#[test]
fn every_model_reflects_its_albedo_under_a_white_sky() {
    let defaults = all().filter(|entry| entry.wesl.is_some() && entry.id != "ambient").map(|entry| (entry.id, &[][..]));
    // Smooth enough that a good part of what it reflects is a perfect mirror.
    let mirrors = [("htsg", &[("sigma0", "0.05"), ("tau", "3")][..])];
    for (id, pairs) in defaults.chain(mirrors) {
        for degrees in [20.0, 65.0] {
            for integrator in [Integrator::Path, Integrator::BsdfOnly] {
                let off = off(id, pairs, degrees, integrator);
                assert!(off < 1.0, "{id} {pairs:?} at {degrees}°, {integrator:?}: {off} times the bound");
            }
        }
    }
}

/// The same of tables, through their files: Ward as MERL has it, brushed GGX as RGL has it, each from along the tangent.
#[test]
fn tables_of_files_reflect_their_albedo_under_a_white_sky() {
    let folder = std::env::temp_dir();
    let file = |name: &str| folder.join(format!("kajo-white-sky-{}-{name}", std::process::id())).to_string_lossy().into_owned();
    let (ward, brushed) = (file("ward.binary"), file("brushed.bsdf"));
    merl::Table::of_model(&*find("ward").unwrap().from_pairs(&[("m", "0.2")], Form::Corrected).unwrap()).write(&ward).unwrap();
    let ggx = find("ggx").unwrap().from_pairs(&[("alpha_x", "0.15"), ("alpha_y", "0.5"), ("f0", "0.8")], Form::Corrected).unwrap();
    let coarse = rgl::Resolution { phi_i: 9, theta_i: 6, normals: [32, 32], samples: 16, ..rgl::Resolution::ANISOTROPIC };
    rgl::Table::of_model(&*ggx, coarse).write(&brushed).unwrap();
    for (id, path) in [("merl", &ward), ("rgl", &brushed)] {
        for (degrees, integrator) in [(20.0, Integrator::Path), (65.0, Integrator::BsdfOnly)] {
            let off = off(id, &[("file", path)], degrees, integrator);
            assert!(off < 1.0, "{id} at {degrees}°, {integrator:?}: {off} times the bound");
        }
    }
    [ward, brushed].into_iter().for_each(|path| std::fs::remove_file(path).unwrap());
}

#[test]
fn a_wrong_model_would_be_noticed() {
    let scene = under_a_white_sky(material("phong", &[("ks", "0.40")]), 65.0);
    let other = find("phong").unwrap().from_pairs(&[("ks", "0.42")], Form::Corrected).unwrap();
    let wo: DVec3 = V3::from_angles(65f64.to_radians(), 0.0).into();
    let (mean, error) = mean_and_error(&scene, &Settings { max_depth: 1, ..sized(16, 16) });
    assert!((mean - albedo(&*other, wo, 1e-6).x).abs() > 4.0 * error + 1e-4, "{mean} ± {error}");
}

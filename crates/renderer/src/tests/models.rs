//! Reflectance models of the library as pictures: the real-time renderer's direct light against the path tracer's.

use super::scenes::*;
use glam::UVec2;
use kajo_bsdf::models::{Form, ModelEntry, all, factored, find, merl, nmf, rgl, tucker};
use kajo_image::{ToneMap, tone_map};
use kajo_path_tracer::{Aov, Pixels};
use kajo_render_graph::Device;
use kajo_scene::{Light, LightShape, Material, ReflectanceModel, Scene};
use kajo_units::LinearRgb;
use std::path::Path;

/// A model with some of its parameters.
type Chosen<'a> = (&'static ModelEntry, &'a [(&'a str, &'a str)]);

/// `builtin:spheres` with models on its spheres, in the order of the materials. A point of light hangs where its first soft box does, and nothing
/// else shines: what can be compared without noise, for one light is no choice among many.
fn spheres(models: &[Chosen]) -> Scene {
    let mut scene = kajo_scene::load("builtin:spheres", &Default::default()).unwrap();
    scene.environment = None;
    scene.lights[0] = Light { shape: LightShape::Point, emission: LinearRgb::splat(60.0), ..scene.lights[0].clone() };
    scene.lights.truncate(1);
    scene.nodes.iter_mut().filter(|node| node.light > Some(0)).for_each(|node| node.light = None);
    let spheres = first_sphere(&scene);
    for (material, (entry, pairs)) in scene.materials[spheres..].iter_mut().zip(models) {
        let named = Material { name: material.name.clone(), ..Material::default() };
        *material = ReflectanceModel::new(entry, pairs, Form::Corrected).unwrap().replace_reflection(named);
    }
    // Spheres without a model keep what glTF says, without their own light.
    scene.materials.iter_mut().for_each(|material| material.emission = LinearRgb::BLACK);
    scene
}

/// The number of the first material that is a sphere's; those of the ground and of the steps come before.
fn first_sphere(scene: &Scene) -> usize {
    scene.materials.iter().position(|material| material.name == "lambert").unwrap()
}

/// For each of the first `count` spheres the share of its pixels whose direct light is off by more than `steps`/255 after tone mapping.
fn shares_off(device: &Device, scene: &Scene, reference_of: &Scene, count: usize, steps: u8) -> Vec<f64> {
    let size = UVec2::new(384, 216);
    let got = frame(device, scene, size, "shadow/ray-traced", &[]);
    let direct = tone_map(&got.direct, 0.0, ToneMap::PbrNeutral);
    let expected = reference(reference_of, START, None, size, 1, vec![Aov::Direct]);
    let Pixels::Color(expected) = &expected.image("direct").unwrap().pixels else { panic!("direct light is a colour") };
    let expected = tone_map(expected, 0.0, ToneMap::PbrNeutral);
    let material = got.gbuffer.unwrap().material;
    let (mut off, mut all) = (vec![0.0; count], vec![0.0; count]);
    for y in 0..size.y {
        for x in 0..size.x {
            let sphere = material.get(x, y).and_then(|index| (index as usize).checked_sub(first_sphere(scene)));
            if let Some(sphere) = sphere.filter(|&sphere| sphere < count) {
                let far = direct.get(x, y).0.iter().zip(expected.get(x, y).0).any(|(a, b)| a.abs_diff(b) > steps);
                all[sphere] += 1.0;
                off[sphere] += f64::from(u8::from(far));
            }
        }
    }
    off.iter().zip(all).map(|(off, all)| off / all).collect()
}

#[test]
fn direct_light_of_every_model_looks_like_the_path_tracer() {
    let device = Device::new().unwrap();
    let models: Vec<Chosen> = all().filter(|entry| entry.wesl.is_some() && entry.id != "ambient").map(|entry| (entry, &[][..])).collect();
    for group in models.chunks(18) {
        let scene = spheres(group);
        for ((entry, _), share) in group.iter().zip(shares_off(&device, &scene, &scene, group.len(), 1)) {
            // On the silhouette and at the edge of a shadow one pixel may see the light where the other does not.
            assert!(share < 0.005, "{}: {share} of the pixels", entry.id);
        }
    }
    let phong = find("phong").unwrap();
    let fault = shares_off(&device, &spheres(&[(phong, &[])]), &spheres(&[(phong, &[("kd", "0.43")])]), 1, 1);
    assert!(fault[0] > 0.3, "planted fault, a brighter reference: {fault:?}");
}

/// Writes files for each model of files, of lobes that they can hold, and says where: model and path.
fn write_files(folder: &Path) -> Vec<(&'static ModelEntry, String)> {
    std::fs::create_dir_all(folder).unwrap();
    let formula = |id: &str, pairs: &[(&str, &str)]| find(id).unwrap().from_pairs(pairs, Form::Corrected).unwrap();
    let path = |name: &str| folder.join(name).to_str().unwrap().to_owned();
    let ward = formula("ward", &[("kd", "0.3,0.2,0.1"), ("ks", "0.1"), ("m", "0.2")]);
    merl::Table::of_model(&*ward).write(&path("ward.binary")).unwrap();
    let brushed = formula("ggx", &[("alpha_x", "0.2"), ("alpha_y", "0.5"), ("f0", "0.9,0.5,0.2")]);
    let few = rgl::Resolution { phi_i: 17, theta_i: 12, ..rgl::Resolution::ANISOTROPIC };
    rgl::Table::of_model(&*brushed, few).write(&path("brushed.bsdf")).unwrap();
    rgl::Table::of_model(&*ward, rgl::Resolution::ISOTROPIC).write(&path("ward.bsdf")).unwrap();
    let grid = factored::Grid { theta_h: 32, phi_h: 8, theta_o: 8, phi_o: 1, channels: 3 };
    // 0.2 exp(−(θ_h/θ_0)²), the less the farther from the normal the viewer is.
    let lobe: Vec<f32> = (0..grid.theta_h).map(|k| 0.2 * (-30.0 * (k as f32 / 31.0).powi(4)).exp()).collect();
    let views: Vec<f32> = (0..grid.theta_o).map(|k| 1.0 - k as f32 / 8.0).collect();
    let (tint, diffuse) = ([1.0, 0.8, 0.4], vec![0.1, 0.2, 0.3]);
    let tinted = views.iter().flat_map(|view| tint.map(|c| c * view)).collect();
    let factors = nmf::Factors {
        grid,
        diffuse: diffuse.clone(),
        outer: 1,
        inner: 1,
        views: tinted,
        inclinations: lobe.clone(),
        azimuths: vec![1.0; grid.phi_h],
    };
    std::fs::write(path("lobe.nmf"), factors.to_bytes()).unwrap();
    let pass = tucker::Pass { functions: [tint.to_vec(), views, vec![1.0], lobe, vec![1.0; grid.phi_h]], core: vec![1.0] };
    let factors = tucker::Factors { grid, diffuse, rank: 1, passes: vec![pass] };
    std::fs::write(path("lobe.tucker"), factors.to_bytes()).unwrap();
    let file = |id: &str, name: &str| (find(id).unwrap(), path(name));
    vec![
        file("merl", "ward.binary"),
        file("rgl", "brushed.bsdf"),
        file("rgl", "ward.bsdf"),
        file("nmf", "lobe.nmf"),
        file("tucker", "lobe.tucker"),
    ]
}

#[test]
fn direct_light_of_models_of_files_looks_like_the_path_tracer() {
    let device = Device::new().unwrap();
    let folder = std::env::temp_dir().join(format!("kajo-renderer-models-{}", std::process::id()));
    let files = write_files(&folder);
    let pairs: Vec<[(&str, &str); 1]> = files.iter().map(|(_, path)| [("file", path.as_str())]).collect();
    let models: Vec<Chosen> = files.iter().zip(&pairs).map(|((entry, _), pairs)| (*entry, &pairs[..])).collect();
    let scene = spheres(&models);
    let mut matt = scene.clone();
    let first = first_sphere(&scene);
    matt.materials[first..first + models.len()].iter_mut().for_each(|material| material.model = None);
    // Files of the second kind have edges at their nodes, and anisotropic tables fewer nodes of their own.
    let is_fine = |(entry, _): &Chosen| entry.id != "rgl";
    for (steps, fine) in [(1, true), (4, false)] {
        let shares = shares_off(&device, &scene, &scene, models.len(), steps);
        let faults = shares_off(&device, &matt, &scene, models.len(), steps);
        for ((model, share), fault) in models.iter().zip(shares).zip(faults).filter(|((model, _), _)| is_fine(model) == fine) {
            assert!(share < 0.005, "{model:?}: {share} of the pixels are off by more than {steps}/255");
            assert!(fault > 0.2, "planted fault, {model:?} as a matt surface: {fault} of the pixels");
        }
    }
    let notes = renderer(&device, &scene, UVec2::new(16, 16), None).ignored();
    for (entry, _) in &models {
        let note = notes.iter().find(|note| note.feature == entry.title).unwrap();
        assert!(note.consequence.contains("read from a table"), "{}", note.consequence);
    }
    std::fs::remove_dir_all(folder).unwrap();
}

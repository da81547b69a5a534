//! Reflectance models of the library as pictures: the real-time renderer's direct light against the path tracer's.

use super::scenes::*;
use glam::UVec2;
use kajo_bsdf::models::{Form, ModelEntry, all, find};
use kajo_image::{ToneMap, tone_map};
use kajo_path_tracer::{Aov, Pixels};
use kajo_render_graph::Device;
use kajo_scene::{Light, LightShape, Material, ReflectanceModel, Scene};
use kajo_units::LinearRgb;

/// A model with some of its parameters.
type Chosen = (&'static ModelEntry, &'static [(&'static str, &'static str)]);

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

/// For each of the first `count` spheres the share of its pixels whose direct light is off by more than 1/255 after tone mapping.
fn shares_off(device: &Device, scene: &Scene, reference_of: &Scene, count: usize) -> Vec<f64> {
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
                let far = direct.get(x, y).0.iter().zip(expected.get(x, y).0).any(|(a, b)| a.abs_diff(b) > 1);
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
        for ((entry, _), share) in group.iter().zip(shares_off(&device, &scene, &scene, group.len())) {
            // On the silhouette and at the edge of a shadow one pixel may see the light where the other does not.
            assert!(share < 0.005, "{}: {share} of the pixels", entry.id);
        }
    }
    let phong = find("phong").unwrap();
    let fault = shares_off(&device, &spheres(&[(phong, &[])]), &spheres(&[(phong, &[("kd", "0.43")])]), 1);
    assert!(fault[0] > 0.3, "planted fault, a brighter reference: {fault:?}");
}

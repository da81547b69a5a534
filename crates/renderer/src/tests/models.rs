//! Reflectance models of the library as pictures: the real-time renderer's direct light against the path tracer's.

use super::scenes::*;
use glam::{Affine3A, UVec2, Vec3};
use kajo_bsdf::models::{Form, ModelEntry, all};
use kajo_image::{ToneMap, tone_map};
use kajo_path_tracer::{Aov, Pixels};
use kajo_render_graph::Device;
use kajo_scene::{LightShape, Material, Projection, ReflectanceModel, Scene, shapes};
use kajo_units::{Meters, Radians};

/// Pixels of a sphere's cell.
const CELL: u32 = 48;

/// A sphere of each model in parallel light, a row of cells: what can be compared without noise, in one scene because a shader is compiled for it.
fn spheres(models: &[(&'static ModelEntry, &[(&str, &str)])]) -> Scene {
    let mut scene = Scene::default();
    for (i, (entry, pairs)) in models.iter().enumerate() {
        let material = ReflectanceModel::new(entry, pairs, Form::Corrected).unwrap().replace_reflection(Material::default());
        let at = Vec3::X * (2.0 * i as f32 + 1.0 - models.len() as f32);
        place(&mut scene, shapes::sphere(0.9, 96), material, Affine3A::from_translation(at));
    }
    light(&mut scene, LightShape::Directional { half_angle: Radians(0.0) }, 2.0, Vec3::ZERO, Vec3::new(-0.2, -0.7, -1.2));
    let parallel = Projection::Orthographic { xmag: Meters(models.len() as f32), ymag: Meters(1.0) };
    camera(&mut scene, parallel, Vec3::new(0.0, 0.0, 5.0), Vec3::ZERO);
    scene
}

/// For each cell the share of pixels whose direct light is off by more than 1/255 after tone mapping.
fn shares_off(device: &Device, scene: &Scene, reference_of: &Scene) -> Vec<f64> {
    let cells = scene.meshes.len() as u32;
    let size = UVec2::new(cells * CELL, CELL);
    let got = tone_map(&frame(device, scene, size, "shadow/ray-traced", &[]).direct, 0.0, ToneMap::PbrNeutral);
    let expected = reference(reference_of, START, None, size, 1, vec![Aov::Direct]);
    let Pixels::Color(expected) = &expected.image("direct").unwrap().pixels else { panic!("direct light is a colour") };
    let expected = tone_map(expected, 0.0, ToneMap::PbrNeutral);
    let off = |x, y| got.get(x, y).0.iter().zip(expected.get(x, y).0).any(|(a, b)| a.abs_diff(b) > 1);
    let count = |cell: u32| (0..CELL * CELL).filter(|i| off(cell * CELL + i % CELL, i / CELL)).count();
    (0..cells).map(|cell| count(cell) as f64 / f64::from(CELL * CELL)).collect()
}

#[test]
fn direct_light_of_every_model_looks_like_the_path_tracer() {
    let device = Device::new().unwrap();
    let all: Vec<_> = all().filter(|entry| entry.wesl.is_some() && entry.id != "ambient").map(|entry| (entry, &[][..])).collect();
    let scene = spheres(&all);
    for ((entry, _), share) in all.iter().zip(shares_off(&device, &scene, &scene)) {
        // On the silhouette and at the terminator one pixel may see the surface where the other does not.
        assert!(share < 0.005, "{}: {share} of the pixels", entry.id);
    }
    let phong = kajo_bsdf::models::find("phong").unwrap();
    let fault = shares_off(&device, &spheres(&[(phong, &[])]), &spheres(&[(phong, &[("kd", "0.43")])]));
    assert!(fault[0] > 0.1, "planted fault, a brighter reference: {fault:?}");
}

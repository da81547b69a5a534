//! Reflectance models of the library: the GPU's side of each against the CPU's, as functions and as pictures.

use super::scenes::*;
use glam::{Affine3A, UVec2, UVec3, Vec3, Vec4};
use kajo_bsdf::models::{Form, ModelEntry, all};
use kajo_image::{ToneMap, tone_map};
use kajo_path_tracer::{Aov, Pixels};
use kajo_render_graph::wgpu::BufferUsages;
use kajo_render_graph::{Bindings, ComputePipeline, Device, PipelineOptions, Shader, readback};
use kajo_scene::{LightShape, Material, Projection, ReflectanceModel, Scene, shapes};
use kajo_shader_lib::BSDF_TABLES;
use kajo_shader_lib::models::{MOST_CONSTANTS, number};
use kajo_techniques::{TraceBackend, shaders};
use kajo_units::{Meters, Radians};

const ROOT: &str = "
    import package::models::model_f_cos;
    import shader_lib::models::geometry::ModelConstants;
    @group(1) @binding(0) var<storage, read> constants: array<ModelConstants>;
    @group(1) @binding(1) var<storage, read> directions: array<vec4f>;
    @group(1) @binding(2) var<storage, read_write> values: array<vec4f>;
    override model: u32 = 0u;
    @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3u) {
        if id.x >= arrayLength(&values) { return; }
        values[id.x] = vec4f(model_f_cos(model, constants[0], directions[2u * id.x].xyz, directions[2u * id.x + 1u].xyz), 0.0);
    }";

/// Models with a side on the GPU.
fn models() -> impl Iterator<Item = &'static ModelEntry> {
    all().filter(|entry| entry.wesl.is_some())
}

/// Pairs over the sphere, some of them mirror pairs and near retro-reflection, where lobes are narrow.
fn pairs() -> Vec<(Vec3, Vec3)> {
    let mut rng = kajo_sampling::Rng::new(3);
    (0..4096)
        .map(|i| {
            let (a, b) = (kajo_sampling::warp::uniform_sphere(rng.next_2d()), kajo_sampling::warp::uniform_sphere(rng.next_2d()));
            match i % 4 {
                0 => (a, b),
                1 => (a, (Vec3::new(-a.x, -a.y, a.z) + 0.1 * b).normalize()),
                2 => (a, (a + 0.1 * b).normalize()),
                _ => (Vec3::new(a.x, a.y, a.z.abs()), Vec3::new(b.x, b.y, b.z.abs())),
            }
        })
        .collect()
}

fn on_device(device: &Device, entry: &'static ModelEntry, constants: &[f32], pairs: &[(Vec3, Vec3)]) -> Vec<Vec3> {
    let models = [entry];
    let variant = shaders::Variant { models: &models, ..shaders::Variant::without_models(TraceBackend::Compute, false) };
    let linked = shaders::link("test", ROOT, variant);
    let reads_tables = linked.as_ref().unwrap().binding(BSDF_TABLES).is_ok();
    let shader = Shader::new(device, linked).unwrap();
    let options = PipelineOptions { constants: &[("model", f64::from(number(entry)))], ..Default::default() };
    let pipeline = ComputePipeline::new(device, &shader, "main", options).unwrap();
    let mut numbers = constants.to_vec();
    numbers.resize(MOST_CONSTANTS, 0.0);
    let directions: Vec<Vec4> = pairs.iter().flat_map(|(wi, wo)| [wi.extend(0.0), wo.extend(0.0)]).collect();
    let constants = device.buffer_with("constants", &numbers, BufferUsages::STORAGE).unwrap();
    let input = device.buffer_with("directions", &directions, BufferUsages::STORAGE).unwrap();
    let size = pairs.len() * size_of::<Vec4>();
    let output = device.buffer("values", size as u64, BufferUsages::STORAGE | BufferUsages::COPY_SRC).unwrap();
    let own = Bindings::new().with("constants", &constants).with("directions", &input).with("values", &output);
    let tables = device.buffer_with(BSDF_TABLES, &kajo_shader_lib::bsdf_tables(), BufferUsages::STORAGE).unwrap();
    let shared = if reads_tables { Bindings::new().with(BSDF_TABLES, &tables) } else { Bindings::new() };
    let mut encoder = device.wgpu.create_command_encoder(&Default::default());
    pipeline.dispatch(device, &mut encoder, &shared, &own, UVec3::new(pairs.len() as u32, 1, 1)).unwrap();
    device.queue.submit([encoder.finish()]);
    readback::read_buffer::<Vec4>(device, &output.wgpu).unwrap().into_iter().map(Vec4::truncate).collect()
}

/// The largest difference in units of the tolerance: 0.5 % of the value and 1e-5 of the largest one.
fn worst(device: &Device, entry: &'static ModelEntry, constants: &[f32]) -> (f32, String) {
    let model = entry.from_pairs(&[], Form::Corrected).unwrap();
    let pairs = pairs();
    let expected: Vec<Vec3> = pairs.iter().map(|&(wi, wo)| model.rendered_f_cos(wi, wo)).collect();
    let largest = expected.iter().fold(0.0, |largest: f32, value| largest.max(value.max_element())).max(1e-3);
    let got = on_device(device, entry, constants, &pairs);
    let off = |i: usize| ((got[i] - expected[i]).abs() / (0.005 * expected[i] + 1e-5 * largest)).max_element();
    let at = (0..pairs.len()).max_by(|&a, &b| off(a).total_cmp(&off(b))).unwrap();
    assert!(got.iter().all(|value| value.is_finite()), "{}: not finite", entry.id);
    (off(at), format!("wi {}, wo {}: {} instead of {}", pairs[at].0, pairs[at].1, got[at], expected[at]))
}

#[test]
fn every_model_on_the_gpu_is_its_twin() {
    let device = Device::new().unwrap();
    for entry in models() {
        let constants = entry.from_pairs(&[], Form::Corrected).unwrap().constants();
        let (off, what) = worst(&device, entry, &constants);
        assert!(off < 1.0, "{}: {what}", entry.id);
        if constants.is_empty() {
            continue;
        }
        let fault: Vec<f32> = constants.iter().map(|c| c * 1.02 + 0.001).collect();
        assert!(worst(&device, entry, &fault).0 > 1.0, "{}: planted fault", entry.id);
    }
}

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
    let all: Vec<_> = models().filter(|entry| entry.id != "ambient").map(|entry| (entry, &[][..])).collect();
    let scene = spheres(&all);
    for ((entry, _), share) in all.iter().zip(shares_off(&device, &scene, &scene)) {
        // On the silhouette and at the terminator one pixel may see the surface where the other does not.
        assert!(share < 0.005, "{}: {share} of the pixels", entry.id);
    }
    let phong = kajo_bsdf::models::find("phong").unwrap();
    let fault = shares_off(&device, &spheres(&[(phong, &[])]), &spheres(&[(phong, &[("kd", "0.43")])]));
    assert!(fault[0] > 0.1, "planted fault, a brighter reference: {fault:?}");
}

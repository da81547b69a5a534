//! Both backends of the interface `trace` against the hierarchy on the CPU.

use super::scenes::*;
use crate::{FrameSettings, Renderer, RendererSettings, RoleSelection};
use glam::{UVec2, UVec3, Vec3};
use kajo_bvh::{Blas, BuildOptions, BvhInstance, Filter, Ray, Tlas};
use kajo_render_graph::wgpu::BufferUsages;
use kajo_render_graph::{Bindings, ComputePipeline, Device, PipelineOptions, Shader, readback};
use kajo_scene::{Culling, Scene, Snapshot, builtin};
use kajo_techniques::{TraceBackend, shaders};
use kajo_units::Meters;
use std::sync::Arc;

const ROOT: &str = "
    import package::trace::{Ray, trace_any, trace_closest};
    struct Query { origin: vec3f, t_max: f32, direction: vec3f, padding: f32 }
    struct Answer { t: f32, u: f32, v: f32, primitive: u32, instance: u32, found: u32, any: u32, padding: u32 }
    @group(1) @binding(0) var<storage, read> queries: array<Query>;
    @group(1) @binding(1) var<storage, read_write> answers: array<Answer>;
    @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3u) {
        if id.x >= arrayLength(&queries) { return; }
        let q = queries[id.x];
        let ray = Ray(q.origin, 0.0, q.direction, q.t_max);
        let hit = trace_closest(ray, 0u);
        answers[id.x] = Answer(hit.t, hit.u, hit.v, hit.primitive, hit.instance, u32(hit.found), u32(trace_any(ray, 0u)), 0u);
    }";

#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Query {
    pub origin: [f32; 3],
    pub t_max: f32,
    pub direction: [f32; 3],
    pub padding: f32,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Answer {
    t: f32,
    u: f32,
    v: f32,
    primitive: u32,
    pub instance: u32,
    pub found: u32,
    any: u32,
    padding: u32,
}

/// Rays between random points of a box twice as large as the scene.
fn random_rays(bounds: [Vec3; 2], count: usize) -> Vec<Query> {
    let mut state = 1u32;
    let mut unit = || {
        state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
        ((word >> 22) ^ word) as f32 / u32::MAX as f32
    };
    let (middle, half) = (0.5 * (bounds[0] + bounds[1]), bounds[1] - bounds[0]);
    let mut point = || middle + half * (Vec3::new(unit(), unit(), unit()) * 1.6 - 0.8);
    (0..count)
        .map(|_| {
            let (from, to) = (point(), point());
            Query { origin: from.to_array(), t_max: 1e18, direction: (to - from).normalize_or(Vec3::Y).to_array(), padding: 0.0 }
        })
        .collect()
}

pub fn on_device(device: &Device, scene: &Scene, backend: TraceBackend, queries: &[Query]) -> Vec<Answer> {
    answers(device, renderer(device, scene, UVec2::splat(8), Some(backend)), backend, queries)
}

fn answers(device: &Device, mut renderer: Renderer, backend: TraceBackend, queries: &[Query]) -> Vec<Answer> {
    // A frame uploads the instances that masks are looked up by.
    renderer.render(&RoleSelection::new(), &FrameSettings::default()).unwrap();
    let shader =
        Shader::new(device, shaders::link("test", ROOT, shaders::Variant::without_models(backend, device.has_bindless_textures())))
            .unwrap();
    let options = PipelineOptions { list_length: renderer.texture_count(), ..Default::default() };
    let pipeline = ComputePipeline::new(device, &shader, "main", options).unwrap();
    let input = device.buffer_with("queries", queries, BufferUsages::STORAGE).unwrap();
    let size = queries.len() * size_of::<Answer>();
    let output = device.buffer("answers", size as u64, BufferUsages::STORAGE | BufferUsages::COPY_SRC).unwrap();
    let view = renderer.view(&FrameSettings::default());
    let frame = renderer.context(&view, &FrameSettings::default(), 0, 0);
    let own = Bindings::new().with("queries", &input).with("answers", &output);
    let mut encoder = device.wgpu.create_command_encoder(&Default::default());
    pipeline.dispatch(device, &mut encoder, &frame.shared, &own, UVec3::new(queries.len() as u32, 1, 1)).unwrap();
    device.queue.submit([encoder.finish()]);
    readback::read_buffer(device, &output.wgpu).unwrap()
}

/// Whether two answers name the same hit: of two triangles at one distance either may be named.
fn same(a: &Answer, b: &Answer) -> bool {
    let near = (a.t - b.t).abs() <= 1e-4 * a.t.max(b.t).max(1e-3);
    a.found == b.found && a.any == a.found && (a.found == 0 || near)
}

/// The interface answers alike on every backend: 10⁵ rays a scene, and the CPU's hierarchy is asked too.
#[test]
fn both_backends_answer_like_the_cpu() {
    let device = Device::new().unwrap();
    let helmet = asset("FlightHelmet/FlightHelmet.gltf");
    for scene in ["cornell", "shadows"].map(|name| builtin::load(name).unwrap()).into_iter().chain(helmet) {
        let snapshot = Snapshot::new(&scene, START);
        let blases =
            snapshot.meshes.iter().map(|mesh| Arc::new(Blas::build(&mesh.positions, &mesh.indices, &BuildOptions::default()).unwrap()));
        let instances = snapshot.instances.iter().map(|instance| BvhInstance::new(instance.mesh, instance.world_from_object));
        let tlas = Tlas::build(blases.collect(), instances.collect()).unwrap();
        let queries = random_rays([tlas.bounds().min.max(Vec3::splat(-4.0)), tlas.bounds().max.min(Vec3::splat(4.0))], 100_000);
        let blended = scene.materials.iter().any(|material| material.needs_alpha_test());
        let on_cpu = |query: &Query| {
            let ray = Ray { t_max: query.t_max, ..Ray::new(query.origin.into(), query.direction.into()) };
            let hit = tlas.closest_hit_opaque(&ray, Filter::ALL);
            let found = u32::from(hit.is_some());
            let hit = hit.map_or((0.0, 0, 0), |hit| (hit.t, hit.primitive, hit.instance));
            Answer { t: hit.0, u: 0.0, v: 0.0, primitive: hit.1, instance: hit.2, found, any: found, padding: 0 }
        };
        let cpu: Vec<Answer> = queries.iter().map(on_cpu).collect();
        let compute = on_device(&device, &scene, TraceBackend::Compute, &queries);
        let agree = |a: &[Answer], b: &[Answer]| a.iter().zip(b).filter(|(a, b)| same(a, b)).count();
        let hits = cpu.iter().filter(|answer| answer.found == 1).count();
        assert!(hits > 20_000, "{}: {hits} hits", scene.name);
        if !blended {
            let count = agree(&compute, &cpu);
            assert!(count >= 99_950, "{}: compute and CPU agree on {count} rays", scene.name);
        }
        if device.has_ray_query() {
            let count = agree(&compute, &on_device(&device, &scene, TraceBackend::RayQuery, &queries));
            assert!(count >= 99_950, "{}: the backends agree on {count} rays", scene.name);
        }
        // Shifted answers must not pass as equal.
        assert!(agree(&compute[1..], &cpu[..99_999]) < 90_000);
    }
}

/// Instances that are left out are met on neither backend, and all others are, as by the CPU's hierarchy of those that are kept.
#[test]
fn both_backends_leave_out_the_instances_that_the_cpu_does() {
    let device = Device::new().unwrap();
    let scene = builtin::load("scatter:4000").unwrap();
    let snapshot = Snapshot::new(&scene, START);
    let culling = Culling::Distance(Meters(15.0));
    let kept = culling.kept(&scene, &snapshot, &snapshot.cameras[0], 1.0);
    let left_out = kept.iter().filter(|kept| !**kept).count();
    assert!((3000..3990).contains(&left_out), "{left_out} left out");
    let queries = random_rays([Vec3::new(-30.0, 0.0, -30.0), Vec3::new(30.0, 1.5, 30.0)], 50_000);
    for backend in [TraceBackend::Compute, TraceBackend::RayQuery] {
        if backend == TraceBackend::RayQuery && !device.has_ray_query() {
            continue;
        }
        let of = |ray_culling| {
            let settings = RendererSettings { backend: Some(backend), ray_culling, ..RendererSettings::new(UVec2::splat(8)) };
            answers(&device, Renderer::new(&device, &scene, &snapshot, settings).unwrap(), backend, &queries)
        };
        let (all, fewer) = (of(Culling::Off), of(culling));
        let met = |answers: &[Answer], want: bool| answers.iter().filter(|a| a.found == 1 && kept[a.instance as usize] == want).count();
        assert!(met(&all, false) > 100 && met(&fewer, false) == 0, "{backend:?}: {} hits of instances left out", met(&fewer, false));
        // What was hit and is kept is still hit.
        let lost = all.iter().zip(&fewer).filter(|(a, b)| a.found == 1 && kept[a.instance as usize] && !same(a, b)).count();
        assert!(lost <= 25, "{backend:?}: {lost} rays lost a kept instance");
    }
}

//! Surfaces that rays meet (`package::hit`), seen along the camera's own rays: the rasteriser's, and as brightly lit.

use super::scenes::*;
use crate::{FrameOutput, FrameSettings, RoleSelection};
use glam::{UVec2, Vec3};
use kajo_render_graph::wgpu::BufferUsages;
use kajo_render_graph::{Bindings, ComputePipeline, Device, PipelineOptions, Shader, readback};
use kajo_scene::{LightShape, Scene, builtin};
use kajo_techniques::{TraceBackend, shaders};

/// What rays meet. `LIT` stands where it is lit.
const ROOT: &str = "
    import package::frame::{frame, ray_direction};
    import package::hit::{direct_at, environment_at, shaded, surface_hit};
    import package::screen::{pixel_at_distance_1, scale_at};
    import package::trace::{Ray, trace_closest};
    import shader_lib::random::hash_pixel;
    struct Answer { position: vec3f, instance: u32, shading: vec3f, roughness: f32, geometric: vec3f, unlit: u32, emission: vec3f,
        padding_a: f32, direct: vec3f, padding_b: f32, around: vec3f, padding_c: f32 }
    @group(1) @binding(0) var<storage, read_write> answers: array<Answer>;
    @group(1) @binding(1) var<uniform> lights_at_once: vec4u;
    @compute @workgroup_size(8, 8) fn main(@builtin(global_invocation_id) id: vec3u) {
        if any(id.xy >= frame.size) { return; }
        let direction = ray_direction(id.xy);
        let hit = trace_closest(Ray(frame.camera_position, 0.0, direction, 1e18), 0u);
        var out = Answer();
        if hit.found {
            // As wide as the pixel.
            let width = pixel_at_distance_1() * scale_at(direction * hit.t);
            let at = surface_hit(hit, direction, width);
            out = Answer(at.relative + frame.camera_position, at.instance + 1u, at.shading, at.packed.f0_roughness.w, at.geometric,
                u32(at.unlit), at.emission, f32(lights_at_once.x), vec3f(0.0), 0.0, vec3f(0.0), 0.0);
            LIT
        }
        answers[id.x + id.y * frame.size.x] = out;
    }";

const LIT: &str = "
            let point = shaded(at);
            var rays = 0u;
            for (var i = 0u; i < lights_at_once.y; i++) {
                out.direct += direct_at(point, at.relative, 16u, lights_at_once.x, hash_pixel(id.xy, i, 7u), &rays) / f32(lights_at_once.y);
            }
            out.around = environment_at(point, at.relative, 64u, hash_pixel(id.xy, 0u, 8u), &rays);";

#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
struct Answer {
    position: Vec3,
    /// + 1.
    instance: u32,
    shading: Vec3,
    roughness: f32,
    geometric: Vec3,
    unlit: u32,
    emission: Vec3,
    padding_a: f32,
    direct: Vec3,
    padding_b: f32,
    around: Vec3,
    padding_c: f32,
}

/// A frame of the renderer, and what rays of its camera met; lit by `most` lights at a time, the mean of `repeats` times, or not at all.
fn both_ways(device: &Device, scene: &Scene, size: UVec2, backend: TraceBackend, [most, repeats]: [u32; 2]) -> (FrameOutput, Vec<Answer>) {
    let mut renderer = renderer(device, scene, size, Some(backend));
    let settings = FrameSettings { gbuffer: true, ..Default::default() };
    let roles = RoleSelection::new().choose("shadow/ray-traced", &[("samples", "16")]).unwrap();
    let roles = roles.choose("ao/ray-traced", &[("samples", "16")]).unwrap().choose("reflection/none", &[]).unwrap();
    let out = renderer.render(&roles, &settings).unwrap();
    let root = ROOT.replace("LIT", if repeats > 0 { LIT } else { "" });
    let linked = shaders::link("test", &root, shaders::Variant::without_models(backend, device.has_bindless_textures()));
    let options = PipelineOptions { list_length: renderer.texture_count(), ..Default::default() };
    let pipeline = ComputePipeline::new(device, &Shader::new(device, linked).unwrap(), "main", options).unwrap();
    let bytes = size.element_product() as usize * size_of::<Answer>();
    let answers = device.buffer("answers", bytes as u64, BufferUsages::STORAGE | BufferUsages::COPY_SRC).unwrap();
    let lights_at_once = device.buffer_with("lights at once", &[most, repeats, 0, 0], BufferUsages::UNIFORM).unwrap();
    let view = renderer.view(&settings);
    let frame = renderer.context(&view, &settings, 0, 0);
    let own = Bindings::new().with("answers", &answers).with("lights_at_once", &lights_at_once);
    let mut encoder = device.wgpu.create_command_encoder(&Default::default());
    pipeline.dispatch(device, &mut encoder, &frame.shared, &own, size.extend(1)).unwrap();
    device.queue.submit([encoder.finish()]);
    (out, readback::read_buffer(device, &answers.wgpu).unwrap())
}

/// Of the pixels that show a surface in either way, the shares whose rays meet what the G-buffer shows: the same instance, in the same place, with the same normals, as rough.
fn agreement(out: &FrameOutput, answers: &[Answer], tolerance: f32) -> [f32; 4] {
    let images = out.gbuffer.as_ref().unwrap();
    let (mut alike, mut covered) = ([0.0f32; 4], 0.0);
    for (i, answer) in answers.iter().enumerate() {
        let instance = images.instance.pixels()[i].map_or(0, |instance| instance + 1);
        covered += f32::from(instance != 0 || answer.instance != 0);
        let near = answer.position.distance(images.position.pixels()[i]) <= 2e-4 * answer.position.length().max(1.0);
        let turned = |a: Vec3, b: Vec3| a.distance(b) <= tolerance;
        let normals = turned(answer.geometric, images.normal.pixels()[i]) && turned(answer.shading, images.shading_normal.pixels()[i]);
        let rough = (answer.roughness - images.roughness.pixels()[i]).abs() <= tolerance;
        for (count, same) in alike.iter_mut().zip([answer.instance == instance, near, normals, rough]) {
            *count += f32::from(instance != 0 && answer.instance == instance && same);
        }
    }
    alike.map(|count| count / covered)
}

/// On every backend the camera's rays make of the scene what the rasteriser makes of it, textures, normal maps and masks included.
#[test]
fn rays_meet_the_surfaces_that_the_rasteriser_draws() {
    let device = Device::new().unwrap();
    let size = UVec2::new(128, 96);
    let helmet = asset("FlightHelmet/FlightHelmet.gltf");
    for scene in [builtin::load("moving").unwrap()].into_iter().chain(helmet) {
        for backend in [TraceBackend::RayQuery, TraceBackend::Compute] {
            if backend == TraceBackend::RayQuery && !device.has_ray_query() {
                continue;
            }
            let (out, answers) = both_ways(&device, &scene, size, backend, [1, 0]);
            // Footprints of rays are round, those of pixels are not.
            let (tolerance, least) = if scene.textures.is_empty() { (0.02, [0.99; 4]) } else { (0.1, [0.97, 0.97, 0.8, 0.8]) };
            let alike = agreement(&out, &answers, tolerance);
            assert!(alike.iter().zip(least).all(|(got, least)| *got >= least), "{} by {}: {alike:?}", scene.name, backend.id());
            // The image of one column further to the right must not pass.
            let shifted: Vec<Answer> = (0..answers.len()).map(|i| answers[(i + 1) % answers.len()]).collect();
            assert!(agreement(&out, &shifted, tolerance)[1] < 0.1, "{}", scene.name);
        }
    }
}

fn mean(values: impl Iterator<Item = Vec3>) -> f32 {
    let (sum, count) = values.fold((0.0, 0), |(sum, count), value| (sum + value.element_sum(), count + 1));
    sum / count as f32
}

/// What they reflect of the environment is what the frame's deferred pass finds with ray-traced ambient visibility, in the mean.
#[test]
fn the_environment_lights_what_rays_meet() {
    let device = Device::new().unwrap();
    let size = UVec2::new(96, 72);
    let scene = builtin::load("spheres").unwrap();
    assert!(scene.environment.is_some());
    let (out, answers) = both_ways(&device, &scene, size, TraceBackend::best(&device), [1, 1]);
    let seen = |i: &usize| answers[*i].instance != 0 && answers[*i].unlit == 0;
    let pixels: Vec<usize> = (0..answers.len()).filter(seen).collect();
    let of_frame = mean(pixels.iter().map(|&i| out.color.pixels()[i].0 - out.direct.pixels()[i].0 - answers[i].emission));
    let of_rays = mean(pixels.iter().map(|&i| answers[i].around));
    assert!(of_frame > 0.0 && (of_rays / of_frame - 1.0).abs() < 0.05, "{of_rays} instead of {of_frame}");
}

/// What they reflect from the lights is what the deferred passes find with ray-traced shadows, pixel by pixel: within half a per cent of the mean under
/// lights that are points or nearly so, within noise under a large one, of which the frame takes light and visibility by samples of their own;
/// with fewer lights at a time than there are, in the mean.
#[test]
fn rays_light_what_they_meet_as_the_frame_is_lit() {
    let device = Device::new().unwrap();
    let size = UVec2::new(96, 72);
    let mut pointed = builtin::load("cornell").unwrap();
    pointed.name += " lit by a point";
    pointed.lights[0].shape = LightShape::Point;
    let [shadows, cornell, lamps] = ["shadows", "cornell", "many-lights:12"].map(|name| builtin::load(name).unwrap());
    for (scene, bound) in [(shadows, 0.005), (pointed, 0.005), (lamps, 0.005), (cornell, 0.06)] {
        let (out, answers) = both_ways(&device, &scene, size, TraceBackend::best(&device), [64, 1]);
        let of_frame = mean(out.direct.pixels().iter().map(|pixel| pixel.0));
        let of_rays = mean(answers.iter().map(|answer| answer.direct));
        assert!(of_frame > 0.0 && (of_rays / of_frame - 1.0).abs() < 0.5 * bound, "{}: {of_rays} instead of {of_frame}", scene.name);
        let difference = |shift: usize| {
            let pairs = out.direct.pixels().iter().zip(answers.iter().cycle().skip(shift));
            mean(pairs.map(|(a, b)| (a.0 - b.direct).abs())) / of_frame
        };
        assert!(difference(0) < bound, "{}: pixels differ by {}", scene.name, difference(0));
        assert!(difference(1) > 2.0 * bound, "{}: one pixel off must not pass: {}", scene.name, difference(1));
        if scene.lights.len() > 4 {
            let (_, few) = both_ways(&device, &scene, size, TraceBackend::best(&device), [4, 16]);
            let of_few = mean(few.iter().map(|answer| answer.direct));
            assert!((of_few / of_rays - 1.0).abs() < 0.05, "{}: {of_few} instead of {of_rays}", scene.name);
            assert!(mean(few.iter().zip(&answers).map(|(a, b)| (a.direct - b.direct).abs())) > 0.05 * of_rays, "they were all taken");
        }
    }
}

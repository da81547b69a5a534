//! Analytic lights.

use crate::compare::{Tolerance, conform};
use glam::{Affine3A, Quat, Vec2, Vec3};
use kajo_render_graph::Device;
use kajo_sampling::Rng;
use kajo_scene::{Light, LightShape, PlacedLight};
use kajo_shader_lib::emission::emission_sample;
use kajo_shader_lib::light::{GpuLight, LightSample, light_center, light_sample};
use kajo_units::{LinearRgb, Meters, Radians};

const SHAPES: [LightShape; 7] = [
    LightShape::Point,
    LightShape::Spot { inner: Radians(0.3), outer: Radians(0.7) },
    LightShape::Directional { half_angle: Radians(0.0) },
    LightShape::Directional { half_angle: Radians(0.1) },
    LightShape::Rectangle { width: Meters(1.0), height: Meters(0.4) },
    LightShape::Disk { radius: Meters(0.5) },
    LightShape::Sphere { radius: Meters(0.5) },
];

fn flat(s: LightSample) -> [f32; 7] {
    [s.wi.x, s.wi.y, s.wi.z, s.distance, s.irradiance.x, s.irradiance.y, s.irradiance.z]
}

/// The light as an expression of WGSL, bit for bit.
fn literal(light: &GpuLight) -> String {
    let words: Vec<String> = bytemuck::cast_slice::<GpuLight, u32>(&[*light]).iter().map(|word| format!("{word}u")).collect();
    let vector = |at: usize| format!("bitcast<vec3f>(vec3u({}, {}, {}))", words[at], words[at + 1], words[at + 2]);
    let float = |at: usize| format!("bitcast<f32>({})", words[at]);
    format!(
        "Light({}, {}, {}, {}, {}, {}, {}, {}, {}, 0.0, 0u, 0u, 0u, 0u)",
        vector(0),
        words[3],
        vector(4),
        float(7),
        vector(8),
        float(11),
        vector(12),
        float(15),
        vector(16)
    )
}

#[test]
fn lights_match() {
    let place = Affine3A::from_scale_rotation_translation(Vec3::new(1.5, 2.0, 1.0), Quat::from_rotation_y(0.8), Vec3::new(0.2, 1.0, -0.4));
    let mut rng = Rng::new(2);
    for shape in SHAPES {
        let light = Light { name: String::new(), shape, emission: LinearRgb::new(3.0, 2.0, 1.0) };
        let light = GpuLight::new(&PlacedLight { light, world_from_light: place }, Vec3::ZERO);
        // In front of the light, behind it, inside a sphere.
        let rows: Vec<[f32; 5]> = (0..1500)
            .map(|_| [rng.next_1d(), rng.next_1d(), 6.0 * rng.next_1d() - 3.0, 6.0 * rng.next_1d() - 3.0, 6.0 * rng.next_1d() - 3.0])
            .collect();
        let value = literal(&light);
        let shader = format!(
            "import shader_lib::light::{{Light, light_sample, light_center}};
            fn eval(x: array<f32, 5>) -> array<f32, 14> {{
                let light = {value};
                let a = light_sample(light, vec3f(x[2], x[3], x[4]), vec2f(x[0], x[1]));
                let b = light_center(light, vec3f(x[2], x[3], x[4]));
                return array(a.wi.x, a.wi.y, a.wi.z, a.distance, a.irradiance.x, a.irradiance.y, a.irradiance.z,
                    b.wi.x, b.wi.y, b.wi.z, b.distance, b.irradiance.x, b.irradiance.y, b.irradiance.z);
            }}"
        );
        let twin = |x: [f32; 5]| -> [f32; 14] {
            let point = Vec3::new(x[2], x[3], x[4]);
            let (a, b) = (flat(light_sample(&light, point, Vec2::new(x[0], x[1]))), flat(light_center(&light, point)));
            std::array::from_fn(|i| if i < 7 { a[i] } else { b[i - 7] })
        };
        // At grazing angles the distance to a sphere is the root of a small difference.
        conform(&format!("light {shape:?}"), &shader, &rows, twin, Tolerance { relative: 1e-3, absolute: 2e-4 });
    }
}

#[test]
fn emissions_match() {
    let place = Affine3A::from_scale_rotation_translation(Vec3::new(1.5, 2.0, 1.0), Quat::from_rotation_y(0.8), Vec3::new(0.2, 1.0, -0.4));
    let mut rng = Rng::new(9);
    for shape in SHAPES {
        let light = Light { name: String::new(), shape, emission: LinearRgb::new(3.0, 2.0, 1.0) };
        let light = GpuLight::new(&PlacedLight { light, world_from_light: place }, Vec3::ZERO);
        let rows: Vec<[f32; 4]> = (0..1500).map(|_| [rng.next_1d(), rng.next_1d(), rng.next_1d(), rng.next_1d()]).collect();
        let (center, radius) = (Vec3::new(0.3, -0.2, 0.5), 4.0);
        let shader = format!(
            "import shader_lib::emission::emission_sample;
            import shader_lib::light::Light;
            fn eval(x: array<f32, 4>) -> array<f32, 9> {{
                let e = emission_sample({}, vec2f(x[0], x[1]), vec2f(x[2], x[3]), vec3f(0.3, -0.2, 0.5), 4.0);
                return array(e.origin.x, e.origin.y, e.origin.z, e.direction.x, e.direction.y, e.direction.z, e.flux.x, e.flux.y, e.flux.z);
            }}",
            literal(&light)
        );
        let twin = |x: [f32; 4]| -> [f32; 9] {
            let e = emission_sample(&light, Vec2::new(x[0], x[1]), Vec2::new(x[2], x[3]), center, radius);
            [e.origin, e.direction, e.flux].map(|v| v.to_array()).concat().try_into().expect("nine numbers")
        };
        conform(&format!("emission {shape:?}"), &shader, &rows, twin, Tolerance { relative: 1e-4, absolute: 2e-5 });
    }
}

#[test]
fn light_struct_is_the_same_in_rust_and_wgsl() {
    let source = "import shader_lib::light::Light;
        @group(0) @binding(0) var<storage, read> lights: array<Light>;
        @group(0) @binding(1) var<storage, read_write> out: array<f32>;
        @compute @workgroup_size(1) fn main() { out[0] = lights[0].size; }";
    let linked = kajo_shader_lib::link("conformance/light", source, &[]).unwrap();
    linked.check_layout::<GpuLight>("Light").unwrap();
}

/// What a technique sees: the struct arrives as it was packed.
#[test]
fn packed_lights_arrive_in_a_shader() {
    let Some(device) = crate::gpu::device() else { return };
    check_arrival(&device).unwrap_or_else(|error| panic!("{error}"));
}

fn check_arrival(device: &Device) -> Result<(), kajo_render_graph::Error> {
    use kajo_render_graph::{Bindings, ComputePipeline, PipelineOptions, Shader, readback::read_buffer};
    let light = Light { name: String::new(), shape: SHAPES[4], emission: LinearRgb::new(3.0, 2.0, 1.0) };
    let light = GpuLight::new(&PlacedLight { light, world_from_light: Affine3A::from_rotation_y(0.3) }, Vec3::ONE);
    let source = "import shader_lib::light::Light;
        @group(0) @binding(0) var<storage, read> lights: array<Light>;
        @group(0) @binding(1) var<storage, read_write> out: array<Light>;
        @compute @workgroup_size(1) fn main() { out[0] = lights[0]; }";
    let shader = Shader::new(device, kajo_shader_lib::link("conformance/arrival", source, &[]))?;
    let pipeline = ComputePipeline::new(device, &shader, "main", PipelineOptions::default())?;
    let input = device.buffer_with("lights", &[light], wgpu::BufferUsages::STORAGE)?;
    let output = device.buffer("out", size_of::<GpuLight>() as u64, wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC)?;
    let mut encoder = device.wgpu.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let bindings = Bindings::new().with("lights", &input).with("out", &output);
    pipeline.dispatch(device, &mut encoder, &Bindings::new(), &bindings, glam::UVec3::ONE)?;
    device.queue.submit([encoder.finish()]);
    assert_eq!(read_buffer::<GpuLight>(device, &output.wgpu)?, [light]);
    Ok(())
}

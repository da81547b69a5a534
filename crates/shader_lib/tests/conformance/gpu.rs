//! Evaluates a WESL function for many rows of numbers.

use glam::UVec3;
use kajo_render_graph::readback::read_buffer;
use kajo_render_graph::{Bindings, ComputePipeline, Device, PipelineOptions, Shader};
use kajo_shader_lib::{BSDF_TABLES, bsdf_tables};
use wgpu::BufferUsages;

/// The device, or `None` with a line that says why: tests that need one are then skipped.
pub fn device() -> Option<Device> {
    match Device::new() {
        Ok(device) => Some(device),
        Err(error) => {
            eprintln!("skipped: no GPU adapter ({error})");
            None
        }
    }
}

/// Runs `fn eval(x: array<f32, N>) -> array<f32, M>` of `shader` for every row.
pub fn evaluate<const N: usize, const M: usize>(device: &Device, name: &str, shader: &str, rows: &[[f32; N]]) -> Vec<[f32; M]> {
    // Runtime-sized arrays of the row type: storage buffers lay arrays of f32 out without padding.
    let source = format!(
        "{shader}
@group(0) @binding(0) var<storage, read> rows: array<array<f32, {N}>>;
@group(0) @binding(1) var<storage, read_write> results: array<array<f32, {M}>>;
@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {{
    if id.x < arrayLength(&rows) {{
        results[id.x] = eval(rows[id.x]);
    }}
}}"
    );
    let run = || -> Result<Vec<f32>, kajo_render_graph::Error> {
        let shader = Shader::new(device, kajo_shader_lib::link(&format!("conformance/{name}"), &source, &[]))?;
        let pipeline = ComputePipeline::new(device, &shader, "main", PipelineOptions::default())?;
        let input = device.buffer_with("rows", rows, BufferUsages::STORAGE)?;
        let output = device.buffer("results", (rows.len() * M * 4) as u64, BufferUsages::STORAGE | BufferUsages::COPY_SRC)?;
        let mut encoder = device.wgpu.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some(name) });
        let tables = device.buffer_with(BSDF_TABLES, &bsdf_tables(), BufferUsages::STORAGE)?;
        let shared = Bindings::new().with(BSDF_TABLES, &tables);
        let bindings = Bindings::new().with("rows", &input).with("results", &output);
        pipeline.dispatch(device, &mut encoder, &shared, &bindings, UVec3::new(rows.len() as u32, 1, 1))?;
        device.queue.submit([encoder.finish()]);
        read_buffer(device, &output.wgpu)
    };
    let values = run().unwrap_or_else(|error| panic!("{name}: {error}"));
    values[..rows.len() * M].chunks_exact(M).map(|chunk| chunk.try_into().expect("chunks of M")).collect()
}

//! What reflectance models cost on a graphics processor: nanoseconds an evaluation, by the device's own timers.
//!
//! A compute shader evaluates one model for pair after pair of directions and adds the values, so that none can be left out; the sums are compared with the
//! CPU's. The time is that of the whole device: a processor with many units has many evaluations in flight. It stands here and not with the CPU's measurements because those need no device.

use crate::LabError;
use glam::{UVec2, UVec3, Vec3, Vec4};
use kajo_bsdf::models::{ModelEntry, Reflectance};
use kajo_render_graph::wgpu::BufferUsages;
use kajo_render_graph::{Access, Bindings, ComputePipeline, Device, Graph, PipelineOptions, Pool, Shader, readback};
use kajo_shader_lib::BSDF_TABLES;
use kajo_shader_lib::models::{MOST_CONSTANTS, number};
use kajo_techniques::{TraceBackend, shaders};

const ROOT: &str = "
    import package::models::model_f_cos;
    import shader_lib::models::geometry::ModelConstants;
    @group(1) @binding(0) var<storage, read> constants: ModelConstants;
    @group(1) @binding(1) var<storage, read> directions: array<vec4f>;
    @group(1) @binding(2) var<storage, read> rounds: array<u32>;
    @group(1) @binding(3) var<storage, read_write> sums: array<vec4f>;
    override model: u32 = 0u;
    @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3u) {
        if id.x >= arrayLength(&sums) { return; }
        let pairs = arrayLength(&directions) / 2u;
        var sum = vec3f(0.0);
        for (var k = 0u; k < rounds[0]; k++) {
            let pair = (id.x + k * 61u) % pairs;
            sum += model_f_cos(model, constants, directions[2u * pair].xyz, directions[2u * pair + 1u].xyz);
        }
        sums[id.x] = vec4f(sum, 0.0);
    }";

/// Invocations of the shader.
const INVOCATIONS: u32 = 1 << 16;

/// A run shorter than this is too short for the timer, and gets more rounds.
const LEAST_MS: f64 = 5.0;

/// Most evaluations of an invocation.
const MOST_ROUNDS: u32 = 1 << 14;

/// Runs of which the fastest counts.
const RUNS: u32 = 5;

/// What a model costs.
#[derive(Clone, Copy, Debug)]
pub struct ModelCost {
    /// ns an evaluation.
    pub ns: f64,
    /// Evaluations of a run.
    pub evaluations: u64,
    /// Mean of f cos θ_i over all pairs and evaluations, its channels added up.
    pub checksum: f64,
    /// The same from the CPU.
    pub expected: f64,
    /// By timers on the device; otherwise from outside.
    pub on_device: bool,
}

/// Times one model on these pairs of directions (to the light, to the viewer); their number is a power of two up to 65 536.
///
/// # Errors
/// A device that fails.
///
/// # Panics
/// For another number of pairs.
pub fn time_model(
    device: &Device,
    entry: &'static ModelEntry,
    model: &dyn Reflectance,
    pairs: &[(Vec3, Vec3)],
) -> Result<ModelCost, LabError> {
    assert!(pairs.len().is_power_of_two() && pairs.len() <= INVOCATIONS as usize, "{} pairs", pairs.len());
    let models = [entry];
    let variant = shaders::Variant { models: &models, ..shaders::Variant::without_models(TraceBackend::Compute, false) };
    let linked = shaders::link("model cost", ROOT, variant);
    let reads_tables = linked.as_ref().is_ok_and(|linked| linked.binding(BSDF_TABLES).is_ok());
    let shader = Shader::new(device, linked)?;
    let options = PipelineOptions { constants: &[("model", f64::from(number(entry)))], ..Default::default() };
    let pipeline = ComputePipeline::new(device, &shader, "main", options)?;

    let mut numbers = model.constants();
    numbers.resize(MOST_CONSTANTS, 0.0);
    let numbers = device.buffer_with("constants", &numbers, BufferUsages::STORAGE)?;
    let directions: Vec<Vec4> = pairs.iter().flat_map(|(wi, wo)| [wi.extend(0.0), wo.extend(0.0)]).collect();
    let directions = device.buffer_with("directions", &directions, BufferUsages::STORAGE)?;
    let sums = device.buffer("sums", u64::from(INVOCATIONS) * size_of::<Vec4>() as u64, BufferUsages::STORAGE | BufferUsages::COPY_SRC)?;
    let tables = device.buffer_with(BSDF_TABLES, &kajo_shader_lib::bsdf_tables(), BufferUsages::STORAGE)?;
    let shared = if reads_tables { Bindings::new().with(BSDF_TABLES, &tables) } else { Bindings::new() };
    let run = |rounds: u32| -> Result<(f64, bool), LabError> {
        let rounds = device.buffer_with("rounds", &[rounds], BufferUsages::STORAGE)?;
        let own = Bindings::new().with("constants", &numbers).with("directions", &directions).with("rounds", &rounds).with("sums", &sums);
        let mut graph = Graph::new();
        graph
            .pass(Access::new("model"), |context| pipeline.dispatch(device, context.encoder, &shared, &own, UVec3::new(INVOCATIONS, 1, 1)));
        let timings = graph.execute(device, &mut Pool::new(UVec2::ONE, 1))?;
        Ok((timings.total_ms(), timings.on_device))
    };

    let mut rounds = 1;
    while run(rounds)?.0 < LEAST_MS && rounds < MOST_ROUNDS {
        rounds *= 2;
    }
    let (mut least, mut on_device) = (f64::INFINITY, false);
    for _ in 0..RUNS {
        let (ms, by_device) = run(rounds)?;
        (least, on_device) = (least.min(ms), by_device);
    }
    let evaluations = u64::from(INVOCATIONS) * u64::from(rounds);
    let sum: f64 =
        readback::read_buffer::<Vec4>(device, &sums.wgpu)?.iter().map(|sum| f64::from(sum.x) + f64::from(sum.y) + f64::from(sum.z)).sum();
    // Every pair comes equally often: as many invocations as pairs, or a multiple.
    let expected: f64 = pairs.iter().map(|&(wi, wo)| f64::from(model.rendered_f_cos(wi, wo).element_sum())).sum();
    Ok(ModelCost {
        ns: least * 1e6 / evaluations as f64,
        evaluations,
        checksum: sum / evaluations as f64,
        expected: expected / pairs.len() as f64,
        on_device,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_bsdf::models::{Form, V3, find};

    /// Row BR-34, on the GPU: what is timed is the model.
    #[test]
    fn the_timed_shader_evaluates_the_model() {
        let device = Device::new().unwrap();
        let mut rng = kajo_sampling::Rng::new(34);
        let mut direction = || Vec3::from(V3::<f32>::from_angles(rng.next_1d().acos(), std::f32::consts::TAU * rng.next_1d()));
        let pairs: Vec<_> = (0..1024).map(|_| (direction(), direction())).collect();
        for id in ["lambert", "ggx"] {
            let entry = find(id).unwrap();
            let model = entry.from_pairs(&[], Form::Corrected).unwrap();
            let cost = time_model(&device, entry, &*model, &pairs).unwrap();
            assert!((cost.checksum / cost.expected - 1.0).abs() < 1e-3, "{id}: {cost:?}");
            assert!(cost.ns > 0.0 && cost.evaluations >= u64::from(INVOCATIONS), "{id}: {cost:?}");
            let other = entry.from_pairs(if id == "ggx" { &[("f0", "0.05")] } else { &[("kd", "0.7")] }, Form::Corrected).unwrap();
            let fault = time_model(&device, entry, &*other, &pairs).unwrap().checksum;
            assert!((fault / cost.expected - 1.0).abs() > 1e-3, "{id}: planted fault");
        }
    }
}

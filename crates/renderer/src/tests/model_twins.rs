//! Reflectance models of the library as functions: the GPU's side of each against the CPU's, over their parameters.

use glam::{UVec3, Vec3, Vec4};
use kajo_bsdf::models::tabulated::{Grid, Tabulated};
use kajo_bsdf::models::{Form, ModelEntry, Reflectance, all, find};
use kajo_params::{ParamKind, ParamValues};
use kajo_render_graph::wgpu::BufferUsages;
use kajo_render_graph::{Bindings, ComputePipeline, Device, PipelineOptions, Shader, readback};
use kajo_sampling::{Rng, warp};
use kajo_shader_lib::models::{MOST_CONSTANTS, number};
use kajo_shader_lib::{BSDF_TABLES, BsdfTables};
use kajo_techniques::{TraceBackend, shaders};
use std::sync::Arc;

const ROOT: &str = "
    import package::models::model_f_cos;
    import shader_lib::models::geometry::ModelConstants;
    @group(1) @binding(0) var<storage, read> constants: array<ModelConstants>;
    @group(1) @binding(1) var<storage, read> directions: array<vec4f>;
    @group(1) @binding(2) var<storage, read_write> values: array<vec4f>;
    override model: u32 = 0u;
    @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3u) {
        if id.x >= arrayLength(&values) { return; }
        let pairs = arrayLength(&directions) / 2u;
        let pair = id.x % pairs;
        values[id.x] = vec4f(model_f_cos(model, constants[id.x / pairs], directions[2u * pair].xyz, directions[2u * pair + 1u].xyz), 0.0);
    }";

/// Random settings of the numbers of each model.
const SETTINGS: usize = 8;

/// A model with parameters, and what they are.
struct Case {
    what: String,
    model: Arc<dyn Reflectance>,
}

/// The model at its defaults, as printed, with each of the names that its parameters choose from, and with random numbers.
fn cases(entry: &'static ModelEntry) -> Vec<Case> {
    let case = |values: &ParamValues, form, what: String| (entry.make)(values, form).ok().map(|model| Case { what, model });
    let defaults = ParamValues::defaults(entry.params);
    let mut cases: Vec<_> = case(&defaults, Form::Corrected, "defaults".to_owned()).into_iter().collect();
    if entry.has_printed_form {
        cases.extend(case(&defaults, Form::Printed, "printed".to_owned()));
    }
    for spec in entry.params {
        let names: &[&str] = match spec.kind {
            ParamKind::Choice { names } => names,
            ParamKind::Bool => &["false", "true"],
            _ => &[],
        };
        for name in names {
            let mut values = defaults.clone();
            values.set(spec.name, name).unwrap();
            cases.extend(case(&values, Form::Corrected, format!("{}={name}", spec.name)));
        }
    }
    let mut rng = Rng::new(7);
    let mut found = 0;
    // Some numbers do not go together (kd + ks > 1); 100 tries find enough that do.
    for _ in 0..100 {
        let values = random_numbers(entry, &mut rng);
        if found < SETTINGS
            && let Some(case) = case(&values, Form::Corrected, format!("{values:?}"))
        {
            cases.push(case);
            found += 1;
        }
    }
    assert!(found == SETTINGS || entry.params.is_empty(), "{}: {found} settings", entry.id);
    cases
}

/// Numbers within a factor of four of the defaults, a colour's channels all different.
fn random_numbers(entry: &ModelEntry, rng: &mut Rng) -> ParamValues {
    let mut values = ParamValues::defaults(entry.params);
    for spec in entry.params {
        let mut near = |default: f64, min: f64, max: f64| {
            let size = if default == 0.0 { 0.3 } else { default };
            (size * 4_f64.powf(2.0 * f64::from(rng.next_1d()) - 1.0)).clamp(min, max)
        };
        let text = match (spec.kind, spec.default) {
            (ParamKind::Float { min, max }, kajo_params::Value::Float(default)) => near(default, min, max).to_string(),
            (ParamKind::Color { min, max }, kajo_params::Value::Color([default, ..])) => {
                format!("{},{},{}", near(default, min, max), near(default, min, max), near(default, min, max))
            }
            (ParamKind::Rows { .. }, _) => {
                let mut lobe =
                    || format!("{},{},{},{}", -near(0.5, 0.0, 1.0), -near(0.5, 0.0, 1.0), near(0.5, 0.0, 1.0), near(10.0, 0.0, 1e4));
                format!("{};{}", lobe(), lobe())
            }
            _ => continue,
        };
        values.set(spec.name, &text).unwrap_or_else(|error| panic!("{}: {error}", entry.id));
    }
    values
}

/// Pairs over the sphere, some of them mirror pairs and near retro-reflection, where lobes are narrow.
fn pairs() -> Vec<(Vec3, Vec3)> {
    let mut rng = Rng::new(3);
    (0..4096)
        .map(|i| {
            let (a, b) = (warp::uniform_sphere(rng.next_2d()), warp::uniform_sphere(rng.next_2d()));
            match i % 4 {
                0 => (a, b),
                1 => (a, (Vec3::new(-a.x, -a.y, a.z) + 0.1 * b).normalize()),
                2 => (a, (a + 0.1 * b).normalize()),
                _ => (Vec3::new(a.x, a.y, a.z.abs()), Vec3::new(b.x, b.y, b.z.abs())),
            }
        })
        .collect()
}

/// Values of all `pairs` for each list of constants.
fn on_device(
    device: &Device,
    entry: &'static ModelEntry,
    tables: &BsdfTables,
    constants: &[Vec<f32>],
    pairs: &[(Vec3, Vec3)],
) -> Vec<Vec<Vec3>> {
    let models = [entry];
    let variant = shaders::Variant { models: &models, ..shaders::Variant::without_models(TraceBackend::Compute, false) };
    let linked = shaders::link("test", ROOT, variant);
    let reads_tables = linked.as_ref().unwrap().binding(BSDF_TABLES).is_ok();
    let shader = Shader::new(device, linked).unwrap();
    let options = PipelineOptions { constants: &[("model", f64::from(number(entry)))], ..Default::default() };
    let pipeline = ComputePipeline::new(device, &shader, "main", options).unwrap();
    let numbers: Vec<f32> =
        constants.iter().flat_map(|own| own.iter().copied().chain(std::iter::repeat(0.0)).take(MOST_CONSTANTS)).collect();
    let directions: Vec<Vec4> = pairs.iter().flat_map(|(wi, wo)| [wi.extend(0.0), wo.extend(0.0)]).collect();
    let values = constants.len() * pairs.len();
    let input = device.buffer_with("directions", &directions, BufferUsages::STORAGE).unwrap();
    let numbers = device.buffer_with("constants", &numbers, BufferUsages::STORAGE).unwrap();
    let output = device.buffer("values", (values * size_of::<Vec4>()) as u64, BufferUsages::STORAGE | BufferUsages::COPY_SRC).unwrap();
    let own = Bindings::new().with("constants", &numbers).with("directions", &input).with("values", &output);
    let tables = device.buffer_with(BSDF_TABLES, tables.numbers(), BufferUsages::STORAGE).unwrap();
    let shared = if reads_tables { Bindings::new().with(BSDF_TABLES, &tables) } else { Bindings::new() };
    let mut encoder = device.wgpu.create_command_encoder(&Default::default());
    pipeline.dispatch(device, &mut encoder, &shared, &own, UVec3::new(values as u32, 1, 1)).unwrap();
    device.queue.submit([encoder.finish()]);
    let all = readback::read_buffer::<Vec4>(device, &output.wgpu).unwrap();
    all.chunks(pairs.len()).map(|chunk| chunk.iter().map(|value| value.truncate()).collect()).collect()
}

/// The largest difference in units of the tolerance, 0.5 % of the value and 1e-5 of the largest one, and where it is.
fn worst(expected: impl Fn(Vec3, Vec3) -> Vec3, got: &[Vec3], pairs: &[(Vec3, Vec3)]) -> (f32, String) {
    let expected: Vec<Vec3> = pairs.iter().map(|&(wi, wo)| expected(wi, wo)).collect();
    let largest = expected.iter().fold(0.0, |largest: f32, value| largest.max(value.max_element())).max(1e-3);
    let off = |i: usize| ((got[i] - expected[i]).abs() / (0.005 * expected[i] + 1e-5 * largest)).max_element();
    // NaN is the largest in this order.
    let at = (0..pairs.len()).max_by(|&a, &b| off(a).total_cmp(&off(b))).unwrap();
    (off(at), format!("wi {}, wo {}: {} instead of {}", pairs[at].0, pairs[at].1, got[at], expected[at]))
}

/// Defaults, printed forms, every choice of every parameter, and random numbers.
#[test]
fn every_model_on_the_gpu_is_its_twin() {
    let device = Device::new().unwrap();
    let pairs = pairs();
    let mut faults = Vec::new();
    for entry in all().filter(|entry| entry.wesl.is_some()) {
        let cases = cases(entry);
        let mut constants: Vec<_> = cases.iter().map(|case| case.model.constants()).collect();
        let fault: Vec<f32> = constants[0].iter().map(|c| c * 1.02 + 0.001).collect();
        constants.push(fault);
        let values = on_device(&device, entry, &BsdfTables::new(), &constants, &pairs);
        for (case, got) in cases.iter().zip(&values) {
            let (off, what) = worst(|wi, wo| case.model.rendered_f_cos(wi, wo), got, &pairs);
            // So that NaN is a fault.
            let holds = off < 1.0;
            if !holds {
                faults.push(format!("{} {}: {off} times the tolerance at {what}", entry.id, case.what));
            }
        }
        let (off, _) = worst(|wi, wo| cases[0].model.rendered_f_cos(wi, wo), values.last().unwrap(), &pairs);
        assert!(off > 1.0 || constants[0].is_empty(), "{}: planted fault", entry.id);
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// Two tables in one buffer, one of them anisotropic, of formulas: whatever a model is, its table is one.
#[test]
fn every_table_on_the_gpu_is_its_twin() {
    let device = Device::new().unwrap();
    let pairs = pairs();
    let formula = |id: &str, pairs: &[(&str, &str)]| find(id).unwrap().from_pairs(pairs, Form::Corrected).unwrap();
    let models = [formula("ward", &[("m", "0.2")]), formula("ggx", &[("alpha_x", "0.2"), ("alpha_y", "0.5"), ("f0", "0.9,0.5,0.2")])];
    let tables: Vec<Tabulated> = models.iter().map(|model| Tabulated::new(&**model, Grid::of(&**model))).collect();
    assert_eq!(tables.iter().map(|table| table.grid.phi_h > 1).collect::<Vec<_>>(), [false, true]);
    let mut buffer = BsdfTables::new();
    let constants: Vec<Vec<f32>> = tables.iter().map(|table| buffer.add(table)).collect();
    for id in ["merl", "rgl", "nmf", "tucker"] {
        let values = on_device(&device, find(id).unwrap(), &buffer, &constants, &pairs);
        for (i, table) in tables.iter().enumerate() {
            let (off, what) = worst(|wi, wo| table.f_cos(wi, wo), &values[i], &pairs);
            assert!(off < 1.0, "{id} {i}: {off} times the tolerance at {what}");
            let (off, _) = worst(|wi, wo| table.f_cos(wi, wo), &values[1 - i], &pairs);
            assert!(off > 1.0, "planted fault, the other table");
        }
    }
}

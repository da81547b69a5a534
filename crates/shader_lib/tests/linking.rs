//! Linking, reflection and the errors a shader author sees.

use kajo_shader_lib::{BindingKind, ShaderError, ShaderLayout, SourceFile, Stage, Texels, check_library, link, link_with, naga};

const RAYS: &str = "
import shader_lib::color::luminance;
import super::common::twice;
enable wgpu_ray_query;

struct Params { sun_direction: vec3f, radius: f32, taps: u32, @size(12) _pad: u32 }
struct Ray { origin: vec3f, direction: vec3f }

@group(1) @binding(0) var<uniform> params: Params;
@group(1) @binding(1) var<storage, read> rays: array<Ray>;
@group(1) @binding(2) var colors: texture_2d<f32>;
@group(1) @binding(3) var depth: texture_depth_2d;
@group(1) @binding(4) var linear_sampler: sampler;
@group(1) @binding(5) var output: texture_storage_2d<r32float, write>;
@group(0) @binding(7) var scene: acceleration_structure;
@group(1) @binding(9) var<storage, read_write> unused: array<f32>;

override step_scale: f32 = 0.5;

@compute @workgroup_size(8, 4)
fn trace(@builtin(global_invocation_id) id: vec3u) {
    let ray = rays[id.x];
    var query: ray_query;
    rayQueryInitialize(&query, scene, RayDesc(0u, 0xffu, 0.0, params.radius, ray.origin, ray.direction));
    while rayQueryProceed(&query) {}
    let hit = rayQueryGetCommittedIntersection(&query).t;
    let color = textureSampleLevel(colors, linear_sampler, vec2f(0.5), 0.0).rgb;
    let z = textureLoad(depth, id.xy, 0);
    textureStore(output, id.xy, vec4f(twice(luminance(color)) * hit * z * step_scale));
}
";
const COMMON: SourceFile = SourceFile { name: "test/common", source: "fn twice(x: f32) -> f32 { return 2.0 * x; }" };

#[derive(ShaderLayout)]
#[repr(C)]
#[allow(dead_code, reason = "only the layout is looked at")]
struct Params {
    sun_direction: [f32; 3],
    radius: f32,
    taps: u32,
    _pad: [u32; 3],
}

/// Planted fault: two fields swapped, and a third shortened.
#[derive(ShaderLayout)]
#[repr(C)]
#[allow(dead_code, reason = "only the layout is looked at")]
struct WrongParams {
    radius: f32,
    sun_direction: [f32; 3],
    taps: u16,
}

fn rays() -> kajo_shader_lib::Linked {
    link_with(SourceFile { name: "test/ray-march", source: RAYS }, &[COMMON], &[]).unwrap()
}

#[test]
fn every_module_of_the_library_links_and_validates() {
    check_library(&[]).unwrap_or_else(|error| panic!("{error}"));
}

#[test]
fn bindings_are_read_by_name_kind_and_place() {
    let linked = rays();
    let names: Vec<_> = linked.bindings.iter().map(|b| (b.group, b.binding, b.name.as_str())).collect();
    let expected =
        [(0, 7, "scene"), (1, 0, "params"), (1, 1, "rays"), (1, 2, "colors"), (1, 3, "depth"), (1, 4, "linear_sampler"), (1, 5, "output")];
    assert_eq!(names, expected, "the unused buffer is left out");
    let kind = |name: &str| linked.binding(name).unwrap().kind;
    assert_eq!(kind("params"), BindingKind::Uniform { size: 32 });
    assert_eq!(kind("rays"), BindingKind::Storage { read_only: true, size: 32 });
    let dimension = naga::ImageDimension::D2;
    let texture = |texels, sampled| BindingKind::Texture { dimension, arrayed: false, multisampled: false, texels, sampled };
    assert_eq!(kind("colors"), texture(Texels::Float, true));
    assert_eq!(kind("depth"), texture(Texels::Depth, false));
    assert_eq!(kind("linear_sampler"), BindingKind::Sampler { comparison: false });
    let (format, access) = (naga::StorageFormat::R32Float, naga::StorageAccess::STORE);
    assert_eq!(kind("output"), BindingKind::StorageTexture { dimension, arrayed: false, format, access });
    assert_eq!(kind("scene"), BindingKind::AccelerationStructure);
}

#[test]
fn entry_points_and_overrides_are_read() {
    let linked = rays();
    let entry = linked.entry_point("trace").unwrap();
    assert_eq!((entry.stage, entry.workgroup_size), (Stage::Compute, [8, 4, 1]));
    assert_eq!(entry.bindings.len(), 7);
    assert_eq!((linked.overrides[0].name.as_str(), linked.overrides[0].default), ("step_scale", Some(0.5)));
}

#[test]
fn missing_names_are_errors_that_list_what_there_is() {
    let error = rays().binding("normals").unwrap_err().to_string();
    assert_eq!(error, "test/ray-march.wesl: no binding `normals`; it has: scene, params, rays, colors, depth, linear_sampler, output");
}

#[test]
fn equal_structs_pass_the_layout_check() {
    rays().check_layout::<Params>("Params").unwrap();
}

#[test]
fn layout_check_finds_planted_faults() {
    let error = rays().check_layout::<WrongParams>("Params").unwrap_err().to_string();
    assert!(error.contains("Rust has `radius` at byte 0 (4 bytes), WGSL has `sun_direction` at byte 0 (12 bytes)"), "{error}");
    assert!(error.contains("Rust has 20 bytes, WGSL has 32 bytes"), "{error}");
}

#[test]
fn features_decide_declarations_and_unknown_ones_are_errors() {
    let source = "
        @if(fast) const STEP = 2.0;
        @else const STEP = 1.0;
        @group(0) @binding(0) var<storage, read_write> out: f32;
        @compute @workgroup_size(1) fn main() { out = STEP; }";
    assert!(link("test/features", source, &[("fast", true)]).unwrap().wgsl.contains("2.0"));
    assert!(link("test/features", source, &[("fast", false)]).unwrap().wgsl.contains("1.0"));
    assert!(link("test/features", source, &[]).unwrap_err().to_string().contains("fast"));
}

fn place(error: &ShaderError) -> (&str, u32, &str) {
    match error {
        ShaderError::Source { file, line, text, .. } => (file, *line, text.trim()),
        other => panic!("no place: {other}"),
    }
}

#[test]
fn syntax_errors_name_file_and_line() {
    let error = link("test/syntax", "\n\n@compute @workgroup_size(1) fn main() { let = 1; }", &[]).unwrap_err();
    assert_eq!(place(&error).0, "test/syntax.wesl");
    assert_eq!(place(&error).1, 3);
}

#[test]
fn type_errors_name_the_line_of_the_statement_a_person_wrote() {
    let source = "import shader_lib::color::luminance;

        // a comment that the linker drops
        @compute @workgroup_size(1)
        fn main() {
            for (var i = 0u; i < 3u; i += 1u) {
                if i > 1u {
                    let good = luminance(vec3f(1.0));
                    let bad: vec2f = luminance(vec3f(1.0));
                }
            }
        }";
    let error = link("test/types", source, &[]).unwrap_err();
    assert_eq!(place(&error), ("test/types.wesl", 9, "let bad: vec2f = luminance(vec3f(1.0));"), "{error}");
}

#[test]
fn errors_in_imported_files_name_that_file() {
    let broken = SourceFile { name: "test/broken", source: "\n\nfn wrong() -> f32 {\n    return 1u;\n}" };
    let root = "import super::broken::wrong;\n@compute @workgroup_size(1) fn main() { let x = wrong(); }";
    let error = link_with(SourceFile { name: "test/root", source: root }, &[broken], &[]).unwrap_err();
    assert_eq!(place(&error).0, "test/broken.wesl", "{error}");
    assert!(!error.to_string().contains("_1wrong"), "mangled names stay inside: {error}");
}

#[test]
fn unknown_imports_name_the_line_and_what_is_missing() {
    let module = "import shader_lib::bsdf::nothing::f;\n@compute @workgroup_size(1) fn main() { f(); }";
    let error = link("test/imports", module, &[]).unwrap_err();
    assert_eq!(place(&error).1, 1, "{error}");
    let item = "import shader_lib::color::nothing;\n@compute @workgroup_size(1) fn main() { nothing(); }";
    assert!(link("test/imports", item, &[]).unwrap_err().to_string().contains("nothing"));
}

//! The reflectance models of `kajo_bsdf` on the GPU: each model's own WESL module, tables of those that have none, and the switch over those that a scene
//! uses.

use crate::Module;
use kajo_bsdf::models::{Kind, ModelEntry, all};
use std::fmt::Write;

/// Numbers that a material's model has room for: twin of `ModelConstants`.
pub const MOST_CONSTANTS: usize = 48;

/// The number by which shaders know a model; 0 is glTF's material.
pub fn number(model: &ModelEntry) -> u32 {
    1 + all().position(|entry| entry.id == model.id).expect("a registered model") as u32
}

/// The WESL module of a model, `models/ward`.
pub(crate) fn module(path: &str) -> Option<Module> {
    let name = path.strip_prefix("models/")?;
    let entry = all().find(|entry| module_name(entry) == name)?;
    Some(Module { path: entry.id, source: entry.wesl? })
}

fn module_name(entry: &ModelEntry) -> String {
    entry.id.replace('-', "_")
}

/// A module with `model_f_cos`, which knows these models and answers 0 for every other: f cos θi in 1/sr, of shading functions S/π. Twin of
/// `Reflectance::rendered_f_cos`. Models without a WESL module are read from tables, which [`BsdfTables`](crate::BsdfTables) makes of them.
pub fn switch(models: &[&ModelEntry]) -> String {
    let mut imports = String::new();
    let mut cases = String::new();
    for entry in models {
        // Models of files are tables here.
        let name = if entry.wesl.is_some() { module_name(entry) } else { "tabulated".to_owned() };
        let factor = match entry.kind {
            Kind::Bsf if entry.wesl.is_some() => "INV_PI",
            _ => "g.wi.z",
        };
        let import = format!("import shader_lib::models::{name}::{name}_value;\n");
        if !imports.contains(&import) {
            imports += &import;
        }
        writeln!(cases, "        case {}u: {{ return {name}_value(c, g) * {factor}; }}", number(entry)).expect("a string takes text");
    }
    format!(
        "import shader_lib::math::INV_PI;
import shader_lib::models::geometry::{{ModelConstants, ReflectionGeometry, reflection_geometry}};
{imports}
/// f cos θi of model number `model` for directions in its frame; 0 unless both are above the surface.
fn model_f_cos(model: u32, c: ModelConstants, wi: vec3f, wo: vec3f) -> vec3f {{
    if wi.z <= 0.0 || wo.z <= 0.0 {{
        return vec3f(0.0);
    }}
    let g = reflection_geometry(wi, wo);
    switch model {{
{cases}        default: {{ return vec3f(0.0); }}
    }}
}}
"
    )
}

//! Shader modules that every technique may import as `package::NAME`: the frame, the scene's buffers, lights, rays.

use crate::TraceBackend;
use kajo_bsdf::models::ModelEntry;
use kajo_shader_lib::{Linked, ShaderError, SourceFile, link_with, models};

macro_rules! files {
    ($($name:literal),* $(,)?) => { &[$(SourceFile { name: $name, source: include_str!(concat!("../wesl/", $name, ".wesl")) }),*] };
}

/// The modules.
pub const FILES: &[SourceFile<'static>] = files![
    "chebyshev",
    "depth_map",
    "emission",
    "environment",
    "frame",
    "gbuffer",
    "hit",
    "lights",
    "material",
    "raster",
    "ray_count",
    "reflect",
    "scene",
    "screen",
    "shadow_rays",
    "soft_map",
    "specular",
    "spread",
    "surface",
    "trace"
];

/// What the modules depend on.
#[derive(Clone, Copy, Debug)]
pub struct Variant<'a> {
    /// Who traces rays.
    pub backend: TraceBackend,
    /// Shaders choose textures from a list; otherwise they read texels from a buffer.
    pub bindless: bool,
    /// Reflectance models of the scene's materials, beside glTF's.
    pub models: &'a [&'static ModelEntry],
}

impl Variant<'static> {
    /// For scenes whose materials are glTF's.
    pub const fn without_models(backend: TraceBackend, bindless: bool) -> Self {
        Self { backend, bindless, models: &[] }
    }
}

/// Links a root file against these modules, `package::models` with the models that the variant names, and `shader_lib`.
///
/// # Errors
/// With file, line and message.
pub fn link(name: &str, source: &str, variant: Variant) -> Result<Linked, ShaderError> {
    link_with_files(name, source, &[], variant)
}

/// [`link`], where the root also imports `files`.
///
/// # Errors
/// As [`link`].
pub fn link_with_files(name: &str, source: &str, files: &[SourceFile], variant: Variant) -> Result<Linked, ShaderError> {
    let features = [("ray_query", variant.backend == TraceBackend::RayQuery), ("bindless", variant.bindless)];
    let models = models::switch(variant.models);
    let files = [FILES, files, &[SourceFile { name: "models", source: &models }]].concat();
    link_with(SourceFile { name, source }, &files, &features)
}

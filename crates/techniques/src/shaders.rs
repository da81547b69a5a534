//! Shader modules that every technique may import as `package::NAME`: the frame, the scene's buffers, lights, rays.

use crate::TraceBackend;
use kajo_shader_lib::{Linked, ShaderError, SourceFile, link_with};

macro_rules! files {
    ($($name:literal),* $(,)?) => { &[$(SourceFile { name: $name, source: include_str!(concat!("../wesl/", $name, ".wesl")) }),*] };
}

/// The modules.
pub const FILES: &[SourceFile<'static>] =
    files!["frame", "gbuffer", "lights", "material", "raster", "reflect", "scene", "surface", "trace"];

/// Links a root file against these modules and `shader_lib`.
///
/// # Errors
/// With file, line and message.
pub fn link(name: &str, source: &str, backend: TraceBackend, bindless: bool) -> Result<Linked, ShaderError> {
    let features = [("ray_query", backend == TraceBackend::RayQuery), ("bindless", bindless)];
    link_with(SourceFile { name, source }, FILES, &features)
}

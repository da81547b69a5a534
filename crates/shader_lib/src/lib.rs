//! Shared shader modules, and what turns a technique's WESL file into checked WGSL.
//!
//! [`link`] resolves the imports of a root file against the library, lets naga validate the result and reads from it what Rust needs
//! to know: bindings by name, entry points, struct layouts, overrides. Every error names the WESL file, line and message.
//! A shared function has the name, argument order and equation comment of its Rust twin; tests compare the two on a GPU. Twins that
//! have no other home are here: [`camera`], [`emission`], [`light`], [`packing`], [`random`].
//!
//! ```
//! let source = "
//!     import shader_lib::color::luminance;
//!     @group(0) @binding(0) var<storage, read_write> values: array<f32>;
//!     @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3u) {
//!         values[id.x] = luminance(vec3f(values[id.x]));
//!     }";
//! let linked = kajo_shader_lib::link("example/luminance", source, &[])?;
//! assert_eq!(linked.binding("values")?.binding, 0);
//! # Ok::<(), kajo_shader_lib::ShaderError>(())
//! ```

// The derive names this crate as its users do.
extern crate self as kajo_shader_lib;

pub mod camera;
mod diagnose;
pub mod emission;
mod error;
mod layout;
mod library;
pub mod light;
mod link;
pub mod models;
pub mod packing;
pub mod random;
mod reflect;
mod tables;

pub use error::ShaderError;
pub use kajo_shader_lib_derive::ShaderLayout;
pub use layout::{FieldLayout, RustLayout, ShaderLayout, StructLayout};
pub use library::{MODULES, Module, module};
pub use link::{Linked, SourceFile, check_library, link, link_with};
pub use naga;
pub use reflect::{Binding, BindingKind, EntryPoint, Override, Stage, Texels};
pub use tables::{BSDF_TABLES, BsdfTables, bsdf_tables};

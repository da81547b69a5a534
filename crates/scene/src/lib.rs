//! Scenes: the description ([`model`]), importers for glTF, OBJ, images and `.kajo.toml`, the built-in scenes, and the evaluation
//! of a scene at one time ([`Snapshot`]).
//!
//! A [`Scene`] is plain data with indices between flat lists; nothing in it knows a renderer. Whatever an importer ignores or
//! replaces is on [`Scene::ignored`], never dropped silently.

pub mod adjacency;
pub mod builtin;
mod culling;
mod decode;
mod emissive;
mod environment_file;
mod environment_lookup;
mod error;
pub mod framing;
pub mod gltf;
pub mod kajo_toml;
pub mod lighting;
mod limits;
mod load;
mod merge;
pub mod model;
pub mod obj;
pub mod shapes;
mod snapshot;
pub mod summary;
mod surface;
#[cfg(test)]
mod test_assets;
mod texture_lookup;

pub use adjacency::Adjacency;
pub use culling::{Culling, UnknownCulling};
pub use decode::decode_texture;
pub use emissive::EmissiveMesh;
pub use environment_file::{LoadedEnvironment, decode_environment, load_environment};
pub use error::SceneError;
pub use gltf::load_gltf;
pub use kajo_toml::load_kajo_toml;
pub use limits::{ImportLimits, MAX_IMAGE_PIXELS};
pub use load::{LoadOptions, load};
pub use model::*;
pub use obj::load_obj;
pub use snapshot::{Instance, PlacedCamera, PlacedLight, Snapshot};
pub use summary::Summary;
pub use surface::{SurfaceMaterial, SurfaceUv};

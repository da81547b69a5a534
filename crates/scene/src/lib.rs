//! Scenes: the description ([`model`]), importers for glTF, OBJ, images and `.kajo.toml`, the built-in scenes, and the evaluation
//! of a scene at one time ([`Snapshot`]).
//!
//! A [`Scene`] is plain data with indices between flat lists; nothing in it knows a renderer. Whatever an importer ignores or
//! replaces is on [`Scene::ignored`], never dropped silently.

mod error;
pub mod framing;
pub mod model;
mod snapshot;

pub use error::SceneError;
pub use model::*;
pub use snapshot::{Instance, PlacedCamera, PlacedLight, Snapshot};

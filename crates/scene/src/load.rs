//! From what the user types to a scene.

use crate::{Scene, SceneError, builtin};

/// How to load a scene.
#[derive(Clone, Debug, Default)]
pub struct LoadOptions {}

/// Loads the scene that `reference` names: a path ending in `.gltf`, `.glb`, `.obj` or `.kajo.toml`, or `builtin:NAME[:N]`.
///
/// # Errors
/// See [`SceneError`]; nothing of a failed scene is returned.
pub fn load(reference: &str, _options: &LoadOptions) -> Result<Scene, SceneError> {
    if let Some(name) = reference.strip_prefix("builtin:") {
        return builtin::load(name);
    }
    Err(SceneError::Unsupported {
        file: reference.into(),
        feature: "this kind of file".into(),
        advice: "give a .gltf, .glb, .obj or .kajo.toml file, or builtin:NAME".into(),
    })
}

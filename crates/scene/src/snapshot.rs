//! A scene evaluated at one time: world transforms, deformed meshes, placed lights and cameras.

use crate::{Camera, Light, Mesh};
use glam::{Affine3A, Mat4};
use kajo_units::Seconds;
use std::sync::Arc;

/// What the renderers see: the scene with every animation, skin and morph evaluated at `time`.
#[derive(Clone, Debug)]
pub struct Snapshot {
    /// The time it was evaluated at.
    pub time: Seconds,
    /// Meshes in object space; those that deform are new, the others shared with the scene. The first ones are in the scene's order.
    pub meshes: Vec<Arc<Mesh>>,
    /// Placed meshes, in node order: equal scenes give equal lists, so an index names the same thing at every time.
    pub instances: Vec<Instance>,
    /// Placed lights.
    pub lights: Vec<PlacedLight>,
    /// Placed cameras; never empty (a camera that frames the scene is made where a file has none).
    pub cameras: Vec<PlacedCamera>,
}

/// A mesh in the world.
#[derive(Clone, Copy, Debug)]
pub struct Instance {
    /// Index into [`Scene::nodes`](crate::Scene::nodes).
    pub node: usize,
    /// Index into [`Snapshot::meshes`].
    pub mesh: usize,
    /// Object to world; may mirror.
    pub world_from_object: Affine3A,
}

/// A light in the world.
#[derive(Clone, Debug)]
pub struct PlacedLight {
    /// The light.
    pub light: Light,
    /// Light space (shines along −z) to world.
    pub world_from_light: Affine3A,
}

/// A camera in the world.
#[derive(Clone, Debug)]
pub struct PlacedCamera {
    /// The camera.
    pub camera: Camera,
    /// View space (looks along −z) to world; rigid.
    pub world_from_view: Mat4,
}

//! The node hierarchy.

use glam::{Mat4, Quat, Vec3};

/// Translation, rotation and scale, or a matrix where a file gives one that has no such parts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Transform {
    /// parent_from_local = T · R · S.
    Trs {
        /// Translation, m.
        translation: Vec3,
        /// Rotation, unit quaternion.
        rotation: Quat,
        /// Scale; may be negative or uneven.
        scale: Vec3,
    },
    /// An affine matrix; cannot be animated.
    Matrix(Mat4),
}

impl Default for Transform {
    fn default() -> Self {
        Self::Trs { translation: Vec3::ZERO, rotation: Quat::IDENTITY, scale: Vec3::ONE }
    }
}

/// A node: a transform and what stands there.
#[derive(Clone, Debug, Default)]
pub struct Node {
    /// For messages and material overrides.
    pub name: String,
    /// `None` for a root.
    pub parent: Option<usize>,
    /// parent_from_local at rest.
    pub transform: Transform,
    /// Indices into [`Scene::meshes`](crate::Scene::meshes).
    pub meshes: Vec<usize>,
    /// Index into [`Scene::skins`](crate::Scene::skins); the meshes are then placed by the joints alone.
    pub skin: Option<usize>,
    /// Morph weights that replace those of the meshes; empty keeps theirs.
    pub morph_weights: Vec<f32>,
    /// Index into [`Scene::lights`](crate::Scene::lights).
    pub light: Option<usize>,
    /// Index into [`Scene::cameras`](crate::Scene::cameras).
    pub camera: Option<usize>,
}

/// Joints that deform a mesh.
#[derive(Clone, Debug, Default)]
pub struct Skin {
    /// Node of each joint.
    pub joints: Vec<usize>,
    /// joint_from_mesh at bind time, one a joint.
    pub inverse_bind: Vec<Mat4>,
}

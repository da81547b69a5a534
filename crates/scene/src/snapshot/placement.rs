//! The node hierarchy multiplied out.

use crate::{Scene, Transform};
use glam::{Affine3A, Mat3A, Mat4, Vec3A};

/// parent_from_local of a transform.    glTF 2.0, section 3.5.3
pub(super) fn parent_from_local(transform: &Transform) -> Affine3A {
    match *transform {
        Transform::Trs { translation, rotation, scale } => Affine3A::from_scale_rotation_translation(scale, rotation, translation),
        Transform::Matrix(matrix) => Affine3A::from_mat4(matrix),
    }
}

/// world_from_node of every node: the product along the chain of parents, each node once.
///
/// A product that overflows becomes the flat transform 0, which shows nothing; nodes on a cycle of parents are treated as roots.
pub(super) fn world_from_nodes(scene: &Scene, parent_from_node: &[Affine3A]) -> Vec<Affine3A> {
    let mut world: Vec<Option<Affine3A>> = vec![None; scene.nodes.len()];
    let mut chain = Vec::new();
    for start in 0..scene.nodes.len() {
        let mut next = Some(start);
        while let Some(node) = next.filter(|&node| world[node].is_none() && chain.len() <= scene.nodes.len()) {
            chain.push(node);
            next = scene.nodes[node].parent;
        }
        let mut world_from_parent = next.and_then(|node| world[node]).unwrap_or(Affine3A::IDENTITY);
        while let Some(node) = chain.pop() {
            let product = world_from_parent * parent_from_node[node];
            world_from_parent = if product.is_finite() { product } else { Affine3A::ZERO };
            world[node] = Some(world_from_parent);
        }
    }
    world.into_iter().map(|matrix| matrix.unwrap_or(Affine3A::IDENTITY)).collect()
}

/// The rigid part of a transform: its translation, its −z direction, and its y as far as it is perpendicular to that; no scale, no mirror.
pub(super) fn rigid(world_from_node: &Affine3A) -> Mat4 {
    let axes = world_from_node.matrix3;
    let z = axes.z_axis.try_normalize().unwrap_or(Vec3A::Z);
    let up = axes.y_axis - z * z.dot(axes.y_axis);
    let y = up.try_normalize().unwrap_or_else(|| z.any_orthonormal_vector());
    Mat4::from(Affine3A { matrix3: Mat3A::from_cols(y.cross(z), y, z), translation: world_from_node.translation })
}

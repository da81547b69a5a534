//! Morph targets and skins: the mesh a node shows at one time.

use crate::{Mesh, Node, Scene, Skin, SkinWeights};
use glam::{Affine3A, Mat3A, Vec3, Vec4};
use rayon::prelude::*;

/// True where a node shows the mesh otherwise than it is in the scene.
pub(super) fn deforms(mesh: &Mesh, node: &Node) -> bool {
    !mesh.morph_targets.is_empty() || is_skinned(mesh, node)
}

/// True where joints place the mesh, and the node's own transform does not count.    glTF 2.0, section 3.7.3.3
pub(super) fn is_skinned(mesh: &Mesh, node: &Node) -> bool {
    node.skin.is_some() && !mesh.skin_weights.is_empty()
}

/// The mesh as `node` shows it: morphed, then skinned. `weights` empty takes the mesh's own.
pub(super) fn deform(scene: &Scene, node: usize, mesh: usize, weights: &[f32], world_from_node: &[Affine3A]) -> Mesh {
    let source = &*scene.meshes[mesh];
    let mut out = source.clone();
    morph(&mut out, if weights.is_empty() { &source.morph_weights } else { weights });
    if let Some(skin) = scene.nodes[node].skin.filter(|_| is_skinned(source, &scene.nodes[node])) {
        skin_mesh(&mut out, &joint_matrices(&scene.skins[skin], world_from_node));
    }
    if out.faceted {
        out.make_faceted_normals();
    }
    out.morph_targets = Vec::new();
    out.morph_weights = Vec::new();
    out.skin_weights = Vec::new();
    out
}

/// attribute + Σ weight · displacement; normals and tangents are made unit again, colours stay in [0, 1].    glTF 2.0, section 3.7.2.2
fn morph(mesh: &mut Mesh, weights: &[f32]) {
    let targets = std::mem::take(&mut mesh.morph_targets);
    for (target, &weight) in targets.iter().zip(weights).filter(|&(_, &weight)| weight != 0.0) {
        add(&mut mesh.positions, &target.positions, weight);
        add(&mut mesh.normals, &target.normals, weight);
        for (tangent, &displacement) in mesh.tangents.iter_mut().zip(&target.tangents) {
            *tangent += (displacement * weight).extend(0.0);
        }
        for (uvs, displacements) in mesh.uvs.iter_mut().zip(&target.uvs) {
            add(uvs, displacements, weight);
        }
        add(&mut mesh.colors, &target.colors, weight);
    }
    for normal in &mut mesh.normals {
        *normal = normal.normalize_or(Vec3::Z);
    }
    for tangent in &mut mesh.tangents {
        *tangent = tangent.truncate().normalize_or(Vec3::X).extend(tangent.w);
    }
    for color in &mut mesh.colors {
        *color = color.clamp(Vec4::ZERO, Vec4::ONE);
    }
}

fn add<T>(values: &mut [T], displacements: &[T], weight: f32)
where
    T: Copy + std::ops::AddAssign + std::ops::Mul<f32, Output = T>,
{
    for (value, &displacement) in values.iter_mut().zip(displacements) {
        *value += displacement * weight;
    }
}

/// world_from_mesh at bind time, through each joint.
fn joint_matrices(skin: &Skin, world_from_node: &[Affine3A]) -> Vec<Affine3A> {
    skin.joints
        .iter()
        .zip(&skin.inverse_bind)
        .map(|(&joint, joint_from_mesh)| world_from_node[joint] * Affine3A::from_mat4(*joint_from_mesh))
        .collect()
}

/// Linear blend skinning: M = Σ wᵢ Jᵢ, positions by M, tangents by its linear part, normals by the inverse transpose of that.
///
/// The inverse transpose is taken as the cofactor matrix, det(M) M⁻ᵀ, which exists for every M; where M mirrors, the sign is put right and
/// the triangle is turned, so that front faces stay front faces.
fn skin_mesh(mesh: &mut Mesh, joints: &[Affine3A]) {
    let blended: Vec<Affine3A> = mesh.skin_weights.par_iter().map(|weights| blend(weights, joints)).collect();
    let sign = |m: &Affine3A| if m.matrix3.determinant() < 0.0 { -1.0 } else { 1.0 };
    for (position, m) in mesh.positions.iter_mut().zip(&blended) {
        let moved = m.transform_point3(*position);
        *position = if moved.is_finite() { moved } else { Vec3::ZERO };
    }
    for (normal, m) in mesh.normals.iter_mut().zip(&blended) {
        *normal = (Vec3::from(cofactor(&m.matrix3) * glam::Vec3A::from(*normal)) * sign(m)).normalize_or(*normal);
    }
    for (tangent, m) in mesh.tangents.iter_mut().zip(&blended) {
        let along = m.transform_vector3(tangent.truncate());
        *tangent = along.normalize_or(tangent.truncate()).extend(tangent.w * sign(m));
    }
    for triangle in &mut mesh.indices {
        if sign(&blended[triangle[0] as usize]) < 0.0 {
            triangle.swap(1, 2);
        }
    }
}

fn blend(weights: &SkinWeights, joints: &[Affine3A]) -> Affine3A {
    let mut sum = Affine3A::ZERO;
    for (&joint, &weight) in weights.joints.iter().zip(&weights.weights).filter(|&(_, &weight)| weight != 0.0) {
        let m = &joints[usize::from(joint)];
        sum.matrix3 += m.matrix3 * weight;
        sum.translation += m.translation * weight;
    }
    sum
}

/// det(M) · M⁻ᵀ, whose columns are the cross products of M's columns.
fn cofactor(m: &Mat3A) -> Mat3A {
    Mat3A::from_cols(m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis))
}

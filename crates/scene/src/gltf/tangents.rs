//! Tangents that a file leaves out, by MikkTSpace as glTF asks.    glTF 2.0, section 3.7.2.1; \[Mikkelsen08]

use crate::Mesh;
use bevy_mikktspace::{Geometry, TangentSpace, generate_tangents};
use glam::{Vec3, Vec4};
use std::collections::HashMap;

/// The corners of a mesh, and their tangents in the making.
struct Corners<'a> {
    mesh: &'a Mesh,
    uv_slot: usize,
    tangents: Vec<[Vec4; 3]>,
}

impl Corners<'_> {
    fn vertex(&self, face: usize, corner: usize) -> usize {
        self.mesh.indices[face][corner] as usize
    }
}

impl Geometry for Corners<'_> {
    fn num_faces(&self) -> usize {
        self.mesh.indices.len()
    }

    fn num_vertices_of_face(&self, _: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        self.mesh.positions[self.vertex(face, corner)].to_array()
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        self.mesh.normals[self.vertex(face, corner)].to_array()
    }

    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        self.mesh.uvs[self.uv_slot][self.vertex(face, corner)].to_array()
    }

    fn set_tangent(&mut self, space: Option<TangentSpace>, face: usize, corner: usize) {
        let normal = self.mesh.normals[self.vertex(face, corner)];
        let [x, y, z, sign] = space.map_or([0.0, 0.0, 0.0, -1.0], |space| space.tangent_encoded());
        let along = Vec3::new(x, y, z);
        let along = along.try_normalize().unwrap_or_else(|| normal.any_orthonormal_vector());
        // The bitangent of MikkTSpace runs along +v, that of glTF's normal maps against it, since v is down.
        self.tangents[face][corner] = along.extend(-sign);
    }
}

/// Gives a mesh tangents along the texture coordinates of a slot. A vertex whose corners differ in their tangents is split.
pub fn generate(mesh: &mut Mesh, uv_slot: usize) {
    let faces = mesh.indices.len();
    let mut corners = Corners { mesh, uv_slot, tangents: vec![[Vec4::ZERO; 3]; faces] };
    let unset = generate_tangents(&mut corners).is_err();
    let mut tangents = corners.tangents;
    for (face, triangle) in tangents.iter_mut().enumerate() {
        for (corner, tangent) in triangle.iter_mut().enumerate().filter(|(_, tangent)| unset || tangent.w == 0.0) {
            let normal = mesh.normals[mesh.indices[face][corner] as usize];
            *tangent = normal.any_orthonormal_vector().extend(1.0);
        }
    }

    let mut vertices = Vec::with_capacity(mesh.positions.len());
    let mut vertex_tangents = Vec::with_capacity(mesh.positions.len());
    let mut known = HashMap::with_capacity(mesh.positions.len());
    let mut indices = mesh.indices.clone();
    for (triangle, tangents) in indices.iter_mut().zip(&tangents) {
        for (index, tangent) in triangle.iter_mut().zip(tangents) {
            let key = (*index, tangent.to_array().map(f32::to_bits));
            *index = *known.entry(key).or_insert_with(|| {
                vertices.push(*index);
                vertex_tangents.push(*tangent);
                vertices.len() as u32 - 1
            });
        }
    }
    *mesh = mesh.gather(&vertices);
    mesh.indices = indices;
    mesh.tangents = vertex_tangents;
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec2;

    fn quad(uvs: [[f32; 2]; 4]) -> Mesh {
        Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y],
            normals: vec![Vec3::Z; 4],
            uvs: [uvs.into_iter().map(Vec2::from).collect(), Vec::new()],
            indices: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        }
    }

    /// u grows along +x and v down, as in an upright picture: the tangent is +x, and w·(n × t) = +y points up the picture.
    #[test]
    fn upright_texture_has_tangent_x_and_positive_handedness() {
        let mut mesh = quad([[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]]);
        generate(&mut mesh, 0);
        assert_eq!(mesh.positions.len(), 4, "smooth corners stay shared");
        for tangent in &mesh.tangents {
            assert!(tangent.distance(Vec4::new(1.0, 0.0, 0.0, 1.0)) < 1e-6, "{tangent}");
        }
    }

    #[test]
    fn mirrored_texture_turns_tangent_and_handedness() {
        let mut mesh = quad([[1.0, 1.0], [0.0, 1.0], [0.0, 0.0], [1.0, 0.0]]);
        generate(&mut mesh, 0);
        for tangent in &mesh.tangents {
            assert!(tangent.distance(Vec4::new(-1.0, 0.0, 0.0, -1.0)) < 1e-6, "{tangent}");
        }
    }

    #[test]
    fn vertices_are_split_where_mirrored_halves_meet() {
        let mut mesh = quad([[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]]);
        mesh.uvs[0][3] = Vec2::new(2.0, 1.0); // mirrors the second triangle
        generate(&mut mesh, 0);
        assert_eq!(mesh.positions.len(), 6);
        assert_eq!(mesh.indices.iter().flatten().count(), 6);
        assert!(mesh.tangents[..3].iter().all(|t| t.w == 1.0) && mesh.tangents[3..].iter().all(|t| t.w == -1.0));
    }

    #[test]
    fn degenerate_texture_coordinates_still_give_unit_tangents() {
        let mut mesh = quad([[0.5; 2]; 4]);
        mesh.indices.push([0, 0, 0]);
        generate(&mut mesh, 0);
        for (tangent, normal) in mesh.tangents.iter().zip(&mesh.normals) {
            assert!((tangent.truncate().length() - 1.0).abs() < 1e-5 && tangent.w.abs() == 1.0, "{tangent}");
            assert!(tangent.truncate().dot(*normal).abs() < 1e-5);
        }
    }
}

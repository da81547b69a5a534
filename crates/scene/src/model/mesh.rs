//! Triangle meshes.

use crate::SurfaceUv;
use glam::{Vec2, Vec3, Vec4};

/// An indexed triangle mesh with one material, in its own object space.
///
/// Every per-vertex list is empty or as long as `positions`. Front faces wind counter-clockwise.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// For messages and id images.
    pub name: String,
    /// Vertex positions, m.
    pub positions: Vec<Vec3>,
    /// Shading normals, unit length. Never empty after import: faceted ones are made where a file has none (vertices unshared).
    pub normals: Vec<Vec3>,
    /// True where the normals were made, one a face, because a file has none: a deformed mesh then gets them anew.
    pub faceted: bool,
    /// Tangents (xyz unit, w = ±1: bitangent = w · normal × tangent). Empty unless a material needs them.
    pub tangents: Vec<Vec4>,
    /// Texture coordinates, set 0 and set 1; v down, as in glTF.
    pub uvs: [Vec<Vec2>; 2],
    /// Vertex colours, linear RGBA, multiplied with the base colour.
    pub colors: Vec<Vec4>,
    /// Three vertex indices a triangle.
    pub indices: Vec<[u32; 3]>,
    /// Index into [`Scene::materials`](crate::Scene::materials).
    pub material: usize,
    /// Joints and weights of each vertex; empty when the mesh is not skinned.
    pub skin_weights: Vec<SkinWeights>,
    /// Displacements blended by the weights of the node.
    pub morph_targets: Vec<MorphTarget>,
    /// Default weight of each morph target.
    pub morph_weights: Vec<f32>,
}

impl Mesh {
    /// The box of its vertices, object space, m: low and high corner; low above high without vertices.
    pub fn bounds(&self) -> [Vec3; 2] {
        self.positions.iter().fold([Vec3::INFINITY, Vec3::NEG_INFINITY], |[low, high], p| [low.min(*p), high.max(*p)])
    }

    /// Makes [`Mesh::normals`] those of the faces. Each vertex belongs to one triangle (the last that names it wins); a triangle without area
    /// gets +z.
    pub fn make_faceted_normals(&mut self) {
        self.normals.clear();
        self.normals.resize(self.positions.len(), Vec3::Z);
        for triangle in &self.indices {
            let [a, b, c] = triangle.map(|vertex| self.positions[vertex as usize]);
            let normal = (b - a).cross(c - a).normalize_or(Vec3::Z);
            for &vertex in triangle {
                self.normals[vertex as usize] = normal;
            }
        }
        self.faceted = true;
    }

    /// Texture coordinates and colour at the barycentric weights `1 − u − v, u, v` of a triangle.
    #[inline]
    pub fn uv_at(&self, triangle: u32, u: f32, v: f32) -> SurfaceUv {
        let [i, j, k] = self.indices[triangle as usize].map(|i| i as usize);
        let w = 1.0 - u - v;
        let uv = |set: &Vec<Vec2>| if set.is_empty() { Vec2::ZERO } else { set[i] * w + set[j] * u + set[k] * v };
        let colors = &self.colors;
        let color = if colors.is_empty() { Vec4::ONE } else { colors[i] * w + colors[j] * u + colors[k] * v };
        SurfaceUv { uvs: [uv(&self.uvs[0]), uv(&self.uvs[1])], color }
    }

    /// The same mesh with other vertices: vertex i of the result is vertex `sources[i]`. The indices are left out, since they name the old
    /// vertices.
    pub fn gather(&self, sources: &[u32]) -> Self {
        fn pick<T: Copy>(values: &[T], sources: &[u32]) -> Vec<T> {
            if values.is_empty() { Vec::new() } else { sources.iter().map(|&source| values[source as usize]).collect() }
        }
        let pick_target = |target: &MorphTarget| MorphTarget {
            positions: pick(&target.positions, sources),
            normals: pick(&target.normals, sources),
            tangents: pick(&target.tangents, sources),
            uvs: target.uvs.each_ref().map(|uvs| pick(uvs, sources)),
            colors: pick(&target.colors, sources),
        };
        Self {
            name: self.name.clone(),
            positions: pick(&self.positions, sources),
            normals: pick(&self.normals, sources),
            faceted: self.faceted,
            tangents: pick(&self.tangents, sources),
            uvs: self.uvs.each_ref().map(|uvs| pick(uvs, sources)),
            colors: pick(&self.colors, sources),
            indices: Vec::new(),
            material: self.material,
            skin_weights: pick(&self.skin_weights, sources),
            morph_targets: self.morph_targets.iter().map(pick_target).collect(),
            morph_weights: self.morph_weights.clone(),
        }
    }
}

/// Up to eight joints of one vertex (two glTF sets); unused entries have weight 0. Weights sum to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SkinWeights {
    /// Indices into [`Skin::joints`](crate::Skin::joints).
    pub joints: [u16; 8],
    /// Weights of the joints.
    pub weights: [f32; 8],
}

/// Displacements added to the vertices, each list empty or one entry a vertex.
#[derive(Clone, Debug, Default)]
pub struct MorphTarget {
    /// Added to positions.
    pub positions: Vec<Vec3>,
    /// Added to normals (then normalised).
    pub normals: Vec<Vec3>,
    /// Added to the xyz of tangents.
    pub tangents: Vec<Vec3>,
    /// Added to texture coordinates.
    pub uvs: [Vec<Vec2>; 2],
    /// Added to vertex colours.
    pub colors: Vec<Vec4>,
}

//! Which triangles of a mesh share an edge, whether the mesh is closed, and where its silhouette lies for a light.
//!
//! Importers split vertices where normals or texture coordinates jump, so corners are welded by position first, bit for bit. A mesh is *closed* when
//! each edge is run through as often in one direction as in the other: then its triangles have no boundary as a chain, which is what shadow
//! volumes rest on. The two triangles a side of a 2-manifold are the usual case of it; two bodies that touch in an edge are another.
//!
//! Whether a triangle faces a light is one sign, whoever asks. So silhouettes are closed loops, whatever rounding does to the sign.

use crate::Mesh;
use glam::{DVec3, Vec3, Vec4};

/// An edge between two welded corners, and up to two triangles at it. Where more meet, the edge is listed several times.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Edge {
    /// Vertices of the mesh: of the corners welded together, the first.
    pub vertices: [u32; 2],
    /// Of the triangles.
    pub sides: [Option<Side>; 2],
}

/// A triangle at an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Side {
    /// Its index.
    pub triangle: u32,
    /// Whether it runs through the edge from the first vertex to the second.
    pub forward: bool,
}

/// What the edges say about a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Topology {
    /// Places where two corners are joined.
    pub edges: usize,
    /// Those with one triangle.
    pub open: usize,
    /// Those with two triangles that run through them in the same direction.
    pub flipped: usize,
    /// Those with three triangles or more.
    pub crowded: usize,
    /// Those that are run through more often in one direction than in the other.
    pub unbalanced: usize,
    /// Triangles with two corners in one place; they have no edges here.
    pub degenerate: usize,
}

impl Topology {
    /// The triangles have no boundary.
    pub fn is_closed(&self) -> bool {
        self.unbalanced == 0
    }

    /// Closed, and two triangles at each edge: the usual closed mesh.
    pub fn is_manifold(&self) -> bool {
        self.is_closed() && self.crowded == 0
    }
}

/// The edges of a mesh.
#[derive(Clone, Debug)]
pub struct Adjacency {
    /// By vertices, each undirected.
    pub edges: Vec<Edge>,
    /// What they say.
    pub topology: Topology,
    /// For each vertex the first one in its place.
    welded: Vec<u32>,
}

impl Adjacency {
    /// Finds the edges of `mesh`.
    pub fn new(mesh: &Mesh) -> Self {
        let welded = weld(&mesh.positions);
        let mut topology = Topology::default();
        // Both corners in ascending order as one number; twice the triangle, plus one where it runs backwards.
        let mut uses: Vec<(u64, u32)> = Vec::with_capacity(mesh.indices.len() * 3);
        for (triangle, corners) in mesh.indices.iter().enumerate() {
            let [a, b, c] = corners.map(|vertex| welded[vertex as usize]);
            if a == b || b == c || c == a {
                topology.degenerate += 1;
                continue;
            }
            for (from, to) in [(a, b), (b, c), (c, a)] {
                uses.push((u64::from(from.min(to)) << 32 | u64::from(from.max(to)), 2 * triangle as u32 + u32::from(from > to)));
            }
        }
        uses.sort_unstable();
        let mut edges = Vec::with_capacity(uses.len() / 2 + 1);
        for group in uses.chunk_by(|a, b| a.0 == b.0) {
            let side = |&(_, packed): &(u64, u32)| Side { triangle: packed / 2, forward: packed % 2 == 0 };
            let (forward, backward): (Vec<Side>, Vec<Side>) = group.iter().map(side).partition(|side| side.forward);
            let vertices = [(group[0].0 >> 32) as u32, group[0].0 as u32];
            for i in 0..forward.len().max(backward.len()) {
                edges.push(Edge { vertices, sides: [forward.get(i).copied(), backward.get(i).copied()] });
            }
            topology.edges += 1;
            topology.open += usize::from(group.len() == 1);
            topology.flipped += usize::from(group.len() == 2 && forward.len() != 1);
            topology.crowded += usize::from(group.len() > 2);
            topology.unbalanced += usize::from(forward.len() != backward.len());
        }
        Self { edges, topology, welded }
    }

    /// Whether it is the adjacency of `mesh` too, which has the same triangles with other positions: what was welded is still together.
    pub fn fits(&self, mesh: &Mesh) -> bool {
        let together = |(vertex, &first): (usize, &u32)| key(mesh.positions[vertex]) == key(mesh.positions[first as usize]);
        self.welded.len() == mesh.positions.len() && self.welded.iter().enumerate().all(together)
    }

    /// The silhouette of a closed mesh: edges between a triangle that faces the light and one that does not, in the direction in which the one
    /// that faces it runs through them. Each edge is listed as often as such a pair meets there.
    pub fn silhouette(&self, faces: &[bool]) -> Vec<[u32; 2]> {
        let lit = |side: Option<Side>| side.filter(|side| faces[side.triangle as usize]);
        let directed = |edge: &Edge| match edge.sides.map(lit) {
            [Some(_), None] => Some(edge.vertices),
            [None, Some(_)] => Some([edge.vertices[1], edge.vertices[0]]),
            _ => None,
        };
        self.edges.iter().filter_map(directed).collect()
    }
}

/// Which triangles face a light: at `light.xyz` where w is 1, in the direction `light.xyz` where w is 0, in the coordinates of the mesh. Those that are
/// seen edge-on do not.
///
/// ```text
/// (b − a) × (c − a) · (light − a) > 0
/// ```
pub fn faces(mesh: &Mesh, light: Vec4) -> Vec<bool> {
    let (light, w) = (light.truncate().as_dvec3(), f64::from(light.w));
    let facing = |corners: &[u32; 3]| {
        let [a, b, c]: [DVec3; 3] = corners.map(|vertex| mesh.positions[vertex as usize].as_dvec3());
        (b - a).cross(c - a).dot(light - a * w) > 0.0
    };
    mesh.indices.iter().map(facing).collect()
}

/// Bits of a position; both zeros are one.
fn key(position: Vec3) -> [u32; 3] {
    (position + Vec3::ZERO).to_array().map(f32::to_bits)
}

/// For each point the first one in the same place.
fn weld(positions: &[Vec3]) -> Vec<u32> {
    let mut order: Vec<([u32; 3], u32)> = positions.iter().enumerate().map(|(i, &p)| (key(p), i as u32)).collect();
    order.sort_unstable();
    let mut first = vec![0; positions.len()];
    for group in order.chunk_by(|a, b| a.0 == b.0) {
        for &(_, vertex) in group {
            first[vertex as usize] = group[0].1;
        }
    }
    first
}

#[cfg(test)]
mod tests;

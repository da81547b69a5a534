//! Ray against triangle, watertight and exact.
//!
//! As in \[Woop13], vertices are translated and sheared so that the ray runs along +z from the origin; the triangle is hit when the
//! origin lies inside its projection, which the signs of three edge functions tell. Adjacent triangles shear a shared vertex to the
//! same numbers, so the projections tile without gaps.
//!
//! Deviations from \[Woop13], both for one reason, that the answer should be exact on the sheared vertices:
//! - Edge functions and `t` are computed in double precision, where products of singles are exact and so are signs. A single-precision `t`
//!   could be wrong by the length of a triangle seen edge-on, and then its box would not contain it. (Single precision may only *reject*:
//!   rounding is monotone, so a computed sign is the true one or zero.)
//! - An edge function that is exactly zero (the ray meets an edge or a vertex) takes the sign it would have if the ray were moved by an
//!   infinitesimal step along x and a yet smaller one along y (\[Edelsbrunner90]). So a ray crosses exactly one of two triangles that
//!   share the edge, and a closed mesh an even number of times.

use crate::ray::Ray;
use glam::Vec3;

/// Greatest magnitude of a coordinate: products of two sheared coordinates then stay finite in single precision.
pub const MAX_COORDINATE: f32 = 1e18;

/// Triangles of a [`Block`].
pub(crate) const BLOCK_SIZE: usize = 4;

/// Marks an unused lane of a [`Block`].
pub(crate) const NO_PRIMITIVE: u32 = u32::MAX;

/// Four triangles, side by side for SIMD.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(16))]
pub(crate) struct Block {
    /// `[vertex][axis][lane]`, m. NaN in unused lanes: every comparison then fails.
    pub vertices: [[[f32; BLOCK_SIZE]; 3]; 3],
    /// Index of the triangle in its mesh, [`NO_PRIMITIVE`] in unused lanes.
    pub primitives: [u32; BLOCK_SIZE],
}

impl Block {
    /// No triangles.
    pub const EMPTY: Self = Self { vertices: [[[f32::NAN; BLOCK_SIZE]; 3]; 3], primitives: [NO_PRIMITIVE; BLOCK_SIZE] };

    /// Puts a triangle into a lane.
    pub fn set(&mut self, lane: usize, primitive: u32, triangle: [Vec3; 3]) {
        for (vertex, p) in triangle.iter().enumerate() {
            for axis in 0..3 {
                self.vertices[vertex][axis][lane] = p[axis];
            }
        }
        self.primitives[lane] = primitive;
    }

    /// The triangle in a lane.
    pub fn get(&self, lane: usize) -> [Vec3; 3] {
        self.vertices.map(|axes| Vec3::from_array(axes.map(|lanes| lanes[lane])))
    }

    /// Lanes in use.
    pub fn len(&self) -> u32 {
        self.primitives.iter().filter(|&&p| p != NO_PRIMITIVE).count() as u32
    }
}

/// A ray prepared for triangles: the axis it runs along most becomes z, the others are sheared onto it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShearedRay {
    /// Which axes become x, y and z.
    pub axes: [usize; 3],
    /// Origin, in the new order of axes.
    pub origin: [f32; 3],
    /// Shear of x and y: the direction divided by its z.
    pub shear: [f32; 2],
    /// The direction's z.
    pub dz: f32,
}

/// Where a ray crosses the plane of a triangle that it hits, rounded once from double precision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// Ray parameter.
    pub t: f32,
    /// Barycentric weight of vertex 1.
    pub u: f32,
    /// Barycentric weight of vertex 2.
    pub v: f32,
}

/// The axes after z in a right-handed order; the last entry is never used and saves a bounds check.
static OTHER_AXES: [[usize; 2]; 4] = [[1, 2], [2, 0], [0, 1], [0, 1]];

impl ShearedRay {
    /// Prepares a ray whose direction is finite and not zero.
    #[inline(always)]
    pub fn new(ray: &Ray) -> Self {
        let size = ray.direction.abs();
        // Of equals the first. Arithmetic, not branches: directions are unpredictable.
        let (x_is_greatest, y_beats_z) = (size.x >= size.y.max(size.z), size.y >= size.z);
        let z = usize::from(!x_is_greatest) << usize::from(!y_beats_z);
        let [x, y] = OTHER_AXES[z & 3];
        let (o, d) = (ray.origin.to_array(), ray.direction.to_array());
        Self { axes: [x, y, z], origin: [o[x], o[y], o[z]], shear: [d[x] / d[z], d[y] / d[z]], dz: d[z] }
    }

    /// A vertex after translation and shear; its z is translated only.
    #[inline(always)]
    fn shear(&self, vertex: [f32; 3]) -> [f32; 3] {
        let z = vertex[self.axes[2]] - self.origin[2];
        let x = (vertex[self.axes[0]] - self.origin[0]) - self.shear[0] * z;
        let y = (vertex[self.axes[1]] - self.origin[1]) - self.shear[1] * z;
        [x, y, z]
    }

    /// Decides and measures one triangle.
    ///
    /// ```text
    /// U = C × B,  V = A × C,  W = B × A  (z components),   t = (U A_z + V B_z + W C_z) / ((U + V + W) d_z)
    /// ```
    ///
    /// \[Woop13] eq. 3–6, in double precision. `None` when it is missed or seen exactly edge-on.
    #[inline(always)]
    pub fn cross(&self, [a, b, c]: [[f32; 3]; 3]) -> Option<Crossing> {
        let (a, b, c) = (self.shear(a), self.shear(b), self.shear(c));
        let (u, v, w) = (edge(c, b), edge(a, c), edge(b, a));
        let side = is_positive(u, c, b);
        if is_positive(v, a, c) != side || is_positive(w, b, a) != side {
            return None;
        }
        let sum = u + v + w;
        // NaN comes from an unused lane.
        if sum == 0.0 || sum.is_nan() {
            return None;
        }
        let t = (u * f64::from(a[2]) + v * f64::from(b[2]) + w * f64::from(c[2])) / (sum * f64::from(self.dz));
        Some(Crossing { t: t as f32, u: (v / sum) as f32, v: (w / sum) as f32 })
    }

    /// [`cross`](Self::cross) for one lane of a block.
    #[inline(always)]
    pub fn cross_lane(&self, block: &Block, lane: usize) -> Option<Crossing> {
        let vertex = |v: usize| {
            let axes = &block.vertices[v];
            [axes[0][lane % BLOCK_SIZE], axes[1][lane % BLOCK_SIZE], axes[2][lane % BLOCK_SIZE]]
        };
        self.cross([vertex(0), vertex(1), vertex(2)])
    }
}

/// Edge function of sheared points: exact in sign, since both products are exact.
#[inline(always)]
fn edge(p: [f32; 3], q: [f32; 3]) -> f64 {
    f64::from(p[0]) * f64::from(q[1]) - f64::from(p[1]) * f64::from(q[0])
}

/// Sign of the edge function of (p, q), or where it is zero its sign when the origin moves to (δ, δ²), δ → 0⁺:
/// that of δ (p_y − q_y) + δ² (q_x − p_x).
#[inline(always)]
fn is_positive(edge: f64, p: [f32; 3], q: [f32; 3]) -> bool {
    if edge != 0.0 {
        edge > 0.0
    } else if p[1] != q[1] {
        p[1] > q[1]
    } else {
        q[0] > p[0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cross(origin: [f32; 3], direction: [f32; 3], triangle: [[f32; 3]; 3]) -> Option<Crossing> {
        ShearedRay::new(&Ray::new(origin.into(), direction.into())).cross(triangle)
    }

    #[test]
    fn the_crossing_is_where_algebra_puts_it() {
        let triangle = [[0.0, 0.0, 2.0], [4.0, 0.0, 2.0], [0.0, 4.0, 6.0]];
        // The plane is z = 2 + y; the ray (1, 1, 0) + t (0, 0, ½) meets it at z = 3.
        let hit = cross([1.0, 1.0, 0.0], [0.0, 0.0, 0.5], triangle).unwrap();
        assert_eq!(hit, Crossing { t: 6.0, u: 0.25, v: 0.25 });
        // From the other side, and backwards.
        assert_eq!(cross([1.0, 1.0, 10.0], [0.0, 0.0, -1.0], triangle).unwrap().t, 7.0);
        assert_eq!(cross([1.0, 1.0, 4.0], [0.0, 0.0, 1.0], triangle).unwrap().t, -1.0);
        assert_eq!(cross([3.0, 3.0, 0.0], [0.0, 0.0, 1.0], triangle), None);
    }

    #[test]
    fn triangles_around_a_vertex_share_every_ray_through_it_once() {
        // A fan of eight triangles around the origin, met exactly at the vertex, along every axis and its diagonals.
        let ring: Vec<[f32; 3]> =
            [[1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0], [-1, -1], [0, -1], [1, -1]].map(|[x, y]| [x as f32, y as f32, 0.0]).to_vec();
        for turn in 0..3 {
            let rotate = |p: [f32; 3]| [p[turn], p[(turn + 1) % 3], p[(turn + 2) % 3]];
            for slant in [[0.0, 0.0, 1.0], [0.5, 0.0, 1.0], [0.0, -0.5, 1.0], [0.5, 0.5, 1.0], [0.25, -0.75, -1.0]] {
                for offset in [[0.0, 0.0], [0.5, 0.0], [0.5, 0.5], [-0.25, 0.0], [0.0, -0.5]] {
                    let origin = [offset[0] - slant[0] * 4.0, offset[1] - slant[1] * 4.0, -slant[2] * 4.0];
                    let hits = (0..8).filter_map(|i| {
                        let triangle = [[0.0; 3], ring[i], ring[(i + 1) % 8]].map(rotate);
                        cross(rotate(origin), rotate(slant), triangle)
                    });
                    assert_eq!(hits.map(|h| h.t).collect::<Vec<_>>(), [4.0], "offset {offset:?} slant {slant:?} turn {turn}");
                }
            }
        }
    }

    #[test]
    fn triangles_without_area_are_never_hit() {
        for triangle in
            [[[0.0; 3]; 3], [[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 0.0, 0.0]], [[-1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [1.0, 1.0, 0.0]]]
        {
            assert_eq!(cross([0.0, 0.0, -1.0], [0.0, 0.0, 1.0], triangle), None);
        }
        // Seen edge-on.
        assert_eq!(cross([-2.0, 0.0, 0.0], [1.0, 0.0, 0.0], [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0]]), None);
    }

    #[test]
    fn scale_changes_neither_the_answer_nor_the_weights() {
        let triangle = [[0.1, 0.2, 2.0], [4.3, 0.4, 2.5], [0.3, 4.1, 6.0]];
        let reference = cross([1.1, 1.2, 0.0], [0.01, 0.02, 0.5], triangle).unwrap();
        for exponent in (-90..=50).step_by(10) {
            let k = 2.0f32.powi(exponent);
            let hit = cross([1.1 * k, 1.2 * k, 0.0], [0.01 * k, 0.02 * k, 0.5 * k], triangle.map(|p| p.map(|x| x * k)));
            assert_eq!(hit, Some(reference), "scale 2^{exponent}");
        }
    }
}

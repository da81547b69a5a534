//! Four-wide vectors of glam: SSE2, NEON or WebAssembly SIMD where there is one, else scalars.

use super::{Distances, Lanes};
use crate::{
    slab::SlabRay,
    triangle::{Block, ShearedRay},
    wide::Node,
};
use glam::Vec4;

/// Works on every processor.
pub(crate) struct Portable;

impl Lanes for Portable {
    #[inline(always)]
    fn boxes(ray: &SlabRay, node: &Node, t_max: f32) -> (u32, Distances) {
        let mut met = 0;
        let mut distances = Distances([0.0; 8]);
        for half in 0..2 {
            let lanes = 4 * half..4 * half + 4;
            let mut near = Vec4::splat(ray.t_min);
            let mut far = Vec4::splat(t_max);
            for axis in 0..3 {
                let planes = |plane: usize| Vec4::from_slice(&node.planes[plane][lanes.clone()]);
                let near_planes = planes(ray.near_plane[axis]);
                let far_planes = planes(ray.near_plane[axis] ^ 1);
                near = (near_planes * ray.reciprocal[axis] + ray.near[axis]).max(near);
                far = (far_planes * ray.reciprocal[axis] + ray.far[axis]).min(far);
            }
            met |= near.cmple(far).bitmask() << (4 * half);
            near.write_to_slice(&mut distances.0[lanes]);
        }
        (met, distances)
    }

    #[inline(always)]
    fn triangles(ray: &ShearedRay, block: &Block) -> u32 {
        let [x, y, z] = ray.axes;
        let sheared = |vertex: usize| {
            let row = |axis: usize| Vec4::from_array(block.vertices[vertex][axis]);
            let dz = row(z) - ray.origin[2];
            [(row(x) - ray.origin[0]) - ray.shear[0] * dz, (row(y) - ray.origin[1]) - ray.shear[1] * dz]
        };
        let (a, b, c) = (sheared(0), sheared(1), sheared(2));
        let edge = |p: [Vec4; 2], q: [Vec4; 2]| p[0] * q[1] - p[1] * q[0];
        let (u, v, w) = (edge(c, b), edge(a, c), edge(b, a));
        let least = u.min(v).min(w);
        let greatest = u.max(v).max(w);
        (least.cmpge(Vec4::ZERO) | greatest.cmple(Vec4::ZERO)).bitmask()
    }
}

//! Plain Rust, for every processor.

use super::{Distances, Lanes};
use crate::{
    slab::SlabRay,
    triangle::{BLOCK_SIZE, Block, ShearedRay},
    wide::{Node, WIDTH},
};

/// Loops over lanes that the compiler may turn into whatever vectors there are.
pub(crate) struct Portable;

impl Lanes for Portable {
    #[inline(always)]
    fn boxes(ray: &SlabRay, node: &Node, t_max: f32) -> (u32, Distances) {
        let mut near = [ray.t_min; WIDTH];
        let mut far = [t_max; WIDTH];
        for axis in 0..3 {
            let near_planes = &node.planes[ray.near_plane[axis]];
            let far_planes = &node.planes[ray.near_plane[axis] ^ 1];
            for i in 0..WIDTH {
                near[i] = near[i].max(near_planes[i] * ray.reciprocal[axis] + ray.near[axis]);
                far[i] = far[i].min(far_planes[i] * ray.reciprocal[axis] + ray.far[axis]);
            }
        }
        let met = (0..WIDTH).fold(0, |bits, i| bits | u32::from(near[i] <= far[i]) << i);
        (met, Distances(near))
    }

    #[inline(always)]
    fn triangles(ray: &ShearedRay, block: &Block) -> u32 {
        let [x, y, z] = ray.axes;
        let sheared = block.vertices.map(|v| {
            let mut out = [[0.0; BLOCK_SIZE]; 2];
            for i in 0..BLOCK_SIZE {
                let dz = v[z][i] - ray.origin[2];
                out[0][i] = (v[x][i] - ray.origin[0]) - ray.shear[0] * dz;
                out[1][i] = (v[y][i] - ray.origin[1]) - ray.shear[1] * dz;
            }
            out
        });
        let [a, b, c] = sheared;
        let edge = |p: &[[f32; BLOCK_SIZE]; 2], q: &[[f32; BLOCK_SIZE]; 2], i: usize| p[0][i] * q[1][i] - p[1][i] * q[0][i];
        (0..BLOCK_SIZE).fold(0, |bits, i| {
            let (u, v, w) = (edge(&c, &b, i), edge(&a, &c, i), edge(&b, &a, i));
            let kept = (u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0);
            bits | u32::from(kept) << i
        })
    }
}

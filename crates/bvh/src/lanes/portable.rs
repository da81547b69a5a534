//! Four-wide vectors of glam: SSE2, NEON or WebAssembly SIMD where there is one, else scalars.

use super::{Crossings, Distances, Lanes, Task};
use crate::{
    packet::Frustum,
    slab::SlabRay,
    stack::Stack,
    triangle::{Block, Crossing, ShearedRay},
    wide::{Child, Node},
};
use glam::Vec4;

/// Works on every processor.
pub(crate) struct Portable;

impl Lanes for Portable {
    #[inline(never)]
    fn call(task: &mut impl Task) {
        task.run::<Self>();
    }

    #[inline(always)]
    fn enter(ray: &SlabRay, node: &Node, t_max: f32, stack: &mut Stack) -> Child {
        let mut met = 0;
        let mut distances = Distances([0.0; 8]);
        let planes = node.planes.as_flattened();
        for half in [0, 4] {
            let load = |first: usize| Vec4::from_slice(&planes[first + half..]);
            let near = |axis: usize| load(ray.near_planes[axis]) * ray.reciprocal[axis] + ray.near[axis];
            let far = |axis: usize| load(ray.far_planes[axis]) * ray.reciprocal[axis] + ray.far[axis];
            let near = near(0).max(near(1)).max(near(2).max(Vec4::splat(ray.t_min)));
            let far = far(0).min(far(1)).min(far(2).min(Vec4::splat(t_max)));
            met |= near.cmple(far).bitmask() << half;
            near.write_to_slice(&mut distances.0[half..]);
        }
        stack.push_farther(node, ray.octant, met, &distances)
    }

    #[inline(always)]
    fn enter_all(ray: &SlabRay, node: &Node, t_max: f32, stack: &mut Stack) {
        let nearest = Self::enter(ray, node, t_max, stack);
        if nearest != Child::NONE {
            stack.push_child(nearest);
        }
    }

    #[inline(always)]
    fn frustum_boxes(frustum: &Frustum, node: &Node, t_max: f32) -> (u32, Distances) {
        frustum.boxes(node, t_max)
    }

    #[inline(always)]
    fn mul_add(a: f32, b: f32, c: f32) -> f32 {
        a * b + c
    }

    #[inline(always)]
    fn may_cross(ray: &ShearedRay, block: &Block) -> bool {
        candidates(ray, block) != 0
    }

    #[inline(always)]
    fn triangles(ray: &ShearedRay, block: &Block, t_min: f32, t_max: f32, out: &mut Crossings) -> u32 {
        let mut candidates = candidates(ray, block);
        let mut crossed = 0;
        while candidates != 0 {
            let lane = candidates.trailing_zeros() as usize;
            candidates &= candidates - 1;
            if let Some(Crossing { t, u, v }) = ray.cross_lane(block, lane)
                && t > t_min
                && t <= t_max
            {
                (out.t[lane], out.u[lane], out.v[lane]) = (t, u, v);
                crossed |= 1 << lane;
            }
        }
        crossed
    }
}

/// Lanes whose edge functions in single precision do not have two signs. Rounding is monotone, so none that is crossed is missing.
#[inline(always)]
fn candidates(ray: &ShearedRay, block: &Block) -> u32 {
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

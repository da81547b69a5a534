//! AVX2 and FMA.

use super::{Distances, Lanes};
use crate::{
    slab::SlabRay,
    triangle::{Block, ShearedRay},
    wide::Node,
};
use std::arch::x86_64::*;

/// Eight boxes in one register, four triangles in half of one. Used only inside functions that enable the features, after
/// [`Backend::is_supported`](super::Backend::is_supported) said so.
pub(crate) struct Avx2;

impl Lanes for Avx2 {
    #[inline(always)]
    fn boxes(ray: &SlabRay, node: &Node, t_max: f32) -> (u32, Distances) {
        // SAFETY: AVX2 and FMA are there (see the type); a row of planes is 8 floats aligned to 32 bytes (`Node` is, and rows are 32 bytes).
        unsafe {
            let mut near = _mm256_set1_ps(ray.t_min);
            let mut far = _mm256_set1_ps(t_max);
            for axis in 0..3 {
                let reciprocal = _mm256_set1_ps(ray.reciprocal[axis]);
                let near_planes = _mm256_load_ps(node.planes[ray.near_plane[axis]].as_ptr());
                let far_planes = _mm256_load_ps(node.planes[ray.near_plane[axis] ^ 1].as_ptr());
                // Where a product overflows to NaN, max and min keep their second operand: the box counts as met.
                near = _mm256_max_ps(_mm256_fmadd_ps(near_planes, reciprocal, _mm256_set1_ps(ray.near[axis])), near);
                far = _mm256_min_ps(_mm256_fmadd_ps(far_planes, reciprocal, _mm256_set1_ps(ray.far[axis])), far);
            }
            let met = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(near, far)) as u32;
            let mut distances = Distances([0.0; 8]);
            _mm256_store_ps(distances.0.as_mut_ptr(), near);
            (met, distances)
        }
    }

    #[inline(always)]
    fn triangles(ray: &ShearedRay, block: &Block) -> u32 {
        // SAFETY: AVX is there (see the type); a row of a block is 4 floats aligned to 16 bytes.
        unsafe {
            let [x, y, z] = ray.axes;
            let origin = ray.origin.map(|o| _mm_set1_ps(o));
            let shear = ray.shear.map(|s| _mm_set1_ps(s));
            let sheared = |v: usize| {
                let row = |axis: usize| _mm_load_ps(block.vertices[v][axis].as_ptr());
                let dz = _mm_sub_ps(row(z), origin[2]);
                [
                    _mm_sub_ps(_mm_sub_ps(row(x), origin[0]), _mm_mul_ps(shear[0], dz)),
                    _mm_sub_ps(_mm_sub_ps(row(y), origin[1]), _mm_mul_ps(shear[1], dz)),
                ]
            };
            let (a, b, c) = (sheared(0), sheared(1), sheared(2));
            // No fused multiply-add: one rounded and one exact product could give a shared edge two different signs.
            let edge = |p: [__m128; 2], q: [__m128; 2]| _mm_sub_ps(_mm_mul_ps(p[0], q[1]), _mm_mul_ps(p[1], q[0]));
            let (u, v, w) = (edge(c, b), edge(a, c), edge(b, a));
            let zero = _mm_setzero_ps();
            let least = _mm_min_ps(_mm_min_ps(u, v), w);
            let greatest = _mm_max_ps(_mm_max_ps(u, v), w);
            let kept = _mm_or_ps(_mm_cmpge_ps(least, zero), _mm_cmple_ps(greatest, zero));
            _mm_movemask_ps(kept) as u32
        }
    }
}

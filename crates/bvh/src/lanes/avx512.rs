//! AVX-512: whole packets in one register, and children put in order without branches. Boxes and triangles of single rays are tested as by AVX2:
//! registers of twice the width gain nothing there.

use super::{Avx2, Crossings, Distances, Lanes, Task, avx2::entry_and_exit};
use crate::{
    packet::Frustum,
    slab::SlabRay,
    stack::Stack,
    triangle::{Block, ShearedRay},
    wide::{Child, Node},
};
use std::arch::x86_64::*;

/// Sixteen rays in one register. Used only inside functions that enable the features, after
/// [`Backend::is_supported`](super::Backend::is_supported) said so.
pub(crate) struct Avx512;

impl Lanes for Avx512 {
    #[inline(always)]
    fn call(task: &mut impl Task) {
        #[inline(never)]
        #[target_feature(enable = "avx512f,avx512vl,avx512bw,avx512dq,avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
        fn with_features(task: &mut impl Task) {
            task.run::<Avx512>();
        }
        // SAFETY: the features are there (see the type).
        unsafe { with_features(task) }
    }

    /// One child that is met and two are decided by branches; more are put in order without.
    #[inline(always)]
    fn enter(ray: &SlabRay, node: &Node, t_max: f32, stack: &mut Stack) -> Child {
        let (near, far) = entry_and_exit(ray, node, t_max);
        // SAFETY: AVX-512 F and VL are there (see the type); the array of distances is aligned. All that grows the stack was written.
        unsafe {
            let met = u32::from(_mm256_cmp_ps_mask::<_CMP_LE_OQ>(near, far));
            if met == 0 {
                return Child::NONE;
            }
            let rest = met & (met - 1);
            if rest == 0 {
                return node.children[met.trailing_zeros() as usize % 8];
            }
            if rest & (rest - 1) == 0 {
                let mut distances = Distances([0.0; 8]);
                _mm256_store_ps(distances.0.as_mut_ptr(), near);
                return stack.push_farther_of_two(node, met, rest, &distances);
            }
            let met = write_in_order(ray, node, near, far, stack);
            stack.grow(met.count_ones() as usize - 1);
            let nearest = node.orders[ray.octant % 8] >> (3 * met.ilog2());
            node.children[nearest as usize % 8]
        }
    }

    #[inline(always)]
    fn enter_all(ray: &SlabRay, node: &Node, t_max: f32, stack: &mut Stack) {
        let (near, far) = entry_and_exit(ray, node, t_max);
        let met = write_in_order(ray, node, near, far, stack);
        // SAFETY: as many were written.
        unsafe { stack.grow(met.count_ones() as usize) }
    }

    #[inline(always)]
    fn frustum_boxes(frustum: &Frustum, node: &Node, t_max: f32) -> (u32, Distances) {
        Avx2::frustum_boxes(frustum, node, t_max)
    }

    #[inline(always)]
    fn mul_add(a: f32, b: f32, c: f32) -> f32 {
        Avx2::mul_add(a, b, c)
    }

    #[inline(always)]
    fn call_for<T>(it: &T) {
        Avx2::call_for(it);
    }

    #[inline(always)]
    fn may_cross(ray: &ShearedRay, block: &Block) -> bool {
        Avx2::may_cross(ray, block)
    }

    #[inline(always)]
    fn triangles(ray: &ShearedRay, block: &Block, t_min: f32, t_max: f32, out: &mut Crossings) -> u32 {
        Avx2::triangles(ray, block, t_min, t_max, out)
    }
}

/// Writes the children that are met and their distances into the room of the stack, in the order of the octant, and tells which of the order they
/// are. Only where the features of [`Avx512`] are.
#[inline(always)]
fn write_in_order(ray: &SlabRay, node: &Node, near: __m256, far: __m256, stack: &mut Stack) -> u8 {
    // SAFETY: the callers are there; the children are eight aligned words; the room is for eight words each, unaligned.
    unsafe {
        let shifts = _mm256_setr_epi32(0, 3, 6, 9, 12, 15, 18, 21);
        let order = _mm256_srlv_epi32(_mm256_set1_epi32(node.orders[ray.octant % 8] as i32), shifts);
        let (near, far) = (_mm256_permutexvar_ps(order, near), _mm256_permutexvar_ps(order, far));
        let children = _mm256_permutexvar_epi32(order, _mm256_load_si256(node.children.as_ptr().cast()));
        let met = _mm256_cmp_ps_mask::<_CMP_LE_OQ>(near, far);
        let (to_children, to_distances) = stack.room();
        _mm256_storeu_si256(to_children.as_mut_ptr().cast(), _mm256_maskz_compress_epi32(met, children));
        _mm256_storeu_ps(to_distances.as_mut_ptr().cast(), _mm256_maskz_compress_ps(met, near));
        met
    }
}

//! AVX-512: whole packets in one register. Single rays gain nothing from it and stay with AVX2.

use super::{Avx2, Crossings, Distances, Lanes, Task};
use crate::{
    packet::Frustum,
    slab::SlabRay,
    triangle::{Block, ShearedRay},
    wide::Node,
};

/// Sixteen rays in one register. Used like [`Avx2`].
pub(crate) struct Avx512;

impl Lanes for Avx512 {
    type Single = Avx2;

    #[inline(always)]
    fn call(task: impl Task) {
        #[inline(never)]
        #[target_feature(enable = "avx512f,avx512vl,avx512bw,avx512dq,avx2,fma")]
        fn with_features(task: impl Task) {
            task.run::<Avx512>();
        }
        // SAFETY: the features are there (see the type).
        unsafe { with_features(task) }
    }

    #[inline(always)]
    fn boxes(ray: &SlabRay, node: &Node, t_max: f32) -> (u32, Distances) {
        Avx2::boxes(ray, node, t_max)
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
    fn triangles(ray: &ShearedRay, block: &Block, t_min: f32, t_max: f32, out: &mut Crossings) -> u32 {
        Avx2::triangles(ray, block, t_min, t_max, out)
    }
}

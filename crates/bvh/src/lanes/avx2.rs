//! AVX2 and FMA.

use super::{Crossings, Distances, Lanes, Task};
use crate::{
    packet::Frustum,
    slab::SlabRay,
    stack::Stack,
    triangle::{Block, ShearedRay},
    wide::{Child, Node},
};
use std::arch::x86_64::*;

/// Eight boxes in one register, four triangles in half of one. Used only inside functions that enable the features, after
/// [`Backend::is_supported`](super::Backend::is_supported) said so.
pub(crate) struct Avx2;

impl Lanes for Avx2 {
    #[inline(always)]
    fn call(task: &mut impl Task) {
        #[inline(never)]
        #[target_feature(enable = "avx2,fma")]
        fn with_features(task: &mut impl Task) {
            task.run::<Avx2>();
        }
        // SAFETY: the features are there (see the type).
        unsafe { with_features(task) }
    }

    #[inline(always)]
    fn enter(ray: &SlabRay, node: &Node, t_max: f32, stack: &mut Stack) -> Child {
        let (near, far) = entry_and_exit(ray, node, t_max);
        // SAFETY: AVX is there (see the type); the array of distances is aligned.
        unsafe {
            let met = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(near, far)) as u32;
            let mut distances = Distances([0.0; 8]);
            _mm256_store_ps(distances.0.as_mut_ptr(), near);
            stack.push_farther(node, ray.octant, met, &distances)
        }
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
        let planes = node.planes.as_ptr().cast::<f32>();
        // SAFETY: as in `boxes`; `Frustum::new` makes the starts of rows.
        unsafe {
            // No closures: what they call may end up outside of the function that has the instructions.
            macro_rules! met {
                ($planes:ident, $of:ident, $choose:ident, $axis:literal) => {{
                    let (plane, r, shift) =
                        (_mm256_load_ps(planes.add(frustum.$planes[$axis])), frustum.reciprocal[$axis], frustum.$of[$axis]);
                    let low = _mm256_fmadd_ps(plane, _mm256_set1_ps(r.low), _mm256_set1_ps(shift.low));
                    $choose(low, _mm256_fmadd_ps(plane, _mm256_set1_ps(r.high), _mm256_set1_ps(shift.high)))
                }};
            }
            let near = [
                met!(near_planes, near, _mm256_min_ps, 0),
                met!(near_planes, near, _mm256_min_ps, 1),
                met!(near_planes, near, _mm256_min_ps, 2),
            ];
            let far =
                [met!(far_planes, far, _mm256_max_ps, 0), met!(far_planes, far, _mm256_max_ps, 1), met!(far_planes, far, _mm256_max_ps, 2)];
            let near = _mm256_max_ps(_mm256_max_ps(near[0], near[1]), _mm256_max_ps(near[2], _mm256_set1_ps(frustum.t_min)));
            let far = _mm256_min_ps(_mm256_min_ps(far[0], far[1]), _mm256_min_ps(far[2], _mm256_set1_ps(t_max)));
            let met = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(near, far)) as u32;
            let mut distances = Distances([0.0; 8]);
            _mm256_store_ps(distances.0.as_mut_ptr(), near);
            (met, distances)
        }
    }

    #[inline(always)]
    fn mul_add(a: f32, b: f32, c: f32) -> f32 {
        a.mul_add(b, c)
    }

    #[inline(always)]
    fn call_for<T>(it: &T) {
        let start = std::ptr::from_ref(it).cast::<i8>();
        for line in (0..size_of::<T>()).step_by(64) {
            // SAFETY: a hint reads nothing, and the address is in `it`.
            unsafe { _mm_prefetch::<_MM_HINT_T0>(start.add(line)) }
        }
    }

    #[inline(always)]
    fn may_cross(ray: &ShearedRay, block: &Block) -> bool {
        // SAFETY: AVX is there (see the type).
        unsafe {
            let [a, b, c] = sheared(ray, block);
            // Rounding is monotone, so the signs are right or zero, and two signs tell a miss.
            macro_rules! edge {
                ($p:ident, $q:ident) => {
                    _mm_sub_ps(_mm_mul_ps($p[0], $q[1]), _mm_mul_ps($p[1], $q[0]))
                };
            }
            let (u, v, w) = (edge!(c, b), edge!(a, c), edge!(b, a));
            let least = _mm_min_ps(_mm_min_ps(u, v), w);
            let greatest = _mm_max_ps(_mm_max_ps(u, v), w);
            let zero = _mm_setzero_ps();
            _mm_movemask_ps(_mm_or_ps(_mm_cmpge_ps(least, zero), _mm_cmple_ps(greatest, zero))) != 0
        }
    }

    #[inline(always)]
    fn triangles(ray: &ShearedRay, block: &Block, t_min: f32, t_max: f32, out: &mut Crossings) -> u32 {
        // SAFETY: AVX and FMA are there (see the type); the rows of `out` are 4 floats aligned to 16 bytes.
        unsafe {
            let [a, b, c] = sheared(ray, block);
            macro_rules! doubled {
                ($p:ident) => {
                    [_mm256_cvtps_pd($p[0]), _mm256_cvtps_pd($p[1]), _mm256_cvtps_pd($p[2])]
                };
            }
            let (a, b, c) = (doubled!(a), doubled!(b), doubled!(c));
            // Products are exact in double precision, so fusing changes nothing here; below it would, and is not done.
            macro_rules! edge {
                ($p:ident, $q:ident) => {
                    _mm256_fmsub_pd($p[0], $q[1], _mm256_mul_pd($p[1], $q[0]))
                };
            }
            let (u, v, w) = (edge!(c, b), edge!(a, c), edge!(b, a));
            let zero = _mm256_setzero_pd();
            let least = _mm256_min_pd(_mm256_min_pd(u, v), w);
            let greatest = _mm256_max_pd(_mm256_max_pd(u, v), w);
            let one_sign = _mm256_or_pd(_mm256_cmp_pd::<_CMP_GE_OQ>(least, zero), _mm256_cmp_pd::<_CMP_LE_OQ>(greatest, zero));

            let sum = _mm256_add_pd(_mm256_add_pd(u, v), w);
            let weighted = _mm256_add_pd(_mm256_mul_pd(u, a[2]), _mm256_mul_pd(v, b[2]));
            let weighted = _mm256_add_pd(weighted, _mm256_mul_pd(w, c[2]));
            // 0/0 without area: NaN, which is in no interval.
            let t = _mm256_cvtpd_ps(_mm256_div_pd(weighted, _mm256_mul_pd(sum, _mm256_set1_pd(f64::from(ray.dz)))));
            let after = _mm_cmpgt_ps(t, _mm_set1_ps(t_min));
            let before = _mm_cmple_ps(t, _mm_set1_ps(t_max));
            let mut crossed = (_mm256_movemask_pd(one_sign) & _mm_movemask_ps(_mm_and_ps(after, before))) as u32;
            if crossed == 0 {
                return 0;
            }
            let on_edge = _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_EQ_OQ>(_mm256_mul_pd(_mm256_mul_pd(u, v), w), zero)) as u32;
            if crossed & on_edge != 0 {
                crossed = decide_edges(ray, block, crossed, crossed & on_edge);
            }
            _mm_store_ps(out.t.as_mut_ptr(), t);
            _mm_store_ps(out.u.as_mut_ptr(), _mm256_cvtpd_ps(_mm256_div_pd(v, sum)));
            _mm_store_ps(out.v.as_mut_ptr(), _mm256_cvtpd_ps(_mm256_div_pd(w, sum)));
            crossed
        }
    }
}

/// Where the boxes of a node are entered, not before `t_min`, and left, not after `t_max`. Only where AVX2 and FMA are.
#[inline(always)]
pub(super) fn entry_and_exit(ray: &SlabRay, node: &Node, t_max: f32) -> (__m256, __m256) {
    let planes = node.planes.as_ptr().cast::<f32>();
    // SAFETY: the callers are there; `SlabRay::new` makes the starts of rows of 8 floats among the 48 planes, and rows are aligned like the node.
    unsafe {
        // No closures: what they call may end up outside of the function that has the instructions.
        macro_rules! met {
            ($planes:ident, $of:ident, $axis:literal) => {
                _mm256_fmadd_ps(
                    _mm256_load_ps(planes.add(ray.$planes[$axis])),
                    _mm256_set1_ps(ray.reciprocal[$axis]),
                    _mm256_set1_ps(ray.$of[$axis]),
                )
            };
        }
        let near = [met!(near_planes, near, 0), met!(near_planes, near, 1), met!(near_planes, near, 2)];
        let far = [met!(far_planes, far, 0), met!(far_planes, far, 1), met!(far_planes, far, 2)];
        // Only the planes of a child that is not there give NaN, for a ray that lacks axes: max and min return their second operand, and at last
        // `t_min` and `t_max`, so the box counts as met. See `SlabRay::lacks_axes`.
        let near = _mm256_max_ps(_mm256_max_ps(near[0], near[1]), _mm256_max_ps(near[2], _mm256_set1_ps(ray.t_min)));
        let far = _mm256_min_ps(_mm256_min_ps(far[0], far[1]), _mm256_min_ps(far[2], _mm256_set1_ps(t_max)));
        (near, far)
    }
}

/// The vertices of four triangles: the operations of `ShearedRay::shear`. Only where AVX is.
#[inline(always)]
fn sheared(ray: &ShearedRay, block: &Block) -> [[__m128; 3]; 3] {
    let [x, y, z] = ray.axes;
    // SAFETY: the callers are there; a row of a block is 4 floats aligned to 16 bytes.
    unsafe {
        let (origin_x, origin_y, origin_z) = (_mm_set1_ps(ray.origin[0]), _mm_set1_ps(ray.origin[1]), _mm_set1_ps(ray.origin[2]));
        let (shear_x, shear_y) = (_mm_set1_ps(ray.shear[0]), _mm_set1_ps(ray.shear[1]));
        macro_rules! vertex {
            ($number:literal) => {{
                let rows = &block.vertices[$number];
                let dz = _mm_sub_ps(_mm_load_ps(rows[z].as_ptr()), origin_z);
                let dx = _mm_sub_ps(_mm_sub_ps(_mm_load_ps(rows[x].as_ptr()), origin_x), _mm_mul_ps(shear_x, dz));
                let dy = _mm_sub_ps(_mm_sub_ps(_mm_load_ps(rows[y].as_ptr()), origin_y), _mm_mul_ps(shear_y, dz));
                [dx, dy, dz]
            }};
        }
        [vertex!(0), vertex!(1), vertex!(2)]
    }
}

/// Which lanes stay of those that were crossed: some of them on an edge or vertex, which may belong to a neighbour.
#[cold]
fn decide_edges(ray: &ShearedRay, block: &Block, crossed: u32, on_edge: u32) -> u32 {
    let lost = (0..4).filter(|&lane| on_edge >> lane & 1 == 1 && ray.cross_lane(block, lane).is_none());
    lost.fold(crossed, |crossed, lane| crossed & !(1 << lane))
}

//! Many rays against eight boxes at once: the box of their origins and the range of their directions in the place of a ray.
//!
//! ```text
//! t = (plane − c) r + k,   r in [r₀, r₁],   k = −(o − c ± e) r in [k₀, k₁]
//! ```
//!
//! with c one of the origins: its product with r is taken out of k, which is then small for rays that start near each other, however far they are
//! from zero. As each component of all directions has one sign, a box is met by none of the rays where the greatest of the three least entry
//! distances lies beyond the least of the three greatest exit distances. Intervals of \[Reshetov05], for all rays at once as in \[Boulos06].

use super::{SIZE, Span, fold, greater, less, span};
use crate::{
    aabb::Aabb,
    lanes::Distances,
    slab::{LEAST_COMPONENT, LEAST_DISTANCE},
    wide::{Node, WIDTH},
};

/// Rays prepared for boxes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frustum {
    /// r₀ and r₁ of each axis.
    pub reciprocal: [Span; 3],
    /// What is added to `plane · r₀` and to `plane · r₁` for the near planes.
    pub near: [Span; 3],
    /// The same for the far planes.
    pub far: [Span; 3],
    /// Where the near planes of each axis start among the floats of a [`Node`].
    pub near_planes: [usize; 3],
    pub far_planes: [usize; 3],
    /// Which of a node's orders they follow.
    pub octant: usize,
    /// The earliest start of a ray.
    pub t_min: f32,
    /// 1/d of each ray, and what is added to a product with it: as in [`SlabRay`](crate::slab::SlabRay).
    each: [Each; 3],
    /// Whether no number overflows or is lost for being small; nothing else means anything if not.
    pub fits: bool,
}

/// One axis of every ray.
#[derive(Clone, Copy, Debug)]
struct Each {
    reciprocal: [f32; SIZE],
    near: [f32; SIZE],
    far: [f32; SIZE],
}

impl Frustum {
    /// Prepares rays whose directions have one sign on each axis for boxes inside `bounds`.
    #[inline(always)]
    pub fn new(origin: &[[f32; SIZE]; 3], direction: &[[f32; SIZE]; 3], t_min: f32, bounds: &Aabb, margin: f32, extra: f32) -> Self {
        let (min, max) = (bounds.min.to_array(), bounds.max.to_array());
        let (mut distance, mut far_from_zero, mut longest) = (0.0f32, 0.0f32, [0.0f32; SIZE]);
        for axis in 0..3 {
            let o = span(&origin[axis]);
            distance = distance.max((o.high - min[axis]).abs()).max((max[axis] - o.low).abs());
            far_from_zero = far_from_zero.max(o.low.abs()).max(o.high.abs());
            for i in 0..SIZE {
                longest[i] = greater(longest[i], direction[axis][i].abs());
            }
        }
        let e = margin * (distance + far_from_zero) + extra;
        let unused = Span { low: 0.0, high: 0.0 };
        let mut frustum = Self {
            reciprocal: [unused; 3],
            near: [unused; 3],
            far: [unused; 3],
            near_planes: [0; 3],
            far_planes: [0; 3],
            octant: 0,
            t_min,
            each: [Each { reciprocal: [0.0; SIZE], near: [0.0; SIZE], far: [0.0; SIZE] }; 3],
            fits: true,
        };
        for axis in 0..3 {
            let (o, d) = (&origin[axis], &direction[axis]);
            let center = o[0];
            let (mut r, mut near, mut far) = ([0.0; SIZE], [0.0; SIZE], [0.0; SIZE]);
            for i in 0..SIZE {
                r[i] = 1.0 / greater(d[i].abs(), longest[i] * LEAST_COMPONENT).copysign(d[i]);
                let outwards = e.copysign(d[i]);
                near[i] = -((o[i] - center) + outwards) * r[i];
                far[i] = -((o[i] - center) - outwards) * r[i];
            }
            for i in 0..SIZE {
                let outwards = e.copysign(d[i]);
                frustum.each[axis].reciprocal[i] = r[i];
                frustum.each[axis].near[i] = -(o[i] + outwards) * r[i];
                frustum.each[axis].far[i] = -(o[i] - outwards) * r[i];
            }
            let (r, near, far) = (span(&r), span(&near), span(&far));
            frustum.reciprocal[axis] = r;
            frustum.near[axis] = Span { low: near.low - center * r.low, high: near.low - center * r.high };
            frustum.far[axis] = Span { low: far.high - center * r.low, high: far.high - center * r.high };
            let side = usize::from(d[0].is_sign_negative());
            frustum.octant |= side << axis;
            frustum.near_planes[axis] = WIDTH * (2 * axis + side);
            frustum.far_planes[axis] = WIDTH * (2 * axis + 1 - side);
        }
        // A plane is at most `distance + |o|` from zero.
        let reach = distance + far_from_zero;
        for axis in 0..3 {
            let (low, high) = (frustum.reciprocal[axis].low.abs(), frustum.reciprocal[axis].high.abs());
            frustum.fits &= less(low, high) * reach >= LEAST_DISTANCE && (greater(low, high) * reach).is_finite();
            frustum.fits &= frustum.near[axis].is_finite() && frustum.far[axis].is_finite();
        }
        frustum
    }

    /// Children that one of the rays may meet between its start and `t_max`, one bit each, and a distance before which none enters.
    pub fn boxes(&self, node: &Node, t_max: f32) -> (u32, Distances) {
        let planes = node.planes.as_flattened();
        let (mut entry, mut exit) = ([self.t_min; WIDTH], [t_max; WIDTH]);
        for axis in 0..3 {
            let (r, near, far) = (self.reciprocal[axis], self.near[axis], self.far[axis]);
            let (near_planes, far_planes) = (&planes[self.near_planes[axis]..][..WIDTH], &planes[self.far_planes[axis]..][..WIDTH]);
            for i in 0..WIDTH {
                let (p, q) = (near_planes[i], far_planes[i]);
                entry[i] = greater(entry[i], less(p * r.low + near.low, p * r.high + near.high));
                exit[i] = less(exit[i], greater(q * r.low + far.low, q * r.high + far.high));
            }
        }
        let met = (0..WIDTH).fold(0, |met, i| met | u32::from(entry[i] <= exit[i]) << i);
        (met, Distances(entry))
    }
}

impl Frustum {
    /// Of the children that are `met`, those whose box one of the rays meets before its `t_max`.
    #[inline(always)]
    pub fn refine(&self, node: &Node, met: u32, t_max: &[f32; SIZE], mul_add: impl Fn(f32, f32, f32) -> f32) -> u32 {
        let planes = node.planes.as_flattened();
        let (mut left, mut kept) = (met, 0);
        while left != 0 {
            let slot = left.trailing_zeros() as usize % WIDTH;
            left &= left - 1;
            let plane = |first: usize| planes[first + slot];
            let near = [plane(self.near_planes[0]), plane(self.near_planes[1]), plane(self.near_planes[2])];
            let far = [plane(self.far_planes[0]), plane(self.far_planes[1]), plane(self.far_planes[2])];
            let mut meets = [0u32; SIZE];
            for i in 0..SIZE {
                let (mut entry, mut exit) = (self.t_min, t_max[i]);
                for axis in 0..3 {
                    let Each { reciprocal, near: n, far: f } = &self.each[axis];
                    entry = greater(mul_add(near[axis], reciprocal[i], n[i]), entry);
                    exit = less(mul_add(far[axis], reciprocal[i], f[i]), exit);
                }
                meets[i] = if entry <= exit { 1 } else { 0 };
            }
            kept |= fold(&meets, |a, b| a | b) << slot;
        }
        kept
    }
}

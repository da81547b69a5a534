//! Ray against box, with a margin that covers every rounding.
//!
//! A box must be entered whenever a triangle in it is hit, by the numbers as computed. The hit is exact on *sheared* vertices
//! ([`triangle`](crate::triangle)); shearing moved each by at most 6 ε D, where ε = 2⁻²⁴ and D bounds the distance from the ray's origin to
//! any vertex, axis by axis. The slab distances themselves, `t = b · r − o · r` with `r = 1/d` rounded, are those of a plane moved by at
//! most 4 ε (D + |o|). So the planes are moved apart by e = 16 ε (D + |o|), once a ray: the idea of [Woop13] section 4 and of [Ize13], but in
//! the ray's constants, so that a box costs six multiply-adds and no correction. `|o|` is the greatest coordinate of the origin.

use crate::{aabb::Aabb, ray::Ray};

/// 16 ε: the margin in units of D + |o|.
pub const MARGIN: f32 = 1.0 / 1048576.0;

/// Least magnitude of a direction's component, relative to the greatest. Raising a smaller one moves the ray by less than the margin
/// and keeps its reciprocal finite.
const LEAST_COMPONENT: f32 = 1.0 / (1u64 << 40) as f32;

/// A ray prepared for boxes: the near and the far plane of an axis are met at `plane · reciprocal + near` and `… + far`.
#[derive(Clone, Copy, Debug)]
pub struct SlabRay {
    /// 1/d, of components kept away from zero.
    pub reciprocal: [f32; 3],
    /// −(o + e sign d)/d: makes near distances smaller.
    pub near: [f32; 3],
    /// −(o − e sign d)/d: makes far distances greater.
    pub far: [f32; 3],
    /// Which of `[min x, max x, min y, max y, min z, max z]` is the near plane of each axis; the far plane is that with the last bit flipped.
    pub near_plane: [usize; 3],
    /// Start of the ray.
    pub t_min: f32,
}

impl SlabRay {
    /// Prepares a ray for boxes inside `bounds`, with `e` = `margin` · (D + |o|) + `extra`.
    #[inline(always)]
    pub fn new(ray: &Ray, bounds: &Aabb, margin: f32, extra: f32) -> Self {
        let distance = (bounds.min - ray.origin).abs().max((bounds.max - ray.origin).abs()).max_element();
        let e = margin * (distance + ray.origin.abs().max_element()) + extra;
        let least = ray.direction.abs().max_element() * LEAST_COMPONENT;
        let mut slab = Self { reciprocal: [0.0; 3], near: [0.0; 3], far: [0.0; 3], near_plane: [0; 3], t_min: ray.t_min };
        for axis in 0..3 {
            let (d, o) = (ray.direction[axis], ray.origin[axis]);
            let r = 1.0 / if d.abs() >= least { d } else { least.copysign(d) };
            let outwards = e.copysign(r);
            slab.reciprocal[axis] = r;
            slab.near[axis] = -(o + outwards) * r;
            slab.far[axis] = -(o - outwards) * r;
            slab.near_plane[axis] = 2 * axis + usize::from(r < 0.0);
        }
        slab
    }
}

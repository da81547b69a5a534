//! Ray against box, with a margin that covers every rounding.
//!
//! A box must be entered whenever a triangle in it is hit, by the numbers as computed. The hit is exact on *sheared* vertices
//! ([`triangle`](crate::triangle)); shearing moved each by at most 6 ε D, where ε = 2⁻²⁴ and D bounds the distance from the ray's origin to
//! any vertex, axis by axis. The slab distances themselves, `t = b · r − o · r` with `r = 1/d` rounded, are those of a plane moved by at
//! most 4 ε (D + |o|). So the planes are moved apart by e = 16 ε (D + |o|), once a ray: the idea of \[Woop13] section 4 and of \[Ize13], but in
//! the ray's constants, so that a box costs six multiply-adds and no correction. `|o|` is the greatest coordinate of the origin.

use crate::{aabb::Aabb, ray::Ray, wide::WIDTH};
use glam::{BVec3A, Vec3A};

/// 16 ε: the margin in units of D + |o|.
pub const MARGIN: f32 = 1.0 / 1048576.0;

/// Least magnitude of a direction's component, relative to the greatest. Raising a smaller one moves the ray by less than the margin
/// and keeps its reciprocal finite.
pub(crate) const LEAST_COMPONENT: f32 = 1.0 / (1u64 << 40) as f32;

/// Sums of two distances up to this are numbers.
const GREATEST_DISTANCE: f32 = 1e37;

/// The steps between the smallest numbers, 2⁻¹⁴⁹, are far below the margin of distances from this on.
pub(crate) const LEAST_DISTANCE: f32 = 1e-35;

/// A ray prepared for boxes: the near and the far plane of an axis are met at `plane · reciprocal + near` and `… + far`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SlabRay {
    /// 1/d, of components kept away from zero.
    pub reciprocal: Vec3A,
    /// −(o + e sign d)/d: makes near distances smaller.
    pub near: Vec3A,
    /// −(o − e sign d)/d: makes far distances greater.
    pub far: Vec3A,
    /// Where the near and the far planes of each axis start among the floats of a [`Node`](crate::wide::Node): multiples of [`WIDTH`].
    pub near_planes: [usize; 3],
    pub far_planes: [usize; 3],
    /// Which of a node's [`orders`](crate::wide::Node::orders) it follows.
    pub octant: usize,
    /// Start of the ray.
    pub t_min: f32,
}

impl SlabRay {
    /// Prepares a ray for boxes inside `bounds`, with `e` = `margin` · (D + |o|) + `extra`.
    #[inline(always)]
    pub fn new(ray: &Ray, bounds: &Aabb, margin: f32, extra: f32) -> Self {
        // Whole loads; the fourth lanes mean nothing.
        let origin = Vec3A::from_vec4(ray.origin.extend(ray.t_min));
        let direction = Vec3A::from_vec4(ray.direction.extend(ray.t_max));
        let distance = (Vec3A::from(bounds.min) - origin).abs().max((Vec3A::from(bounds.max) - origin).abs());
        let reach = distance.max_element() + origin.abs().max_element();
        let e = margin * reach + extra;
        let size = direction.abs();
        let least = Vec3A::splat(size.max_element() * LEAST_COMPONENT);
        let time = 1.0 / size.max(least);
        let reciprocal = time.copysign(direction);
        let reversed = -reciprocal;
        let outwards = Vec3A::splat(e).copysign(direction);
        let negative = direction.is_negative_bitmask() as usize;
        let side = [negative & 1, negative >> 1 & 1, negative >> 2 & 1];
        let slab = Self {
            reciprocal,
            near: (origin + outwards) * reversed,
            far: (origin - outwards) * reversed,
            near_planes: [WIDTH * side[0], WIDTH * (2 + side[1]), WIDTH * (4 + side[2])],
            far_planes: [WIDTH * (1 - side[0]), WIDTH * (3 - side[1]), WIDTH * (5 - side[2])],
            octant: negative & 7,
            t_min: ray.t_min,
        };
        // No plane and no part of the origin is farther from zero than `reach`. Comparisons with NaN are false.
        let farthest = time * (reach + e);
        let fits = farthest.cmple(Vec3A::splat(GREATEST_DISTANCE)) & farthest.cmpge(Vec3A::splat(LEAST_DISTANCE));
        if fits.all() { slab } else { slab.without_axes(!fits) }
    }

    /// Without the axes whose distances overflow or vanish, as with a direction of 10⁻³⁷ or 10³⁷ m: there every plane is met at −∞ and left at +∞.
    #[cold]
    fn without_axes(self, axes: BVec3A) -> Self {
        Self {
            reciprocal: Vec3A::select(axes, Vec3A::ZERO, self.reciprocal),
            near: Vec3A::select(axes, Vec3A::NEG_INFINITY, self.near),
            far: Vec3A::select(axes, Vec3A::INFINITY, self.far),
            ..self
        }
    }

    /// Whether it lacks axes. The box of a child that is not there, whose planes are infinite, may then count as met.
    #[inline(always)]
    pub fn lacks_axes(&self) -> bool {
        !self.near.is_finite()
    }
}

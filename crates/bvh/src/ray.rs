//! Rays, hits and what a ray may see.

use crate::triangle::{MAX_COORDINATE, NO_PRIMITIVE};
use glam::{Vec3, Vec3A};

/// A part of a line: the points `origin + t · direction` with `t_min < t < t_max`, both ends excluded for triangles (shapes count at both, see
/// [`Procedural`](crate::Procedural)).
///
/// The direction need not be of unit length: `t` counts in its length, and is the same in every instance's space.
/// A ray hits nothing if its interval is empty or not a number, if its origin is not finite or beyond [`MAX_COORDINATE`], or if its direction is not finite
/// or, in the world or in an instance's space, shorter along every axis than [`LEAST_DIRECTION`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Ray {
    /// Where it starts, m.
    pub origin: Vec3,
    /// Hits must lie beyond this.
    pub t_min: f32,
    /// Where it goes; any length.
    pub direction: Vec3,
    /// Hits must lie before this; may be infinite.
    pub t_max: f32,
}

/// Least of the greatest component of a direction, m: 2⁻¹²⁴. Smaller numbers have too few digits to say where a ray goes.
pub const LEAST_DIRECTION: f32 = 4.0 * f32::MIN_POSITIVE;

impl Ray {
    /// A ray without end, from `t = 0`.
    pub const fn new(origin: Vec3, direction: Vec3) -> Self {
        Self { origin, t_min: 0.0, direction, t_max: f32::INFINITY }
    }

    /// The open segment from `from` to `to`; t = 1 at `to`.
    pub fn between(from: Vec3, to: Vec3) -> Self {
        Self { origin: from, t_min: 0.0, direction: to - from, t_max: 1.0 }
    }

    /// The point at `t`.
    pub fn at(&self, t: f32) -> Vec3 {
        self.origin + t * self.direction
    }

    /// Whether the ray can hit anything at all.
    #[inline(always)]
    pub(crate) fn is_usable(&self) -> bool {
        // Whole loads; the fourth lanes mean nothing.
        let origin = Vec3A::from_vec4(self.origin.extend(self.t_min)).abs();
        let direction = Vec3A::from_vec4(self.direction.extend(self.t_max)).abs();
        // Comparisons with NaN are false.
        let finite = origin.cmple(Vec3A::splat(MAX_COORDINATE)) & direction.cmple(Vec3A::MAX);
        finite.all() && direction.max_element() >= LEAST_DIRECTION && self.t_min < self.t_max
    }
}

/// Where a ray met a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Ray parameter, in lengths of the ray's direction.
    pub t: f32,
    /// Barycentric weight of vertex 1; that of vertex 0 is 1 − u − v.
    pub u: f32,
    /// Barycentric weight of vertex 2.
    pub v: f32,
    /// Index of the triangle in its mesh.
    pub primitive: u32,
    /// Index of the instance.
    pub instance: u32,
}

/// One triangle of one instance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PrimitiveRef {
    /// Index of the instance.
    pub instance: u32,
    /// Index of the triangle in its mesh.
    pub primitive: u32,
}

impl PrimitiveRef {
    /// Both indices in one number that orders like (instance, primitive).
    pub(crate) fn key(self) -> u64 {
        (self.instance as u64) << 32 | self.primitive as u64
    }
}

impl Hit {
    /// The triangle that was hit.
    pub fn primitive_ref(&self) -> PrimitiveRef {
        PrimitiveRef { instance: self.instance, primitive: self.primitive }
    }
}

/// What a ray may see.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Filter {
    /// An instance is seen when its mask and this one share a bit.
    pub mask: u32,
    /// A triangle that is never hit: the flat one the ray starts on.
    pub exclude: Option<PrimitiveRef>,
}

impl Filter {
    /// Sees everything whose mask is not zero.
    pub const ALL: Self = Self { mask: u32::MAX, exclude: None };

    /// Sees everything but the triangle that `hit` lies on.
    pub fn leaving(hit: &Hit) -> Self {
        Self { exclude: Some(hit.primitive_ref()), ..Self::ALL }
    }

    /// The triangle of `instance` that is never hit, [`NO_PRIMITIVE`] for none.
    #[inline(always)]
    pub(crate) fn excluded_in(&self, instance: u32) -> u32 {
        match self.exclude {
            Some(excluded) if excluded.instance == instance => excluded.primitive,
            _ => NO_PRIMITIVE,
        }
    }
}

impl Default for Filter {
    fn default() -> Self {
        Self::ALL
    }
}

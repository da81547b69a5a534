//! Sixteen rays at once: where they run nearly alike, one walk serves them all.
//!
//! Nodes are tested against all rays together, as a [`Frustum`], and the children it meets against each ray; then each triangle against all
//! rays. Arrays of sixteen numbers become registers of the instructions that the walk is compiled for. Every hit is, bit for bit, that of
//! the ray alone.

#![allow(clippy::needless_range_loop, reason = "one index into many arrays is what becomes registers")]

mod crossing;
mod frustum;
mod nearest;
mod walk;

pub(crate) use frustum::Frustum;
pub(crate) use nearest::NearestHits;
pub(crate) use walk::PacketWorld;

use crate::{
    aabb::Aabb,
    ray::{LEAST_DIRECTION, Ray},
    triangle::{MAX_COORDINATE, ShearedRay},
};

/// Rays of a packet.
pub(crate) const SIZE: usize = 16;

/// Least and greatest of some numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Span {
    pub low: f32,
    pub high: f32,
}

impl Span {
    fn is_finite(self) -> bool {
        self.low.is_finite() && self.high.is_finite()
    }

    fn width(self) -> f32 {
        self.high - self.low
    }
}

/// Folds halves onto each other, which stays in registers.
#[inline(always)]
fn fold<T: Copy>(numbers: &[T; SIZE], join: impl Fn(T, T) -> T) -> T {
    let mut n = *numbers;
    let mut half = SIZE / 2;
    while half > 0 {
        for i in 0..half {
            n[i] = join(n[i], n[i + half]);
        }
        half /= 2;
    }
    n[0]
}

#[inline(always)]
fn span(numbers: &[f32; SIZE]) -> Span {
    Span { low: fold(numbers, less), high: fold(numbers, greater) }
}

/// The greater of two, `b` where one is NaN: one instruction, unlike `f32::max`.
#[inline(always)]
fn greater(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// The lesser of two, `b` where one is NaN.
#[inline(always)]
fn less(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The widest range of a direction's minor components, relative to the greatest component, that is traced as a packet.
const MOST_SPREAD: f32 = 0.25;

/// A glance at three of the rays: whether they may be alike. It saves the set-up of most packets that would be refused.
#[inline(always)]
pub(crate) fn may_be_alike(rays: &[Ray; SIZE]) -> bool {
    let near = |a: &Ray, b: &Ray| {
        let (p, q) = (a.direction, b.direction);
        // Less than a right angle between them, and |p × q|² ≤ (2 s)² |p|² |q|².
        (p.dot(q) > 0.0) & (p.cross(q).length_squared() <= 4.0 * MOST_SPREAD * MOST_SPREAD * p.length_squared() * q.length_squared())
    };
    near(&rays[0], &rays[SIZE / 2]) & near(&rays[0], &rays[SIZE - 1])
}

/// As [`ShearedRay`], side by side.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShearedRays {
    /// Which axes become x, y and z.
    axes: [usize; 3],
    /// Origins, in the new order of axes.
    origin: [[f32; SIZE]; 3],
    shear: [[f32; SIZE]; 2],
    dz: [f32; SIZE],
}

/// Rays side by side, of one sign on each axis and with one greatest axis.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Packet {
    origin: [[f32; SIZE]; 3],
    direction: [[f32; SIZE]; 3],
    t_min: [f32; SIZE],
    sheared: ShearedRays,
    /// Whether they are alike enough to be traced together; nothing else means anything if not. A flag and no `Option`, which would be copied.
    pub alike: bool,
}

impl Packet {
    /// Not [`alike`](Self::alike) if one of the rays hits nothing or if they run too differently.
    #[inline(always)]
    pub fn new(rays: &[Ray; SIZE]) -> Self {
        let (mut origin, mut direction, mut t_min, mut t_max) = ([[0.0; SIZE]; 3], [[0.0; SIZE]; 3], [0.0; SIZE], [0.0; SIZE]);
        for (i, ray) in rays.iter().enumerate() {
            let (o, d) = (ray.origin.to_array(), ray.direction.to_array());
            for axis in 0..3 {
                origin[axis][i] = o[axis];
                direction[axis][i] = d[axis];
            }
            (t_min[i], t_max[i]) = (ray.t_min, ray.t_max);
        }
        let first = ShearedRay::new(&rays[0]);
        let [x, y, z] = first.axes.map(|axis| axis.min(2));
        // What differs from the first ray: bits of signs, and all ones for another greatest axis or a ray that hits nothing.
        let (mut signs, mut unlike) = ([0u32; SIZE], [0u32; SIZE]);
        let (x_first, y_first) = (z == 0, z == 1);
        for i in 0..SIZE {
            let d = [direction[0][i], direction[1][i], direction[2][i]];
            for axis in 0..3 {
                signs[i] |= d[axis].to_bits() ^ direction[axis][0].to_bits();
            }
            let size = d.map(f32::abs);
            let other = greater(size[1], size[2]);
            let x_is_greatest = size[0] >= other;
            let y_is_greatest = !x_is_greatest & (size[1] >= size[2]);
            // A NaN among the bounds would spoil the packet's own.
            let usable = (size[0] <= f32::MAX) & (size[1] <= f32::MAX) & (size[2] <= f32::MAX) & (t_min[i] < t_max[i]);
            let usable = usable & (greater(size[0], other) >= LEAST_DIRECTION);
            let near = |axis: usize| origin[axis][i].abs() <= MAX_COORDINATE;
            let alike = (x_is_greatest == x_first) & (y_is_greatest == y_first) & usable & near(0) & near(1) & near(2);
            unlike[i] = if alike { 0 } else { u32::MAX };
        }
        let mut shear = [[0.0; SIZE]; 2];
        for i in 0..SIZE {
            shear[0][i] = direction[x][i] / direction[z][i];
            shear[1][i] = direction[y][i] / direction[z][i];
        }
        let spread = greater(span(&shear[0]).width(), span(&shear[1]).width());
        // NaN, of a direction without length, is no spread that would do.
        let narrow = spread <= MOST_SPREAD;
        let alike = narrow && fold(&signs, |a, b| a | b) >> 31 == 0 && fold(&unlike, |a, b| a | b) == 0;
        let sheared = ShearedRays { axes: [x, y, z], origin: [origin[x], origin[y], origin[z]], shear, dz: direction[z] };
        Self { origin, direction, t_min, sheared, alike }
    }

    /// Which axes become x, y and z of the sheared space.
    #[inline(always)]
    fn axes(&self) -> [usize; 3] {
        self.sheared.axes.map(|axis| axis.min(2))
    }

    /// The rays prepared for boxes inside `bounds`, with a margin as in [`SlabRay`](crate::slab::SlabRay).
    #[inline(always)]
    fn frustum(&self, bounds: &Aabb, margin: f32, extra: f32) -> Frustum {
        Frustum::new(&self.origin, &self.direction, fold(&self.t_min, less), bounds, margin, extra)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    /// A row of sixteen pixels.
    fn row() -> [Ray; SIZE] {
        std::array::from_fn(|i| Ray::new(Vec3::new(0.0, 1.0, 2.0), Vec3::new(0.1 + 0.01 * i as f32, -0.2, -1.0)))
    }

    #[test]
    fn rows_of_pixels_are_packets() {
        assert!(may_be_alike(&row()) && Packet::new(&row()).alike);
    }

    #[test]
    fn rays_that_differ_are_none() {
        let with = |i: usize, ray: Ray| {
            let mut rays = row();
            rays[i] = ray;
            rays
        };
        let from = |direction: [f32; 3]| Ray::new(Vec3::ZERO, direction.into());
        for (what, ray) in [
            ("another sign", from([-0.1, -0.2, -1.0])),
            ("a negative zero", from([-0.0, -0.2, -1.0])),
            ("another greatest axis", from([1.0, -0.2, -0.9])),
            ("too far away", from([0.1 + 2.0 * MOST_SPREAD, -0.2, -1.0])),
            ("no length", from([0.0, -0.0, -0.0])),
            ("no number", from([0.1, f32::NAN, -1.0])),
            ("infinite", from([0.1, -0.2, f32::NEG_INFINITY])),
            ("an origin out of bounds", Ray::new(Vec3::splat(1e19), Vec3::new(0.1, -0.2, -1.0))),
        ] {
            for i in [0, 7, 15] {
                assert!(!Packet::new(&with(i, ray)).alike, "{what}");
            }
        }
        assert!(!may_be_alike(&with(15, from([0.1, -0.2, 1.0]))));
    }

    #[test]
    fn spans_and_folds_reach_every_number() {
        for i in 0..SIZE {
            let mut numbers = [0.5; SIZE];
            numbers[i] = 2.0;
            assert_eq!(span(&numbers).high, 2.0);
            numbers[i] = -2.0;
            assert_eq!(span(&numbers).low, -2.0);
        }
    }
}

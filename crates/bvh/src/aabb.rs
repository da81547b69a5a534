//! Axis-aligned boxes.

use glam::{Affine3A, DAffine3, DVec3, Vec3};

/// An axis-aligned box; empty when a minimum exceeds its maximum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Least corner.
    pub min: Vec3,
    /// Greatest corner.
    pub max: Vec3,
}

impl Aabb {
    /// Contains nothing; the neutral element of [`union`](Self::union).
    pub const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    /// The least box around points.
    pub fn of_points(points: impl IntoIterator<Item = Vec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, |b, p| Self { min: b.min.min(p), max: b.max.max(p) })
    }

    /// The least box around both.
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Whether it contains nothing.
    pub fn is_empty(&self) -> bool {
        !self.min.cmple(self.max).all()
    }

    /// Whether every point of `other` lies in it.
    pub fn contains(&self, other: &Self) -> bool {
        other.is_empty() || (self.min.cmple(other.min).all() && other.max.cmple(self.max).all())
    }

    /// Half the surface, m²; 0 when empty.
    pub fn half_area(&self) -> f32 {
        if self.is_empty() {
            return 0.0;
        }
        let d = self.max - self.min;
        d.x * d.y + d.y * d.z + d.z * d.x
    }

    /// The box moved out by `margin` on every side.
    pub fn expanded(self, margin: f32) -> Self {
        Self { min: self.min - margin, max: self.max + margin }
    }

    /// Greatest absolute coordinate; 0 when empty.
    pub fn max_abs(&self) -> f32 {
        if self.is_empty() { 0.0 } else { self.min.abs().max(self.max.abs()).max_element() }
    }

    /// A box around the image under an affine map: computed in double precision, then moved out by 2⁻²⁰ of its greatest coordinate.
    pub fn transformed(&self, map: &Affine3A) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        let map = DAffine3::from_mat3_translation(map.matrix3.as_dmat3(), map.translation.as_dvec3());
        let (lo, hi) = (self.min.as_dvec3(), self.max.as_dvec3());
        let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for corner in 0..8 {
            let pick = |axis: usize| if corner >> axis & 1 == 0 { lo[axis] } else { hi[axis] };
            let p = map.transform_point3(DVec3::new(pick(0), pick(1), pick(2)));
            (min, max) = (min.min(p), max.max(p));
        }
        let image = Self { min: min.as_vec3(), max: max.as_vec3() };
        image.expanded(image.max_abs() * (1.0 / 1048576.0))
    }
}

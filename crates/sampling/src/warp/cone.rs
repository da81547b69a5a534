//! A cone of directions around +z.

use super::hemisphere::turn;
use super::to_unit;
use glam::{Vec2, Vec3};
use std::f32::consts::TAU;

/// Uniform directions within a cone around +z.
///
/// Keeps 1 − cos θ_max, not cos θ_max: the latter rounds to one for lights smaller than about a minute of arc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    one_minus_cos_max: f32,
}

impl Cone {
    /// The cone whose half angle has this cosine, in [−1, 1).
    pub fn new(cos_max: f32) -> Self {
        Self::from_one_minus_cos(1.0 - cos_max)
    }

    /// The cone of half angle θ_max given by 1 − cos θ_max, in (0, 2].
    #[inline]
    pub fn from_one_minus_cos(one_minus_cos_max: f32) -> Self {
        Self { one_minus_cos_max: one_minus_cos_max.clamp(f32::MIN_POSITIVE, 2.0) }
    }

    /// The cone that touches a sphere, given sin² of its half angle, in (0, 1].
    #[inline]
    pub fn from_sin2(sin2_max: f32) -> Self {
        // 1 − √(1 − s) = s / (1 + √(1 − s)), without the cancellation.
        Self::from_one_minus_cos(sin2_max / (1.0 + (1.0 - sin2_max).max(0.0).sqrt()))
    }

    /// Ω = 2π (1 − cos θ_max), sr.
    #[inline]
    pub fn solid_angle(&self) -> f32 {
        TAU * self.one_minus_cos_max
    }

    /// A direction in the cone: 1 − cos θ = u (1 − cos θ_max), φ = 2π v.
    #[inline]
    pub fn sample(&self, u: Vec2) -> Vec3 {
        let one_minus_z = u.x * self.one_minus_cos_max;
        let r = (one_minus_z * (2.0 - one_minus_z)).max(0.0).sqrt();
        let (sin, cos) = (TAU * u.y).sin_cos();
        Vec3::new(r * cos, r * sin, 1.0 - one_minus_z)
    }

    /// True for directions in the cone.
    #[inline]
    pub fn contains(&self, d: Vec3) -> bool {
        Self::one_minus_z(d) <= self.one_minus_cos_max
    }

    /// 1/Ω in the cone, 0 outside.
    #[inline]
    pub fn pdf(&self, d: Vec3) -> f32 {
        if self.contains(d) { 1.0 / self.solid_angle() } else { 0.0 }
    }

    /// The inverse of [`Cone::sample`].
    pub fn inverse(&self, d: Vec3) -> Vec2 {
        Vec2::new(to_unit(Self::one_minus_z(d) / self.one_minus_cos_max), turn(d))
    }

    /// 1 − cos θ, from the sine where the cosine is near one.
    #[inline]
    fn one_minus_z(d: Vec3) -> f32 {
        if d.z > 0.5 { d.truncate().length_squared() / (1.0 + d.z) } else { 1.0 - d.z }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Rng;

    #[test]
    fn tiny_cones_keep_their_precision() {
        // The Sun: half angle 0.2666°.
        let half = 0.2666f64.to_radians();
        let cone = Cone::from_sin2((half.sin() * half.sin()) as f32);
        let exact = std::f64::consts::TAU * (1.0 - half.cos());
        assert!((f64::from(cone.solid_angle()) / exact - 1.0).abs() < 1e-6);
        let mut rng = Rng::new(3);
        let mean: f64 = (0..100_000).map(|_| f64::from(cone.sample(rng.next_2d()).truncate().length_squared())).sum::<f64>() / 1e5;
        assert!((mean / (half.sin() * half.sin() / 2.0) - 1.0).abs() < 0.01, "mean sin² is half of the largest");
    }
}

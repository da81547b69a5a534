//! Orthonormal frames: between world space and the local space in which directions are sampled.

use glam::Vec3;

/// A right-handed orthonormal frame; `z` is the normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Tangent.
    pub x: Vec3,
    /// Bitangent.
    pub y: Vec3,
    /// Normal.
    pub z: Vec3,
}

impl Frame {
    /// The frame that changes nothing.
    pub const IDENTITY: Self = Self { x: Vec3::X, y: Vec3::Y, z: Vec3::Z };

    /// Some frame around the unit vector `z`, continuous except at z.z = 0⁻.    \[Duff17] listing 3
    #[inline]
    pub fn from_z(z: Vec3) -> Self {
        let sign = 1.0f32.copysign(z.z);
        let a = -1.0 / (sign + z.z);
        let b = z.x * z.y * a;
        Self { x: Vec3::new(1.0 + sign * z.x * z.x * a, sign * b, -sign * z.x), y: Vec3::new(b, sign + z.y * z.y * a, -z.y), z }
    }

    /// The frame around the unit vector `z` whose x is as near to `tangent` as can be; any frame if they are parallel.
    #[inline]
    pub fn from_z_tangent(z: Vec3, tangent: Vec3) -> Self {
        let x = tangent - z * z.dot(tangent);
        let length2 = x.length_squared();
        // Below this the direction of x is rounding noise.
        if length2.is_nan() || length2 <= 1e-10 * tangent.length_squared().max(f32::MIN_POSITIVE) {
            return Self::from_z(z);
        }
        let x = x / length2.sqrt();
        // Once more: a tangent nearly parallel to z leaves a rest of z in x.
        let x = (x - z * z.dot(x)).normalize();
        Self { x, y: z.cross(x), z }
    }

    /// World to local.
    #[inline]
    pub fn to_local(&self, v: Vec3) -> Vec3 {
        Vec3::new(self.x.dot(v), self.y.dot(v), self.z.dot(v))
    }

    /// Local to world.
    #[inline]
    pub fn to_world(&self, v: Vec3) -> Vec3 {
        self.x * v.x + self.y * v.y + self.z * v.z
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Rng, warp};

    fn check(f: &Frame) {
        for (a, b, expected) in [(f.x, f.x, 1.0), (f.y, f.y, 1.0), (f.z, f.z, 1.0), (f.x, f.y, 0.0), (f.y, f.z, 0.0), (f.z, f.x, 0.0)] {
            assert!((a.dot(b) - expected).abs() < 2e-6, "{f:?}");
        }
        assert!(f.x.cross(f.y).dot(f.z) > 0.999, "right-handed: {f:?}");
    }

    #[test]
    fn frames_are_orthonormal_and_right_handed() {
        let mut rng = Rng::new(1);
        for _ in 0..10_000 {
            let (z, t) = (warp::uniform_sphere(rng.next_2d()), warp::uniform_sphere(rng.next_2d()));
            check(&Frame::from_z(z));
            check(&Frame::from_z_tangent(z, t * 1e-3));
            let f = Frame::from_z_tangent(z, t);
            assert!(f.to_world(f.to_local(t)).abs_diff_eq(t, 1e-6));
        }
        for z in [Vec3::Z, -Vec3::Z, Vec3::X, Vec3::new(0.0, -1.0, -0.0)] {
            check(&Frame::from_z(z));
            check(&Frame::from_z_tangent(z, z));
            check(&Frame::from_z_tangent(z, Vec3::ZERO));
        }
    }
}

//! Points on the triangles of an instance: [`SurfacePoint::new`], bit for bit, with what depends on the instance alone computed once.

use crate::world::Placed;
use glam::{Affine3A, DMat3, DVec3, Vec3};
use kajo_bvh::SurfacePoint;

/// Error in units of the greatest coordinate around, the hierarchy's: 64 roundings.
const RELATIVE_ERROR: f32 = 1.0 / 262144.0;

/// An instance's transform in double precision.
#[derive(Clone, Debug)]
pub(crate) struct PointFrame {
    /// The instance's space is the world.
    in_place: bool,
    linear: DMat3,
    translation: DVec3,
    /// −1 for a mirroring transform, whose triangles are seen from the other side, else 1.
    facing: f64,
    /// Sum of the lengths of the axes, by coordinate.
    stretch: DVec3,
}

impl PointFrame {
    pub(crate) fn new(world_from_object: &Affine3A) -> Self {
        let linear = world_from_object.matrix3.as_dmat3();
        Self {
            in_place: *world_from_object == Affine3A::IDENTITY,
            linear,
            translation: world_from_object.translation.as_dvec3(),
            facing: if linear.determinant() < 0.0 { -1.0 } else { 1.0 },
            stretch: linear.x_axis.abs() + linear.y_axis.abs() + linear.z_axis.abs(),
        }
    }

    /// [`SurfacePoint::new`].
    #[inline(always)]
    fn point(&self, corners: [Vec3; 3], u: f32, v: f32) -> SurfacePoint {
        let mut placed = corners.map(|corner| corner.as_dvec3());
        if !self.in_place {
            placed = placed.map(|corner| self.linear * corner + self.translation);
        }
        let [a, b, c] = placed;
        let (u, v) = (f64::from(u), f64::from(v));
        let position = a * (1.0 - u - v) + b * u + c * v;
        let normal = (b - a).cross(c - a).normalize_or_zero() * self.facing;
        // The object's own coordinates count too: a mesh far from its own origin is rounded there.
        let local = corners[0].abs().max(corners[1].abs()).max(corners[2].abs()).max_element();
        let world = a.abs().max(b.abs()).max(c.abs());
        let reach = world.max(self.stretch * f64::from(local)).max(self.translation.abs()).max_element();
        SurfacePoint { position: position.as_vec3(), geometric_normal: normal.as_vec3(), error: reach as f32 * RELATIVE_ERROR }
    }
}

impl Placed {
    /// The point of a triangle with barycentric weights 1 − u − v, u, v.
    #[inline(always)]
    pub(crate) fn point(&self, primitive: u32, u: f32, v: f32) -> SurfacePoint {
        self.points.point(self.triangle(primitive), u, v)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Quat;
    use kajo_sampling::Rng;

    #[test]
    fn equals_the_point_of_the_hierarchy_bit_for_bit() {
        let mut rng = Rng::new(8);
        let mut vector = |scale: f32| (Vec3::from_array([(); 3].map(|()| rng.next_1d())) - 0.5) * scale;
        for round in 0..2000 {
            let rotation = Quat::from_scaled_axis(vector(6.0));
            // Half of them mirror.
            let moved = Affine3A::from_scale_rotation_translation(vector(3.0), rotation, vector(100.0));
            let world = if round % 8 == 0 { Affine3A::IDENTITY } else { moved };
            let mut corners = [(); 3].map(|()| vector(if round % 2 == 0 { 1.0 } else { 1e4 }));
            if round % 16 == 0 {
                corners[2] = corners[1];
            }
            let (u, v) = (vector(1.0).x + 0.5, vector(1.0).y);
            let (got, expected) = (PointFrame::new(&world).point(corners, u, v), SurfacePoint::new(&world, corners, u, v));
            assert_eq!(got, expected);
        }
    }
}

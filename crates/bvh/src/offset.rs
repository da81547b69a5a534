//! Where to start a ray that leaves a surface.
//!
//! A hit point is rounded, so it lies a little before or behind its triangle, and a ray started there may meet that triangle again. The
//! cure is to start further out along the normal by a bound on the error, as \[PBR4] section 6.8.6 and \[Waechter19] do; on a flat triangle
//! the ray may also simply be told to ignore it ([`Filter::leaving`](crate::Filter::leaving)).

use glam::{Affine3A, DVec3, Vec3};

/// Offset in units of the greatest coordinate around: 2⁻¹⁸, 64 roundings. Covers the shear of vertices (see [`crate::slab`]) and both
/// transforms of an instance; 16 are needed for a mesh in place.
pub const RELATIVE_ERROR: f32 = 1.0 / 262144.0;

/// A point on a triangle in the world, with what is needed to leave it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// The point, m.
    pub position: Vec3,
    /// Unit normal of the triangle: counter-clockwise winding sees it, also under a mirroring transform (docs/conventions.md).
    /// Zero when the triangle has no area.
    pub geometric_normal: Vec3,
    /// Bound on the distance between the triangle as traced and the point, m.
    pub error: f32,
}

impl SurfacePoint {
    /// The point with barycentric weights `1 − u − v, u, v` on a triangle of an instance, computed in double precision.
    pub fn new(world_from_object: &Affine3A, triangle: [Vec3; 3], u: f32, v: f32) -> Self {
        let linear = world_from_object.matrix3.as_dmat3();
        let translation = world_from_object.translation.as_dvec3();
        let [a, b, c] = triangle.map(|p| linear * p.as_dvec3() + translation);
        let (u, v) = (f64::from(u), f64::from(v));
        let position = a * (1.0 - u - v) + b * u + c * v;
        let mut normal = (b - a).cross(c - a).normalize_or_zero();
        if linear.determinant() < 0.0 {
            normal = -normal;
        }
        // The object's own coordinates count too: a mesh far from its own origin is rounded there.
        let stretch = linear.x_axis.abs() + linear.y_axis.abs() + linear.z_axis.abs();
        let local = triangle.iter().fold(Vec3::ZERO, |m, p| m.max(p.abs())).max_element();
        let reach = [a, b, c, stretch * f64::from(local), translation].iter().fold(DVec3::ZERO, |m, p| m.max(p.abs())).max_element();
        Self { position: position.as_vec3(), geometric_normal: normal.as_vec3(), error: reach as f32 * RELATIVE_ERROR }
    }

    /// Where a ray towards `direction` starts: moved to the side of the triangle that the direction points to.
    pub fn ray_origin(&self, direction: Vec3) -> Vec3 {
        let normal = if direction.dot(self.geometric_normal) < 0.0 { -self.geometric_normal } else { self.geometric_normal };
        offset_origin(self.position, normal, self.error)
    }
}

/// Moves `position` by `error` along the unit `normal`, and every coordinate that moves on to the next number away, so that rounding of the sum
/// cannot undo the step.
#[inline]
pub fn offset_origin(position: Vec3, normal: Vec3, error: f32) -> Vec3 {
    let step = |p: f32, n: f32| {
        let moved = p + n * error;
        match n {
            n if n > 0.0 => moved.next_up(),
            n if n < 0.0 => moved.next_down(),
            _ => moved,
        }
    };
    Vec3::new(step(position.x, normal.x), step(position.y, normal.y), step(position.z, normal.z))
}

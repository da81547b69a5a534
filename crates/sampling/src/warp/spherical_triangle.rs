//! A triangle seen from a point, sampled uniformly in solid angle.

use super::to_unit;
use glam::{DVec3, Vec2, Vec3};

/// Directions towards a triangle, uniform in the solid angle that it subtends at a point.    \[Arvo95]
///
/// Works in double precision: the solid angle is a difference of angles. Below about 1e-7 sr prefer to sample the area.
#[derive(Clone, Copy, Debug)]
pub struct SphericalTriangle {
    a: DVec3,
    b: DVec3,
    c: DVec3,
    cos_alpha: f64,
    sin_alpha: f64,
    alpha: f64,
    solid_angle: f64,
}

impl SphericalTriangle {
    /// The triangle of three world points seen from `point`; either winding.
    pub fn new(point: Vec3, corners: [Vec3; 3]) -> Self {
        let [a, b, c] = corners.map(|p| (p.as_dvec3() - point.as_dvec3()).normalize_or_zero());
        let (ab, ac) = (a.cross(b).normalize_or_zero(), a.cross(c).normalize_or_zero());
        let cos_alpha = ab.dot(ac).clamp(-1.0, 1.0);
        let sin_alpha = (1.0 - cos_alpha * cos_alpha).sqrt();
        Self { a, b, c, cos_alpha, sin_alpha, alpha: cos_alpha.acos(), solid_angle: solid_angle(a, b, c) }
    }

    /// Solid angle, sr.
    pub fn solid_angle(&self) -> f32 {
        self.solid_angle as f32
    }

    /// 1/Ω; 0 when nothing is subtended.
    pub fn pdf(&self) -> f32 {
        if self.solid_angle > 0.0 { (1.0 / self.solid_angle) as f32 } else { 0.0 }
    }

    /// A unit direction towards the triangle, world space.
    pub fn sample(&self, u: Vec2) -> Vec3 {
        let part = f64::from(u.x) * self.solid_angle;
        let (s, t) = (part - self.alpha).sin_cos();
        let cos_ab = self.a.dot(self.b);
        let (p, q) = (t - self.cos_alpha, s + self.sin_alpha * cos_ab);
        let denominator = (q * s + p * t) * self.sin_alpha;
        let cos_side = if denominator == 0.0 { 1.0 } else { (((q * t - p * s) * self.cos_alpha - q) / denominator).clamp(-1.0, 1.0) };
        let c = slide(self.a, self.c, cos_side);
        let z = 1.0 - f64::from(u.y) * (1.0 - c.dot(self.b));
        slide(self.b, c, z.clamp(-1.0, 1.0)).as_vec3()
    }

    /// The inverse of [`SphericalTriangle::sample`].
    pub fn inverse(&self, direction: Vec3) -> Vec2 {
        let d = direction.as_dvec3().normalize_or_zero();
        // c' = where the great circle through b and d meets the side from a to c.
        let mut c = self.b.cross(d).cross(self.c.cross(self.a)).normalize_or_zero();
        if c.dot(self.a + self.c) < 0.0 {
            c = -c;
        }
        let u = solid_angle(self.a, self.b, c) / self.solid_angle;
        let (full, part) = ((c - self.b).length_squared(), (d - self.b).length_squared());
        Vec2::new(to_unit(u as f32), to_unit(if full > 0.0 { (part / full) as f32 } else { 0.0 }))
    }
}

/// The unit vector with cosine `cos` to `from`, in the plane of `from` and `towards`.
fn slide(from: DVec3, towards: DVec3, cos: f64) -> DVec3 {
    let side = (towards - towards.dot(from) * from).normalize_or_zero();
    cos * from + (1.0 - cos * cos).max(0.0).sqrt() * side
}

/// tan(Ω/2) = |a·(b×c)| / (1 + a·b + b·c + c·a).    \[Oosterom83]
fn solid_angle(a: DVec3, b: DVec3, c: DVec3) -> f64 {
    2.0 * a.dot(b.cross(c)).abs().atan2(1.0 + a.dot(b) + b.dot(c) + c.dot(a))
}

/// Solid angle of a triangle at `point`, sr.    \[Oosterom83]
pub fn triangle_solid_angle(point: Vec3, corners: [Vec3; 3]) -> f32 {
    SphericalTriangle::new(point, corners).solid_angle()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_octant_subtends_half_pi() {
        let s = triangle_solid_angle(Vec3::ONE, [Vec3::ONE + Vec3::X, Vec3::ONE + Vec3::Y * 3.0, Vec3::ONE + Vec3::Z * 0.5]);
        assert!((s - std::f32::consts::FRAC_PI_2).abs() < 1e-6, "{s}");
    }

    #[test]
    fn degenerate_triangles_give_no_density_and_no_nan() {
        let t = SphericalTriangle::new(Vec3::ZERO, [Vec3::Z, Vec3::Z, Vec3::Z]);
        assert_eq!(t.pdf(), 0.0);
        assert!(t.sample(Vec2::splat(0.3)).is_finite() && t.inverse(Vec3::Z).x.is_finite() == t.inverse(Vec3::Z).x.is_finite());
    }
}

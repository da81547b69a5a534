//! A rectangle seen from a point, sampled uniformly in solid angle.

use super::to_unit;
use glam::{DVec2, DVec3, Vec2, Vec3};
use std::f64::consts::TAU;

/// Below this solid angle, sr, the sum of four angles loses its digits and the area is sampled instead.
const SMALL: f64 = 1e-7;

/// Points of a planar rectangle, uniform in the solid angle that it subtends at a point.    \[Urena13]
///
/// Works in double precision: the solid angle is a difference of angles. Angles are kept as unit complex numbers and added by multiplying
/// them, so that two inverse functions of one angle are left in the place of those of four. For tiny solid angles the area is sampled and
/// the density converted, which is the same to first order and always consistent with [`SphericalRectangle::pdf`].
#[derive(Clone, Copy, Debug)]
pub struct SphericalRectangle {
    origin: DVec3,
    axes: [DVec3; 3],
    x: [f64; 2],
    y: [f64; 2],
    z: f64,
    b: [f64; 2],
    /// Cosine and sine of \[Urena13] k.
    k: DVec2,
    solid_angle: f64,
}

impl SphericalRectangle {
    /// The rectangle `corner` + s `edge_x` + t `edge_y`, s, t in [0, 1], edges perpendicular, seen from `point`.
    pub fn new(point: Vec3, corner: Vec3, edge_x: Vec3, edge_y: Vec3) -> Self {
        let (edge_x, edge_y) = (edge_x.as_dvec3(), edge_y.as_dvec3());
        let (ax, ay) = (edge_x.normalize_or_zero(), edge_y.normalize_or_zero());
        Self::from_axes(point.as_dvec3(), corner.as_dvec3(), [ax, ay, ax.cross(ay)], [edge_x.length(), edge_y.length()])
    }

    /// The same with unit axes and the lengths of the edges along the first two.
    #[inline]
    pub(super) fn from_axes(origin: DVec3, corner: DVec3, [ax, ay, mut az]: [DVec3; 3], lengths: [f64; 2]) -> Self {
        let d = corner - origin;
        let (x, y, mut z) = (d.dot(ax), d.dot(ay), d.dot(az));
        if z > 0.0 {
            (az, z) = (-az, -z);
        }
        let (x, y) = ([x, x + lengths[0]], [y, y + lengths[1]]);
        // Strictly below the point; zero would put the point in the plane, where nothing is subtended.
        let z = z.min(-1e-12);
        let cy = heights(y, z * z);
        let (solid_angle, k) = solid_angle_and_k(heights(x, z * z), cy);
        Self { origin, axes: [ax, ay, az], x, y, z, b: [-cy[0], cy[1]], k, solid_angle }
    }

    /// Solid angle, sr.
    pub fn solid_angle(&self) -> f32 {
        self.solid_angle as f32
    }

    /// A point of the rectangle, world space.
    #[inline]
    pub fn sample(&self, u: Vec2) -> Vec3 {
        (self.origin + self.point(u)).as_vec3()
    }

    /// A point of the rectangle, relative to the point that sees it.
    #[inline]
    pub(super) fn sample_relative(&self, u: Vec2) -> Vec3 {
        self.point(u).as_vec3()
    }

    #[inline]
    fn point(&self, u: Vec2) -> DVec3 {
        let (u, v) = (f64::from(u.x), f64::from(u.y));
        if self.solid_angle < SMALL {
            return self.at(self.x[0] + u * (self.x[1] - self.x[0]), self.y[0] + v * (self.y[1] - self.y[0]));
        }
        // \[Urena13] eq. 6 to 8 with φ = u Ω + k, solved for x: x = |z| sin φ / √((b₀ cos φ − b₁)² − (1 − b₀²) sin² φ).
        let (sin, cos) = (u * self.solid_angle).sin_cos();
        let turned = DVec2::new(cos, sin).rotate(self.k);
        let side = turned.x * self.b[0] - self.b[1];
        let square = side * side - (1.0 - self.b[0] * self.b[0]) * turned.y * turned.y;
        let xu = (-self.z * turned.y / square.max(f64::MIN_POSITIVE).sqrt().copysign(side)).clamp(self.x[0], self.x[1]);
        let d2 = xu * xu + self.z * self.z;
        let [h0, h1] = heights(self.y, d2);
        let h = h0 + v * (h1 - h0);
        let yv = if h * h < 1.0 - 1e-12 { h * (d2 / (1.0 - h * h)).sqrt() } else { self.y[1] };
        self.at(xu, yv.clamp(self.y[0], self.y[1]))
    }

    /// Density per solid angle of a direction (any length) that meets the rectangle: 1/Ω.
    #[inline]
    pub fn pdf(&self, direction: Vec3) -> f32 {
        if self.solid_angle >= SMALL {
            return (1.0 / self.solid_angle) as f32;
        }
        let area = (self.x[1] - self.x[0]) * (self.y[1] - self.y[0]);
        let d = direction.as_dvec3().normalize_or_zero();
        let cos = d.dot(self.axes[2]).abs();
        // r = |z| / cos; p = r² / (A cos).
        if cos > 0.0 && area > 0.0 { (self.z * self.z / (cos * cos * cos * area)) as f32 } else { 0.0 }
    }

    /// The inverse of [`SphericalRectangle::sample`].
    pub fn inverse(&self, point: Vec3) -> Vec2 {
        let d = point.as_dvec3() - self.origin;
        let (xu, yv) = (d.dot(self.axes[0]).clamp(self.x[0], self.x[1]), d.dot(self.axes[1]).clamp(self.y[0], self.y[1]));
        if self.solid_angle < SMALL {
            return Vec2::new(
                to_unit(((xu - self.x[0]) / (self.x[1] - self.x[0])) as f32),
                to_unit(((yv - self.y[0]) / (self.y[1] - self.y[0])) as f32),
            );
        }
        let z2 = self.z * self.z;
        let left = solid_angle_and_k(heights([self.x[0], xu], z2), heights(self.y, z2)).0;
        let d2 = xu * xu + self.z * self.z;
        let [h0, h1] = heights(self.y, d2);
        let h = yv / (d2 + yv * yv).sqrt();
        Vec2::new(to_unit((left / self.solid_angle) as f32), to_unit(((h - h0) / (h1 - h0)) as f32))
    }

    #[inline]
    fn at(&self, x: f64, y: f64) -> DVec3 {
        x * self.axes[0] + y * self.axes[1] + self.z * self.axes[2]
    }
}

/// Sines of the elevation of two edges, at `edges` across, in the plane at distance √d2 from the point.
#[inline]
fn heights(edges: [f64; 2], d2: f64) -> [f64; 2] {
    let sine = |edge: f64| edge / (d2 + edge * edge).sqrt();
    [sine(edges[0]), sine(edges[1])]
}

/// Solid angle of a rectangle, and cosine and sine of the sum k of \[Urena13] eq. 4, from the sines of the elevation of its edges along x
/// and y.
#[inline]
fn solid_angle_and_k(cx: [f64; 2], cy: [f64; 2]) -> (f64, DVec2) {
    // Inner angles between the planes through the point and the edges: cosine and sine.
    let inner = |c: f64| DVec2::new(c, (1.0 - c * c).max(0.0).sqrt());
    let [a, b, c, d] = [cy[0] * cx[1], -cx[1] * cy[1], cx[0] * cy[1], -cx[0] * cy[0]].map(inner);
    let rest = c.rotate(d);
    let sum = a.rotate(b).rotate(rest);
    let mut angle = sum.y.atan2(sum.x);
    if angle < 0.0 {
        // More than half the sphere's half; or, between edges that lie close together, nothing but rounding.
        let wide = (cx[1] - cx[0]).min(cy[1] - cy[0]) > 0.5;
        angle = if wide { angle + TAU } else { 0.0 };
    }
    (angle, DVec2::new(rest.x, -rest.y))
}

/// Solid angle of the rectangle `corner`, `edge_x`, `edge_y` at `point`, sr.    \[Urena13] eq. 3
pub fn rectangle_solid_angle(point: Vec3, corner: Vec3, edge_x: Vec3, edge_y: Vec3) -> f32 {
    SphericalRectangle::new(point, corner, edge_x, edge_y).solid_angle()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_face_of_a_cube_subtends_4_pi_over_6() {
        let s = rectangle_solid_angle(Vec3::ZERO, Vec3::new(-1.0, -1.0, 1.0), Vec3::X * 2.0, Vec3::Y * 2.0);
        assert!((s - 4.0 * std::f32::consts::PI / 6.0).abs() < 1e-5, "{s}");
    }

    #[test]
    fn small_rectangles_subtend_area_over_distance_squared() {
        for distance in [10.0f32, 1e3, 1e4] {
            let r = SphericalRectangle::new(Vec3::ZERO, Vec3::new(-0.5, -0.5, distance), Vec3::X, Vec3::Y);
            let expected = distance * distance;
            assert!((r.pdf(Vec3::Z) / expected - 1.0).abs() < 0.01, "distance {distance}: {}", r.pdf(Vec3::Z));
            let p = r.sample(Vec2::new(0.25, 0.75));
            assert!(p.abs_diff_eq(Vec3::new(-0.25, 0.25, distance), 0.02 + distance * 1e-6), "{p}");
        }
    }

    #[test]
    fn samples_stay_on_the_rectangle_even_from_its_plane() {
        let mut rng = crate::Rng::new(6);
        for point in [Vec3::ZERO, Vec3::new(0.5, 0.5, 1.0), Vec3::new(3.0, 0.0, 1.0), Vec3::new(0.2, 0.3, 1.0 - 1e-6)] {
            let r = SphericalRectangle::new(point, Vec3::Z, Vec3::X, Vec3::Y);
            for _ in 0..1000 {
                let p = r.sample(rng.next_2d());
                assert!(p.is_finite() && (p.z - 1.0).abs() < 1e-5, "{p}");
                assert!(p.x > -1e-5 && p.x < 1.00001 && p.y > -1e-5 && p.y < 1.00001, "{p}");
            }
        }
    }
}

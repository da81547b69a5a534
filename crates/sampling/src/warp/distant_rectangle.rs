//! A rectangle seen from some distance: nearly uniform in solid angle, for a few operations.

use super::to_unit;
use glam::{Vec2, Vec3};

/// Points of a planar rectangle, in proportion to the bilinear interpolation of its solid angle per area at the four corners.
///
/// ```text
/// dω/dA = |z| / r³;    p_A(s, t) = b(s, t) / (b̄ A),    b bilinear with 1/r³ at the corners, b̄ its mean;    p_ω = p_A r³ / |z|
/// ```
///
/// The bilinear warp is that of \[Hart20] section 4. Seen from further away than its diagonal and with corners at similar distances
/// ([`DistantRectangle::new`]), 1/r³ is so nearly bilinear that p_ω varies by less than the half of itself around 1/Ω; the four arc
/// cosines, the sine and the double precision of the exact warp [`SphericalRectangle`](super::SphericalRectangle) are not needed.
#[derive(Clone, Copy, Debug)]
pub struct DistantRectangle {
    /// From the point to the corner.
    corner: Vec3,
    edge_x: Vec3,
    edge_y: Vec3,
    /// 1/r³ at the corners (0, 0), (1, 0), (0, 1), (1, 1), the nearest being 1.
    weights: [f32; 4],
    /// p_ω / (b r³).
    scale: f32,
}

/// Greatest ratio of squared distances of two corners.
const UNEVEN: f32 = 2.25;

impl DistantRectangle {
    /// The rectangle `corner` + s `edge_x` + t `edge_y`, s, t in [0, 1], its corner being relative to the point that sees it, `height` above
    /// its plane. `None` where the point is too near.
    #[inline]
    pub fn new(corner: Vec3, edge_x: Vec3, edge_y: Vec3, height: f32) -> Option<Self> {
        let opposite = corner + edge_x + edge_y;
        let squares = [corner, corner + edge_x, corner + edge_y, opposite].map(Vec3::length_squared);
        let (least, most) = squares.iter().fold((f32::INFINITY, 0.0f32), |(least, most), &r2| (least.min(r2), most.max(r2)));
        let far = 0.25 * (corner + opposite).length_squared() >= (edge_x + edge_y).length_squared();
        if !(far && most <= UNEVEN * least && least > 0.0) {
            return None;
        }
        let weights = squares.map(|r2| {
            let nearness = least / r2;
            nearness * nearness.sqrt()
        });
        let sum: f32 = weights.iter().sum();
        let area = edge_x.cross(edge_y).length();
        Some(Self { corner, edge_x, edge_y, weights, scale: 4.0 / (sum * area * height) })
    }

    /// A point of the rectangle, relative to the point that sees it, and the density per solid angle of its direction.
    #[inline]
    pub fn sample(&self, u: Vec2) -> (Vec3, f32) {
        let [a, b, c, d] = self.weights;
        let t = linear(u.y, a + b, c + d);
        let s = linear(u.x, a + (c - a) * t, b + (d - b) * t);
        let point = self.corner + s * self.edge_x + t * self.edge_y;
        (point, self.density(Vec2::new(s, t), point))
    }

    /// Density per solid angle with which [`DistantRectangle::sample`] finds `point`, relative to the point that sees it.
    #[inline]
    pub fn pdf(&self, point: Vec3) -> f32 {
        self.density(self.place(point), point)
    }

    /// The inverse of [`DistantRectangle::sample`].
    pub fn inverse(&self, point: Vec3) -> Vec2 {
        let [a, b, c, d] = self.weights;
        let Vec2 { x: s, y: t } = self.place(point);
        Vec2::new(to_unit(linear_inverse(s, a + (c - a) * t, b + (d - b) * t)), to_unit(linear_inverse(t, a + b, c + d)))
    }

    /// (s, t) of a point of the rectangle.
    #[inline]
    fn place(&self, point: Vec3) -> Vec2 {
        let p = point - self.corner;
        let along = |edge: Vec3| (p.dot(edge) / edge.length_squared()).clamp(0.0, 1.0);
        Vec2::new(along(self.edge_x), along(self.edge_y))
    }

    #[inline]
    fn density(&self, at: Vec2, point: Vec3) -> f32 {
        let [a, b, c, d] = self.weights;
        let (near, far) = (a + (b - a) * at.x, c + (d - c) * at.x);
        let r2 = point.length_squared();
        (near + (far - near) * at.y) * self.scale * r2 * r2.sqrt()
    }
}

/// Inverts the distribution of the density in proportion to a (1 − x) + b x; a, b positive.    \[Hart20] section 4
#[inline]
fn linear(u: f32, a: f32, b: f32) -> f32 {
    u * (a + b) / (a + (a * a + (b * b - a * a) * u).sqrt())
}

/// The distribution of [`linear`].
fn linear_inverse(x: f32, a: f32, b: f32) -> f32 {
    x * (2.0 * a + (b - a) * x) / (a + b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Rng;
    use crate::sobol_2d;
    use crate::warp::{SphericalRectangle, uniform_sphere};

    /// Rectangles at random places that are far enough, with the exact warp beside them.
    fn rectangles(count: usize) -> Vec<(DistantRectangle, SphericalRectangle, [Vec3; 3])> {
        let (mut rng, mut found) = (Rng::new(31), Vec::new());
        while found.len() < count {
            let (axis, angle) = (uniform_sphere(rng.next_2d()), std::f32::consts::TAU * rng.next_1d());
            let x = axis.any_orthonormal_vector();
            let (sin, cos) = angle.sin_cos();
            let (x, y) = (x * cos + axis.cross(x) * sin, axis.cross(x) * cos - x * sin);
            let (edge_x, edge_y) = (x * (0.1 + rng.next_1d()), y * (0.1 + rng.next_1d()));
            let corner = uniform_sphere(rng.next_2d()) * 4.0 * rng.next_1d();
            let height = corner.dot(axis).abs();
            if let Some(distant) = DistantRectangle::new(corner, edge_x, edge_y, height).filter(|_| height > 0.01) {
                found.push((distant, SphericalRectangle::new(Vec3::ZERO, corner, edge_x, edge_y), [corner, edge_x, edge_y]));
            }
        }
        found
    }

    #[test]
    fn the_density_is_that_of_the_samples_and_near_to_uniform() {
        let mut planted_fault = 0.0f64;
        for (distant, exact, [corner, ..]) in rectangles(200) {
            let n = 4096;
            let (mut total, mut spread, mut wrong) = (0.0, 0.0f64, 0.0);
            for i in 0..n {
                let u = sobol_2d(i);
                let (point, pdf) = distant.sample(u);
                assert!((distant.pdf(point) / pdf - 1.0).abs() < 1e-4, "{} instead of {pdf}", distant.pdf(point));
                assert!(distant.inverse(point).abs_diff_eq(u, 1e-4), "{u} came back as {}", distant.inverse(point));
                // The mean of 1/p is the solid angle.
                total += 1.0 / f64::from(pdf) / f64::from(n);
                wrong += f64::from((point.length() / corner.length()).powi(3)) / f64::from(pdf) / f64::from(n);
                spread = spread.max(f64::from(pdf * exact.solid_angle()).ln().abs());
            }
            let solid_angle = f64::from(exact.solid_angle());
            assert!((total / solid_angle - 1.0).abs() < 2e-3, "{total} sr instead of {solid_angle}");
            assert!(spread < 1.5f64.ln(), "the density differs by a factor {} from uniform", spread.exp());
            planted_fault = planted_fault.max((wrong / solid_angle - 1.0).abs());
        }
        assert!(planted_fault > 0.1, "another power of the distance is seen: {planted_fault}");
    }

    #[test]
    fn samples_are_uniform_where_the_corners_are_equally_far() {
        let distant = DistantRectangle::new(Vec3::new(-0.5, -0.5, 3.0), Vec3::X, Vec3::Y, 3.0).expect("far enough");
        assert!(distant.sample(Vec2::new(0.25, 0.75)).0.abs_diff_eq(Vec3::new(-0.25, 0.25, 3.0), 1e-6));
    }

    #[test]
    fn near_and_grazing_points_are_refused() {
        let seen_from = |point: Vec3| DistantRectangle::new(-point, Vec3::X, Vec3::Y, point.z.abs());
        assert!(seen_from(Vec3::new(0.5, 0.5, 1.0)).is_none() && seen_from(Vec3::new(0.5, 0.5, 1.5)).is_some());
        assert!(seen_from(Vec3::new(2.0, 0.5, 0.1)).is_none() && seen_from(Vec3::new(5.0, 0.5, 0.1)).is_some());
        assert!(seen_from(Vec3::ZERO).is_none() && seen_from(Vec3::NAN).is_none());
    }
}

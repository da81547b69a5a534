//! Warps from the unit interval or square to discs, directions, triangles, rectangles and filters.
//!
//! Each warp `w` comes with `w_pdf` and `w_inverse`; w_inverse(w(u)) = u. Directions are unit vectors, z is the axis. Warps
//! that first measure their domain (cones, lights seen from a point) are small structs with the methods `sample`, `pdf` and
//! `inverse`.

mod cone;
mod disk;
mod distant_rectangle;
mod filter;
mod hemisphere;
mod light_sphere;
mod rectangle;
mod spherical_rectangle;
mod spherical_triangle;
mod triangle;

pub use cone::Cone;
pub use disk::{concentric_disk, concentric_disk_inverse, concentric_disk_pdf_area};
pub use distant_rectangle::DistantRectangle;
pub use filter::{normal_2d, normal_2d_inverse, normal_2d_pdf, tent, tent_inverse, tent_pdf};
pub use hemisphere::{
    cosine_hemisphere, cosine_hemisphere_inverse, cosine_hemisphere_pdf, uniform_hemisphere, uniform_hemisphere_inverse,
    uniform_hemisphere_pdf, uniform_sphere, uniform_sphere_inverse, uniform_sphere_pdf,
};
pub use light_sphere::LightSphere;
pub use rectangle::{Rectangle, SeenRectangle};
pub use spherical_rectangle::{SphericalRectangle, rectangle_solid_angle};
pub use spherical_triangle::{SphericalTriangle, triangle_solid_angle};
pub use triangle::{triangle_barycentrics, triangle_barycentrics_inverse, triangle_pdf_area};

/// Moves an inverse that rounding put outside back to [0, 1).
fn to_unit(u: f32) -> f32 {
    u.clamp(0.0, crate::bits::ONE_MINUS_EPSILON)
}

#[cfg(test)]
mod tests {
    //! One harness for all warps: the histogram over the sphere follows the pdf, and the inverse returns the argument.

    use super::*;
    use crate::statistics::chi_square_p_value;
    use crate::{Frame, Rng};
    use glam::{Vec2, Vec3};

    /// χ² of `sample` against `pdf` over a grid of cells equal in cos θ and φ; expectations by midpoint quadrature in each cell.
    fn sphere_p_value(seed: u64, sample: impl Fn(Vec2) -> Vec3, pdf: impl Fn(Vec3) -> f32) -> f64 {
        const ROWS: usize = 24;
        const COLUMNS: usize = 32;
        const SUB: usize = 24;
        let n = 200_000;
        let mut observed = vec![0.0; ROWS * COLUMNS];
        let mut rng = Rng::new(seed);
        for _ in 0..n {
            let d = sample(rng.next_2d());
            assert!((d.length() - 1.0).abs() < 1e-5, "{d}");
            let row = (((d.z + 1.0) * 0.5 * ROWS as f32) as usize).min(ROWS - 1);
            let phi = (d.y.atan2(d.x) / std::f32::consts::TAU).rem_euclid(1.0);
            observed[row * COLUMNS + ((phi * COLUMNS as f32) as usize).min(COLUMNS - 1)] += 1.0;
        }
        let cell = 4.0 * std::f64::consts::PI / (ROWS * COLUMNS * SUB * SUB) as f64;
        let mut expected = vec![0.0; ROWS * COLUMNS];
        for (i, e) in expected.iter_mut().enumerate() {
            for s in 0..SUB * SUB {
                let z = 2.0 * ((i / COLUMNS) as f32 + ((s / SUB) as f32 + 0.5) / SUB as f32) / ROWS as f32 - 1.0;
                let phi = std::f32::consts::TAU * ((i % COLUMNS) as f32 + ((s % SUB) as f32 + 0.5) / SUB as f32) / COLUMNS as f32;
                let r = (1.0 - z * z).max(0.0).sqrt();
                *e += f64::from(pdf(Vec3::new(r * phi.cos(), r * phi.sin(), z))) * cell;
            }
        }
        let total: f64 = expected.iter().sum();
        assert!((total - 1.0).abs() < 0.02, "pdf integrates to {total}");
        expected.iter_mut().for_each(|e| *e *= f64::from(n) / total);
        chi_square_p_value(&observed, &expected, 0)
    }

    fn check_inverse(sample: impl Fn(Vec2) -> Vec3, inverse: impl Fn(Vec3) -> Vec2, tolerance: f32) {
        let mut rng = Rng::new(5);
        for _ in 0..20_000 {
            let u = rng.next_2d();
            let back = inverse(sample(u));
            let wrapped = (back - u).abs();
            // φ is periodic: 0 and 1 are the same place.
            let distance = wrapped.min(Vec2::ONE - wrapped);
            assert!(distance.max_element() < tolerance, "{u} came back as {back}");
        }
    }

    #[test]
    fn directions_follow_their_pdf() {
        let cone = Cone::new(0.75);
        let p_values = [
            ("uniform sphere", sphere_p_value(1, uniform_sphere, uniform_sphere_pdf)),
            ("uniform hemisphere", sphere_p_value(2, uniform_hemisphere, uniform_hemisphere_pdf)),
            ("cosine hemisphere", sphere_p_value(3, cosine_hemisphere, cosine_hemisphere_pdf)),
            ("cone", sphere_p_value(4, |u| cone.sample(u), |d| cone.pdf(d))),
        ];
        for (name, p) in p_values {
            assert!(p > 1e-3, "{name}: p = {p}");
        }
    }

    /// χ² over the parts of a domain whose solid angles are known: the share of samples is the share of the solid angle.
    fn parts_p_value(solid_angles: &[f64], part_of_sample: impl Fn(Vec2) -> usize) -> f64 {
        let n = 200_000;
        let mut rng = Rng::new(17);
        let mut counts = vec![0.0; solid_angles.len()];
        (0..n).for_each(|_| counts[part_of_sample(rng.next_2d())] += 1.0);
        let total: f64 = solid_angles.iter().sum();
        chi_square_p_value(&counts, &solid_angles.iter().map(|s| s / total * f64::from(n)).collect::<Vec<_>>(), 0)
    }

    #[test]
    fn lights_seen_from_a_point_are_sampled_uniformly_in_solid_angle() {
        let cell = |x: f32| ((x * 16.0).max(0.0) as usize).min(15);
        // A rectangle cut into 16 × 16, each piece measured as two triangles.
        let (corner, ex, ey) = (Vec3::new(-0.3, 0.2, 0.6), Vec3::X * 2.0, Vec3::Y * 1.5);
        let rectangle = SphericalRectangle::new(Vec3::ZERO, corner, ex, ey);
        let at = |i: usize, j: usize| corner + ex * (i as f32 / 16.0) + ey * (j as f32 / 16.0);
        let pieces: Vec<f64> = (0..256)
            .map(|c| {
                let (i, j) = (c % 16, c / 16);
                [[at(i, j), at(i + 1, j), at(i, j + 1)], [at(i + 1, j + 1), at(i, j + 1), at(i + 1, j)]]
                    .map(|t| f64::from(triangle_solid_angle(Vec3::ZERO, t)))
                    .iter()
                    .sum()
            })
            .collect();
        assert!((pieces.iter().sum::<f64>() * f64::from(rectangle.pdf(Vec3::Z)) - 1.0).abs() < 1e-5);
        let piece = |p: Vec3| cell((p.y - corner.y) / 1.5) * 16 + cell((p.x - corner.x) / 2.0);
        let p = parts_p_value(&pieces, |u| piece(rectangle.sample(u)));
        assert!(p > 1e-3, "rectangle: p = {p}");
        let p = parts_p_value(&pieces, |u| piece(corner + ex * u.x + ey * u.y));
        assert!(p < 1e-12, "planted fault, sampling the area: p = {p}");

        // A triangle cut along lines from b: the strips are triangles too.
        let [a, b, c] = [Vec3::new(1.0, 0.2, 0.1), Vec3::new(0.1, 1.2, 0.3), Vec3::new(-0.2, 0.3, 1.1)];
        let triangle = SphericalTriangle::new(Vec3::ZERO, [a, b, c]);
        let on_side = |k: usize| a.lerp(c, k as f32 / 16.0);
        let strips: Vec<f64> = (0..16).map(|k| f64::from(triangle_solid_angle(Vec3::ZERO, [on_side(k), b, on_side(k + 1)]))).collect();
        assert!((strips.iter().sum::<f64>() * f64::from(triangle.pdf()) - 1.0).abs() < 1e-5);
        let strip_of = |d: Vec3, from: Vec3, k: usize| from.cross(on_side(k)).dot(d) > 0.0;
        let sign = strip_of(a, b, 8);
        let strip = |d: Vec3| (1..16).find(|&k| strip_of(d, b, k) == sign).map_or(15, |k| k - 1);
        let p = parts_p_value(&strips, |u| strip(triangle.sample(u)));
        assert!(p > 1e-3, "triangle: p = {p}");
        let inside = |d: Vec3| [(a, b), (b, c), (c, a)].iter().all(|(p, q)| p.cross(*q).dot(d) * a.cross(b).dot(c) > -1e-6);
        assert!((0..10_000).all(|i| inside(triangle.sample(Vec2::new((i % 100) as f32 / 100.0, (i / 100) as f32 / 100.0)))));

        // A sphere: 1 − cos and the azimuth around the line to its centre are uniform.
        let center = Vec3::new(0.5, -0.3, 1.0);
        let sphere = LightSphere::new(Vec3::ZERO, center, 0.6);
        let one_minus_cos_max = 1.0 - (1.0 - 0.36 / center.length_squared()).sqrt();
        assert!((sphere.solid_angle() / (std::f32::consts::TAU * one_minus_cos_max) - 1.0).abs() < 1e-5);
        let frame = Frame::from_z(center.normalize());
        let part = |d: Vec3| {
            let l = frame.to_local(d);
            cell((1.0 - l.z) / one_minus_cos_max) * 16 + cell((l.y.atan2(l.x) / std::f32::consts::TAU).rem_euclid(1.0))
        };
        let p = parts_p_value(&[1.0; 256], |u| part(sphere.sample(u)));
        assert!(p > 1e-3, "sphere: p = {p}");
        assert_eq!((sphere.pdf(center.normalize()), sphere.pdf(-Vec3::Z)), (1.0 / sphere.solid_angle(), 0.0));
    }

    #[test]
    fn planted_fault_the_wrong_pdf_is_seen() {
        assert!(sphere_p_value(3, uniform_hemisphere, cosine_hemisphere_pdf) < 1e-9);
        let p = sphere_p_value(3, |u| cosine_hemisphere(Vec2::new(u.x * 0.98, u.y)), cosine_hemisphere_pdf);
        assert!(p < 1e-4, "2 % of the square missing: p = {p}");
    }

    #[test]
    fn inverses_return_the_argument() {
        check_inverse(uniform_sphere, uniform_sphere_inverse, 1e-4);
        check_inverse(uniform_hemisphere, uniform_hemisphere_inverse, 1e-4);
        check_inverse(cosine_hemisphere, cosine_hemisphere_inverse, 2e-3);
        let cone = Cone::new(0.7);
        check_inverse(|u| cone.sample(u), |d| cone.inverse(d), 1e-4);
        let rectangle = SphericalRectangle::new(Vec3::ZERO, Vec3::new(-0.3, 0.2, 0.6), Vec3::X * 2.0, Vec3::Y * 1.5);
        check_inverse(|u| rectangle.sample(u), |p| rectangle.inverse(p), 1e-4);
        let triangle = SphericalTriangle::new(Vec3::ZERO, [Vec3::X, Vec3::Y, Vec3::Z]);
        check_inverse(|u| triangle.sample(u), |d| triangle.inverse(d), 2e-3);
        let sphere = LightSphere::new(Vec3::ZERO, Vec3::new(0.5, -0.3, 1.0), 0.6);
        check_inverse(|u| sphere.sample(u), |d| sphere.inverse(d), 1e-4);
    }

    /// Row L-03.
    #[test]
    fn hemisphere_integrates_to_2_pi_and_cosine_to_pi() {
        let n = 1000;
        let (mut solid, mut projected, mut irradiance) = (0.0, 0.0, 0.0);
        let radiance = 3.7;
        for i in 0..n {
            let theta = (f64::from(i) + 0.5) / f64::from(n) * std::f64::consts::FRAC_PI_2;
            let d_omega = theta.sin() * std::f64::consts::FRAC_PI_2 / f64::from(n) * std::f64::consts::TAU;
            solid += d_omega;
            projected += theta.cos() * d_omega;
            irradiance += radiance * theta.cos() * d_omega;
        }
        assert!((solid - std::f64::consts::TAU).abs() < 1e-4);
        assert!((projected - std::f64::consts::PI).abs() < 1e-4);
        assert!((irradiance - std::f64::consts::PI * radiance).abs() < 1e-4);
        // The pdfs say the same: E = mean of L cos θ / p.
        let mut rng = Rng::new(8);
        for _ in 0..1000 {
            let d = cosine_hemisphere(rng.next_2d());
            assert!((d.z / cosine_hemisphere_pdf(d) - std::f32::consts::PI).abs() < 1e-4);
            assert!((1.0 / uniform_hemisphere_pdf(uniform_hemisphere(rng.next_2d())) - std::f32::consts::TAU).abs() < 1e-4);
        }
    }

    #[test]
    fn cosine_hemisphere_never_meets_the_horizon() {
        for u in [Vec2::ZERO, Vec2::new(0.0, 0.3), Vec2::new(0.7, 0.0), Vec2::new(0.999_999_94, 0.5)] {
            let d = cosine_hemisphere(u);
            assert!(cosine_hemisphere_pdf(d) > 0.0 && (d.length() - 1.0).abs() < 1e-6, "{u}: {d}");
        }
    }

    #[test]
    fn rotated_domains_agree_with_the_frame() {
        let mut rng = Rng::new(12);
        for _ in 0..100 {
            let f = Frame::from_z(uniform_sphere(rng.next_2d()));
            let center = f.to_world(Vec3::new(0.0, 0.0, 3.0));
            let light = LightSphere::new(Vec3::ZERO, center, 1.0);
            let d = light.sample(rng.next_2d());
            assert!(d.dot(f.z) >= (1.0f32 - 1.0 / 9.0).sqrt() - 1e-5);
        }
    }
}

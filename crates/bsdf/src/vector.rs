//! Mirror and refracted directions. All directions point away from the surface.

use glam::Vec3;

/// The mirror direction of `wo` about the unit normal `n`: 2 (wo·n) n − wo.    Law of reflection
#[inline]
pub fn reflect(wo: Vec3, n: Vec3) -> Vec3 {
    2.0 * wo.dot(n) * n - wo
}

/// The direction into which light along `wo` refracts at a surface with unit normal `n` on the side of `wo`.
///
/// ```text
/// wi = −wo/η + (cos θo/η − cos θi) n,    cos² θi = 1 − (1 − cos² θo)/η²            Snell's law
/// ```
///
/// `eta` = n_i / n_o, the index beyond the surface over the index on the side of `wo`. `None`: total internal reflection.
#[inline]
pub fn refract(wo: Vec3, n: Vec3, eta: f32) -> Option<Vec3> {
    let cos_o = wo.dot(n);
    let sin2_i = (1.0 - cos_o * cos_o).max(0.0) / (eta * eta);
    if sin2_i >= 1.0 {
        return None;
    }
    let cos_i = (1.0 - sin2_i).sqrt();
    Some((cos_o / eta - cos_i) * n - wo / eta)
}

/// The critical angle arcsin(n₂/n₁), rad, beyond which light in `n1` is totally reflected at `n2`; `None` if n₁ ≤ n₂.
pub fn critical_angle(n1: f32, n2: f32) -> Option<f32> {
    (n1 > n2).then(|| (n2 / n1).asin())
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_sampling::{Rng, warp};

    /// Angle between unit vectors, precise for small ones.
    fn angle(a: Vec3, b: Vec3) -> f64 {
        let (a, b) = (a.as_dvec3().normalize(), b.as_dvec3().normalize());
        2.0 * (a - b).length().atan2((a + b).length())
    }

    /// Row L-01.
    #[test]
    fn mirror_keeps_the_angle_and_the_plane() {
        let mut rng = Rng::new(1);
        for _ in 0..100_000 {
            let (n, wo) = (warp::uniform_sphere(rng.next_2d()), warp::uniform_sphere(rng.next_2d()));
            let (n, wo) = if wo.dot(n) < 0.0 { (-n, wo) } else { (n, wo) };
            let wi = reflect(wo, n);
            assert!((angle(wi, n) - angle(wo, n)).abs() < 1e-6, "{wo} {n}");
            assert!(wo.as_dvec3().cross(n.as_dvec3()).dot(wi.as_dvec3()).abs() < 1e-6, "coplanar");
            assert!(wi.cross(n).dot(wo.cross(n)) <= 1e-6, "on the other side of the normal");
        }
    }

    fn refraction_angle(n1: f32, n2: f32, degrees: f32) -> Option<f64> {
        let (sin, cos) = degrees.to_radians().sin_cos();
        refract(Vec3::new(sin, 0.0, cos), Vec3::Z, n2 / n1).map(|wi| angle(wi, -Vec3::Z).to_degrees())
    }

    /// Row L-02.
    #[test]
    fn refraction_follows_snell_up_to_the_critical_angle() {
        assert!((refraction_angle(1.0003, 1.33, 45.0).unwrap() - 32.128).abs() < 1e-3);
        // The row prints 35.277°: Snell with an index of 1.0003 for air gives that (1.0 would give 35.264°).
        assert!((refraction_angle(1.0003, 1.5, 60.0).unwrap() - 35.277).abs() < 1e-3);
        for (n1, n2, critical) in [(1.5, 1.0003, 41.826), (1.33, 1.0003, 48.773)] {
            assert!((critical_angle(n1, n2).unwrap().to_degrees() - critical).abs() < 1e-3);
            assert!(refraction_angle(n1, n2, critical + 0.1).is_none());
            assert!(refraction_angle(n1, n2, critical - 0.1).is_some());
        }
        assert!(critical_angle(1.0, 1.5).is_none());
    }

    #[test]
    fn refraction_is_reversible() {
        let mut rng = Rng::new(2);
        for _ in 0..10_000 {
            let wo = warp::cosine_hemisphere(rng.next_2d());
            let eta = 0.4 + 2.0 * rng.next_1d();
            if let Some(wi) = refract(wo, Vec3::Z, eta) {
                assert!((wi.length() - 1.0).abs() < 1e-5 && wi.z <= 0.0);
                let back = refract(wi, -Vec3::Z, 1.0 / eta);
                assert!(back.is_none_or(|b| b.abs_diff_eq(wo, 2e-3)), "{wo} {back:?}");
            }
        }
    }
}

//! Fresnel reflectances: exact for dielectrics and conductors, and Schlick's approximation.

use glam::Vec3;

/// (1 − cos θ)⁵, the angular factor of Schlick's approximation.
#[inline]
pub fn schlick_weight(cos_theta: f32) -> f32 {
    let m = (1.0 - cos_theta).clamp(0.0, 1.0);
    let m2 = m * m;
    m2 * m2 * m
}

/// Schlick's approximation, F = f0 + (f90 − f0)(1 − cos θ)⁵.    \[Schlick94] eq. 15
#[inline]
pub fn fresnel_schlick(f0: Vec3, f90: Vec3, cos_theta: f32) -> Vec3 {
    f0 + (f90 - f0) * schlick_weight(cos_theta)
}

/// Mean of [`fresnel_schlick`] over the cosine-weighted hemisphere: 2 ∫ F cos θ d cos θ = f0 + (f90 − f0)/21.
#[inline]
pub fn fresnel_schlick_average(f0: Vec3, f90: Vec3) -> Vec3 {
    f0 + (f90 - f0) * (1.0 / 21.0)
}

/// Reflectance at normal incidence: ((η − 1)/(η + 1))².
#[inline]
pub fn f0_from_ior(eta: f32) -> f32 {
    let r = (eta - 1.0) / (eta + 1.0);
    r * r
}

/// The inverse of [`f0_from_ior`] for η ≥ 1; `f0` in [0, 1), values above 0.9999 are clamped.
#[inline]
pub fn ior_from_f0(f0: f32) -> f32 {
    let r = f0.clamp(0.0, 0.9999).sqrt();
    (1.0 + r) / (1.0 - r)
}

/// Unpolarised reflectance of a dielectric interface.    Fresnel's equations, e.g. \[Walter07] eq. 22
///
/// ```text
/// F = ½ (g − c)²/(g + c)² (1 + (c (g + c) − 1)²/(c (g − c) + 1)²),    g² = η² − 1 + c²
/// ```
///
/// `cos_theta` = c in [0, 1] on the side of the incident light, `eta` = index beyond over index before. Total internal
/// reflection gives 1.
#[inline]
pub fn fresnel_dielectric(cos_theta: f32, eta: f32) -> f32 {
    let c = cos_theta.clamp(0.0, 1.0);
    let g2 = eta * eta - 1.0 + c * c;
    if g2 <= 0.0 {
        return 1.0;
    }
    let g = g2.sqrt();
    let a = (g - c) / (g + c);
    let b = (c * (g + c) - 1.0) / (c * (g - c) + 1.0);
    (0.5 * a * a * (1.0 + b * b)).min(1.0)
}

/// Unpolarised reflectance of a conductor with complex index η + iκ, per channel.    Fresnel's equations, e.g. \[Cook82]
///
/// ```text
/// a² + b² = √((η² − κ² − sin²)² + 4η²κ²),  F = ½ (Rs + Rp),
/// Rs = (t − 2ac + c²)/(t + 2ac + c²),  Rp = Rs (c²t − 2ac sin² + sin⁴)/(c²t + 2ac sin² + sin⁴),  t = a² + b²
/// ```
#[inline]
pub fn fresnel_conductor(cos_theta: f32, eta: Vec3, kappa: Vec3) -> Vec3 {
    let c = cos_theta.clamp(0.0, 1.0);
    let (c2, s2) = (c * c, 1.0 - c * c);
    let e2k2 = eta * eta - kappa * kappa - Vec3::splat(s2);
    let t = vec_sqrt(e2k2 * e2k2 + 4.0 * eta * eta * kappa * kappa);
    let ac2 = 2.0 * c * vec_sqrt(0.5 * (t + e2k2).max(Vec3::ZERO));
    let rs = (t + c2 - ac2) / (t + c2 + ac2).max(Vec3::splat(f32::MIN_POSITIVE));
    let (m, n) = (c2 * t + s2 * s2, ac2 * s2);
    let rp = rs * (m - n) / (m + n).max(Vec3::splat(f32::MIN_POSITIVE));
    (0.5 * (rs + rp)).clamp(Vec3::ZERO, Vec3::ONE)
}

#[inline]
fn vec_sqrt(v: Vec3) -> Vec3 {
    Vec3::new(v.x.sqrt(), v.y.sqrt(), v.z.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Part of row L-07: F(0) = 0.04 for glass.
    #[test]
    fn glass_reflects_4_percent_and_everything_at_grazing() {
        assert!((f0_from_ior(1.5) - 0.04).abs() < 1e-7);
        assert!((fresnel_schlick(Vec3::splat(f0_from_ior(1.5)), Vec3::ONE, 1.0).x - 0.04).abs() < 1e-7);
        assert!((fresnel_dielectric(1.0, 1.5) - 0.04).abs() < 1e-6);
        assert!((fresnel_dielectric(0.0, 1.5) - 1.0).abs() < 1e-6);
        assert!((ior_from_f0(0.04) - 1.5).abs() < 1e-5);
        assert_eq!(fresnel_dielectric(0.3, 1.0), 0.0);
    }

    /// Brewster's angle tan θ = η: the parallel part vanishes, F = ½ Rs = ½ ((η² − 1)/(η² + 1))².
    #[test]
    fn brewster_angle_has_half_of_the_perpendicular_part() {
        let eta = 1.5f32;
        let c = 1.0 / (1.0 + eta * eta).sqrt();
        let expected = 0.5 * ((eta * eta - 1.0) / (eta * eta + 1.0)).powi(2);
        assert!((fresnel_dielectric(c, eta) - expected).abs() < 1e-6);
    }

    #[test]
    fn reflectance_is_the_same_from_both_sides_and_total_beyond_the_critical_angle() {
        for i in 1..100 {
            let sin_o = i as f32 / 100.0;
            let (co, ci) = ((1.0 - sin_o * sin_o).sqrt(), (1.0 - (sin_o / 1.5f32).powi(2)).sqrt());
            assert!((fresnel_dielectric(co, 1.5) - fresnel_dielectric(ci, 1.0 / 1.5)).abs() < 1e-5);
        }
        assert_eq!(fresnel_dielectric((1.0f32 - 0.7 * 0.7).sqrt(), 1.0 / 1.5), 1.0, "sin θ = 0.7 > 1/1.5");
    }

    #[test]
    fn a_conductor_without_absorption_is_a_dielectric() {
        for i in 0..=20 {
            let c = i as f32 / 20.0;
            let f = fresnel_conductor(c, Vec3::splat(1.5), Vec3::ZERO).x;
            assert!((f - fresnel_dielectric(c, 1.5)).abs() < 1e-5, "cos {c}: {f}");
        }
        // Normal incidence: ((η − 1)² + κ²)/((η + 1)² + κ²); gold at 630 nm: η = 0.18, κ = 3.43.
        let f = fresnel_conductor(1.0, Vec3::splat(0.18), Vec3::splat(3.43)).x;
        assert!((f - (0.82f32.powi(2) + 3.43f32.powi(2)) / (1.18f32.powi(2) + 3.43f32.powi(2))).abs() < 1e-5);
        assert!((fresnel_conductor(0.0, Vec3::splat(0.18), Vec3::splat(3.43)).x - 1.0).abs() < 1e-5);
    }

    #[test]
    fn schlick_average_is_the_hemisphere_mean() {
        let n = 10_000;
        let mean: f64 = (0..n)
            .map(|i| {
                let c = (f64::from(i) + 0.5) / f64::from(n);
                f64::from(fresnel_schlick(Vec3::splat(0.1), Vec3::splat(0.9), c as f32).x) * 2.0 * c / f64::from(n)
            })
            .sum();
        assert!((mean - f64::from(fresnel_schlick_average(Vec3::splat(0.1), Vec3::splat(0.9)).x)).abs() < 1e-5);
    }
}

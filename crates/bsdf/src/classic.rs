//! Lambert, Phong and Blinn-Phong as bare functions, in the forms whose energy is right and in the form whose energy is not.

use std::f32::consts::{FRAC_1_PI, PI};

/// Lambert: f = ρ/π, 1/sr.    \[Lambert1760]
#[inline]
pub fn lambert(albedo: f32) -> f32 {
    albedo * FRAC_1_PI
}

/// Phong's highlight cosⁿα, without any normalisation; `cos_alpha` is the cosine to the mirror direction.    \[Phong75]
///
/// # Surprises
/// As a BRDF it reflects up to 2π/(n + 2) times its factor: more than arrives for n ≤ 4.
#[inline]
pub fn phong_lobe(cos_alpha: f32, n: f32) -> f32 {
    cos_alpha.max(0.0).powf(n)
}

/// Phong as a BRDF: f = ks (n + 2)/(2π) cosⁿα, 1/sr; albedo ks at normal incidence and less elsewhere.    \[Lafortune94]
#[inline]
pub fn phong(ks: f32, n: f32, cos_alpha: f32) -> f32 {
    ks * (n + 2.0) / (2.0 * PI) * phong_lobe(cos_alpha, n)
}

/// Blinn-Phong as a BRDF: f = ks (n + 2)(n + 4)/(8π (n + 2^(−n/2))) cosⁿδ, 1/sr; albedo ks at normal incidence.    \[Blinn77]
///
/// `n_dot_h` is cos δ. The normalisation is the integral of cosⁿδ cos θ at normal incidence; the (n + 2)/2π of Phong does not
/// fit the half vector and reflects up to four times too much.
#[inline]
pub fn blinn_phong(ks: f32, n: f32, n_dot_h: f32) -> f32 {
    ks * (n + 2.0) * (n + 4.0) / (8.0 * PI * (n + (-0.5 * n).exp2())) * n_dot_h.max(0.0).powf(n)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{fresnel_schlick, ggx_d_aniso, ggx_visibility_aniso, reflect};
    use glam::{Vec2, Vec3};
    use kajo_sampling::{Rng, warp};

    /// ∫ f(wo, wi) cos θi dωi by midpoints in cos θ and φ.
    fn albedo(f: impl Fn(Vec3, Vec3) -> f32, degrees: f32) -> f64 {
        let (nz, np) = (1200, 360);
        let (s, c) = degrees.to_radians().sin_cos();
        let wo = Vec3::new(s, 0.0, c);
        let mut sum = 0.0;
        for i in 0..nz {
            // θ, not cos θ: narrow lobes sit at the pole.
            let theta = (i as f32 + 0.5) / nz as f32 * std::f32::consts::FRAC_PI_2;
            for j in 0..np {
                let phi = (j as f32 + 0.5) / np as f32 * std::f32::consts::TAU;
                let wi = Vec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos());
                sum += f64::from(f(wo, wi) * wi.z * theta.sin());
            }
        }
        sum * std::f64::consts::PI * std::f64::consts::PI / f64::from(nz * np)
    }

    fn ggx(alpha: f32, f0: f32) -> impl Fn(Vec3, Vec3) -> f32 {
        move |wo, wi| {
            let m = (wo + wi).normalize();
            let d = ggx_d_aniso(Vec2::splat(alpha), m);
            d * ggx_visibility_aniso(Vec2::splat(alpha), wo, wi) * fresnel_schlick(Vec3::splat(f0), Vec3::ONE, wo.dot(m)).x
        }
    }

    /// Row L-04.
    #[test]
    fn lambert_albedo_is_rho() {
        for rho in [0.0, 0.18, 0.5, 1.0] {
            assert!((albedo(|_, _| lambert(rho), 40.0) - f64::from(rho)).abs() < 1e-4, "{rho}");
        }
    }

    fn asymmetry(f: impl Fn(Vec3, Vec3) -> f32) -> f32 {
        let mut rng = Rng::new(12);
        (0..10_000).fold(0.0f32, |worst, _| {
            let (o, i) = (warp::uniform_hemisphere(rng.next_2d()), warp::uniform_hemisphere(rng.next_2d()));
            let (a, b) = (f(o, i), f(i, o));
            worst.max((a - b).abs() / a.max(b).max(1e-12))
        })
    }

    /// Row L-05.
    #[test]
    fn lambert_blinn_phong_and_ggx_are_reciprocal() {
        assert_eq!(asymmetry(|_, _| lambert(0.7)), 0.0);
        assert!(asymmetry(|o, i| blinn_phong(1.0, 50.0, (o + i).normalize().z)) < 1e-5);
        for alpha in [0.1, 0.5, 1.0] {
            assert!(asymmetry(ggx(alpha, 0.04)) < 1e-5, "alpha {alpha}: {}", asymmetry(ggx(alpha, 0.04)));
        }
        let fault = asymmetry(|o, i| phong_lobe(reflect(o, Vec3::Z).dot(i), 5.0) / i.z.max(1e-3));
        assert!(fault > 0.5, "planted fault, Phong over the cosine of the light: {fault}");
    }

    /// Row L-06.
    #[test]
    fn energy_is_conserved_but_not_by_unnormalised_phong() {
        for degrees in [0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0, 85.0] {
            let limit = 1.0 + 1e-3;
            assert!(albedo(|_, _| lambert(1.0), degrees) <= limit);
            for alpha in [0.1, 0.5, 1.0] {
                let a = albedo(ggx(alpha, 1.0), degrees);
                assert!(a <= limit, "alpha {alpha}, {degrees}°: {a}");
            }
            assert!(albedo(|o, i| phong(1.0, 20.0, reflect(o, Vec3::Z).dot(i)), degrees) <= limit);
            assert!(albedo(|o, i| blinn_phong(1.0, 20.0, (o + i).normalize().z), degrees) <= limit);
        }
        let unnormalised = albedo(|o, i| phong_lobe(reflect(o, Vec3::Z).dot(i), 2.0), 0.0);
        assert!((unnormalised - 1.571).abs() < 1e-3, "2π/(n + 2) for n = 2: {unnormalised}");
        assert!((albedo(|o, i| phong(1.0, 50.0, reflect(o, Vec3::Z).dot(i)), 0.0) - 1.0).abs() < 1e-3);
        assert!((albedo(|o, i| blinn_phong(1.0, 50.0, (o + i).normalize().z), 0.0) - 1.0).abs() < 1e-3);
    }
}

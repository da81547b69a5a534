//! The GGX (Trowbridge-Reitz) distribution of facet normals and its Smith masking, isotropic and anisotropic.
//!
//! Isotropic functions take `alpha` and cosines; `_aniso` functions take (α_x, α_y) and directions in the local frame. The latter
//! never form 1 − cos², so they stay precise for the narrowest lobes; the material uses only them.

use glam::{Vec2, Vec3};
use kajo_units::Alpha;
use std::f32::consts::{PI, TAU};

/// Below this width a lobe is taken as a perfect mirror (a delta): its half-width is then under 0.06°.
pub const MIN_ALPHA: f32 = 1e-3;

/// GGX normal distribution D(m), isotropic.
///
/// ```text
/// D(m) = α² / (π ((n·m)² (α² − 1) + 1)²)            [Walter07] eq. 33, [Karis13]
/// ```
///
/// Unit: 1/sr. Normalised so that ∫ D(m) (n·m) dm = 1. `n_dot_m` in [0, 1]; values outside are clamped.
#[inline]
pub fn ggx_d(alpha: Alpha, n_dot_m: f32) -> f32 {
    let a2 = alpha.0 * alpha.0;
    let c = n_dot_m.clamp(0.0, 1.0);
    let d = c * c * (a2 - 1.0) + 1.0;
    a2 / (PI * d * d)
}

/// GGX normal distribution D(m), anisotropic: 1/(π α_x α_y (m_x²/α_x² + m_y²/α_y² + m_z²)²).    \[Heitz14] eq. 84
///
/// Unit: 1/sr. `m` a unit vector; 0 below the surface.
#[inline]
pub fn ggx_d_aniso(alpha: Vec2, m: Vec3) -> f32 {
    if m.z <= 0.0 {
        return 0.0;
    }
    let (x, y) = (m.x / alpha.x, m.y / alpha.y);
    let s = x * x + y * y + m.z * m.z;
    1.0 / (PI * alpha.x * alpha.y * s * s)
}

/// Smith masking G1(v) = 2 cos / (cos + √(α² + (1 − α²) cos²)), isotropic.    \[Walter07] eq. 34
#[inline]
pub fn ggx_g1(alpha: Alpha, n_dot_v: f32) -> f32 {
    let a2 = alpha.0 * alpha.0;
    let c = n_dot_v.clamp(0.0, 1.0);
    2.0 * c / (c + (a2 + (1.0 - a2) * c * c).sqrt()).max(f32::MIN_POSITIVE)
}

/// Smith's Λ(v) = (√(1 + (α_x² v_x² + α_y² v_y²)/v_z²) − 1)/2, anisotropic.    \[Heitz14] eq. 86
#[inline]
pub fn ggx_lambda_aniso(alpha: Vec2, v: Vec3) -> f32 {
    0.5 * (stretched_length(alpha, v) / v.z.abs().max(f32::MIN_POSITIVE) - 1.0).max(0.0)
}

/// Smith masking G1(v) = 1/(1 + Λ(v)), anisotropic.
#[inline]
pub fn ggx_g1_aniso(alpha: Vec2, v: Vec3) -> f32 {
    let z = v.z.abs();
    2.0 * z / (z + stretched_length(alpha, v)).max(f32::MIN_POSITIVE)
}

/// Height-correlated Smith masking and shadowing G2 = 1/(1 + Λ(o) + Λ(i)), isotropic, both on one side.    \[Heitz14] eq. 99
#[inline]
pub fn ggx_g2(alpha: Alpha, n_dot_o: f32, n_dot_i: f32) -> f32 {
    4.0 * n_dot_o.max(0.0) * n_dot_i.max(0.0) * ggx_visibility(alpha, n_dot_o, n_dot_i)
}

/// Height-correlated G2, anisotropic; for directions on opposite sides G2 = 1/(1 + Λ(o) + Λ(i)) too, the usual
/// choice for transmission.
#[inline]
pub fn ggx_g2_aniso(alpha: Vec2, wo: Vec3, wi: Vec3) -> f32 {
    4.0 * (wo.z * wi.z).abs() * ggx_visibility_aniso(alpha, wo, wi)
}

/// V = G2 / (4 cos θo cos θi), isotropic, height-correlated.    \[Lagarde14] section 3.2.1
#[inline]
pub fn ggx_visibility(alpha: Alpha, n_dot_o: f32, n_dot_i: f32) -> f32 {
    let a2 = alpha.0 * alpha.0;
    let (o, i) = (n_dot_o.clamp(0.0, 1.0), n_dot_i.clamp(0.0, 1.0));
    let sum = i * (a2 + (1.0 - a2) * o * o).sqrt() + o * (a2 + (1.0 - a2) * i * i).sqrt();
    0.5 / sum.max(f32::MIN_POSITIVE)
}

/// V = G2 / (4 |cos θo cos θi|), anisotropic, height-correlated.
#[inline]
pub fn ggx_visibility_aniso(alpha: Vec2, wo: Vec3, wi: Vec3) -> f32 {
    let sum = wi.z.abs() * stretched_length(alpha, wo) + wo.z.abs() * stretched_length(alpha, wi);
    // Two directions in the surface would give 0/0; the cosine that multiplies f makes the limit irrelevant.
    0.5 / sum.max(1e-30)
}

/// |(α_x v_x, α_y v_y, v_z)|, the length of the direction stretched to the unit-roughness configuration.
#[inline]
pub(crate) fn stretched_length(alpha: Vec2, v: Vec3) -> f32 {
    Vec3::new(alpha.x * v.x, alpha.y * v.y, v.z).length()
}

/// A facet normal with density D(m) (n·m): θ = arctan(α √(u/(1 − u))).    \[Walter07] eqs. 35, 36
#[inline]
pub fn ggx_sample_normal(alpha: Vec2, u: Vec2) -> Vec3 {
    let (sin, cos) = (TAU * u.y).sin_cos();
    let slope = (u.x / (1.0 - u.x)).sqrt();
    Vec3::new(alpha.x * slope * cos, alpha.y * slope * sin, 1.0).normalize()
}

/// A facet normal visible from `wo` (wo.z > 0), density [`ggx_vndf_pdf`].    \[Heitz18], as a spherical cap \[Dupuy23]
#[inline]
pub fn ggx_sample_vndf(alpha: Vec2, wo: Vec3, u: Vec2) -> Vec3 {
    let stretched = Vec3::new(alpha.x * wo.x, alpha.y * wo.y, wo.z).normalize();
    // A uniform point of the cap of the unit sphere below `stretched`; the half vector with it is visible.
    let z = (1.0 - u.y) * (1.0 + stretched.z) - stretched.z;
    let r = (1.0 - z * z).max(0.0).sqrt();
    let (sin, cos) = (TAU * u.x).sin_cos();
    let h = Vec3::new(r * cos, r * sin, z) + stretched;
    Vec3::new(alpha.x * h.x, alpha.y * h.y, h.z.max(1e-20)).normalize()
}

/// Factor k in [0, 1] by which the cap of [`ggx_sample_vndf`] shrinks when only reflections above the surface count.
///
/// ```text
/// k = (1 − a²) s² / (s² + a² z²),    a = min(α_x, α_y), s = 1 + √(1 − z²), z = wo.z            [Eto23]
/// ```
#[inline]
pub fn ggx_cap_bound(alpha: Vec2, wo: Vec3) -> f32 {
    let a = alpha.min_element().min(1.0);
    let s = 1.0 + Vec2::new(wo.x, wo.y).length();
    let (a2, s2) = (a * a, s * s);
    (1.0 - a2) * s2 / (s2 + a2 * wo.z * wo.z)
}

/// A facet normal for reflection from `wo` (wo.z > 0): [`ggx_sample_vndf`] without most of the facets that would reflect below
/// the surface. The density of the reflected direction is [`ggx_reflection_pdf`].    \[Eto23]
#[inline]
pub fn ggx_sample_reflection(alpha: Vec2, wo: Vec3, u: Vec2) -> Vec3 {
    let stretched = Vec3::new(alpha.x * wo.x, alpha.y * wo.y, wo.z).normalize();
    let bound = ggx_cap_bound(alpha, wo) * stretched.z;
    let z = (1.0 - u.y) * (1.0 + bound) - bound;
    let r = (1.0 - z * z).max(0.0).sqrt();
    let (sin, cos) = (TAU * u.x).sin_cos();
    let h = Vec3::new(r * cos, r * sin, z) + stretched;
    Vec3::new(alpha.x * h.x, alpha.y * h.y, h.z.max(1e-20)).normalize()
}

/// Density of the direction mirrored at a normal of [`ggx_sample_reflection`]: D(m) / (2 (k wo.z + |stretched wo|)).    \[Eto23]
#[inline]
pub fn ggx_reflection_pdf(alpha: Vec2, wo: Vec3, m: Vec3) -> f32 {
    0.5 * ggx_d_aniso(alpha, m) / (ggx_cap_bound(alpha, wo) * wo.z + stretched_length(alpha, wo)).max(f32::MIN_POSITIVE)
}

/// Density of [`ggx_sample_vndf`]: G1(wo) D(m) max(0, wo·m) / wo.z, per solid angle of m.    \[Heitz18] eq. 3
///
/// The density of the mirrored direction wi is this over 4 wo·m.
#[inline]
pub fn ggx_vndf_pdf(alpha: Vec2, wo: Vec3, m: Vec3) -> f32 {
    let g1_over_z = 2.0 / (wo.z.abs() + stretched_length(alpha, wo)).max(f32::MIN_POSITIVE);
    g1_over_z * ggx_d_aniso(alpha, m) * wo.dot(m).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reflect;
    use kajo_sampling::statistics::chi_square_p_value;
    use kajo_sampling::{Rng, warp};

    const ALPHAS: [f32; 4] = [0.05, 0.1, 0.5, 1.0];

    /// ∫ f over the hemisphere; substituting tan θ = s/(1 − s) resolves narrow lobes.
    fn hemisphere_integral(f: impl Fn(Vec3) -> f32) -> f64 {
        let (nt, np) = (2000, 64);
        let mut sum = 0.0;
        for i in 0..nt {
            let s = (f64::from(i) + 0.5) / f64::from(nt);
            let t = s / (1.0 - s);
            let theta = t.atan();
            let d_theta = 1.0 / ((1.0 - s) * (1.0 - s)) / (1.0 + t * t) / f64::from(nt);
            for j in 0..np {
                let phi = std::f64::consts::TAU * (f64::from(j) + 0.5) / f64::from(np);
                let d = Vec3::new((theta.sin() * phi.cos()) as f32, (theta.sin() * phi.sin()) as f32, theta.cos() as f32);
                sum += f64::from(f(d)) * theta.sin() * d_theta * std::f64::consts::TAU / f64::from(np);
            }
        }
        sum
    }

    /// Row L-07, first clause.
    #[test]
    fn distribution_is_normalised() {
        for a in ALPHAS {
            let iso = hemisphere_integral(|m| ggx_d(Alpha(a), m.z) * m.z);
            assert!((iso - 1.0).abs() < 1e-3, "alpha {a}: {iso}");
            let aniso = hemisphere_integral(|m| ggx_d_aniso(Vec2::new(a, 0.3), m) * m.z);
            assert!((aniso - 1.0).abs() < 1e-3, "alpha ({a}, 0.3): {aniso}");
        }
    }

    #[test]
    fn isotropic_and_anisotropic_forms_agree() {
        let mut rng = Rng::new(3);
        for _ in 0..1000 {
            let a = 0.05 + 0.95 * rng.next_1d();
            let (o, i) = (warp::cosine_hemisphere(rng.next_2d()), warp::cosine_hemisphere(rng.next_2d()));
            let close = |x: f32, y: f32| (x - y).abs() <= 2e-4 * x.abs().max(y.abs()).max(1e-6);
            assert!(close(ggx_d(Alpha(a), o.z), ggx_d_aniso(Vec2::splat(a), o)));
            assert!(close(ggx_g1(Alpha(a), o.z), ggx_g1_aniso(Vec2::splat(a), o)));
            assert!(close(1.0 / (1.0 + ggx_lambda_aniso(Vec2::splat(a), o)), ggx_g1(Alpha(a), o.z)));
            assert!(close(ggx_g2(Alpha(a), o.z, i.z), ggx_g2_aniso(Vec2::splat(a), o, i)));
            let lambda = |v| ggx_lambda_aniso(Vec2::splat(a), v);
            assert!(close(ggx_g2_aniso(Vec2::splat(a), o, i), 1.0 / (1.0 + lambda(o) + lambda(i))));
        }
    }

    /// The projected area of the visible facets is the projected area of the surface: ∫ D(m) G1(o) max(0, o·m) dm = cos θo.
    #[test]
    fn visible_normals_integrate_to_one() {
        for a in [Vec2::splat(0.1), Vec2::new(0.2, 0.7), Vec2::splat(1.0)] {
            for degrees in [0.0f32, 30.0, 60.0, 80.0] {
                let (s, c) = degrees.to_radians().sin_cos();
                let integral = hemisphere_integral(|m| ggx_vndf_pdf(a, Vec3::new(s * 0.6, s * 0.8, c), m));
                assert!((integral - 1.0).abs() < 5e-3, "alpha {a}, {degrees}°: {integral}");
            }
        }
    }

    /// Histogram in the coordinates in which D(m)(n·m) is uniform, against `weight` relative to that density.
    fn p_value(alpha: Vec2, sample: impl Fn(Vec2) -> Vec3, weight: impl Fn(Vec3) -> f32) -> f64 {
        const CELLS: usize = 24;
        const SUB: usize = 20;
        let n = 100_000;
        let mut rng = Rng::new(9);
        let mut observed = vec![0.0; CELLS * CELLS];
        for _ in 0..n {
            let m = sample(rng.next_2d());
            let (x, y) = (m.x / alpha.x / m.z, m.y / alpha.y / m.z);
            let slope2 = x * x + y * y;
            let row = ((slope2 / (1.0 + slope2) * CELLS as f32) as usize).min(CELLS - 1);
            let column = (((y.atan2(x) / TAU).rem_euclid(1.0) * CELLS as f32) as usize).min(CELLS - 1);
            observed[row * CELLS + column] += 1.0;
        }
        let mut expected = vec![0.0; CELLS * CELLS];
        for (i, e) in expected.iter_mut().enumerate() {
            for s in 0..SUB * SUB {
                let u = Vec2::new(
                    ((i / CELLS) as f32 + ((s / SUB) as f32 + 0.5) / SUB as f32) / CELLS as f32,
                    ((i % CELLS) as f32 + ((s % SUB) as f32 + 0.5) / SUB as f32) / CELLS as f32,
                );
                let m = ggx_sample_normal(alpha, u);
                *e += f64::from(weight(m) / (ggx_d_aniso(alpha, m) * m.z)) / (SUB * SUB) as f64;
            }
        }
        let total: f64 = expected.iter().sum();
        expected.iter_mut().for_each(|e| *e *= f64::from(n) / total);
        chi_square_p_value(&observed, &expected, 0)
    }

    /// Row L-07, last clause: sampled normals follow D(m)(n·m), and visible normals follow their pdf.
    #[test]
    fn sampled_normals_follow_their_pdf() {
        for alpha in [Vec2::splat(0.05), Vec2::splat(0.5), Vec2::new(0.1, 0.6), Vec2::splat(1.0)] {
            let p = p_value(alpha, |u| ggx_sample_normal(alpha, u), |m| ggx_d_aniso(alpha, m) * m.z);
            assert!(p > 0.01, "alpha {alpha}: p = {p}");
            for degrees in [0.0f32, 45.0, 75.0] {
                let (s, c) = degrees.to_radians().sin_cos();
                let wo = Vec3::new(s * 0.6, -s * 0.8, c);
                let p = p_value(alpha, |u| ggx_sample_vndf(alpha, wo, u), |m| ggx_vndf_pdf(alpha, wo, m));
                assert!(p > 1e-3, "alpha {alpha}, {degrees}°: p = {p}");
                if degrees > 0.0 {
                    let fault = p_value(alpha, |u| ggx_sample_vndf(alpha, wo, u), |m| ggx_d_aniso(alpha, m) * m.z);
                    assert!(fault < 1e-9, "planted fault, the pdf of all normals: p = {fault}");
                }
            }
        }
    }

    /// Among reflections above the surface both samplers find every facet; the bounded one wastes fewer.
    #[test]
    fn bounded_sampling_loses_fewer_reflections() {
        let mut rng = Rng::new(14);
        for (alpha, degrees) in [(Vec2::splat(0.3), 70.0f32), (Vec2::splat(0.8), 30.0), (Vec2::ONE, 60.0), (Vec2::new(0.9, 0.4), 45.0)] {
            let (s, c) = degrees.to_radians().sin_cos();
            let wo = Vec3::new(0.8 * s, 0.6 * s, c);
            let n = 40_000;
            let (mut plain, mut bounded, mut plain_sum, mut bounded_sum) = (0, 0, 0.0f64, 0.0f64);
            for _ in 0..n {
                let u = rng.next_2d();
                let m = ggx_sample_vndf(alpha, wo, u);
                let wi = reflect(wo, m);
                if wi.z > 0.0 {
                    plain += 1;
                    plain_sum += f64::from(wi.z);
                }
                let m = ggx_sample_reflection(alpha, wo, u);
                let wi = reflect(wo, m);
                if wi.z > 0.0 {
                    bounded += 1;
                    bounded_sum += f64::from(wi.z * ggx_vndf_pdf(alpha, wo, m) / (4.0 * wo.dot(m)) / ggx_reflection_pdf(alpha, wo, m));
                }
            }
            assert!(bounded >= plain, "alpha {alpha}, {degrees}°: {bounded} kept of {n}, {plain} without bound");
            assert!((bounded_sum / plain_sum - 1.0).abs() < 0.02, "alpha {alpha}, {degrees}°: {bounded_sum} {plain_sum}");
        }
    }

    #[test]
    fn extreme_arguments_stay_finite() {
        for alpha in [Vec2::splat(MIN_ALPHA), Vec2::new(1.0, MIN_ALPHA), Vec2::ONE] {
            for wo in [Vec3::Z, Vec3::new(1.0, 0.0, 1e-7).normalize(), Vec3::new(0.0, 1.0, 0.0)] {
                for u in [Vec2::ZERO, Vec2::splat(0.999_999_9), Vec2::new(0.5, 0.0), Vec2::new(0.0, 0.999_999_9)] {
                    let m = ggx_sample_vndf(alpha, wo, u);
                    assert!(m.is_finite() && (m.length() - 1.0).abs() < 1e-5, "{alpha} {wo} {u}: {m}");
                    let wi = reflect(wo, m);
                    assert!(ggx_vndf_pdf(alpha, wo, m).is_finite() && ggx_visibility_aniso(alpha, wo, wi).is_finite());
                    assert!(ggx_g2_aniso(alpha, wo, wi).is_finite() && ggx_g1_aniso(alpha, wo).is_finite());
                }
            }
        }
    }
}

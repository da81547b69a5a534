//! The energy that single scattering between facets loses, and what gives it back.
//!
//! Conductors and the opaque dielectric get the reciprocal multiple-scattering lobe of Kulla and Conty,
//! f_ms = F_ms (1 − E(o))(1 − E(i)) / (π (1 − Ē)); glass is divided by its albedo. E comes from the tables.

use super::stretched_length;
use crate::tables::{self, place};
use crate::{fresnel_schlick_average, schlick_weight};
use glam::{Vec2, Vec3};

/// Directional albedo of GGX with Schlick's Fresnel, as factors of f0 and f90.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GgxAlbedo {
    /// Factor of f0.
    pub f0: f32,
    /// Factor of f90.
    pub f90: f32,
}

impl GgxAlbedo {
    /// Albedo of a facet that reflects everything, E = f0 + f90 factors; 1 − E is what single scattering loses.
    #[inline]
    pub fn white(self) -> f32 {
        self.f0 + self.f90
    }

    /// Albedo with these reflectances.
    #[inline]
    pub fn with(self, f0: Vec3, f90: Vec3) -> Vec3 {
        f0 * self.f0 + f90 * self.f90
    }

    #[inline]
    fn lerp(a: [f32; 2], b: [f32; 2], t: f32) -> [f32; 2] {
        [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]
    }
}

/// E(θ) of isotropic GGX of width `alpha`, from [`tables::GGX_ALBEDO`]; absolute error below 3e-3 up to 88°, see the test.
#[inline]
pub fn ggx_albedo(alpha: f32, cos_theta: f32) -> GgxAlbedo {
    let (c, tc) = place(cos_theta.max(0.0).sqrt(), tables::COS_NODES);
    let (r, tr) = place(alpha.max(0.0).sqrt(), tables::ROUGHNESS_NODES);
    let k = r * tables::COS_NODES + c;
    let t = &tables::GGX_ALBEDO;
    let low = GgxAlbedo::lerp(t[k], t[k + 1], tc);
    let high = GgxAlbedo::lerp(t[k + tables::COS_NODES], t[k + tables::COS_NODES + 1], tc);
    let [f0, f90] = GgxAlbedo::lerp(low, high, tr);
    GgxAlbedo { f0, f90 }
}

/// Cosine-weighted mean of [`ggx_albedo`] over the hemisphere, Ē.
#[inline]
pub fn ggx_albedo_average(alpha: f32) -> GgxAlbedo {
    let (r, t) = place(alpha.max(0.0).sqrt(), tables::ROUGHNESS_NODES);
    let [f0, f90] = GgxAlbedo::lerp(tables::GGX_ALBEDO_AVERAGE[r], tables::GGX_ALBEDO_AVERAGE[r + 1], t);
    GgxAlbedo { f0, f90 }
}

/// E of anisotropic GGX seen from `v`, from [`tables::ANISO_WHITE`] and [`tables::ANISO_MEAN_COS`]; α_x ≥ α_y ≥ [`MIN_ALPHA`].
///
/// [`MIN_ALPHA`]: super::MIN_ALPHA
#[inline]
pub fn ggx_albedo_aniso(alpha: Vec2, v: Vec3) -> GgxAlbedo {
    aniso_albedo_of(|i| tables::ANISO_WHITE.get(i), |i| tables::ANISO_MEAN_COS.get(i), alpha, v)
}

/// [`ggx_albedo_aniso`] from any tables of that layout.
///
/// ```text
/// f0 + f90 = E of white facets,    f90 = E (1 − c)⁵,    c = ρ |(α_x v_x, α_y v_y, v_z)|
/// ```
pub(crate) fn aniso_albedo_of(white: impl Fn(usize) -> f32, mean_cos: impl Fn(usize) -> f32, alpha: Vec2, v: Vec3) -> GgxAlbedo {
    let [strength, roughness] = tables::aniso_widths(alpha);
    let [polar, azimuth] = tables::aniso_stretched(alpha, v);
    let white = tables::ANISO_WHITE_GRID.interpolate(white, [polar, azimuth, strength, roughness]);
    let [polar, azimuth] = tables::aniso_half_stretched(alpha, v);
    let rho = tables::ANISO_COS_SCALE * tables::ANISO_COS_GRID.interpolate(mean_cos, [polar, azimuth, strength, roughness]);
    let f90 = white * schlick_weight(rho * stretched_length(alpha, v));
    GgxAlbedo { f0: white - f90, f90 }
}

/// Cosine-weighted mean of [`ggx_albedo_aniso`] over the hemisphere, Ē.
pub fn ggx_albedo_aniso_average(alpha: Vec2) -> GgxAlbedo {
    let widths = tables::aniso_widths(alpha);
    let [f0, f90] = [0, 1].map(|k| tables::ANISO_AVERAGE_GRID.interpolate(|i| tables::ANISO_AVERAGE.get(2 * i + k), widths));
    GgxAlbedo { f0, f90 }
}

/// [`glass_albedo`] of anisotropic facets seen from `v`, from [`tables::ANISO_GLASS`]; α_x ≥ α_y ≥ [`MIN_ALPHA`].
///
/// [`MIN_ALPHA`]: super::MIN_ALPHA
pub fn glass_albedo_aniso(alpha: Vec2, v: Vec3, eta: f32) -> f32 {
    let [strength, roughness] = tables::aniso_widths(alpha);
    let [polar, azimuth] = tables::aniso_half_stretched(alpha, v);
    let position = [polar, azimuth, strength, roughness, tables::aniso_index(eta)];
    tables::ANISO_GLASS_GRID.interpolate(|i| tables::ANISO_GLASS.get(i), position)
}

/// Colour of the light that meets several facets: F_ms = F̄² Ē / (1 − F̄ (1 − Ē)).    \[Kulla17] slide 17, \[Turquin19] eq. 9
#[inline]
pub fn ggx_multiple_scattering_color(f0: Vec3, f90: Vec3, white_average: f32) -> Vec3 {
    let f = fresnel_schlick_average(f0, f90);
    f * f * white_average / (Vec3::ONE - f * (1.0 - white_average))
}

/// Share of light that rough glass of width `alpha` reflects or transmits, from [`tables::GLASS_ALBEDO`].
///
/// `eta` = index beyond over index before; outside [1/3, 3] the end of the table is used.
#[inline]
pub fn glass_albedo(alpha: f32, cos_theta: f32, eta: f32) -> f32 {
    use tables::{GLASS_ALBEDO as T, GLASS_COS_NODES as NC, GLASS_ETA_NODES as NE, GLASS_ROUGHNESS_NODES as NR};
    let z = (eta - 1.0) / (eta + 1.0);
    let (c, tc) = place(cos_theta.max(0.0).sqrt(), NC);
    let (r, tr) = place(alpha.max(0.0).sqrt(), NR);
    let (e, te) = place(0.5 + 0.5 * z / tables::GLASS_Z_MAX, NE);
    let row = |e: usize, r: usize| {
        let k = (e * NR + r) * NC + c;
        T[k] + tc * (T[k + 1] - T[k])
    };
    let plane = |e: usize| row(e, r) + tr * (row(e, r + 1) - row(e, r));
    plane(e) + te * (plane(e + 1) - plane(e))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tables::quadrature;
    use glam::Vec2;
    use kajo_sampling::Rng;

    #[test]
    fn ggx_table_is_its_integral() {
        let mut rng = Rng::new(4);
        let mut worst = 0.0f32;
        for _ in 0..600 {
            // Beyond 88.3° narrow lobes change faster than the nodes; there the error reaches 6e-3.
            let (c, r) = (0.03 + 0.97 * rng.next_1d(), 0.03 + 0.97 * rng.next_1d());
            let [f0, f90] = quadrature::ggx_albedo(quadrature::direction(c, 0.0), Vec2::splat(r * r), 4096);
            let e = ggx_albedo(r * r, c);
            let error = (e.f0 - f0).abs().max((e.f90 - f90).abs()).max((e.white() - f0 - f90).abs());
            worst = worst.max(error);
        }
        assert!(worst < 3e-3, "{worst}");
    }

    /// Widths over glTF's square, any azimuth, down to 2° above the horizon.
    fn anisotropic_points(seed: u64, n: usize) -> impl Iterator<Item = (Vec2, Vec3)> {
        let mut rng = Rng::new(seed);
        (0..n).map(move |_| {
            let (c, phi) = (0.035 + 0.965 * rng.next_1d(), std::f32::consts::FRAC_PI_2 * rng.next_1d());
            let (roughness, strength) = (rng.next_1d(), rng.next_1d());
            let narrow = roughness * roughness;
            let alpha = Vec2::new(narrow + (1.0 - narrow) * strength * strength, narrow);
            (alpha.max(Vec2::splat(crate::MIN_ALPHA)), quadrature::direction(c, phi))
        })
    }

    /// Largest and mean size of the errors, and their mean.
    fn worst_mean_bias(errors: &[f32]) -> [f32; 3] {
        let mean = |f: fn(f32) -> f32| errors.iter().map(|&e| f(e)).sum::<f32>() / errors.len() as f32;
        [errors.iter().fold(0.0, |worst, e| worst.max(e.abs())), mean(f32::abs), mean(|e| e)]
    }

    /// Measured: white 2.6e-3 at most, 3.7e-4 in the mean; f90 4.7e-3, for the narrowest ridges near the horizon, and 1.5e-4.
    #[test]
    fn anisotropic_albedo_is_near_its_integral() {
        let (mut white, mut f90) = (Vec::new(), Vec::new());
        for (alpha, v) in anisotropic_points(7, 1500) {
            let [a, b] = quadrature::ggx_albedo(v, alpha, 4096);
            let e = ggx_albedo_aniso(alpha, v);
            white.push(e.white() - a - b);
            f90.push(e.f90 - b);
        }
        let (white, f90) = (worst_mean_bias(&white), worst_mean_bias(&f90));
        assert!(white[0] < 3.5e-3 && white[1] < 6e-4 && white[2].abs() < 2e-4, "white: {white:?}");
        assert!(f90[0] < 6e-3 && f90[1] < 3e-4 && f90[2].abs() < 2e-4, "f90: {f90:?}");
    }

    #[test]
    fn planted_fault_the_albedo_of_equal_area_is_not_near_the_integral() {
        let errors: Vec<f32> = anisotropic_points(7, 300)
            .map(|(alpha, v)| {
                let [a, b] = quadrature::ggx_albedo(v, alpha, 1024);
                ggx_albedo((alpha.x * alpha.y).sqrt(), v.z).white() - a - b
            })
            .collect();
        assert!(worst_mean_bias(&errors)[0] > 0.1 && worst_mean_bias(&errors)[1] > 1e-2, "{:?}", worst_mean_bias(&errors));
    }

    /// Five dimensions in 230,000 numbers: single directions inside strongly anisotropic glass, where total reflection meets the horizon,
    /// are off by up to 0.12; the mean is kept.
    #[test]
    fn anisotropic_glass_table_is_near_its_integral() {
        for ior in [1.1, 1.33, 1.5, 2.4f32] {
            for (eta, worst, mean) in [(ior, 0.02, 2e-3), (1.0 / ior, 0.13, 5e-3)] {
                let error = |(alpha, v)| glass_albedo_aniso(alpha, v, eta) - quadrature::glass_albedo(v, alpha, eta, 4096);
                let errors: Vec<f32> = anisotropic_points(8, 800).map(error).collect();
                let e = worst_mean_bias(&errors);
                assert!(e[0] < worst && e[1] < mean && e[2].abs() < 1e-3, "eta {eta}: {e:?}");
            }
        }
    }

    #[test]
    fn glass_table_is_its_integral() {
        let mut rng = Rng::new(5);
        let mut worst = 0.0f32;
        for _ in 0..600 {
            let (c, r) = (0.03 + 0.97 * rng.next_1d(), 0.03 + 0.97 * rng.next_1d());
            let ior = 1.1 + 1.4 * rng.next_1d();
            for eta in [ior, 1.0 / ior] {
                let error = (glass_albedo(r * r, c, eta)
                    - quadrature::glass_albedo(quadrature::direction(c, 0.0), Vec2::splat(r * r), eta, 4096))
                .abs();
                worst = worst.max(error);
            }
        }
        assert!(worst < 7e-3, "{worst}");
    }
}

//! The energy that single scattering between facets loses, and what gives it back.
//!
//! Conductors and the opaque dielectric get the reciprocal multiple-scattering lobe of Kulla and Conty,
//! f_ms = F_ms (1 − E(o))(1 − E(i)) / (π (1 − Ē)); glass is divided by its albedo. E comes from the tables.

use crate::fresnel_schlick_average;
use crate::tables::{self, place};
use glam::Vec3;

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

/// Colour of the light that meets several facets: F_ms = F̄² Ē / (1 − F̄ (1 − Ē)).    [Kulla17] slide 17, [Turquin19] eq. 9
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
            let [f0, f90] = quadrature::ggx_albedo(c, Vec2::splat(r * r), 0.0, 4096);
            let e = ggx_albedo(r * r, c);
            let error = (e.f0 - f0).abs().max((e.f90 - f90).abs()).max((e.white() - f0 - f90).abs());
            worst = worst.max(error);
        }
        assert!(worst < 3e-3, "{worst}");
    }

    #[test]
    fn glass_table_is_its_integral() {
        let mut rng = Rng::new(5);
        let mut worst = 0.0f32;
        for _ in 0..600 {
            let (c, r) = (0.03 + 0.97 * rng.next_1d(), 0.03 + 0.97 * rng.next_1d());
            let ior = 1.1 + 1.4 * rng.next_1d();
            for eta in [ior, 1.0 / ior] {
                let error = (glass_albedo(r * r, c, eta) - quadrature::glass_albedo(c, r * r, eta, 4096)).abs();
                worst = worst.max(error);
            }
        }
        assert!(worst < 7e-3, "{worst}");
    }
}

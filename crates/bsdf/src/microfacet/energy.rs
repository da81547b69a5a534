//! The energy that single scattering between facets loses, and what gives it back.
//!
//! Conductors and the opaque dielectric get the reciprocal multiple-scattering lobe of Kulla and Conty,
//! f_ms = F_ms (1 − E(o))(1 − E(i)) / (π (1 − Ē)); glass is divided by its albedo. E comes from the tables.

use crate::fresnel_schlick_average;
use crate::tables::{self, place};
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

/// E of anisotropic GGX seen from `v`; [`ggx_albedo`] when both widths are equal.
///
/// The white albedo is blended between its values over the two axes, each taken at the angle with the same Smith parameter
/// α_φ tan θ, with the weights cos² and sin² of the azimuth in the stretched configuration. This is our own approximation:
/// against the integral it is within 3e-3 for α_y ≤ α_x/4 or α ≤ 0.5, and within 1.5e-2 everywhere. The split into f0 and f90
/// is that of the isotropic lobe of equal area; it is wrong near the horizon, where a dielectric should integrate instead.
pub fn ggx_albedo_aniso(alpha: Vec2, v: Vec3) -> GgxAlbedo {
    let same_area = ggx_albedo((alpha.x * alpha.y).sqrt(), v.z.abs());
    if alpha.x == alpha.y {
        return same_area;
    }
    let scale = aniso_white_albedo(&tables::GGX_ANISO_ALBEDO, alpha, v) / same_area.white().max(1e-3);
    GgxAlbedo { f0: same_area.f0 * scale, f90: same_area.f90 * scale }
}

/// Cosine-weighted mean of [`ggx_albedo_aniso`] over the hemisphere, Ē.
pub fn ggx_albedo_aniso_average(alpha: Vec2) -> GgxAlbedo {
    const R: usize = tables::ANISO_ROUGHNESS_NODES;
    let same_area = ggx_albedo_average((alpha.x * alpha.y).sqrt());
    if alpha.x == alpha.y {
        return same_area;
    }
    let (x, tx) = place(alpha.x.max(0.0).sqrt(), R);
    let (y, ty) = place(alpha.y.max(0.0).sqrt(), R);
    let row = |y: usize| {
        let k = y * R + x;
        tables::GGX_ANISO_ALBEDO_AVERAGE[k] + tx * (tables::GGX_ANISO_ALBEDO_AVERAGE[k + 1] - tables::GGX_ANISO_ALBEDO_AVERAGE[k])
    };
    let scale = (row(y) + ty * (row(y + 1) - row(y))) / same_area.white().max(1e-3);
    GgxAlbedo { f0: same_area.f0 * scale, f90: same_area.f90 * scale }
}

/// The blend of [`ggx_albedo_aniso`] from a table laid out like [`tables::GGX_ANISO_ALBEDO`].
pub(crate) fn aniso_white_albedo(table: &[f32], alpha: Vec2, v: Vec3) -> f32 {
    const C: usize = tables::ANISO_COS_NODES;
    const R: usize = tables::ANISO_ROUGHNESS_NODES;
    let along_axis = |cos_theta: f32, along: f32, across: f32| {
        let (c, tc) = place(cos_theta.sqrt(), C);
        let (a, ta) = place(along.max(0.0).sqrt(), R);
        let (b, tb) = place(across.max(0.0).sqrt(), R);
        let cell = |a: usize, b: usize| {
            let k = (b * R + a) * C + c;
            table[k] + tc * (table[k + 1] - table[k])
        };
        let low = cell(a, b) + ta * (cell(a + 1, b) - cell(a, b));
        let high = cell(a, b + 1) + ta * (cell(a + 1, b + 1) - cell(a, b + 1));
        low + tb * (high - low)
    };
    let stretched = Vec2::new(alpha.x * v.x, alpha.y * v.y);
    let length2 = stretched.length_squared();
    if length2 < 1e-14 {
        return along_axis(1.0, alpha.x, alpha.y);
    }
    // cos θ at which an axis of width α has the same α tan θ.
    let smith2 = length2 / (v.z * v.z).max(1e-12);
    let equal_cos = |a: f32| (1.0 / (1.0 + smith2 / (a * a))).sqrt();
    let over_x = stretched.x * stretched.x / length2;
    let x = along_axis(equal_cos(alpha.x), alpha.x, alpha.y);
    let y = along_axis(equal_cos(alpha.y), alpha.y, alpha.x);
    y + over_x * (x - y)
}

/// The isotropic width with this white albedo at this angle: what stands in for an anisotropic pair where only an isotropic
/// table exists.
pub(crate) fn alpha_of_albedo(white: f32, cos_theta: f32) -> f32 {
    let (mut low, mut high) = (0.0f32, 1.0f32);
    // The albedo falls with the roughness at every angle; 12 halvings of √α are finer than the table.
    for _ in 0..12 {
        let middle = 0.5 * (low + high);
        if ggx_albedo(middle * middle, cos_theta).white() > white {
            low = middle;
        } else {
            high = middle;
        }
    }
    high * high
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
            let [f0, f90] = quadrature::ggx_albedo(quadrature::direction(c, 0.0), Vec2::splat(r * r), 4096);
            let e = ggx_albedo(r * r, c);
            let error = (e.f0 - f0).abs().max((e.f90 - f90).abs()).max((e.white() - f0 - f90).abs());
            worst = worst.max(error);
        }
        assert!(worst < 3e-3, "{worst}");
    }

    #[test]
    fn anisotropic_albedo_is_near_its_integral() {
        let mut rng = Rng::new(7);
        let (mut worst, mut sum, n) = (0.0f32, 0.0, 600);
        for _ in 0..n {
            let (c, phi) = (0.05 + 0.95 * rng.next_1d(), std::f32::consts::FRAC_PI_2 * rng.next_1d());
            let alpha = Vec2::new((0.1 + 0.9 * rng.next_1d()).powi(2), (0.1 + 0.9 * rng.next_1d()).powi(2));
            let v = quadrature::direction(c, phi);
            let [f0, f90] = quadrature::ggx_albedo(v, alpha, 4096);
            let e = ggx_albedo_aniso(alpha, v);
            let error = (e.white() - f0 - f90).abs();
            worst = worst.max(error);
            sum += error / n as f32;
        }
        assert!(worst < 0.015 && sum < 2e-3, "worst {worst}, mean {sum}");
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

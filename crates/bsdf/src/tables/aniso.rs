//! The tables of anisotropic facets: their axes and coordinates.
//!
//! Widths are given by the two numbers of glTF, which fill a square: the roughness √α_y and the strength of the anisotropy,
//! α_x = mix(α_y, 1, strength²). Directions are given by coordinates in which albedos stay smooth down to the narrowest facets. What
//! masking does depends on the *stretched* direction (α_x v_x, α_y v_y, v_z), what Fresnel's factor does on `v` itself; the
//! *half-stretched* direction (√α_x v_x, √α_y v_y, v_z) resolves both.

use super::grid::{Fractions, Grid};
use crate::microfacet::MIN_ALPHA;
use glam::{Vec2, Vec3};

/// White albedo: stretched polar angle, stretched azimuth, strength, roughness.
pub const ANISO_WHITE_GRID: Grid<4> = Grid([20, 4, 14, 20]);
/// Mean cosine of [`ANISO_MEAN_COS`]: half-stretched polar angle, half-stretched azimuth, strength, roughness.
pub const ANISO_COS_GRID: Grid<4> = Grid([16, 16, 12, 16]);
/// Means over directions: strength, roughness.
pub const ANISO_AVERAGE_GRID: Grid<2> = Grid([24, 32]);
/// Glass: half-stretched polar angle, half-stretched azimuth, strength, roughness, index.
pub const ANISO_GLASS_GRID: Grid<5> = Grid([16, 12, 7, 10, 17]);

/// What the stored mean cosine is multiplied by.
pub const ANISO_COS_SCALE: f32 = 2.0;

/// White albedo of anisotropic GGX, [`ANISO_WHITE_GRID`].
pub static ANISO_WHITE: Fractions = Fractions(include_bytes!("aniso_white.bin"));
/// ρ / [`ANISO_COS_SCALE`], [`ANISO_COS_GRID`]: ρ times the stretched length of v is the cosine c at which (1 − c)⁵ is the mean of
/// (1 − v·m)⁵ over the reflected light.
pub static ANISO_MEAN_COS: Fractions = Fractions(include_bytes!("aniso_mean_cos.bin"));
/// Cosine-weighted means over the hemisphere of the albedo's factors of f0 and f90, pairs, [`ANISO_AVERAGE_GRID`].
pub static ANISO_AVERAGE: Fractions = Fractions(include_bytes!("aniso_average.bin"));
/// Reflected plus transmitted share of rough anisotropic glass, [`ANISO_GLASS_GRID`].
pub static ANISO_GLASS: Fractions = Fractions(include_bytes!("aniso_glass.bin"));

/// Strength and roughness of the facets, in [0, 1]; α_x ≥ α_y ≥ [`MIN_ALPHA`].
#[inline]
pub fn aniso_widths(alpha: Vec2) -> [f32; 2] {
    let least = MIN_ALPHA.sqrt();
    [((alpha.x - alpha.y).max(0.0) / (1.0 - alpha.y).max(1e-6)).sqrt(), (alpha.y.sqrt() - least) / (1.0 - least)]
}

/// (α_x, α_y) of [`aniso_widths`].
pub fn aniso_alpha([strength, roughness]: [f32; 2]) -> Vec2 {
    let least = MIN_ALPHA.sqrt();
    let y = (least + (1.0 - least) * roughness).powi(2);
    Vec2::new(y + (1.0 - y) * strength * strength, y)
}

/// Polar and azimuthal coordinate of the stretched direction: √μ / (√μ + √(1 − μ)) of its cosine μ, and cos² of its azimuth.
#[inline]
pub fn aniso_stretched(alpha: Vec2, v: Vec3) -> [f32; 2] {
    let s = Vec2::new(alpha.x * v.x, alpha.y * v.y);
    let s2 = s.length_squared();
    let z = v.z.abs();
    let length = (s2 + z * z).sqrt();
    let (mu, rest) = ((z / length).sqrt(), (s2 / (length * (length + z))).sqrt());
    [mu / (mu + rest), s.x * s.x / s2.max(1e-30)]
}

/// A direction of [`aniso_stretched`].
pub fn aniso_from_stretched(alpha: Vec2, [polar, azimuth]: [f32; 2]) -> Vec3 {
    let (a, b) = (polar * polar, (1.0 - polar) * (1.0 - polar));
    let mu = a / (a + b);
    let r = (1.0 - mu * mu).max(0.0).sqrt();
    lifted(Vec3::new(r * azimuth.sqrt() / alpha.x, r * (1.0 - azimuth).sqrt() / alpha.y, mu))
}

/// Polar and azimuthal coordinate of the half-stretched direction h: 1/(1 + √tan θ), √|h_x| / (√|h_x| + √|h_y|).
#[inline]
pub fn aniso_half_stretched(alpha: Vec2, v: Vec3) -> [f32; 2] {
    let h = Vec2::new(alpha.x.sqrt() * v.x.abs(), alpha.y.sqrt() * v.y.abs());
    let (x, y) = (h.x.sqrt(), h.y.sqrt());
    [1.0 / (1.0 + (h.length() / v.z.abs().max(1e-12)).sqrt()), x / (x + y).max(1e-30)]
}

/// A direction of [`aniso_half_stretched`].
pub fn aniso_from_half_stretched(alpha: Vec2, [polar, azimuth]: [f32; 2]) -> Vec3 {
    let tan = ((1.0 - polar) / polar.max(1e-3)).powi(2);
    let h = Vec2::new(azimuth * azimuth, (1.0 - azimuth) * (1.0 - azimuth)).normalize();
    lifted(Vec3::new(tan * h.x / alpha.x.sqrt(), tan * h.y / alpha.y.sqrt(), 1.0))
}

/// Coordinate of the index in [0, 1]: finer near one, where total reflection sets in.
#[inline]
pub fn aniso_index(eta: f32) -> f32 {
    let z = (eta - 1.0) / (eta + 1.0);
    0.5 + 0.5 * z.signum() * (z.abs() / super::GLASS_Z_MAX).sqrt()
}

/// η of [`aniso_index`].
pub fn aniso_eta(index: f32) -> f32 {
    let t = 2.0 * index - 1.0;
    let z = super::GLASS_Z_MAX * t * t.abs();
    (1.0 + z) / (1.0 - z)
}

/// Unit length, and off the horizon, where no albedo exists.
fn lifted(v: Vec3) -> Vec3 {
    let v = v.normalize();
    Vec3::new(v.x, v.y, v.z.max(1e-4)).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_have_the_sizes_of_their_grids() {
        assert_eq!(ANISO_WHITE.iter().count(), ANISO_WHITE_GRID.size());
        assert_eq!(ANISO_MEAN_COS.iter().count(), ANISO_COS_GRID.size());
        assert_eq!(ANISO_AVERAGE.iter().count(), 2 * ANISO_AVERAGE_GRID.size());
        assert_eq!(ANISO_GLASS.iter().count(), ANISO_GLASS_GRID.size());
    }

    #[test]
    fn coordinates_invert() {
        for widths in [[0.0, 0.0], [0.5, 0.2], [0.9, 0.7], [1.0, 0.3]] {
            let alpha = aniso_alpha(widths);
            let again = aniso_widths(alpha);
            assert!((0..2).all(|i| (again[i] - widths[i]).abs() < 2e-3), "{widths:?} {again:?}");
            for p in [[0.4, 0.3], [0.7, 0.9], [0.9, 0.5]] {
                let full = aniso_stretched(alpha, aniso_from_stretched(alpha, p));
                let half = aniso_half_stretched(alpha, aniso_from_half_stretched(alpha, p));
                assert!(
                    (0..2).all(|i| (full[i] - p[i]).abs() < 1e-3 && (half[i] - p[i]).abs() < 1e-3),
                    "{widths:?} {p:?}: {full:?} {half:?}"
                );
            }
        }
        for eta in [0.4, 0.95, 1.0, 1.5, 2.5] {
            assert!((aniso_eta(aniso_index(eta)) / eta - 1.0).abs() < 1e-4, "{eta}");
        }
    }
}

//! Iridescence: interference in one thin film over a base, integrated over the RGB sensitivities.

use crate::{f0_from_ior, ior_from_f0, schlick_weight};
use glam::{Mat3, Vec3};
use std::f32::consts::{PI, TAU};

/// CIE XYZ to linear BT.709.    IEC 61966-2-1
const BT709_FROM_XYZ: Mat3 =
    Mat3::from_cols_array(&[3.2404542, -0.969266, 0.0556434, -1.5371385, 1.8760108, -0.2040259, -0.4985314, 0.041556, 1.0572252]);

/// Fourier transform of the colour-matching functions at an optical path difference (nm) with a phase shift, linear BT.709.
///
/// Gaussian fits of x̄ (two lobes), ȳ, z̄.    \[Belcour17] eq. 10 and supplemental
#[inline]
pub fn film_sensitivity(path_difference: f32, shift: Vec3) -> Vec3 {
    let phase = TAU * path_difference * 1e-9;
    let lobe = |value: f32, position: f32, variance: f32, shift: f32| {
        value * (TAU * variance).sqrt() * (position * phase + shift).cos() * (-phase * phase * variance).exp()
    };
    let xyz = |shift: f32| {
        Vec3::new(
            lobe(5.4856e-13, 1.6810e6, 4.3278e9, shift) + lobe(9.7470e-14, 2.2399e6, 4.5282e9, shift),
            lobe(4.4201e-13, 1.7953e6, 9.3046e9, shift),
            lobe(5.2481e-13, 2.2084e6, 6.6121e9, shift),
        ) / 1.0685e-7
    };
    // Each RGB channel has its own shift, because the index of the base differs by channel.
    if shift.x == shift.y && shift.y == shift.z {
        return BT709_FROM_XYZ * xyz(shift.x);
    }
    Vec3::new((BT709_FROM_XYZ * xyz(shift.x)).x, (BT709_FROM_XYZ * xyz(shift.y)).y, (BT709_FROM_XYZ * xyz(shift.z)).z)
}

/// Reflectance of a base of normal reflectance `base_f0` under a film of index `film_ior` and `thickness` nm.
///
/// Airy summation of the film's reflections, with Schlick's reflectances at both interfaces and two harmonics of the spectral
/// response.    \[Belcour17] eqs. 3, 7; KHR_materials_iridescence, "Iridescence Fresnel". Clamped to [0, 1]: the RGB form can
/// leave it for saturated colours.
pub fn fresnel_thin_film(cos_theta: f32, film_ior: f32, thickness: f32, base_f0: Vec3) -> Vec3 {
    // A film thinner than 0.03 nm fades to none: its index tends to that of air.
    let fade = (thickness / 0.03).clamp(0.0, 1.0);
    let film_ior = 1.0 + (film_ior - 1.0) * fade * fade * (3.0 - 2.0 * fade);
    let cos2_film = 1.0 - (1.0 - cos_theta * cos_theta) / (film_ior * film_ior);
    if cos2_film < 0.0 {
        return Vec3::ONE;
    }
    let cos_film = cos2_film.sqrt();
    let schlick = |f0: f32, c: f32| f0 + (1.0 - f0) * schlick_weight(c);
    let r12 = schlick(f0_from_ior(film_ior), cos_theta);
    let t121 = 1.0 - r12;
    let phi21 = if film_ior < 1.0 { 0.0 } else { PI };
    let base_ior = base_f0.to_array().map(ior_from_f0);
    let r23 = Vec3::from_array(base_ior.map(|base| schlick(f0_from_ior(base / film_ior), cos_film)));
    let phase = Vec3::from_array(base_ior.map(|base| phi21 + if base < film_ior { PI } else { 0.0 }));
    let path_difference = 2.0 * film_ior * thickness * cos_film;
    let r123 = (r12 * r23).clamp(Vec3::splat(1e-5), Vec3::splat(0.9999));
    let amplitude = Vec3::new(r123.x.sqrt(), r123.y.sqrt(), r123.z.sqrt());
    let rs = t121 * t121 * r23 / (Vec3::ONE - r123);
    let mut reflectance = rs + Vec3::splat(r12);
    let mut harmonic = rs - Vec3::splat(t121);
    for m in [1.0, 2.0] {
        harmonic *= amplitude;
        reflectance += harmonic * 2.0 * film_sensitivity(m * path_difference, m * phase);
    }
    reflectance.clamp(Vec3::ZERO, Vec3::ONE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_thickness_the_base_remains() {
        for f0 in [0.04, 0.3, 0.9] {
            let f = fresnel_thin_film(1.0, 1.3, 0.0, Vec3::splat(f0));
            assert!(f.abs_diff_eq(Vec3::splat(f0), 8e-3), "{f0}: {f}");
        }
    }

    /// White light keeps no phase over a path much longer than its coherence length: the colour fades.
    #[test]
    fn thick_films_lose_their_colour() {
        let spread = |thickness| {
            let f = fresnel_thin_film(0.8, 1.4, thickness, Vec3::splat(0.6));
            f.max_element() - f.min_element()
        };
        assert!(spread(300.0) > 0.05 && spread(20_000.0) < 1e-3, "{} {}", spread(300.0), spread(20_000.0));
    }

    /// The response to no path difference is white: each channel 1.
    #[test]
    fn sensitivities_are_normalised_to_white() {
        let white = film_sensitivity(0.0, Vec3::ZERO);
        assert!((white.dot(Vec3::new(0.2126, 0.7152, 0.0722)) - 1.0).abs() < 0.03, "{white}");
    }

    #[test]
    fn colours_change_with_thickness_and_angle_and_stay_reflectances() {
        let mut distinct = 0;
        for t in 0..60 {
            for c in 0..=10 {
                let f = fresnel_thin_film(c as f32 / 10.0, 1.33, t as f32 * 20.0, Vec3::new(0.04, 0.5, 1.0));
                assert!(f.is_finite() && f.min_element() >= 0.0 && f.max_element() <= 1.0);
                let g = fresnel_thin_film(c as f32 / 10.0, 1.33, (t + 1) as f32 * 20.0, Vec3::new(0.04, 0.5, 1.0));
                distinct += usize::from((f - g).abs().max_element() > 0.01);
            }
        }
        assert!(distinct > 200, "{distinct}");
    }
}

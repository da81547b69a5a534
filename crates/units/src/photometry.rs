//! Photometric to radiometric conversions, each a named function with its source.

use crate::{Candela, Irradiance, Lumens, Lux, Nits, Radiance, Radians, RadiantIntensity};
use std::f32::consts::PI;

/// Luminous efficacy of radiation, lm/W: the photometric value of one watt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LuminousEfficacy(pub f32);

impl LuminousEfficacy {
    /// Monochromatic light of 540 THz, the definition of the candela: 683 lm/W. Source: SI brochure, 9th edition, 2.3.1.
    pub const SI: Self = Self(683.0);

    /// The scale in which files are imported: one lumen per watt, so that a luminance of 1 nt in a file is a radiance of 1 W/(m² sr).
    ///
    /// A file mixes photometric lights, emissive factors and environments that have no absolute unit. One common factor keeps
    /// their ratios and is absorbed by exposure; the factor 1 also keeps every number what the file says.
    pub const IMPORT: Self = Self(1.0);
}

impl Lumens {
    /// I = Φ / 4π: the luminous intensity of an isotropic point light. Source: KHR_lights_punctual, "Light units".
    pub fn to_candela_isotropic(self) -> Candela {
        Candela(self.0 / (4.0 * PI))
    }

    /// I = Φ / Ω: the luminous intensity on the axis of a spot light, where Ω = ∫ falloff dω.
    ///
    /// With the falloff of KHR_lights_punctual, ((cos θ − cos θ_o) / (cos θ_i − cos θ_o))² between the half angles, the integral is closed:
    ///
    /// ```text
    /// Ω = 2π [(1 − cos θ_i) + (cos θ_i − cos θ_o) / 3]
    /// ```
    ///
    /// Domain: 0 ≤ inner ≤ outer, 0 < outer ≤ π/2.
    pub fn to_candela_spot(self, inner: Radians, outer: Radians) -> Candela {
        let (cos_inner, cos_outer) = (inner.0.cos(), outer.0.cos());
        Candela(self.0 / (2.0 * PI * ((1.0 - cos_inner) + (cos_inner - cos_outer) / 3.0)))
    }

    /// L = Φ / (π A): the luminance of a surface of area A, m², that emits Lambertian light on one side.
    pub fn to_nits_lambertian(self, area: f32) -> Nits {
        Nits(self.0 / (PI * area))
    }
}

impl Candela {
    /// I_e = I_v / K.
    pub fn to_radiant_intensity(self, efficacy: LuminousEfficacy) -> RadiantIntensity {
        RadiantIntensity(self.0 / efficacy.0)
    }
}

impl Lux {
    /// E_e = E_v / K.
    pub fn to_irradiance(self, efficacy: LuminousEfficacy) -> Irradiance {
        Irradiance(self.0 / efficacy.0)
    }
}

impl Nits {
    /// L_e = L_v / K.
    pub fn to_radiance(self, efficacy: LuminousEfficacy) -> Radiance {
        Radiance(self.0 / efficacy.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn isotropic_light_of_4_pi_lumens_has_one_candela() {
        assert!((Lumens(4.0 * PI).to_candela_isotropic().0 - 1.0).abs() < 1e-6);
    }

    /// The flux of one candela, by a fine sum of the falloff over the sphere.
    #[test]
    fn spot_of_one_candela_has_the_flux_of_its_falloff() {
        for (inner, outer) in [(0.0f32, 0.5f32), (0.3, 0.3), (0.2, 1.2), (0.0, PI / 2.0)] {
            let (cos_inner, cos_outer) = (f64::from(inner).cos(), f64::from(outer).cos());
            let n = 200_000;
            let flux: f64 = (0..n)
                .map(|i| 1.0 - (f64::from(i) + 0.5) / f64::from(n))
                .map(|cos| ((cos - cos_outer) / (cos_inner - cos_outer).max(1e-9)).clamp(0.0, 1.0).powi(2))
                .sum::<f64>()
                * 2.0
                * std::f64::consts::PI
                / f64::from(n);
            let candela = Lumens(flux as f32).to_candela_spot(Radians(inner), Radians(outer));
            assert!((candela.0 - 1.0).abs() < 1e-3, "{inner} {outer}: {candela:?}");
        }
    }

    #[test]
    fn lambertian_square_metre_of_pi_lumens_has_one_nit() {
        assert!((Lumens(PI).to_nits_lambertian(1.0).0 - 1.0).abs() < 1e-6);
    }

    #[test]
    fn si_watt_of_green_is_683_lumens() {
        assert_eq!(Candela(683.0).to_radiant_intensity(LuminousEfficacy::SI).0, 1.0);
        assert_eq!(Lux(683.0).to_irradiance(LuminousEfficacy::SI).0, 1.0);
        assert_eq!(Nits(5.0).to_radiance(LuminousEfficacy::IMPORT).0, 5.0);
    }
}

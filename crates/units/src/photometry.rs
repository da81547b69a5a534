//! Photometric to radiometric conversions, each a named function with its source.

use crate::{Candela, Irradiance, Lumens, Lux, Nits, Radiance, RadiantIntensity};
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

    #[test]
    fn si_watt_of_green_is_683_lumens() {
        assert_eq!(Candela(683.0).to_radiant_intensity(LuminousEfficacy::SI).0, 1.0);
        assert_eq!(Lux(683.0).to_irradiance(LuminousEfficacy::SI).0, 1.0);
        assert_eq!(Nits(5.0).to_radiance(LuminousEfficacy::IMPORT).0, 5.0);
    }
}

//! The ten materials that Ward measured with his gonioreflectometer.    \[Ward92] table 1

use super::Params;
use kajo_params::ParamChoice;

/// A measured material, or none.
#[derive(ParamChoice, Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names are the materials")]
pub enum Material {
    /// The parameters as given.
    None,
    RolledBrass,
    RolledAluminium,
    LightlyBrushedAluminium,
    VarnishedPlywood,
    EnamelFinishedMetal,
    PaintedCardboardBox,
    WhiteCeramicTile,
    GlossyGreyPaper,
    IvoryComputerPlastic,
    PlasticLaminate,
}

impl Material {
    /// Every material of the table.
    pub const MEASURED: [Self; 10] = [
        Self::RolledBrass,
        Self::RolledAluminium,
        Self::LightlyBrushedAluminium,
        Self::VarnishedPlywood,
        Self::EnamelFinishedMetal,
        Self::PaintedCardboardBox,
        Self::WhiteCeramicTile,
        Self::GlossyGreyPaper,
        Self::IvoryComputerPlastic,
        Self::PlasticLaminate,
    ];

    /// ρ_d, ρ_s, m_x, m_y.
    pub const fn values(self) -> Option<[f64; 4]> {
        Some(match self {
            Self::None => return None,
            Self::RolledBrass => [0.10, 0.33, 0.050, 0.16],
            Self::RolledAluminium => [0.1, 0.21, 0.04, 0.09],
            Self::LightlyBrushedAluminium => [0.15, 0.19, 0.088, 0.13],
            Self::VarnishedPlywood => [0.33, 0.025, 0.04, 0.11],
            Self::EnamelFinishedMetal => [0.25, 0.047, 0.080, 0.096],
            Self::PaintedCardboardBox => [0.19, 0.043, 0.076, 0.085],
            Self::WhiteCeramicTile => [0.70, 0.050, 0.071, 0.071],
            Self::GlossyGreyPaper => [0.29, 0.083, 0.082, 0.082],
            Self::IvoryComputerPlastic => [0.45, 0.043, 0.13, 0.13],
            Self::PlasticLaminate => [0.67, 0.070, 0.092, 0.092],
        })
    }
}

impl Params {
    /// With the values of the measured material, if one is chosen.
    pub(super) fn measured(self) -> Self {
        match self.material.values() {
            Some([kd, ks, mx, my]) => Self { kd: [kd; 3], ks: [ks; 3], mx, my, ..self },
            None => self,
        }
    }
}

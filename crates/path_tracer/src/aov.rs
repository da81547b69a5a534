//! The images a rendering can have besides `beauty`, and their names.
//!
//! Radiance is split by light-path expressions: by the number of bounces, by light, and by the lobe of the *first* bounce. With
//! the bounces of a path counted from the camera, on the same random streams,
//!
//! ```text
//! beauty = emission + direct + indirect-diffuse + indirect-specular
//! direct = direct-diffuse + direct-specular = Σ direct.<light>
//! beauty = Σ bounce.<n>,  n = 0 … max_depth
//! ```
//!
//! The role images (`visibility.<light>`, `ambient-visibility`, `diffuse-indirect`, `specular-indirect`) are the integrals that
//! real-time techniques estimate at the first hit; asking for them does not change the random numbers of `beauty`.

use crate::PathTracerError;
use std::fmt;
use std::str::FromStr;

/// One output image. Lights are named as `Tracer::light_names` lists them; the light `*` stands for every light.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Aov {
    /// Emitters and background seen by the camera itself, W/(m² sr).
    Emission,
    /// Light that bounced once, W/(m² sr).
    Direct,
    /// Share of [`Aov::Direct`] by diffuse lobes.
    DirectDiffuse,
    /// Share of [`Aov::Direct`] by specular lobes, reflection and transmission.
    DirectSpecular,
    /// Share of [`Aov::Direct`] from one light.
    DirectLight(String),
    /// Light that bounced at least twice and left the first surface by a diffuse lobe, W/(m² sr).
    IndirectDiffuse,
    /// Light that bounced at least twice and left the first surface by a specular lobe, W/(m² sr).
    IndirectSpecular,
    /// Light that bounced exactly this often; 0 is [`Aov::Emission`].
    Bounce(u32),
    /// Role direct-visibility: the share of a light that the first hit sees, [0, 1].
    ///
    /// ```text
    /// (1/A) ∫_A V(x, y) dA_y     (directional and sphere lights: the mean over the solid angle they fill as seen from x)
    /// ∫_F w V(x, y) dA_y / ∫_F w dA_y      (emissive meshes; F: the triangles that face x, w: the mean luminance each emits)
    /// ```
    ///
    /// Other parts of an emissive mesh block it as any surface does; where none of it faces x, V = 1: it lights nothing there. Purely geometric: no cosine of the receiver, no falloff, no sidedness of the light, no cone of a spot. V = 0 where the
    /// segment leaves below the geometric surface that the viewer sees: the surface blocks it itself. Masked and blended
    /// surfaces count with their coverage, transmissive ones block. Pixels without a hit are 1, and 0 in [`Aov::Coverage`].
    Visibility(String),
    /// Role ambient-visibility: (1/π) ∫ V cos θ dω about the shading normal, [0, 1], V = 1 where nothing is met within
    /// [`Settings::ambient_distance`](crate::Settings::ambient_distance). 1 without a hit.
    AmbientVisibility,
    /// Mean direction (1/π) ∫ ω V cos θ dω of the above, not normalised, world space.
    BentNormal,
    /// Role diffuse-indirect: irradiance at the first hit by light that bounced at least once before it,
    /// ∫ L_indirect cos θ dω about the shading normal, W/m²; emission that arrives directly is left out.
    DiffuseIndirect,
    /// Role specular-indirect: ∫ f_specular L cos θ dω at the first hit, W/(m² sr), over everything that arrives but the light of
    /// analytic lights: other surfaces, emissive meshes and the environment, as a reflection technique shows them.
    SpecularIndirect,
    /// Base colour at the first hit.
    Albedo,
    /// Geometric normal at the first hit, world space, on the viewer's side.
    Normal,
    /// Shading normal at the first hit (interpolated, normal map applied), world space, on the viewer's side.
    ShadingNormal,
    /// Distance of the first hit along the viewing axis, m; 0 without a hit.
    Depth,
    /// Position of the first hit, world space, m.
    Position,
    /// Share of samples that hit a surface, [0, 1].
    Coverage,
    /// Index of the instance that the pixel's first sample hits; −1 without a hit.
    InstanceId,
    /// Index of the material that the pixel's first sample hits; −1 without a hit.
    MaterialId,
    /// Samples of the pixel: where [`Settings::adaptive`](crate::Settings::adaptive) has put them.
    Samples,
    /// Motion of the first hit since the previous snapshot, px: (x right, y down) now minus then.
    Motion,
}

/// How the samples of a pixel become its value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Combine {
    /// Mean over all samples; its variance is tracked.
    TrackedMean,
    /// Mean over all samples.
    Mean,
    /// Mean over the samples that hit a surface; 0 without any.
    Covered,
    /// The value of the first sample.
    First,
    /// The number of samples.
    Count,
}

impl Aov {
    pub(crate) const PLAIN: [Self; 20] = [
        Self::Emission,
        Self::Direct,
        Self::DirectDiffuse,
        Self::DirectSpecular,
        Self::IndirectDiffuse,
        Self::IndirectSpecular,
        Self::AmbientVisibility,
        Self::BentNormal,
        Self::DiffuseIndirect,
        Self::SpecularIndirect,
        Self::Albedo,
        Self::Normal,
        Self::ShadingNormal,
        Self::Depth,
        Self::Position,
        Self::Coverage,
        Self::InstanceId,
        Self::MaterialId,
        Self::Samples,
        Self::Motion,
    ];

    /// Channels of the image: 1, 2 or 3.
    pub fn channels(&self) -> usize {
        match self {
            Self::Visibility(_) | Self::AmbientVisibility | Self::Depth | Self::Coverage => 1,
            Self::InstanceId | Self::MaterialId | Self::Samples => 1,
            Self::Motion => 2,
            _ => 3,
        }
    }

    /// True for the images that judge a role; their variance is tracked like that of `beauty`.
    pub fn is_role(&self) -> bool {
        matches!(self, Self::Visibility(_) | Self::AmbientVisibility | Self::DiffuseIndirect | Self::SpecularIndirect)
    }

    /// True for images of light or reflectance, false for directions, positions and single numbers.
    pub fn is_color(&self) -> bool {
        let vector = matches!(self, Self::BentNormal | Self::Normal | Self::ShadingNormal | Self::Position | Self::Motion);
        self.channels() == 3 && !vector
    }

    pub(crate) fn combine(&self) -> Combine {
        match self {
            Self::Albedo | Self::Normal | Self::ShadingNormal | Self::Depth | Self::Position | Self::Motion => Combine::Covered,
            Self::InstanceId | Self::MaterialId => Combine::First,
            Self::Samples => Combine::Count,
            aov if aov.is_role() || *aov == Self::Direct => Combine::TrackedMean,
            _ => Combine::Mean,
        }
    }
}

impl fmt::Display for Aov {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Emission => "emission",
            Self::Direct => "direct",
            Self::DirectDiffuse => "direct-diffuse",
            Self::DirectSpecular => "direct-specular",
            Self::DirectLight(light) => return write!(f, "direct.{light}"),
            Self::IndirectDiffuse => "indirect-diffuse",
            Self::IndirectSpecular => "indirect-specular",
            Self::Bounce(n) => return write!(f, "bounce.{n}"),
            Self::Visibility(light) => return write!(f, "visibility.{light}"),
            Self::AmbientVisibility => "ambient-visibility",
            Self::BentNormal => "bent-normal",
            Self::DiffuseIndirect => "diffuse-indirect",
            Self::SpecularIndirect => "specular-indirect",
            Self::Albedo => "albedo",
            Self::Normal => "normal",
            Self::ShadingNormal => "shading-normal",
            Self::Depth => "depth",
            Self::Position => "position",
            Self::Coverage => "coverage",
            Self::InstanceId => "instance-id",
            Self::MaterialId => "material-id",
            Self::Samples => "samples",
            Self::Motion => "motion",
        })
    }
}

impl FromStr for Aov {
    type Err = PathTracerError;

    fn from_str(s: &str) -> Result<Self, PathTracerError> {
        if let Some(light) = s.strip_prefix("direct.").filter(|light| !light.is_empty()) {
            return Ok(Self::DirectLight(light.into()));
        }
        if let Some(light) = s.strip_prefix("visibility.").filter(|light| !light.is_empty()) {
            return Ok(Self::Visibility(light.into()));
        }
        if let Some(n) = s.strip_prefix("bounce.").and_then(|n| n.parse().ok()) {
            return Ok(Self::Bounce(n));
        }
        Self::PLAIN.iter().find(|aov| aov.to_string() == s).cloned().ok_or_else(|| PathTracerError::Aov {
            got: s.into(),
            known: Self::PLAIN.iter().map(Self::to_string).collect::<Vec<_>>().join(", ")
                + ", direct.<light>, visibility.<light>, bounce.<n>",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_parses_back() {
        let with_argument = [Aov::DirectLight("Key light".into()), Aov::Bounce(3), Aov::Visibility("2".into())];
        for aov in Aov::PLAIN.iter().chain(&with_argument) {
            assert_eq!(&aov.to_string().parse::<Aov>().unwrap(), aov);
        }
        for wrong in ["diffuse", "bounce.x", "direct.", ""] {
            let message = wrong.parse::<Aov>().unwrap_err().to_string();
            assert!(message.contains("ambient-visibility"), "{message}");
        }
    }
}

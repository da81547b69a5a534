//! Roles: what a technique may be asked to estimate. A role fixes the output, its unit, the integral, and the reference that judges it.

use kajo_names::UnknownName;
use kajo_render_graph::{Slot, slot};
use std::fmt;
use std::str::FromStr;

/// A part of the picture that exchangeable techniques estimate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Role {
    /// Which share of each light a point sees.
    DirectVisibility,
    /// Which share of the hemisphere a point sees.
    AmbientVisibility,
    /// Diffusely reflected light that bounced before.
    DiffuseIndirect,
    /// Light that arrives by specular reflection.
    SpecularIndirect,
    /// Which lights to sample.
    LightSampling,
    /// Noise removal.
    Denoise,
    /// Edges without stairs.
    AntiAlias,
    /// Radiance to display values.
    ToneMap,
}

/// What is fixed for a role.
#[derive(Clone, Copy, Debug, PartialEq)]
struct RoleData {
    id: &'static str,
    title: &'static str,
    estimates: &'static str,
    unit: &'static str,
    judged_by: &'static str,
    output: Option<Slot>,
}

impl Role {
    /// Every role, in the order of every list.
    pub const ALL: [Self; 8] = [
        Self::DirectVisibility,
        Self::AmbientVisibility,
        Self::DiffuseIndirect,
        Self::SpecularIndirect,
        Self::LightSampling,
        Self::Denoise,
        Self::AntiAlias,
        Self::ToneMap,
    ];

    const fn data(self) -> RoleData {
        match self {
            Self::DirectVisibility => RoleData {
                id: "direct-visibility",
                title: "Direct visibility",
                estimates: "(1/A) ∫ V(x, y) dA over each light",
                unit: "1, in [0, 1] per light",
                judged_by: "visibility.<light>",
                output: Some(slot::SHADOW_VISIBILITY),
            },
            Self::AmbientVisibility => RoleData {
                id: "ambient-visibility",
                title: "Ambient visibility",
                estimates: "(1/π) ∫ V cos θ dω, V = 1 where nothing is met within the ambient distance",
                unit: "1, in [0, 1]",
                judged_by: "ambient-visibility",
                output: Some(slot::AMBIENT_VISIBILITY),
            },
            Self::DiffuseIndirect => RoleData {
                id: "diffuse-indirect",
                title: "Diffuse indirect light",
                estimates: "∫ L_indirect cos θ dω",
                unit: "W/m²",
                judged_by: "diffuse-indirect",
                output: Some(slot::DIFFUSE_INDIRECT),
            },
            Self::SpecularIndirect => RoleData {
                id: "specular-indirect",
                title: "Specular indirect light",
                estimates: "∫ f_specular L cos θ dω",
                unit: "W/(m² sr)",
                judged_by: "specular-indirect",
                output: Some(slot::SPECULAR_INDIRECT),
            },
            Self::LightSampling => RoleData {
                id: "light-sampling",
                title: "Light sampling",
                estimates: "Σ over lights of the direct light",
                unit: "W/(m² sr)",
                judged_by: "direct",
                output: Some(slot::DIRECT),
            },
            Self::Denoise => RoleData {
                id: "denoise",
                title: "Denoising",
                estimates: "the mean of its noisy input",
                unit: "as its input",
                judged_by: "beauty",
                output: None,
            },
            Self::AntiAlias => RoleData {
                id: "anti-alias",
                title: "Anti-aliasing",
                estimates: "the mean over each pixel's area",
                unit: "as its input",
                judged_by: "beauty",
                output: Some(slot::RESOLVED),
            },
            Self::ToneMap => RoleData {
                id: "tone-map",
                title: "Tone map",
                estimates: "the display value of a radiance",
                unit: "sRGB display value",
                judged_by: "its analytic curve",
                output: Some(slot::DISPLAY),
            },
        }
    }

    /// Name on the command line and in reports, e.g. `direct-visibility`.
    pub const fn id(self) -> &'static str {
        self.data().id
    }

    /// Name for people.
    pub const fn title(self) -> &'static str {
        self.data().title
    }

    /// The integral that every technique of the role estimates.
    pub const fn estimates(self) -> &'static str {
        self.data().estimates
    }

    /// Unit of the output.
    pub const fn unit(self) -> &'static str {
        self.data().unit
    }

    /// The path tracer's image that judges it; `<light>` stands for the name of each light.
    pub const fn judged_by(self) -> &'static str {
        self.data().judged_by
    }

    /// The slot that its techniques fill; `None` for roles that no technique fills yet.
    pub const fn output(self) -> Option<Slot> {
        self.data().output
    }
}

impl fmt::Display for Role {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.id())
    }
}

impl FromStr for Role {
    type Err = crate::Error;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let unknown = || UnknownName::new("role", text, &Self::ALL.map(Self::id)).into();
        Self::ALL.into_iter().find(|role| role.id() == text).ok_or_else(unknown)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_role_parses_back() {
        for role in Role::ALL {
            assert_eq!(role.to_string().parse::<Role>().unwrap(), role);
        }
        assert!("shadows".parse::<Role>().unwrap_err().to_string().contains("direct-visibility"));
    }
}

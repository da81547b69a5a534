//! What to render, and with which technique for each role.

use crate::Error;
use glam::{UVec2, Vec2};
use kajo_params::ParamValues;
use kajo_scene::Culling;
use kajo_techniques::{Role, Technique, TraceBackend};

/// What stays the same for the life of a renderer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RendererSettings {
    /// Size of the image, px.
    pub size: UVec2,
    /// Index of the camera.
    pub camera: usize,
    /// Who traces rays; `None` takes ray queries where the adapter has them.
    pub backend: Option<TraceBackend>,
    /// Samples of the unshadowed light of lights with an extent.
    pub light_samples: u32,
    /// Lets shaders choose textures by number where the adapter can; off, texels are read from a buffer.
    pub bindless: bool,
    /// Instances that rays do not meet: reflections, shadow rays and all others. The camera sees them, and shadow maps have them.
    pub ray_culling: Culling,
    /// Largest memory of the images that have a layer for each light, bytes: more lights are worked on in groups.
    pub light_memory: u64,
}

impl RendererSettings {
    /// The defaults for an image of `size`.
    pub fn new(size: UVec2) -> Self {
        Self { size, camera: 0, backend: None, light_samples: 16, bindless: true, ray_culling: Culling::Off, light_memory: 256 << 20 }
    }
}

/// What changes from frame to frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameSettings {
    /// Number of the frame: random numbers depend on it, and what is kept from frame to frame belongs to the number before.
    pub index: u32,
    /// Where in each pixel is sampled, from its centre, px, x right and y down; what the technique of the role anti-alias chooses is added.
    pub jitter: Vec2,
    /// Exposure in stops; `None` takes the scene's, or 0.
    pub exposure: Option<f32>,
    /// Reads the G-buffer back.
    pub gbuffer: bool,
    /// Role ambient visibility: how far a surface blocks, m; infinite where everything does.
    pub ambient_distance: f32,
    /// Reads back what the techniques of these roles estimated.
    pub read: Read,
    /// The environment lights surfaces, by the share of it that the role ambient visibility finds; else it is seen and reflected only.
    pub environment_light: bool,
    /// Asks techniques for pictures of their inner workings.
    pub debug: bool,
    /// Lights opaque surfaces as they are drawn, without shadows, instead of through the G-buffer: to check one way by the other.
    pub forward: bool,
    /// Leaves out draws that the camera cannot see; they cast shadows and are met by rays all the same.
    pub culling: bool,
}

impl Default for FrameSettings {
    fn default() -> Self {
        Self {
            index: 0,
            jitter: Vec2::ZERO,
            exposure: None,
            gbuffer: false,
            ambient_distance: f32::INFINITY,
            read: Read::Nothing,
            environment_light: true,
            debug: false,
            forward: false,
            culling: true,
        }
    }
}

/// Roles with one image whose estimates are read back; the role direct visibility has one for each light that is [watched](crate::Renderer::watch).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Read {
    /// None.
    Nothing,
    /// This one; of other roles nothing.
    One(Role),
    /// Each of them.
    Every,
}

impl Read {
    const ALL: [Role; 3] = [Role::AmbientVisibility, Role::DiffuseIndirect, Role::SpecularIndirect];

    /// The roles.
    pub(crate) fn roles(self) -> impl Iterator<Item = Role> {
        Self::ALL.into_iter().filter(move |role| self == Self::Every || self == Self::One(*role))
    }
}

/// A technique with its parameters for each role that a frame needs.
#[derive(Clone, Debug, PartialEq)]
pub struct RoleSelection {
    choices: Vec<Choice>,
}

/// A technique with its parameters.
#[derive(Clone, Debug)]
pub(crate) struct Choice {
    pub technique: &'static Technique,
    pub params: ParamValues,
}

impl PartialEq for Choice {
    fn eq(&self, other: &Self) -> bool {
        self.technique.id == other.technique.id && self.params == other.params
    }
}

impl Default for RoleSelection {
    fn default() -> Self {
        let default =
            |role| kajo_techniques::default_of(role).map(|technique| Choice { technique, params: ParamValues::defaults(technique.params) });
        Self { choices: Role::ALL.into_iter().filter_map(default).collect() }
    }
}

impl RoleSelection {
    /// The default technique of every role.
    pub fn new() -> Self {
        Self::default()
    }

    /// Chooses a technique for its role.
    pub fn with(mut self, technique: &'static Technique, params: ParamValues) -> Self {
        self.choices.retain(|choice| choice.technique.role != technique.role);
        self.choices.push(Choice { technique, params });
        self
    }

    /// Chooses a technique by id, with parameters as text.
    ///
    /// # Errors
    /// When there is no such technique, or a parameter cannot be used.
    pub fn choose(self, id: &str, params: &[(&str, &str)]) -> Result<Self, Error> {
        let technique = kajo_techniques::find(id)?;
        let params = technique.parse_params(params)?;
        Ok(self.with(technique, params))
    }

    /// The technique chosen for a role.
    pub fn technique(&self, role: Role) -> Option<&'static Technique> {
        self.choice(role).map(|choice| choice.technique)
    }

    pub(crate) fn choice(&self, role: Role) -> Option<&Choice> {
        self.choices.iter().find(|choice| choice.technique.role == role)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_choice_replaces_that_of_its_role_only() {
        let selection = RoleSelection::new().choose("shadow/none", &[]).unwrap();
        assert_eq!(selection.technique(Role::DirectVisibility).unwrap().id, "shadow/none");
        assert!(selection.technique(Role::ToneMap).is_some());
        assert!(RoleSelection::new().choose("shadow/nothing", &[]).is_err());
        assert!(RoleSelection::new().choose("shadow/ray-traced", &[("samples", "0")]).is_err());
    }
}

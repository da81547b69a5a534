//! What techniques are given: by the scene once, and by the frame again and again.

use crate::view::View;
use crate::{Error, shaders};
use glam::{UVec2, Vec3};
use kajo_render_graph::wgpu;
use kajo_render_graph::{Bindings, Device, Shader};
use kajo_scene::{PlacedLight, Scene, Snapshot};
use kajo_shader_lib::SourceFile;

/// Which hardware traces rays behind the interface `trace`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TraceBackend {
    /// Ray queries of the device.
    RayQuery,
    /// A hierarchy in buffers, walked by the shader; runs on every adapter.
    Compute,
}

impl TraceBackend {
    /// Ray queries where the device has them.
    pub fn best(device: &Device) -> Self {
        if device.has_ray_query() { Self::RayQuery } else { Self::Compute }
    }

    /// `ray-query` or `compute`.
    pub const fn id(self) -> &'static str {
        match self {
            Self::RayQuery => "ray-query",
            Self::Compute => "compute",
        }
    }
}

/// What stays the same for a scene: shaders depend on it.
#[derive(Clone, Copy, Debug)]
pub struct MakeContext<'a> {
    /// The device; it counts the memory of the technique apart.
    pub device: &'a Device,
    /// What its shaders depend on.
    pub variant: shaders::Variant<'a>,
    /// Length of the list of textures.
    pub textures: u32,
}

impl MakeContext<'_> {
    /// Links and compiles a technique's shader; it may import the modules of [`shaders`] and of `shader_lib`.
    ///
    /// # Errors
    /// When the shader does not link or the device refuses it.
    pub fn shader(&self, name: &str, source: &str) -> Result<Shader, Error> {
        self.shader_with(name, source, &[])
    }

    /// The same, where the shader also imports `files`.
    ///
    /// # Errors
    /// As [`Self::shader`].
    pub fn shader_with(&self, name: &str, source: &str, files: &[SourceFile]) -> Result<Shader, Error> {
        Ok(Shader::new(self.device, shaders::link_with_files(name, source, files, self.variant))?)
    }
}

/// A mesh to draw: a range of the index buffer, and the instance it belongs to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Draw {
    /// Index of the instance in the list on the device.
    pub instance: u32,
    /// First entry of the index buffer.
    pub first_index: u32,
    /// Entries of the index buffer.
    pub index_count: u32,
    /// Added to each entry.
    pub base_vertex: i32,
    /// How the surface covers what is behind it.
    pub coverage: Coverage,
}

/// How a surface covers what is behind it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coverage {
    /// Wholly.
    Opaque,
    /// Wholly or not at all, by a texture.
    Mask,
    /// In part.
    Blend,
}

/// A light of the frame.
#[derive(Clone, Debug)]
pub enum FrameLight {
    /// An analytic light.
    Analytic(PlacedLight),
    /// An instance that emits.
    Mesh {
        /// Its index in the list on the device.
        instance: u32,
        /// Middle of its emission, world, m.
        center: Vec3,
    },
}

impl FrameLight {
    /// The analytic light, when it is one.
    pub fn analytic(&self) -> Option<&PlacedLight> {
        match self {
            Self::Analytic(placed) => Some(placed),
            Self::Mesh { .. } => None,
        }
    }

    /// The middle of the light, world, m.
    pub fn center(&self) -> Vec3 {
        match self {
            Self::Analytic(placed) => placed.world_from_light.translation.into(),
            Self::Mesh { center, .. } => *center,
        }
    }

    /// Whether the light is that instance.
    pub fn is(&self, of: u32) -> bool {
        matches!(self, Self::Mesh { instance, .. } if *instance == of)
    }
}

/// What changes with each frame, for one group of lights.
pub struct FrameContext<'a> {
    /// The device; it counts the memory of the technique apart.
    pub device: &'a Device,
    /// The camera.
    pub view: View,
    /// Number of the frame: random numbers depend on it.
    pub index: u32,
    /// Nothing has moved since the frame before, and no other technique was chosen.
    pub still: bool,
    /// Lights of this group.
    pub lights: &'a [FrameLight],
    /// Index of the first of them in the list on the device.
    pub first_light: u32,
    /// Everything that casts shadows; draws of one mesh with different instances stand apart.
    pub draws: &'a [Draw],
    /// Index buffer of all draws.
    pub indices: &'a wgpu::Buffer,
    /// The scene, for names and materials.
    pub scene: &'a Scene,
    /// The scene as it is drawn: `draws` are its instances, in the same order.
    pub snapshot: &'a Snapshot,
    /// Box around everything, world, m.
    pub bounds: [Vec3; 2],
    /// Exposure in stops: a display shows radiance · 2^exposure.
    pub exposure: f32,
    /// Role ambient visibility: how far a surface blocks, m; infinite where everything does.
    pub ambient_distance: f32,
    /// The environment lights surfaces.
    pub environment_light: bool,
    /// Pictures of the technique's inner workings are wanted: see [`Effect::debug_views`](crate::Effect::debug_views).
    pub debug: bool,
    /// What the shared modules declare, by name: frame, scene, lights, trace.
    pub shared: Bindings<'a>,
}

impl FrameContext<'_> {
    /// Size of the image, px.
    pub fn size(&self) -> UVec2 {
        self.view.size
    }

    /// Draws every mesh for which `wanted` holds; the pipeline is set.
    pub fn draw(&self, pass: &mut wgpu::RenderPass, wanted: impl Fn(&Draw) -> bool) {
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
        for draw in self.draws.iter().filter(|draw| wanted(draw)) {
            pass.draw_indexed(draw.first_index..draw.first_index + draw.index_count, draw.base_vertex, draw.instance..draw.instance + 1);
        }
    }
}

//! The passes that every frame has, whatever the techniques: G-buffer, background, direct light, forward light, the picture without reflections and with them.

pub(crate) mod background;
pub(crate) mod direct;
pub(crate) mod forward;
pub(crate) mod gbuffer;
pub(crate) mod lit;
pub(crate) mod picture;

use kajo_render_graph::{Device, Shader, wgpu};
use kajo_shader_lib::SourceFile;
use kajo_techniques::shaders::{self, Variant};

/// What a pipeline of this crate depends on.
#[derive(Clone, Copy)]
pub(crate) struct Setup<'a> {
    pub device: &'a Device,
    pub variant: Variant<'a>,
    pub textures: u32,
}

impl Setup<'_> {
    pub fn shader(&self, name: &str, source: &str) -> Result<Shader, kajo_render_graph::Error> {
        self.shader_with(name, source, &[])
    }

    /// The same, where the shader also imports `files`.
    pub fn shader_with(&self, name: &str, source: &str, files: &[SourceFile]) -> Result<Shader, kajo_render_graph::Error> {
        Shader::new(self.device, shaders::link_with_files(name, source, files, self.variant))
    }
}

/// A colour attachment; cleared to zeros, or kept.
pub(crate) fn attachment(view: &wgpu::TextureView, clear: bool) -> Option<wgpu::RenderPassColorAttachment<'_>> {
    let load = if clear { wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT) } else { wgpu::LoadOp::Load };
    Some(wgpu::RenderPassColorAttachment {
        view,
        depth_slice: None,
        resolve_target: None,
        ops: wgpu::Operations { load, store: wgpu::StoreOp::Store },
    })
}

/// Triangles without culling: rays see both sides, and so does the rasteriser.
pub(crate) const TRIANGLES: wgpu::PrimitiveState = wgpu::PrimitiveState {
    topology: wgpu::PrimitiveTopology::TriangleList,
    strip_index_format: None,
    front_face: wgpu::FrontFace::Ccw,
    cull_mode: None,
    unclipped_depth: false,
    polygon_mode: wgpu::PolygonMode::Fill,
    conservative: false,
};

/// Reversed depth: nearer is greater.
pub(crate) fn depth_state(write: bool) -> wgpu::DepthStencilState {
    wgpu::DepthStencilState {
        format: wgpu::TextureFormat::Depth32Float,
        depth_write_enabled: Some(write),
        depth_compare: Some(wgpu::CompareFunction::Greater),
        stencil: wgpu::StencilState::default(),
        bias: wgpu::DepthBiasState::default(),
    }
}

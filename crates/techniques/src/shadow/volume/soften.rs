//! Penumbrae: what the edges of the silhouettes cut off each light.

use super::buffers;
use super::extract::Lists;
use crate::{Error, FrameContext, MakeContext};
use bytemuck::{Pod, Zeroable};
use kajo_render_graph::{Bindings, Buffer, ComputePipeline, PassContext, PipelineOptions, Resource, Texture, slot};
use kajo_shader_lib::ShaderLayout;

/// Twin of `Softening` in soften.wesl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable, ShaderLayout)]
pub(super) struct GpuSoftening {
    light: u32,
    layer: u32,
    distance: f32,
    samples: u32,
}

/// Points of a light that the horizon cuts.
const HORIZON_SAMPLES: u32 = 64;

pub(super) struct Soften {
    pipeline: ComputePipeline,
    uniforms: Option<Buffer>,
}

impl Soften {
    pub fn new(context: &MakeContext) -> Result<Self, Error> {
        let shader = context.shader("shadow/volume/soften", include_str!("soften.wesl"))?;
        let options = PipelineOptions { list_length: context.textures, ..Default::default() };
        Ok(Self { pipeline: ComputePipeline::new(context.device, &shader, "soften", options)?, uniforms: None })
    }

    pub fn prepare(&mut self, frame: &FrameContext) -> Result<(), Error> {
        let [low, high] = frame.bounds;
        let distance = 4.0 * (high - low).length() + (low - frame.view.position).abs().max((high - frame.view.position).abs()).length();
        let uniform = |layer| GpuSoftening { light: frame.first_light + layer, layer, distance, samples: HORIZON_SAMPLES };
        let uniforms: Vec<GpuSoftening> = (0..frame.lights.len() as u32).map(uniform).collect();
        buffers::upload_uniforms(frame.device, &mut self.uniforms, "shadow/volume softening", &uniforms)
    }

    pub fn run(
        &self,
        frame: &FrameContext,
        layer: usize,
        stencil: &Texture,
        (lists, counts): (Lists, Resource),
        pass: &mut PassContext,
    ) -> Result<(), kajo_render_graph::Error> {
        let own = Bindings::new()
            .with("softening", buffers::uniform::<GpuSoftening>(&self.uniforms, layer))
            .with("depth", pass.view(slot::DEPTH)?)
            .with("normal", pass.view(slot::NORMAL)?)
            .with("ids", pass.view(slot::IDS)?)
            .with("stencil", stencil)
            .with("counts", counts)
            .with("silhouette", lists.silhouette)
            .with("visibility", pass.view(slot::SHADOW_VISIBILITY)?);
        self.pipeline.dispatch(pass.device, pass.encoder, &frame.shared, &own, frame.size().extend(1))
    }
}

//! Where the visible points lie, and what the counts say about them.

use super::{Count, buffers};
use crate::{Error, FrameContext, MakeContext};
use bytemuck::{Pod, Zeroable};
use glam::UVec3;
use kajo_render_graph::{Bindings, Buffer, ComputePipeline, PassContext, PipelineOptions, Resource, Texture, slot};
use kajo_shader_lib::ShaderLayout;

/// Twin of `Receiving` in receive.wesl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable, ShaderLayout)]
pub(super) struct GpuReceiving {
    light: u32,
    layer: u32,
    skip: u32,
    least: f32,
}

pub(super) struct Receive {
    find_limits: ComputePipeline,
    answer: ComputePipeline,
    show_counts: ComputePipeline,
    uniforms: Option<Buffer>,
}

impl Receive {
    pub fn new(context: &MakeContext) -> Result<Self, Error> {
        let shader = context.shader("shadow/volume/receive", include_str!("receive.wesl"))?;
        let options = PipelineOptions { list_length: context.textures, ..Default::default() };
        let pipeline = |entry| ComputePipeline::new(context.device, &shader, entry, options);
        Ok(Self {
            find_limits: pipeline("find_limits")?,
            answer: pipeline("answer")?,
            show_counts: pipeline("show_counts")?,
            uniforms: None,
        })
    }

    /// `skip`: nothing is counted where the answer is known.
    pub fn prepare(&mut self, frame: &FrameContext, count: Count, skip: bool) -> Result<(), Error> {
        // Caps know their own side exactly; without them what lies within the rounding of normals is dark.
        let least = if count == Count::Behind { -1.0 } else { 2e-4 };
        let uniform = |layer| GpuReceiving { light: frame.first_light + layer, layer, skip: u32::from(skip), least };
        let uniforms: Vec<GpuReceiving> = (0..frame.lights.len() as u32).map(uniform).collect();
        buffers::upload_uniforms(frame.device, &mut self.uniforms, "shadow/volume receiving", &uniforms)
    }

    pub fn find_limits(
        &self,
        frame: &FrameContext,
        layer: usize,
        limit: &Texture,
        pass: &mut PassContext,
    ) -> Result<(), kajo_render_graph::Error> {
        let own = self.points(layer, pass)?.with("limit", limit);
        self.find_limits.dispatch(pass.device, pass.encoder, &frame.shared, &own, over(frame))
    }

    pub fn answer(
        &self,
        frame: &FrameContext,
        layer: usize,
        [stencil, dark]: [&Texture; 2],
        counts: Resource,
        pass: &mut PassContext,
    ) -> Result<(), kajo_render_graph::Error> {
        let own = self.points(layer, pass)?.with("stencil", stencil).with("dark", dark).with("counts", counts);
        let own = own.with("visibility", pass.view(slot::SHADOW_VISIBILITY)?);
        self.answer.dispatch(pass.device, pass.encoder, &frame.shared, &own, over(frame))
    }

    /// Copies the counts of a light into its layer of `shown`.
    pub fn show_counts(
        &self,
        frame: &FrameContext,
        layer: usize,
        [stencil, shown]: [&Texture; 2],
        counts: Resource,
        pass: &mut PassContext,
    ) -> Result<(), kajo_render_graph::Error> {
        let own = Bindings::new()
            .with("receiving", buffers::uniform::<GpuReceiving>(&self.uniforms, layer))
            .with("stencil", stencil)
            .with("counts", counts)
            .with("shown", shown.array());
        self.show_counts.dispatch(pass.device, pass.encoder, &frame.shared, &own, over(frame))
    }

    /// What the visible points are found from.
    fn points(&self, layer: usize, pass: &PassContext) -> Result<Bindings<'_>, kajo_render_graph::Error> {
        Ok(Bindings::new()
            .with("receiving", buffers::uniform::<GpuReceiving>(&self.uniforms, layer))
            .with("depth", pass.view(slot::DEPTH)?)
            .with("normal", pass.view(slot::NORMAL)?)
            .with("ids", pass.view(slot::IDS)?))
    }
}

fn over(frame: &FrameContext) -> UVec3 {
    frame.size().extend(1)
}

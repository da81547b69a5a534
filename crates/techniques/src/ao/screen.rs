//! The pass of a technique that looks around in the depth buffer and in nothing else.

use super::READS;
use crate::{Error, FrameContext, MakeContext};
use kajo_render_graph::wgpu::BufferUsages;
use kajo_render_graph::{Access, Bindings, Buffer, ComputePipeline, Graph, PipelineOptions, Slot, slot};

/// A shader with the entry point `look_around` that reads `params`, `depth` and `normal` and writes `visibility`.
pub(super) struct ScreenPass {
    name: &'static str,
    pipeline: ComputePipeline,
    uniform: Buffer,
}

impl ScreenPass {
    /// `id` is the technique's, `name` the pass's, `bytes` the size of its uniform.
    ///
    /// # Errors
    /// When the device refuses.
    pub fn new(context: &MakeContext, (id, name): (&str, &'static str), source: &str, bytes: usize) -> Result<Self, Error> {
        let shader = context.shader(id, source)?;
        let options = PipelineOptions { list_length: context.textures, ..Default::default() };
        Ok(Self {
            name,
            pipeline: ComputePipeline::new(context.device, &shader, "look_around", options)?,
            uniform: context.device.buffer(name, bytes as u64, BufferUsages::UNIFORM | BufferUsages::COPY_DST)?,
        })
    }

    /// Uploads what the shader reads.
    pub fn write(&self, frame: &FrameContext, params: &impl bytemuck::NoUninit) {
        self.uniform.write(&frame.device.queue, bytemuck::bytes_of(params));
    }

    /// Adds the pass, which makes `target`.
    pub fn record<'a>(&'a self, frame: &'a FrameContext<'a>, graph: &mut Graph<'a>, target: Slot) {
        graph.pass(Access::new(self.name).reads(READS).writes(&[target]), move |pass| {
            let own = Bindings::new()
                .with("params", &self.uniform)
                .with("depth", pass.view(slot::DEPTH)?)
                .with("normal", pass.view(slot::NORMAL)?)
                .with("visibility", pass.view(target)?);
            self.pipeline.dispatch(pass.device, pass.encoder, &frame.shared, &own, frame.size().extend(1))
        });
    }
}

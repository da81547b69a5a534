//! The pass that hybrids share: rays where a shadow map is not to be trusted, over what the map answered.

use crate::ray_count::RayCount;
use crate::{Error, FrameContext, MakeContext};
use kajo_render_graph::wgpu::BufferUsages;
use kajo_render_graph::{Bindings, Buffer, ComputePipeline, PassContext, PipelineOptions, slot};

/// A shader with the entry point `trace_some` that reads `params`, `depth` and `normal`, changes `visibility` and counts its rays.
pub(super) struct RayPass {
    pipeline: ComputePipeline,
    uniform: Buffer,
    /// What it counted.
    pub rays: RayCount,
}

impl RayPass {
    /// `id` is the technique's, `bytes` the size of the shader's uniform.
    ///
    /// # Errors
    /// When the device refuses.
    pub fn new(context: &MakeContext, id: &str, source: &str, bytes: usize) -> Result<Self, Error> {
        let shader = context.shader(id, source)?;
        let options = PipelineOptions { list_length: context.textures, ..Default::default() };
        Ok(Self {
            pipeline: ComputePipeline::new(context.device, &shader, "trace_some", options)?,
            uniform: context.device.buffer(id, bytes as u64, BufferUsages::UNIFORM | BufferUsages::COPY_DST)?,
            rays: RayCount::new(context, &format!("{id} rays"))?,
        })
    }

    /// Uploads what the shader reads and begins to count.
    pub fn prepare(&self, frame: &FrameContext, params: &impl bytemuck::NoUninit) {
        self.uniform.write(&frame.device.queue, bytemuck::bytes_of(params));
        self.rays.prepare(frame);
    }

    /// Runs it for every pixel and light; `more` is what the shader binds beside.
    ///
    /// # Errors
    /// When the pass has not declared depth, normal and the role's slot.
    pub fn dispatch<'p>(
        &'p self,
        frame: &'p FrameContext,
        pass: &mut PassContext,
        more: Bindings<'p>,
    ) -> Result<(), kajo_render_graph::Error> {
        let own = more
            .with("params", &self.uniform)
            .with("depth", pass.view(slot::DEPTH)?)
            .with("normal", pass.view(slot::NORMAL)?)
            .with("visibility", pass.view(slot::SHADOW_VISIBILITY)?)
            .with(RayCount::BINDING, self.rays.buffer());
        self.pipeline.dispatch(pass.device, pass.encoder, &frame.shared, &own, frame.size().extend(frame.lights.len() as u32))
    }
}

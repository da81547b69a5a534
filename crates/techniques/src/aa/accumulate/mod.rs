//! The mean of frames of a still view.

use super::{History, halton_jitter};
use crate::{Effect, Error, FrameContext, MakeContext, Needs, Role, Technique};
use glam::Vec2;
use kajo_params::{ParamValues, Params};
use kajo_render_graph::wgpu::BufferUsages;
use kajo_render_graph::{Access, Bindings, Buffer, ComputePipeline, Graph, PipelineOptions, slot};

/// The technique.
pub const TECHNIQUE: Technique = Technique {
    id: "aa/accumulate",
    role: Role::AntiAlias,
    title: "Mean of frames",
    doc: include_str!("doc.md"),
    cites: &["Haeberli90", "Halton64"],
    reads: &[slot::COLOR],
    needs: Needs::NONE,
    params: Params::SPEC,
    make: |context, values| Ok(Box::new(Accumulate::new(context, values)?)),
};

/// Its parameters.
#[derive(Params, Clone, Copy, Debug)]
pub struct Params {
    /// Frames in the mean, and points of the jitter. More are smoother, and take longer to gather.
    #[param(default = 16, range = 1..=4096)]
    pub frames: u32,
}

/// What the shader reads.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable, kajo_shader_lib::ShaderLayout)]
struct GpuParams {
    share: f32,
    _padding: [u32; 3],
}

struct Accumulate {
    params: Params,
    pipeline: ComputePipeline,
    uniform: Buffer,
    history: History,
    /// Number of the last frame, and the frames in its mean.
    gathered: Option<(u32, u32)>,
}

impl Accumulate {
    fn new(context: &MakeContext, values: &ParamValues) -> Result<Self, Error> {
        let shader = context.shader(TECHNIQUE.id, include_str!("accumulate.wesl"))?;
        let options = PipelineOptions { list_length: context.textures, ..Default::default() };
        let usage = BufferUsages::UNIFORM | BufferUsages::COPY_DST;
        Ok(Self {
            params: Params::from_values(values),
            pipeline: ComputePipeline::new(context.device, &shader, "add_frame", options)?,
            uniform: context.device.buffer(TECHNIQUE.id, size_of::<GpuParams>() as u64, usage)?,
            history: History::default(),
            gathered: None,
        })
    }
}

impl Effect for Accumulate {
    fn prepare(&mut self, frame: &FrameContext) -> Result<(), Error> {
        let goes_on = self.history.begin(frame) && frame.still;
        let count = match self.gathered {
            Some((last, count)) if last == frame.index => count,
            Some((_, count)) if goes_on => count.saturating_add(1),
            _ => 1,
        };
        self.gathered = Some((frame.index, count));
        let params = GpuParams { share: 1.0 / count.min(self.params.frames) as f32, _padding: [0; 3] };
        self.uniform.write(&frame.device.queue, bytemuck::bytes_of(&params));
        Ok(())
    }

    fn record<'a>(&'a self, frame: &'a FrameContext<'a>, graph: &mut Graph<'a>) {
        graph.lend(slot::RESOLVED, self.history.after().clone());
        graph.pass(Access::new(TECHNIQUE.id).reads(TECHNIQUE.reads).writes(&[slot::RESOLVED]), move |pass| {
            let own = Bindings::new()
                .with("params", &self.uniform)
                .with("color", pass.view(slot::COLOR)?)
                .with("before", &**self.history.before())
                .with("resolved", pass.view(slot::RESOLVED)?);
            self.pipeline.dispatch(pass.device, pass.encoder, &frame.shared, &own, frame.size().extend(1))
        });
    }

    fn jitter(&self, index: u32) -> Vec2 {
        halton_jitter(index, self.params.frames)
    }

    fn history(&self) -> u32 {
        self.params.frames
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{TraceBackend, shaders};

    #[test]
    fn the_uniform_is_laid_out_as_the_shader_reads_it() {
        let variant = shaders::Variant::without_models(TraceBackend::Compute, true);
        shaders::link(TECHNIQUE.id, include_str!("accumulate.wesl"), variant).unwrap().check_layout::<GpuParams>("Params").unwrap();
    }
}

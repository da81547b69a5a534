//! An edge-avoiding filter over noisy visibility.    \[Dammertz10]

use super::TECHNIQUE;
use crate::{Error, FrameContext, MakeContext};
use kajo_render_graph::wgpu::BufferUsages;
use kajo_render_graph::{Access, Bindings, Buffer, ComputePipeline, Graph, PipelineOptions, Slot, slot};

/// What the shader reads.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable, kajo_shader_lib::ShaderLayout)]
pub(super) struct GpuDenoise {
    first_light: u32,
    step: u32,
    inverse_sigma2: f32,
    _padding: u32,
}

/// The passes: each doubles the distance between its taps.
pub(super) struct Denoise {
    /// Absent without passes: nothing is compiled for them.
    pipeline: Option<ComputePipeline>,
    uniforms: Vec<Buffer>,
    samples: u32,
}

impl Denoise {
    /// `passes` passes over the estimate of `samples` rays.
    pub fn new(context: &MakeContext, passes: u32, samples: u32) -> Result<Self, Error> {
        let uniform = |_| {
            context.device.buffer(
                "shadow/ray-traced denoise",
                size_of::<GpuDenoise>() as u64,
                BufferUsages::UNIFORM | BufferUsages::COPY_DST,
            )
        };
        let pipeline = if passes > 0 {
            let shader = context.shader("shadow/ray-traced/denoise", include_str!("denoise.wesl"))?;
            let options = PipelineOptions { list_length: context.textures, ..Default::default() };
            Some(ComputePipeline::new(context.device, &shader, "filter_visibility", options)?)
        } else {
            None
        };
        Ok(Self { pipeline, uniforms: (0..passes).map(uniform).collect::<Result<_, _>>()?, samples })
    }

    /// Writes what the passes read.
    pub fn prepare(&self, frame: &FrameContext) {
        for (i, uniform) in self.uniforms.iter().enumerate() {
            // The standard deviation of a mean of N answers yes or no is at most 1/(2√N). The noise that is left halves with each pass.
            let sigma = 1.0 / (self.samples as f32).sqrt() * 0.5f32.powi(i as i32);
            let params = GpuDenoise { first_light: frame.first_light, step: 1 << i, inverse_sigma2: 1.0 / (sigma * sigma), _padding: 0 };
            uniform.write(&frame.device.queue, bytemuck::bytes_of(&params));
        }
    }

    /// The slot that pass `pass` reads, and the trace writes for pass 0: they take turns, so that the last pass writes the role's.
    pub fn source(&self, pass: usize) -> Slot {
        if (self.uniforms.len() - pass).is_multiple_of(2) { slot::SHADOW_VISIBILITY } else { slot::SHADOW_FILTERED }
    }

    /// Adds the passes.
    pub fn record<'a>(&'a self, frame: &'a FrameContext<'a>, graph: &mut Graph<'a>) {
        let Some(pipeline) = &self.pipeline else { return };
        for (i, uniform) in self.uniforms.iter().enumerate() {
            let (source, target) = (self.source(i), self.source(i + 1));
            let access = Access::new(format!("shadow/ray-traced/denoise-{i}")).reads(TECHNIQUE.reads);
            // Who reads a slot sees it after every change, so passes that take turns change both: they keep their order. The first one makes its target.
            let access = access.updates(&[source]);
            let access = if i == 0 { access.writes(&[target]) } else { access.updates(&[target]) };
            graph.pass(access, move |pass| {
                let own = Bindings::new()
                    .with("params", uniform)
                    .with("depth", pass.view(slot::DEPTH)?)
                    .with("normal", pass.view(slot::NORMAL)?)
                    .with("source", pass.view(source)?)
                    .with("filtered", pass.view(target)?);
                pipeline.dispatch(pass.device, pass.encoder, &frame.shared, &own, frame.size().extend(frame.lights.len() as u32))
            });
        }
    }
}

//! An edge-avoiding filter over noisy ambient visibility, for every technique of the group.    \[Dammertz10]

use super::READS;
use crate::{Error, FrameContext, MakeContext};
use kajo_render_graph::wgpu::BufferUsages;
use kajo_render_graph::{Access, Bindings, Buffer, ComputePipeline, Graph, PipelineOptions, Slot, slot};

/// What the shader reads.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable, kajo_shader_lib::ShaderLayout)]
struct GpuParams {
    step: u32,
    inverse_sigma2: f32,
    padding_a: u32,
    padding_b: u32,
}

/// The passes: each doubles the distance between its taps.
pub(super) struct Filter {
    id: &'static str,
    /// Absent without passes: nothing is compiled for them.
    pipeline: Option<ComputePipeline>,
    uniforms: Vec<Buffer>,
}

impl Filter {
    /// `passes` passes over the estimate of `samples` answers yes or no; `id` names them.
    ///
    /// # Errors
    /// When the device refuses.
    pub fn new(context: &MakeContext, id: &'static str, passes: u32, samples: u32) -> Result<Self, Error> {
        let uniform = |pass: u32| {
            // The standard deviation of a mean of N answers yes or no is at most 1/(2√N). The noise that is left halves with each pass.
            let sigma = 1.0 / (samples as f32).sqrt() * 0.5f32.powi(pass as i32);
            let params = GpuParams { step: 1 << pass, inverse_sigma2: 1.0 / (sigma * sigma), padding_a: 0, padding_b: 0 };
            context.device.buffer_with(id, &[params], BufferUsages::UNIFORM)
        };
        let pipeline = if passes > 0 {
            let shader = context.shader("ao/filter", include_str!("filter.wesl"))?;
            let options = PipelineOptions { list_length: context.textures, ..Default::default() };
            Some(ComputePipeline::new(context.device, &shader, "filter_ambient", options)?)
        } else {
            None
        };
        Ok(Self { id, pipeline, uniforms: (0..passes).map(uniform).collect::<Result<_, _>>()? })
    }

    /// The slot that pass `pass` reads, and the estimate writes for pass 0: they take turns, so that the last pass writes the role's.
    pub fn source(&self, pass: usize) -> Slot {
        if (self.uniforms.len() - pass).is_multiple_of(2) { slot::AMBIENT_VISIBILITY } else { slot::AMBIENT_FILTERED }
    }

    /// Adds the passes.
    pub fn record<'a>(&'a self, frame: &'a FrameContext<'a>, graph: &mut Graph<'a>) {
        let Some(pipeline) = &self.pipeline else { return };
        for (i, uniform) in self.uniforms.iter().enumerate() {
            let (source, target) = (self.source(i), self.source(i + 1));
            // Who reads a slot sees it after every change, so passes that take turns change both: they keep their order. The first one makes its target.
            let access = Access::new(format!("{}/denoise-{i}", self.id)).reads(READS).updates(&[source]);
            let access = if i == 0 { access.writes(&[target]) } else { access.updates(&[target]) };
            graph.pass(access, move |pass| {
                let own = Bindings::new()
                    .with("params", uniform)
                    .with("depth", pass.view(slot::DEPTH)?)
                    .with("normal", pass.view(slot::NORMAL)?)
                    .with("source", pass.view(source)?)
                    .with("filtered", pass.view(target)?);
                pipeline.dispatch(pass.device, pass.encoder, &frame.shared, &own, frame.size().extend(1))
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{TraceBackend, shaders};

    #[test]
    fn the_uniform_is_laid_out_as_the_shader_reads_it() {
        let variant = shaders::Variant::without_models(TraceBackend::Compute, true);
        shaders::link("ao/filter", include_str!("filter.wesl"), variant).unwrap().check_layout::<GpuParams>("Params").unwrap();
    }
}

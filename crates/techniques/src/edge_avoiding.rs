//! An edge-avoiding filter over a noisy share of what is visible: of each light, or of the surroundings.    \[Dammertz10]

use crate::{Error, FrameContext, MakeContext};
use kajo_render_graph::wgpu::BufferUsages;
use kajo_render_graph::{Access, Bindings, Buffer, ComputePipeline, Graph, PipelineOptions, Slot, slot};

/// What the shader reads.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable, kajo_shader_lib::ShaderLayout)]
struct GpuParams {
    first_light: u32,
    step: u32,
    inverse_sigma2: f32,
    padding: u32,
}

/// In the place of a first light: layers are not lights. Twin of `NO_LIGHT` in edge_avoiding.wesl.
const NO_LIGHT: u32 = u32::MAX;

/// What is filtered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Filtered {
    /// Role direct visibility, a layer a light.
    Lights,
    /// Role ambient visibility.
    Surroundings,
}

impl Filtered {
    /// The role's slot and the one that takes turns with it.
    fn slots(self) -> [Slot; 2] {
        match self {
            Self::Lights => [slot::SHADOW_VISIBILITY, slot::SHADOW_FILTERED],
            Self::Surroundings => [slot::AMBIENT_VISIBILITY, slot::AMBIENT_FILTERED],
        }
    }
}

/// The passes: each doubles the distance between its taps.
pub(crate) struct EdgeAvoiding {
    id: &'static str,
    what: Filtered,
    /// Absent without passes: nothing is compiled for them.
    pipeline: Option<ComputePipeline>,
    uniforms: Vec<Buffer>,
    samples: u32,
}

impl EdgeAvoiding {
    /// `passes` passes over the estimate of `samples` answers yes or no; `id` names them.
    ///
    /// # Errors
    /// When the device refuses.
    pub fn new(context: &MakeContext, id: &'static str, what: Filtered, [passes, samples]: [u32; 2]) -> Result<Self, Error> {
        let usage = BufferUsages::UNIFORM | BufferUsages::COPY_DST;
        let uniform = |_| context.device.buffer(id, size_of::<GpuParams>() as u64, usage);
        let pipeline = if passes > 0 {
            let shader = context.shader("edge-avoiding", include_str!("edge_avoiding.wesl"))?;
            let options = PipelineOptions { list_length: context.textures, ..Default::default() };
            Some(ComputePipeline::new(context.device, &shader, "filter_visibility", options)?)
        } else {
            None
        };
        Ok(Self { id, what, pipeline, uniforms: (0..passes).map(uniform).collect::<Result<_, _>>()?, samples })
    }

    /// Writes what the passes read.
    pub fn prepare(&self, frame: &FrameContext) {
        let first_light = if self.what == Filtered::Lights { frame.first_light } else { NO_LIGHT };
        for (i, uniform) in self.uniforms.iter().enumerate() {
            // The standard deviation of a mean of N answers yes or no is at most 1/(2√N). The noise that is left halves with each pass.
            let sigma = 1.0 / (self.samples as f32).sqrt() * 0.5f32.powi(i as i32);
            let params = GpuParams { first_light, step: 1 << i, inverse_sigma2: 1.0 / (sigma * sigma), padding: 0 };
            uniform.write(&frame.device.queue, bytemuck::bytes_of(&params));
        }
    }

    /// The slot that pass `pass` reads, and the estimate writes for pass 0: they take turns, so that the last pass writes the role's.
    pub fn source(&self, pass: usize) -> Slot {
        self.what.slots()[(self.uniforms.len() - pass) % 2]
    }

    /// Adds the passes.
    pub fn record<'a>(&'a self, frame: &'a FrameContext<'a>, graph: &mut Graph<'a>) {
        let Some(pipeline) = &self.pipeline else { return };
        let layers = if self.what == Filtered::Lights { frame.lights.len() as u32 } else { 1 };
        for (i, uniform) in self.uniforms.iter().enumerate() {
            let (source, target) = (self.source(i), self.source(i + 1));
            let access = Access::new(format!("{}/denoise-{i}", self.id)).reads(&[slot::DEPTH, slot::NORMAL]);
            // Who reads a slot sees it after every change, so passes that take turns change both: they keep their order. The first one makes its target.
            let access = access.updates(&[source]);
            let access = if i == 0 { access.writes(&[target]) } else { access.updates(&[target]) };
            graph.pass(access, move |pass| {
                let own = Bindings::new()
                    .with("params", uniform)
                    .with("depth", pass.view(slot::DEPTH)?)
                    .with("normal", pass.view(slot::NORMAL)?)
                    .with("source", pass.texture(source)?.array())
                    .with("filtered", pass.texture(target)?.array());
                pipeline.dispatch(pass.device, pass.encoder, &frame.shared, &own, frame.size().extend(layers))
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
        shaders::link("edge-avoiding", include_str!("edge_avoiding.wesl"), variant).unwrap().check_layout::<GpuParams>("Params").unwrap();
    }
}

//! Edges smoothed within one frame.

use crate::{Effect, Error, FrameContext, MakeContext, Needs, Role, Technique};
use kajo_params::{ParamValues, Params};
use kajo_render_graph::wgpu::BufferUsages;
use kajo_render_graph::{Access, Bindings, Buffer, ComputePipeline, Graph, PipelineOptions, slot};

/// The technique.
pub const TECHNIQUE: Technique = Technique {
    id: "aa/fxaa",
    role: Role::AntiAlias,
    title: "Fast approximate anti-aliasing",
    doc: include_str!("doc.md"),
    cites: &["Lottes09"],
    reads: &[slot::COLOR],
    needs: Needs::NONE,
    params: Params::SPEC,
    make: |context, values| Ok(Box::new(Fxaa::new(context, values)?)),
};

/// Its parameters.
#[derive(Params, Clone, Copy, Debug)]
pub struct Params {
    /// Contrast, as a share of the brightest luma around, from which on there is an edge.
    #[param(default = 0.125, range = 0.0..=1.0)]
    pub threshold: f32,
    /// Contrast of luma below which nothing is an edge, however dark it is around.
    #[param(default = 0.03, range = 0.0..=1.0)]
    pub least_contrast: f32,
    /// How far the ends of an edge are looked for.
    #[param(default = 16, range = 1..=128, unit = "px")]
    pub search: u32,
    /// How much lone pixels are blended with those around.
    #[param(default = 0.5, range = 0.0..=1.0)]
    pub subpixel: f32,
}

/// What the shader reads.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable, kajo_shader_lib::ShaderLayout)]
struct GpuParams {
    threshold: f32,
    least_contrast: f32,
    subpixel: f32,
    exposure: f32,
    search: u32,
    _padding: [u32; 3],
}

struct Fxaa {
    params: Params,
    pipeline: ComputePipeline,
    uniform: Buffer,
}

impl Fxaa {
    fn new(context: &MakeContext, values: &ParamValues) -> Result<Self, Error> {
        let shader = context.shader(TECHNIQUE.id, include_str!("fxaa.wesl"))?;
        let options = PipelineOptions { list_length: context.textures, ..Default::default() };
        let usage = BufferUsages::UNIFORM | BufferUsages::COPY_DST;
        Ok(Self {
            params: Params::from_values(values),
            pipeline: ComputePipeline::new(context.device, &shader, "smooth_edges", options)?,
            uniform: context.device.buffer(TECHNIQUE.id, size_of::<GpuParams>() as u64, usage)?,
        })
    }
}

impl Effect for Fxaa {
    fn prepare(&mut self, frame: &FrameContext) -> Result<(), Error> {
        let Params { threshold, least_contrast, search, subpixel } = self.params;
        let params = GpuParams { threshold, least_contrast, subpixel, exposure: frame.exposure.exp2(), search, _padding: [0; 3] };
        self.uniform.write(&frame.device.queue, bytemuck::bytes_of(&params));
        Ok(())
    }

    fn record<'a>(&'a self, frame: &'a FrameContext<'a>, graph: &mut Graph<'a>) {
        graph.pass(Access::new(TECHNIQUE.id).reads(TECHNIQUE.reads).writes(&[slot::RESOLVED]), move |pass| {
            let own = Bindings::new()
                .with("params", &self.uniform)
                .with("color", pass.view(slot::COLOR)?)
                .with("resolved", pass.view(slot::RESOLVED)?);
            self.pipeline.dispatch(pass.device, pass.encoder, &frame.shared, &own, frame.size().extend(1))
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{TraceBackend, shaders};

    #[test]
    fn the_uniform_is_laid_out_as_the_shader_reads_it() {
        let variant = shaders::Variant::without_models(TraceBackend::Compute, true);
        shaders::link(TECHNIQUE.id, include_str!("fxaa.wesl"), variant).unwrap().check_layout::<GpuParams>("Params").unwrap();
    }
}

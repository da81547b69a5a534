//! No cast shadows.

#[cfg(test)]
mod tests;

use crate::{Effect, Error, FrameContext, MakeContext, Needs, Role, Technique};
use kajo_params::{ParamValues, Params};
use kajo_render_graph::wgpu::BufferUsages;
use kajo_render_graph::{Access, Bindings, Buffer, ComputePipeline, Graph, PipelineOptions, slot};

/// The technique.
pub const TECHNIQUE: Technique = Technique {
    id: "shadow/none",
    role: Role::DirectVisibility,
    title: "No shadows",
    doc: include_str!("doc.md"),
    cites: &[],
    reads: &[slot::DEPTH, slot::NORMAL],
    needs: Needs::NONE,
    params: Params::SPEC,
    make: |context, values| Ok(Box::new(Unoccluded::new(context, values)?)),
};

/// Its parameters.
#[derive(Params, Clone, Copy, Debug)]
pub struct Params {
    /// Points of each light that has an extent, of which those above the horizon are counted.
    #[param(default = 16, range = 1..=1024)]
    pub samples: u32,
}

/// What the shader reads.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable, kajo_shader_lib::ShaderLayout)]
struct GpuParams {
    samples: u32,
    first_light: u32,
    light_count: u32,
    _padding: u32,
}

struct Unoccluded {
    params: Params,
    pipeline: ComputePipeline,
    uniform: Buffer,
}

impl Unoccluded {
    fn new(context: &MakeContext, values: &ParamValues) -> Result<Self, Error> {
        let shader = context.shader("shadow/none", include_str!("none.wesl"))?;
        let options = PipelineOptions { list_length: context.textures, ..Default::default() };
        let usage = BufferUsages::UNIFORM | BufferUsages::COPY_DST;
        Ok(Self {
            params: Params::from_values(values),
            pipeline: ComputePipeline::new(context.device, &shader, "look_above", options)?,
            uniform: context.device.buffer("shadow/none", size_of::<GpuParams>() as u64, usage)?,
        })
    }
}

impl Effect for Unoccluded {
    fn prepare(&mut self, frame: &FrameContext) -> Result<(), Error> {
        let params =
            GpuParams { samples: self.params.samples, first_light: frame.first_light, light_count: frame.lights.len() as u32, _padding: 0 };
        self.uniform.write(&frame.device.queue, bytemuck::bytes_of(&params));
        Ok(())
    }

    fn record<'a>(&'a self, frame: &'a FrameContext<'a>, graph: &mut Graph<'a>) {
        let access = Access::new("shadow/none").reads(TECHNIQUE.reads).writes(&[slot::SHADOW_VISIBILITY]);
        graph.pass(access, move |pass| {
            let own = Bindings::new()
                .with("params", &self.uniform)
                .with("depth", pass.view(slot::DEPTH)?)
                .with("normal", pass.view(slot::NORMAL)?)
                .with("visibility", pass.view(slot::SHADOW_VISIBILITY)?);
            let invocations = frame.size().extend(frame.lights.len() as u32);
            self.pipeline.dispatch(pass.device, pass.encoder, &frame.shared, &own, invocations)
        });
    }
}

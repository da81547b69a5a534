//! Indirect light by paths.

#[cfg(test)]
mod tests;

use super::READS;
use crate::ray_count::RayCount;
use crate::{Effect, Error, FrameContext, MakeContext, Needs, Role, Technique};
use kajo_params::{ParamValues, Params};
use kajo_render_graph::wgpu::BufferUsages;
use kajo_render_graph::{Access, Bindings, Buffer, ComputePipeline, Device, Graph, PipelineOptions, slot};

/// The technique.
pub const TECHNIQUE: Technique = Technique {
    id: "gi/ray-traced",
    role: Role::DiffuseIndirect,
    title: "Ray-traced indirect light",
    doc: include_str!("doc.md"),
    cites: &["Kajiya86", "Roberts18"],
    reads: READS,
    needs: Needs::NONE,
    params: Params::SPEC,
    make: |context, values| Ok(Box::new(RayTraced::new(context, values)?)),
};

/// Its parameters.
#[derive(Params, Clone, Copy, Debug)]
pub struct Params {
    /// Paths of each pixel.
    #[param(default = 2, range = 1..=65536)]
    pub samples: u32,
    /// Bounces of the light before it reaches what is seen.
    #[param(default = 3, range = 1..=32)]
    pub bounces: u32,
}

/// What the shader reads.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable, kajo_shader_lib::ShaderLayout)]
struct GpuParams {
    samples: u32,
    bounces: u32,
    padding_a: u32,
    padding_b: u32,
}

struct RayTraced {
    pipeline: ComputePipeline,
    uniform: Buffer,
    rays: RayCount,
}

impl RayTraced {
    fn new(context: &MakeContext, values: &ParamValues) -> Result<Self, Error> {
        let Params { samples, bounces } = Params::from_values(values);
        let shader = context.shader(TECHNIQUE.id, include_str!("ray_traced.wesl"))?;
        let options = PipelineOptions { list_length: context.textures, ..Default::default() };
        let params = GpuParams { samples, bounces, padding_a: 0, padding_b: 0 };
        Ok(Self {
            pipeline: ComputePipeline::new(context.device, &shader, "gather", options)?,
            uniform: context.device.buffer_with(TECHNIQUE.id, &[params], BufferUsages::UNIFORM)?,
            rays: RayCount::new(context, "gi/ray-traced rays")?,
        })
    }
}

impl Effect for RayTraced {
    fn prepare(&mut self, frame: &FrameContext) -> Result<(), Error> {
        self.rays.prepare(frame);
        Ok(())
    }

    fn record<'a>(&'a self, frame: &'a FrameContext<'a>, graph: &mut Graph<'a>) {
        let access = Access::new("gi/ray-traced/gather").reads(READS).writes(&[slot::DIFFUSE_INDIRECT]);
        graph.pass(access, move |pass| {
            let own = Bindings::new()
                .with("params", &self.uniform)
                .with("depth", pass.view(slot::DEPTH)?)
                .with("normal", pass.view(slot::NORMAL)?)
                .with("irradiance", pass.view(slot::DIFFUSE_INDIRECT)?)
                .with(RayCount::BINDING, self.rays.buffer());
            self.pipeline.dispatch(pass.device, pass.encoder, &frame.shared, &own, frame.size().extend(1))
        });
    }

    fn rays(&self, device: &Device) -> Result<u64, Error> {
        self.rays.rays(device)
    }
}

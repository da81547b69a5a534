//! Shadows by rays.

#[cfg(test)]
mod tests;

use crate::edge_avoiding::{EdgeAvoiding, Filtered};
use crate::ray_count::RayCount;
use crate::{Effect, Error, FrameContext, MakeContext, Needs, Role, Statistic, Technique};
use kajo_params::{ParamValues, Params};
use kajo_render_graph::wgpu::BufferUsages;
use kajo_render_graph::{Access, Bindings, Buffer, ComputePipeline, Device, Graph, PipelineOptions, slot};

/// The technique.
pub const TECHNIQUE: Technique = Technique {
    id: "shadow/ray-traced",
    role: Role::DirectVisibility,
    title: "Ray-traced shadows",
    doc: include_str!("doc.md"),
    cites: &["Whitted80", "Cook84", "Roberts18", "Dammertz10"],
    reads: &[slot::DEPTH, slot::NORMAL],
    needs: Needs::NONE,
    params: Params::SPEC,
    make: |context, values| Ok(Box::new(RayTraced::new(context, values)?)),
};

/// Its parameters.
#[derive(Params, Clone, Copy, Debug)]
pub struct Params {
    /// Rays to each light that has an extent; points, spots and parallel lights take one.
    #[param(default = 4, range = 1..=1024)]
    pub samples: u32,
    /// Passes of a filter that spreads the noise of lights with an extent over pixels of the same surface. None keeps the estimate unbiased; each pass
    /// doubles the reach and costs some sharpness of penumbrae.
    #[param(default = 0, range = 0..=5)]
    pub denoise: u32,
}

/// What the shader reads.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable, kajo_shader_lib::ShaderLayout)]
struct GpuParams {
    samples: u32,
    first_light: u32,
    padding_a: u32,
    padding_b: u32,
}

struct RayTraced {
    params: Params,
    pipeline: ComputePipeline,
    uniform: Buffer,
    rays: RayCount,
    denoise: EdgeAvoiding,
}

impl RayTraced {
    fn new(context: &MakeContext, values: &ParamValues) -> Result<Self, Error> {
        let shader = context.shader("shadow/ray-traced", include_str!("ray_traced.wesl"))?;
        let options = PipelineOptions { list_length: context.textures, ..Default::default() };
        let params = Params::from_values(values);
        Ok(Self {
            params,
            denoise: EdgeAvoiding::new(context, TECHNIQUE.id, Filtered::Lights, [params.denoise, params.samples])?,
            pipeline: ComputePipeline::new(context.device, &shader, "trace_visibility", options)?,
            uniform: context.device.buffer(
                "shadow/ray-traced",
                size_of::<GpuParams>() as u64,
                BufferUsages::UNIFORM | BufferUsages::COPY_DST,
            )?,
            rays: RayCount::new(context, "shadow/ray-traced rays")?,
        })
    }
}

impl Effect for RayTraced {
    fn prepare(&mut self, frame: &FrameContext) -> Result<(), Error> {
        let params = GpuParams { samples: self.params.samples, first_light: frame.first_light, padding_a: 0, padding_b: 0 };
        self.rays.prepare(frame);
        self.uniform.write(&frame.device.queue, bytemuck::bytes_of(&params));
        self.denoise.prepare(frame);
        Ok(())
    }

    fn record<'a>(&'a self, frame: &'a FrameContext<'a>, graph: &mut Graph<'a>) {
        let traced = self.denoise.source(0);
        let access = Access::new("shadow/ray-traced/trace").reads(TECHNIQUE.reads).writes(&[traced]);
        graph.pass(access, move |pass| {
            let own = Bindings::new()
                .with("params", &self.uniform)
                .with("depth", pass.view(slot::DEPTH)?)
                .with("normal", pass.view(slot::NORMAL)?)
                .with("visibility", pass.view(traced)?)
                .with(RayCount::BINDING, self.rays.buffer());
            let invocations = frame.size().extend(frame.lights.len() as u32);
            self.pipeline.dispatch(pass.device, pass.encoder, &frame.shared, &own, invocations)
        });
        self.denoise.record(frame, graph);
    }

    fn rays(&self, device: &Device) -> Result<u64, Error> {
        self.rays.rays(device)
    }

    fn statistics(&self, frame: &FrameContext) -> Result<Vec<Statistic>, Error> {
        self.rays.statistics(frame)
    }
}

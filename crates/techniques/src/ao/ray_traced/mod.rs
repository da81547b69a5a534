//! Ambient occlusion by rays.

#[cfg(test)]
mod tests;

mod upsample;

use super::{READS, reach};
use crate::edge_avoiding::{EdgeAvoiding, Filtered};
use crate::ray_count::RayCount;
use crate::{Effect, Error, FrameContext, MakeContext, Needs, Role, Technique};
use kajo_params::{ParamChoice, ParamValues, Params};
use kajo_render_graph::wgpu::BufferUsages;
use kajo_render_graph::{Access, Bindings, Buffer, ComputePipeline, Device, Graph, PipelineOptions, slot};
use upsample::Upsample;

/// The technique.
pub const TECHNIQUE: Technique = Technique {
    id: "ao/ray-traced",
    role: Role::AmbientVisibility,
    title: "Ray-traced ambient occlusion",
    doc: include_str!("doc.md"),
    cites: &["Zhukov98", "Roberts18", "Kopf07", "Dammertz10"],
    reads: READS,
    needs: Needs::NONE,
    params: Params::SPEC,
    make: |context, values| Ok(Box::new(RayTraced::new(context, values)?)),
};

/// How directions are spread over the hemisphere.
#[derive(ParamChoice, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Directions {
    /// Density cos θ / π: the mean of V is the role's integral.
    Cosine,
    /// Density 1 / 2π: the mean of V is 1/2π ∫ V dω, another integral.
    Uniform,
}

/// Which pixels are traced.
#[derive(ParamChoice, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Resolution {
    /// Every one.
    Full,
    /// One of each 2 × 2, another one each frame.
    Half,
}

/// Its parameters.
#[derive(Params, Clone, Copy, Debug)]
pub struct Params {
    /// Rays of each pixel that is traced.
    #[param(default = 4, range = 1..=65536)]
    pub samples: u32,
    /// Cosine estimates the role's integral; uniform is what the plain share of open rays is.
    #[param(default = Directions::Cosine)]
    pub directions: Directions,
    /// Half takes a quarter of the rays and fills the other pixels in from neighbours on the same surface.
    #[param(default = Resolution::Full)]
    pub resolution: Resolution,
    /// Passes of a filter that spreads the noise over pixels of the same surface. None keeps the estimate unbiased; each pass doubles the reach and
    /// costs some detail.
    #[param(default = 0, range = 0..=5)]
    pub denoise: u32,
}

/// What the shader reads.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable, kajo_shader_lib::ShaderLayout)]
struct GpuParams {
    samples: u32,
    uniform_directions: u32,
    spacing: u32,
    distance: f32,
}

struct RayTraced {
    params: Params,
    pipeline: ComputePipeline,
    uniform: Buffer,
    rays: RayCount,
    upsample: Option<Upsample>,
    filter: EdgeAvoiding,
}

impl RayTraced {
    fn new(context: &MakeContext, values: &ParamValues) -> Result<Self, Error> {
        let device = context.device;
        let shader = context.shader(TECHNIQUE.id, include_str!("ray_traced.wesl"))?;
        let options = PipelineOptions { list_length: context.textures, ..Default::default() };
        let params = Params::from_values(values);
        Ok(Self {
            params,
            pipeline: ComputePipeline::new(device, &shader, "trace_around", options)?,
            uniform: device.buffer(TECHNIQUE.id, size_of::<GpuParams>() as u64, BufferUsages::UNIFORM | BufferUsages::COPY_DST)?,
            rays: RayCount::new(context, "ao/ray-traced rays")?,
            upsample: if params.resolution == Resolution::Half { Some(Upsample::new(context)?) } else { None },
            filter: EdgeAvoiding::new(context, TECHNIQUE.id, Filtered::Surroundings, [params.denoise, params.samples])?,
        })
    }
}

impl Effect for RayTraced {
    fn prepare(&mut self, frame: &FrameContext) -> Result<(), Error> {
        let params = GpuParams {
            samples: self.params.samples,
            uniform_directions: u32::from(self.params.directions == Directions::Uniform),
            spacing: if self.upsample.is_some() { 2 } else { 1 },
            distance: reach(frame),
        };
        self.uniform.write(&frame.device.queue, bytemuck::bytes_of(&params));
        if let Some(upsample) = &mut self.upsample {
            upsample.prepare(frame);
        }
        self.filter.prepare(frame);
        Ok(())
    }

    fn record<'a>(&'a self, frame: &'a FrameContext<'a>, graph: &mut Graph<'a>) {
        let traced = self.filter.source(0);
        let access = Access::new("ao/ray-traced/trace").reads(READS).writes(&[traced]);
        graph.pass(access, move |pass| {
            let (size, target) = match &self.upsample {
                Some(upsample) => (upsample.size(), upsample.target()),
                None => (frame.size(), pass.view(traced)?),
            };
            let own = Bindings::new()
                .with("params", &self.uniform)
                .with("depth", pass.view(slot::DEPTH)?)
                .with("normal", pass.view(slot::NORMAL)?)
                .with("visibility", target)
                .with(RayCount::BINDING, self.rays.buffer());
            self.pipeline.dispatch(pass.device, pass.encoder, &frame.shared, &own, size.extend(1))
        });
        if let Some(upsample) = &self.upsample {
            upsample.record(frame, graph, traced);
        }
        self.filter.record(frame, graph);
    }

    fn rays(&self, device: &Device) -> Result<u64, Error> {
        self.rays.rays(device)
    }
}

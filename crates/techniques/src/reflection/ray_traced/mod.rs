//! Reflections by rays.

#[cfg(test)]
mod tests;

use super::surfaces::{self, READS};
use crate::ray_count::RayCount;
use crate::{Effect, Error, FrameContext, MakeContext, Needs, Role, Technique};
use kajo_params::{ParamValues, Params};
use kajo_render_graph::wgpu::BufferUsages;
use kajo_render_graph::{Access, Buffer, ComputePipeline, Device, Graph, PipelineOptions, slot};

/// The technique.
pub const TECHNIQUE: Technique = Technique {
    id: "reflection/ray-traced",
    role: Role::SpecularIndirect,
    title: "Ray-traced reflections",
    doc: include_str!("doc.md"),
    cites: &["Whitted80", "Cook84", "Heitz18", "AkenineMoller21"],
    reads: READS,
    needs: Needs::NONE,
    params: Params::SPEC,
    make: |context, values| Ok(Box::new(RayTraced::new(context, values)?)),
};

/// Its parameters.
#[derive(Params, Clone, Copy, Debug)]
pub struct Params {
    /// Paths of each pixel.
    #[param(default = 4, range = 1..=65536)]
    pub samples: u32,
    /// How often light may bounce between what is reflected and its source: 1 is direct light alone, more brings indirect light and mirrors in mirrors.
    #[param(default = 1, range = 0..=16)]
    pub bounces: u32,
    /// Shadow rays to each light with an extent, from each surface that is met.
    #[param(default = 1, range = 1..=64)]
    pub light_samples: u32,
    /// Lights asked at each surface that is met; of more than that, as many are chosen at random.
    #[param(default = 16, range = 1..=1024)]
    pub lights: u32,
    /// Rougher surfaces reflect nothing.
    #[param(default = 1.0, range = 0.0..=1.0)]
    pub max_roughness: f32,
}

/// What the shader reads.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable, kajo_shader_lib::ShaderLayout)]
struct GpuParams {
    samples: u32,
    bounces: u32,
    light_samples: u32,
    lights: u32,
    max_roughness: f32,
    padding_a: u32,
    padding_b: u32,
    padding_c: u32,
}

struct RayTraced {
    params: Params,
    pipeline: ComputePipeline,
    uniform: Buffer,
    rays: RayCount,
}

impl RayTraced {
    fn new(context: &MakeContext, values: &ParamValues) -> Result<Self, Error> {
        let device = context.device;
        let params = Params::from_values(values);
        let Params { samples, bounces, light_samples, lights, max_roughness } = params;
        let shader = context.shader(TECHNIQUE.id, include_str!("ray_traced.wesl"))?;
        let options = PipelineOptions { list_length: context.textures, ..Default::default() };
        let uniform = GpuParams { samples, bounces, light_samples, lights, max_roughness, padding_a: 0, padding_b: 0, padding_c: 0 };
        Ok(Self {
            params,
            pipeline: ComputePipeline::new(device, &shader, "trace_reflections", options)?,
            uniform: device.buffer_with(TECHNIQUE.id, &[uniform], BufferUsages::UNIFORM)?,
            rays: RayCount::new(context, "reflection/ray-traced rays")?,
        })
    }
}

impl Effect for RayTraced {
    fn prepare(&mut self, frame: &FrameContext) -> Result<(), Error> {
        self.rays.prepare(frame);
        Ok(())
    }

    fn record<'a>(&'a self, frame: &'a FrameContext<'a>, graph: &mut Graph<'a>) {
        graph.pass(Access::new(TECHNIQUE.id).reads(READS).writes(&[slot::SPECULAR_INDIRECT]), move |pass| {
            let own = surfaces::bind(pass)?
                .with("params", &self.uniform)
                .with("reflected", pass.view(slot::SPECULAR_INDIRECT)?)
                .with(RayCount::BINDING, self.rays.buffer());
            self.pipeline.dispatch(pass.device, pass.encoder, &frame.shared, &own, frame.size().extend(1))
        });
    }

    fn mirrors_up_to(&self) -> Option<f32> {
        Some(self.params.max_roughness)
    }

    fn rays(&self, device: &Device) -> Result<u64, Error> {
        self.rays.rays(device)
    }
}

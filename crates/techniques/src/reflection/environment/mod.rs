//! The environment, looked up in the direction of reflection.

#[cfg(test)]
mod tests;

use super::surfaces::{self, READS};
use crate::{Effect, Error, FrameContext, MakeContext, Needs, Role, Technique};
use kajo_params::{ParamChoice, ParamValues, Params};
use kajo_render_graph::wgpu::BufferUsages;
use kajo_render_graph::{Access, Buffer, ComputePipeline, Graph, PipelineOptions, slot};

/// The technique.
pub const TECHNIQUE: Technique = Technique {
    id: "reflection/environment",
    role: Role::SpecularIndirect,
    title: "Environment map",
    doc: include_str!("doc.md"),
    cites: &["Blinn76", "Karis13", "Heitz18"],
    reads: READS,
    needs: Needs::NONE,
    params: Params::SPEC,
    make: |context, values| Ok(Box::new(EnvironmentMap::new(context, values)?)),
};

/// Where the map is read.
#[derive(ParamChoice, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lookup {
    /// In directions drawn from the specular lobes.
    Lobe,
    /// In one direction, between the mirror's and the normal by roughness, weighted with the lobes' albedo.
    Direction,
}

/// Its parameters.
#[derive(Params, Clone, Copy, Debug)]
pub struct Params {
    /// One direction is sharp on every surface and free of noise; the lobe is as blurred as the material asks for.
    #[param(default = Lookup::Lobe)]
    pub lookup: Lookup,
    /// Directions of a lobe.
    #[param(default = 16, range = 1..=65536)]
    pub samples: u32,
}

/// What the shader reads.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable, kajo_shader_lib::ShaderLayout)]
struct GpuParams {
    samples: u32,
    padding_a: u32,
    padding_b: u32,
    padding_c: u32,
}

struct EnvironmentMap {
    pipeline: ComputePipeline,
    uniform: Buffer,
}

impl EnvironmentMap {
    fn new(context: &MakeContext, values: &ParamValues) -> Result<Self, Error> {
        let Params { lookup, samples } = Params::from_values(values);
        let shader = context.shader(TECHNIQUE.id, include_str!("environment.wesl"))?;
        let options = PipelineOptions { list_length: context.textures, ..Default::default() };
        let samples = if lookup == Lookup::Lobe { samples } else { 0 };
        let uniform = GpuParams { samples, padding_a: 0, padding_b: 0, padding_c: 0 };
        Ok(Self {
            pipeline: ComputePipeline::new(context.device, &shader, "look_up", options)?,
            uniform: context.device.buffer_with(TECHNIQUE.id, &[uniform], BufferUsages::UNIFORM)?,
        })
    }
}

impl Effect for EnvironmentMap {
    fn prepare(&mut self, _frame: &FrameContext) -> Result<(), Error> {
        Ok(())
    }

    fn record<'a>(&'a self, frame: &'a FrameContext<'a>, graph: &mut Graph<'a>) {
        graph.pass(Access::new(TECHNIQUE.id).reads(READS).writes(&[slot::SPECULAR_INDIRECT]), move |pass| {
            let own = surfaces::bind(pass)?.with("params", &self.uniform).with("reflected", pass.view(slot::SPECULAR_INDIRECT)?);
            self.pipeline.dispatch(pass.device, pass.encoder, &frame.shared, &own, frame.size().extend(1))
        });
    }
}

//! Contact shadows.

#[cfg(test)]
mod tests;

use super::depth_map::{self, FilteredMaps, Settings, fit, reach_of};
use crate::{DebugView, Effect, Error, FrameContext, MakeContext, Needs, Role, Technique};
use kajo_params::{ParamValues, Params};
use kajo_render_graph::{Access, Bindings, Buffer, ComputePipeline, Graph, PipelineOptions, Resource, slot};
use kajo_units::Meters;

/// The technique.
pub const TECHNIQUE: Technique = Technique {
    id: "shadow/contact",
    role: Role::DirectVisibility,
    title: "Shadow maps with contact shadows",
    doc: include_str!("doc.md"),
    cites: &["Williams78", "McGuire14"],
    reads: depth_map::READS,
    needs: Needs::NONE,
    params: Params::SPEC,
    make: |context, values| Ok(Box::new(Contact::new(context, values)?)),
};

/// Its parameters.
#[derive(Params, Clone, Copy, Debug)]
pub struct Params {
    /// Side of a map; a cube has six of them.
    #[param(default = 2048, range = 16..=8192, unit = "px")]
    pub resolution: u32,
    /// Half the side of the filter: 0 compares one texel, k averages (2k + 1)² comparisons.
    #[param(default = 1, range = 0..=8)]
    pub kernel: u32,
    /// Length of the way towards the light.
    #[param(default = 0.1, range = 0.0..=100.0, unit = "m")]
    pub length: Meters,
    /// Steps of the way.
    #[param(default = 16, range = 1..=256)]
    pub steps: u32,
    /// How thick every surface is taken to be, since the camera sees their front only.
    #[param(default = 0.01, range = 0.0..=100.0, unit = "m")]
    pub thickness: Meters,
}

/// What the march reads.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable, kajo_shader_lib::ShaderLayout)]
struct GpuParams {
    light: u32,
    layer: u32,
    steps: u32,
    length: f32,
    thickness: f32,
    padding_a: u32,
    padding_b: u32,
    padding_c: u32,
}

/// Distance between the uniforms of two lights.
const STRIDE: u64 = 256;

struct Contact {
    params: Params,
    maps: FilteredMaps,
    march: ComputePipeline,
    uniforms: Option<Buffer>,
}

impl Contact {
    fn new(context: &MakeContext, values: &ParamValues) -> Result<Self, Error> {
        let params = Params::from_values(values);
        let shader = context.shader(TECHNIQUE.id, include_str!("contact.wesl"))?;
        let options = PipelineOptions { list_length: context.textures, ..Default::default() };
        let settings = Settings::new(params.resolution, reach_of(params.kernel));
        Ok(Self {
            params,
            maps: FilteredMaps::new(context, TECHNIQUE.id, settings, params.kernel, Box::new(fit))?,
            march: ComputePipeline::new(context.device, &shader, "march", options)?,
            uniforms: None,
        })
    }
}

impl Effect for Contact {
    fn prepare(&mut self, frame: &FrameContext) -> Result<(), Error> {
        let Params { steps, length, thickness, .. } = self.params;
        let mut bytes = vec![0u8; frame.lights.len() * STRIDE as usize];
        for layer in 0..frame.lights.len() {
            let params = GpuParams {
                light: frame.first_light + layer as u32,
                layer: layer as u32,
                steps,
                length: length.0,
                thickness: thickness.0,
                padding_a: 0,
                padding_b: 0,
                padding_c: 0,
            };
            bytes[layer * STRIDE as usize..][..size_of::<GpuParams>()].copy_from_slice(bytemuck::bytes_of(&params));
        }
        depth_map::upload(frame.device, &mut self.uniforms, TECHNIQUE.id, &bytes)?;
        self.maps.prepare(frame)
    }

    fn record<'a>(&'a self, frame: &'a FrameContext<'a>, graph: &mut Graph<'a>) {
        self.maps.record(frame, graph);
        for layer in 0..frame.lights.len() as u64 {
            let access = Access::new("shadow/contact/march").reads(&[slot::DEPTH, slot::NORMAL]).updates(&[slot::SHADOW_VISIBILITY]);
            graph.pass(access, move |pass| {
                let uniforms = &self.uniforms.as_ref().expect("prepared").wgpu;
                let own = Bindings::new()
                    .with("params", Resource::Range(uniforms, layer * STRIDE, size_of::<GpuParams>() as u64))
                    .with("depth", pass.view(slot::DEPTH)?)
                    .with("normal", pass.view(slot::NORMAL)?)
                    .with("visibility", pass.view(slot::SHADOW_VISIBILITY)?);
                self.march.dispatch(pass.device, pass.encoder, &frame.shared, &own, frame.size().extend(1))
            });
        }
    }

    fn debug_views(&self, frame: &FrameContext) -> Result<Vec<DebugView>, Error> {
        self.maps.debug_views(frame)
    }
}

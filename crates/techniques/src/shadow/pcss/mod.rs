//! Percentage-closer soft shadows.

#[cfg(test)]
mod tests;

use super::depth_map::{self, DepthMaps, Settings, fit};
use crate::{DebugView, Effect, Error, FrameContext, MakeContext, Needs, Role, Technique};
use kajo_params::{ParamValues, Params};
use kajo_render_graph::wgpu::BufferUsages;
use kajo_render_graph::{Buffer, ComputePipeline, Graph, PipelineOptions};

/// The technique.
pub const TECHNIQUE: Technique = Technique {
    id: "shadow/pcss",
    role: Role::DirectVisibility,
    title: "Percentage-closer soft shadows",
    doc: include_str!("doc.md"),
    cites: &["Fernando05", "Reeves87", "Roberts18"],
    reads: depth_map::READS,
    needs: Needs::NONE,
    params: Params::SPEC,
    make: |context, values| Ok(Box::new(Pcss::new(context, values)?)),
};

/// Its parameters.
#[derive(Params, Clone, Copy, Debug)]
pub struct Params {
    /// Side of a map; a cube has six of them.
    #[param(default = 1024, range = 16..=8192, unit = "px")]
    pub resolution: u32,
    /// Texels in which blockers are looked for.
    #[param(default = 24, range = 1..=256)]
    pub blocker_samples: u32,
    /// Comparisons that are averaged.
    #[param(default = 32, range = 1..=256)]
    pub filter_samples: u32,
    /// Share of the way from the light within which no blockers are looked for: their penumbrae would spread over much of the map.
    #[param(default = 0.2, range = 0.01..=0.95)]
    pub nearest: f32,
}

/// What the look-up reads beside the map.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable, kajo_shader_lib::ShaderLayout)]
struct GpuParams {
    blocker_samples: u32,
    filter_samples: u32,
    nearest: f32,
    padding: u32,
}

struct Pcss {
    maps: DepthMaps,
    look_up: ComputePipeline,
    uniform: Buffer,
}

impl Pcss {
    fn new(context: &MakeContext, values: &ParamValues) -> Result<Self, Error> {
        let params = Params::from_values(values);
        let Params { blocker_samples, filter_samples, nearest, .. } = params;
        let shader = context.shader(TECHNIQUE.id, include_str!("pcss.wesl"))?;
        let options = PipelineOptions { list_length: context.textures, ..Default::default() };
        let uniform = GpuParams { blocker_samples, filter_samples, nearest, padding: 0 };
        Ok(Self {
            // Each comparison lies on the receiver's plane, in one texel; as far from the point as the light is wide.
            maps: DepthMaps::new(context, TECHNIQUE.id, Settings { near_points: false, ..Settings::new(params.resolution, 0.5) })?,
            look_up: ComputePipeline::new(context.device, &shader, "look_up", options)?,
            uniform: context.device.buffer_with(TECHNIQUE.id, &[uniform], BufferUsages::UNIFORM)?,
        })
    }
}

impl Effect for Pcss {
    fn prepare(&mut self, frame: &FrameContext) -> Result<(), Error> {
        self.maps.prepare(frame, &fit)
    }

    fn record<'a>(&'a self, frame: &'a FrameContext<'a>, graph: &mut Graph<'a>) {
        self.maps.record(frame, graph, &["look-up"], move |_, layer, pass| {
            let own = self.maps.bindings(layer, pass)?.with("params", &self.uniform);
            self.look_up.dispatch(pass.device, pass.encoder, &frame.shared, &own, frame.size().extend(1))
        });
    }

    fn debug_views(&self, frame: &FrameContext) -> Result<Vec<DebugView>, Error> {
        self.maps.debug_views(frame)
    }
}

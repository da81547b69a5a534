//! Maps that are looked up by percentage-closer filtering.    \[Reeves87\]

use super::{DepthMaps, Fit, Projection, Settings, comparison};
use crate::{DebugView, Effect, Error, FrameContext, MakeContext};
use kajo_render_graph::wgpu::{self, BufferUsages};
use kajo_render_graph::{Buffer, ComputePipeline, Graph, PipelineOptions};

/// Fits the maps of a light.
pub(in crate::shadow) type FitMaps = Box<dyn Fn(&Fit) -> Projection>;

/// What the look-up reads beside the map.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable, kajo_shader_lib::ShaderLayout)]
pub(super) struct GpuParams {
    kernel: i32,
    padding_a: u32,
    padding_b: u32,
    padding_c: u32,
}

/// Texels from a point to the furthest that a filter of 2 `kernel` + 1 texels a side reads: a filtered comparison reads the four around it, `kernel`
/// texels away; a kernel of 0 reads the one texel that the point lies in.
pub(in crate::shadow) fn reach_of(kernel: u32) -> f32 {
    if kernel == 0 { 0.5 } else { kernel as f32 + 1.0 }
}

/// A technique that differs from the plain map by how its maps are fitted.
pub(in crate::shadow) struct FilteredMaps {
    maps: DepthMaps,
    fit: FitMaps,
    look_up: ComputePipeline,
    uniform: Buffer,
    compare: wgpu::Sampler,
}

impl FilteredMaps {
    /// `id` names the passes.
    ///
    /// # Errors
    /// When the device refuses.
    pub fn new(context: &MakeContext, id: &'static str, settings: Settings, kernel: u32, fit: FitMaps) -> Result<Self, Error> {
        let shader = context.shader("shadow/depth-map/filtered", include_str!("filtered.wesl"))?;
        let options = PipelineOptions { list_length: context.textures, ..Default::default() };
        let uniform = GpuParams { kernel: kernel as i32, padding_a: 0, padding_b: 0, padding_c: 0 };
        Ok(Self {
            maps: DepthMaps::new(context, id, settings)?,
            fit,
            look_up: ComputePipeline::new(context.device, &shader, "look_up", options)?,
            uniform: context.device.buffer_with(id, &[uniform], BufferUsages::UNIFORM)?,
            compare: comparison(context.device),
        })
    }
}

impl Effect for FilteredMaps {
    fn prepare(&mut self, frame: &FrameContext) -> Result<(), Error> {
        self.maps.prepare(frame, &self.fit)
    }

    fn record<'a>(&'a self, frame: &'a FrameContext<'a>, graph: &mut Graph<'a>) {
        self.maps.record(frame, graph, &["look-up"], move |_, layer, pass| {
            let own = self.maps.bindings(layer, pass)?.with("params", &self.uniform).with("compare", &self.compare);
            self.look_up.dispatch(pass.device, pass.encoder, &frame.shared, &own, frame.size().extend(1))
        });
    }

    fn debug_views(&self, frame: &FrameContext) -> Result<Vec<DebugView>, Error> {
        self.maps.debug_views(frame)
    }
}

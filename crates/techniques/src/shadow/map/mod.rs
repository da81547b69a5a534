//! Shadow maps.

#[cfg(test)]
mod tests;

use super::depth_map::{self, DepthLayout, DepthMaps, Precision, Settings, Shift, fit};
use crate::{Effect, Error, FrameContext, MakeContext, Needs, Role, Technique};
use kajo_params::{ParamChoice, ParamValues, Params};
use kajo_render_graph::wgpu::{self, BufferUsages};
use kajo_render_graph::{Buffer, ComputePipeline, Graph, PipelineOptions};
use kajo_units::Meters;

/// The technique.
pub const TECHNIQUE: Technique = Technique {
    id: "shadow/map",
    role: Role::DirectVisibility,
    title: "Shadow maps",
    doc: include_str!("doc.md"),
    cites: &["Williams78", "Reeves87"],
    reads: depth_map::READS,
    needs: Needs::NONE,
    params: Params::SPEC,
    make: |context, values| Ok(Box::new(ShadowMap::new(context, values)?)),
};

/// How far a point is moved before it is looked up.
#[derive(ParamChoice, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bias {
    /// Along the normal, as far as the filter needs and no further.
    Automatic,
    /// By `constant_bias`.
    Constant,
    /// By `constant_bias` and `slope_bias`.
    SlopeScaled,
    /// By `constant_bias` and `normal_offset`.
    NormalOffset,
}

/// Its parameters.
#[derive(Params, Clone, Copy, Debug)]
pub struct Params {
    /// Side of a map; a cube has six of them.
    #[param(default = 2048, range = 16..=8192, unit = "px")]
    pub resolution: u32,
    /// Half the side of the filter: 0 compares one texel, k averages (2k + 1)² comparisons.
    #[param(default = 1, range = 0..=8)]
    pub kernel: u32,
    /// Automatic: from the size of a texel, the width of the filter and the slope of the surface. The others use the numbers below.
    #[param(default = Bias::Automatic)]
    pub bias: Bias,
    /// Shift towards the light.
    #[param(default = 0.005, range = 0.0..=10.0, unit = "m")]
    pub constant_bias: Meters,
    /// Shift towards the light, in texels, times the tangent of the angle of incidence.
    #[param(default = 1.5, range = 0.0..=64.0)]
    pub slope_bias: f32,
    /// Shift along the normal, in texels, times the sine of the angle between the normal and the axis of the map.
    #[param(default = 2.0, range = 0.0..=64.0)]
    pub normal_offset: f32,
    /// What depth means in maps of points and spots; those of directional lights are linear by nature.
    #[param(default = DepthLayout::Perspective)]
    pub depth: DepthLayout,
    /// How depth is stored.
    #[param(default = Precision::Float32)]
    pub precision: Precision,
}

impl Params {
    /// What the maps are made for.
    fn settings(&self) -> Settings {
        let (constant, slope, normal) = (self.constant_bias.0, self.slope_bias, self.normal_offset);
        let shift = match self.bias {
            Bias::Automatic => Shift::Automatic,
            Bias::Constant => Shift::ByHand { constant, slope: 0.0, normal: 0.0 },
            Bias::SlopeScaled => Shift::ByHand { constant, slope, normal: 0.0 },
            Bias::NormalOffset => Shift::ByHand { constant, slope: 0.0, normal },
        };
        // One texel is read for a point somewhere in it; a filtered comparison reads the four around it, kernel texels away.
        let reach = if self.kernel == 0 { 0.5 } else { self.kernel as f32 + 1.0 };
        Settings { shift, layout: self.depth, precision: self.precision, ..Settings::new(self.resolution, reach) }
    }
}

/// What the look-up reads beside the map.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable, kajo_shader_lib::ShaderLayout)]
struct GpuParams {
    kernel: i32,
    padding_a: u32,
    padding_b: u32,
    padding_c: u32,
}

struct ShadowMap {
    maps: DepthMaps,
    look_up: ComputePipeline,
    uniform: Buffer,
    compare: wgpu::Sampler,
}

impl ShadowMap {
    fn new(context: &MakeContext, values: &ParamValues) -> Result<Self, Error> {
        let params = Params::from_values(values);
        let shader = context.shader("shadow/map", include_str!("look_up.wesl"))?;
        let options = PipelineOptions { list_length: context.textures, ..Default::default() };
        let uniform = GpuParams { kernel: params.kernel as i32, padding_a: 0, padding_b: 0, padding_c: 0 };
        Ok(Self {
            maps: DepthMaps::new(context, TECHNIQUE.id, params.settings())?,
            look_up: ComputePipeline::new(context.device, &shader, "look_up", options)?,
            uniform: context.device.buffer_with(TECHNIQUE.id, &[uniform], BufferUsages::UNIFORM)?,
            compare: depth_map::comparison(context.device),
        })
    }
}

impl Effect for ShadowMap {
    fn prepare(&mut self, frame: &FrameContext) -> Result<(), Error> {
        self.maps.prepare(frame, fit)
    }

    fn record<'a>(&'a self, frame: &'a FrameContext<'a>, graph: &mut Graph<'a>) {
        self.maps.record(frame, graph, &["look-up"], move |_, layer, pass| {
            let own = self.maps.bindings(layer, pass)?.with("params", &self.uniform).with("compare", &self.compare);
            self.look_up.dispatch(pass.device, pass.encoder, &frame.shared, &own, frame.size().extend(1))
        });
    }
}

//! Rays near the camera or the lights, a shadow map elsewhere.

#[cfg(test)]
mod tests;

use super::depth_map::{FilteredMaps, READS, Settings, fit, reach_of};
use super::hybrid::RayPass;
use crate::{DebugView, Effect, Error, FrameContext, MakeContext, Needs, Role, Statistic, Technique};
use kajo_params::{ParamChoice, ParamValues, Params};
use kajo_render_graph::{Access, Bindings, Device, Graph, slot};
use kajo_units::Meters;

/// The technique.
pub const TECHNIQUE: Technique = Technique {
    id: "shadow/near-rays",
    role: Role::DirectVisibility,
    title: "Shadow maps with rays near by",
    doc: include_str!("doc.md"),
    cites: &["Williams78", "Reeves87", "Cook84"],
    reads: READS,
    needs: Needs::NONE,
    params: Params::SPEC,
    make: |context, values| Ok(Box::new(NearRays::new(context, values)?)),
};

/// What a point must be near to.
#[derive(ParamChoice, Clone, Copy, Debug, PartialEq, Eq)]
pub enum From {
    /// The camera, along its axis.
    Camera,
    /// The middle of the light; no point is near to parallel light.
    Light,
}

/// Its parameters.
#[derive(Params, Clone, Copy, Debug)]
pub struct Params {
    /// Side of a map; a cube has six of them.
    #[param(default = 1024, range = 16..=8192, unit = "px")]
    pub resolution: u32,
    /// Half the side of the filter: 0 compares one texel, k averages (2k + 1)² comparisons.
    #[param(default = 1, range = 0..=8)]
    pub kernel: u32,
    /// Rays to each light that has an extent; points, spots and parallel lights take one.
    #[param(default = 4, range = 1..=1024)]
    pub samples: u32,
    /// What is near.
    #[param(default = From::Camera)]
    pub from: From,
    /// Up to where rays are traced.
    #[param(default = 5.0, range = 0.0..=1000000.0, unit = "m")]
    pub distance: Meters,
    /// Share of that distance over which the map takes over.
    #[param(default = 0.2, range = 0.0..=1.0)]
    pub fade: f32,
    /// How many lights are traced at all: the first ones of the scene. Others have their map everywhere.
    #[param(default = 65536, range = 0..=65536)]
    pub lights: u32,
}

/// What the shader reads.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable, kajo_shader_lib::ShaderLayout)]
struct GpuParams {
    samples: u32,
    first_light: u32,
    traced_lights: u32,
    from_light: u32,
    distance: f32,
    fade: f32,
    padding_a: u32,
    padding_b: u32,
}

struct NearRays {
    params: Params,
    maps: FilteredMaps,
    trace: RayPass,
}

impl NearRays {
    fn new(context: &MakeContext, values: &ParamValues) -> Result<Self, Error> {
        let params = Params::from_values(values);
        let settings = Settings::new(params.resolution, reach_of(params.kernel));
        Ok(Self {
            params,
            maps: FilteredMaps::new(context, TECHNIQUE.id, settings, params.kernel, Box::new(fit))?,
            trace: RayPass::new(context, TECHNIQUE.id, include_str!("near_rays.wesl"), size_of::<GpuParams>())?,
        })
    }
}

impl Effect for NearRays {
    fn prepare(&mut self, frame: &FrameContext) -> Result<(), Error> {
        let Params { samples, from, distance, fade, lights, .. } = self.params;
        let params = GpuParams {
            samples,
            first_light: frame.first_light,
            traced_lights: lights,
            from_light: u32::from(from == From::Light),
            distance: distance.0,
            fade,
            padding_a: 0,
            padding_b: 0,
        };
        self.trace.prepare(frame, &params);
        self.maps.prepare(frame)
    }

    fn record<'a>(&'a self, frame: &'a FrameContext<'a>, graph: &mut Graph<'a>) {
        self.maps.record(frame, graph);
        let access = Access::new("shadow/near-rays/trace").reads(&[slot::DEPTH, slot::NORMAL]).updates(&[slot::SHADOW_VISIBILITY]);
        graph.pass(access, move |pass| self.trace.dispatch(frame, pass, Bindings::new()));
    }

    fn rays(&self, device: &Device) -> Result<u64, Error> {
        self.trace.rays.rays(device)
    }

    fn statistics(&self, frame: &FrameContext) -> Result<Vec<Statistic>, Error> {
        self.trace.rays.statistics(frame)
    }

    fn debug_views(&self, frame: &FrameContext) -> Result<Vec<DebugView>, Error> {
        self.maps.debug_views(frame)
    }
}

//! Short rays over a shadow map.

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
    id: "shadow/contact-rays",
    role: Role::DirectVisibility,
    title: "Shadow maps with short rays",
    doc: include_str!("doc.md"),
    cites: &["Williams78", "Reeves87", "Cook84"],
    reads: READS,
    needs: Needs::NONE,
    params: Params::SPEC,
    make: |context, values| Ok(Box::new(ContactRays::new(context, values)?)),
};

/// What is known beyond the end of a ray.
#[derive(ParamChoice, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Beyond {
    /// What the map says.
    Map,
    /// Nothing blocks there.
    Nothing,
}

/// Its parameters.
#[derive(Params, Clone, Copy, Debug)]
pub struct Params {
    /// Longest ray.
    #[param(default = 0.1, range = 0.0..=1000000.0, unit = "m")]
    pub length: Meters,
    /// Rays to each light that has an extent; points, spots and parallel lights take one.
    #[param(default = 4, range = 1..=65536)]
    pub samples: u32,
    /// What stands for the rest of the way.
    #[param(default = Beyond::Map)]
    pub beyond: Beyond,
    /// Side of a map; a cube has six of them.
    #[param(default = 1024, range = 16..=8192, unit = "px")]
    pub resolution: u32,
    /// Half the side of the filter: 0 compares one texel, k averages (2k + 1)² comparisons.
    #[param(default = 1, range = 0..=8)]
    pub kernel: u32,
}

/// What the shader reads.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable, kajo_shader_lib::ShaderLayout)]
struct GpuParams {
    samples: u32,
    first_light: u32,
    length: f32,
    over_map: u32,
}

struct ContactRays {
    params: Params,
    /// Absent where nothing stands for the rest of the way.
    maps: Option<FilteredMaps>,
    trace: RayPass,
}

impl ContactRays {
    fn new(context: &MakeContext, values: &ParamValues) -> Result<Self, Error> {
        let params = Params::from_values(values);
        let settings = Settings::new(params.resolution, reach_of(params.kernel));
        let maps = match params.beyond {
            Beyond::Map => Some(FilteredMaps::new(context, TECHNIQUE.id, settings, params.kernel, Box::new(fit))?),
            Beyond::Nothing => None,
        };
        let trace = RayPass::new(context, TECHNIQUE.id, include_str!("contact_rays.wesl"), size_of::<GpuParams>())?;
        Ok(Self { params, maps, trace })
    }
}

impl Effect for ContactRays {
    fn prepare(&mut self, frame: &FrameContext) -> Result<(), Error> {
        let Params { samples, length, .. } = self.params;
        let over_map = u32::from(self.maps.is_some());
        self.trace.prepare(frame, &GpuParams { samples, first_light: frame.first_light, length: length.0, over_map });
        self.maps.as_mut().map_or(Ok(()), |maps| maps.prepare(frame))
    }

    fn record<'a>(&'a self, frame: &'a FrameContext<'a>, graph: &mut Graph<'a>) {
        let access = Access::new("shadow/contact-rays/trace").reads(&[slot::DEPTH, slot::NORMAL]);
        let access = match &self.maps {
            Some(maps) => {
                maps.record(frame, graph);
                access.updates(&[slot::SHADOW_VISIBILITY])
            }
            None => access.writes(&[slot::SHADOW_VISIBILITY]),
        };
        graph.pass(access, move |pass| self.trace.dispatch(frame, pass, Bindings::new()));
    }

    fn rays(&self, device: &Device) -> Result<u64, Error> {
        self.trace.rays.rays(device)
    }

    fn statistics(&self, frame: &FrameContext) -> Result<Vec<Statistic>, Error> {
        self.trace.rays.statistics(frame)
    }

    fn debug_views(&self, frame: &FrameContext) -> Result<Vec<DebugView>, Error> {
        self.maps.as_ref().map_or(Ok(Vec::new()), |maps| maps.debug_views(frame))
    }
}

//! Ambient occlusion from horizons in the depth buffer.

#[cfg(test)]
mod tests;

use super::screen::ScreenPass;
use super::{READS, reach};
use crate::edge_avoiding::{EdgeAvoiding, Filtered};
use crate::{Effect, Error, FrameContext, MakeContext, Needs, Role, Technique};
use kajo_params::{ParamValues, Params};
use kajo_render_graph::Graph;

/// The technique.
pub const TECHNIQUE: Technique = Technique {
    id: "ao/gtao",
    role: Role::AmbientVisibility,
    title: "Ambient occlusion from horizons (GTAO)",
    doc: include_str!("doc.md"),
    cites: &["Bavoil08", "Jimenez16", "Dammertz10"],
    reads: READS,
    needs: Needs::NONE,
    params: Params::SPEC,
    make: |context, values| Ok(Box::new(Gtao::new(context, values)?)),
};

/// Its parameters.
#[derive(Params, Clone, Copy, Debug)]
pub struct Params {
    /// Slices through the view ray, spread over half a turn.
    #[param(default = 2, range = 1..=64)]
    pub slices: u32,
    /// Steps on each side of a slice, denser near the point.
    #[param(default = 8, range = 1..=256)]
    pub steps: u32,
    /// How fast a horizon falls behind what raised it: 0 takes everything for endlessly thick, values near 1 for leaves of paper.
    #[param(default = 0.0, range = 0.0..=0.99)]
    pub thickness: f32,
    /// Passes of a filter that spreads the noise over pixels of the same surface; each doubles the reach and costs some detail.
    #[param(default = 2, range = 0..=5)]
    pub denoise: u32,
}

/// What the shader reads.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable, kajo_shader_lib::ShaderLayout)]
struct GpuParams {
    slices: u32,
    steps: u32,
    thickness: f32,
    distance: f32,
}

struct Gtao {
    params: Params,
    look: ScreenPass,
    filter: EdgeAvoiding,
}

impl Gtao {
    fn new(context: &MakeContext, values: &ParamValues) -> Result<Self, Error> {
        let params = Params::from_values(values);
        Ok(Self {
            params,
            look: ScreenPass::new(context, (TECHNIQUE.id, "ao/gtao/look"), include_str!("gtao.wesl"), size_of::<GpuParams>())?,
            filter: EdgeAvoiding::new(context, TECHNIQUE.id, Filtered::Surroundings, [params.denoise, 2 * params.slices])?,
        })
    }
}

impl Effect for Gtao {
    fn prepare(&mut self, frame: &FrameContext) -> Result<(), Error> {
        let Params { slices, steps, thickness, .. } = self.params;
        self.look.write(frame, &GpuParams { slices, steps, thickness, distance: reach(frame) });
        self.filter.prepare(frame);
        Ok(())
    }

    fn record<'a>(&'a self, frame: &'a FrameContext<'a>, graph: &mut Graph<'a>) {
        self.look.record(frame, graph, self.filter.source(0));
        self.filter.record(frame, graph);
    }
}

//! Screen-space ambient occlusion.

#[cfg(test)]
mod tests;

use super::screen::ScreenPass;
use super::{READS, reach};
use crate::edge_avoiding::{EdgeAvoiding, Filtered};
use crate::{Effect, Error, FrameContext, MakeContext, Needs, Role, Technique};
use kajo_params::{ParamChoice, ParamValues, Params};
use kajo_render_graph::Graph;

/// The technique.
pub const TECHNIQUE: Technique = Technique {
    id: "ao/ssao",
    role: Role::AmbientVisibility,
    title: "Screen-space ambient occlusion",
    doc: include_str!("doc.md"),
    cites: &["Mittring07", "Filion08", "Roberts18", "Dammertz10"],
    reads: READS,
    needs: Needs::NONE,
    params: Params::SPEC,
    make: |context, values| Ok(Box::new(Ssao::new(context, values)?)),
};

/// Where the points lie.
#[derive(ParamChoice, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kernel {
    /// Over the surface.
    Hemisphere,
    /// On all sides: half of them lie in a flat surface.
    Sphere,
}

/// Its parameters.
#[derive(Params, Clone, Copy, Debug)]
pub struct Params {
    /// Points around each point.
    #[param(default = 16, range = 1..=1024)]
    pub samples: u32,
    /// The sphere is the first form of the technique, which darkens everything flat.
    #[param(default = Kernel::Hemisphere)]
    pub kernel: Kernel,
    /// Passes of a filter that spreads the noise over pixels of the same surface; each doubles the reach and costs some detail.
    #[param(default = 2, range = 0..=5)]
    pub denoise: u32,
}

/// What the shader reads.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable, kajo_shader_lib::ShaderLayout)]
struct GpuParams {
    samples: u32,
    full_sphere: u32,
    distance: f32,
    padding: u32,
}

struct Ssao {
    params: Params,
    look: ScreenPass,
    filter: EdgeAvoiding,
}

impl Ssao {
    fn new(context: &MakeContext, values: &ParamValues) -> Result<Self, Error> {
        let params = Params::from_values(values);
        Ok(Self {
            params,
            look: ScreenPass::new(context, (TECHNIQUE.id, "ao/ssao/look"), include_str!("ssao.wesl"), size_of::<GpuParams>())?,
            filter: EdgeAvoiding::new(context, TECHNIQUE.id, Filtered::Surroundings, [params.denoise, params.samples])?,
        })
    }
}

impl Effect for Ssao {
    fn prepare(&mut self, frame: &FrameContext) -> Result<(), Error> {
        let full_sphere = u32::from(self.params.kernel == Kernel::Sphere);
        self.look.write(frame, &GpuParams { samples: self.params.samples, full_sphere, distance: reach(frame), padding: 0 });
        self.filter.prepare(frame);
        Ok(())
    }

    fn record<'a>(&'a self, frame: &'a FrameContext<'a>, graph: &mut Graph<'a>) {
        self.look.record(frame, graph, self.filter.source(0));
        self.filter.record(frame, graph);
    }
}

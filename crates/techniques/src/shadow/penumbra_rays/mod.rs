//! Rays in penumbrae, a shadow map elsewhere.

#[cfg(test)]
mod tests;

use super::depth_map::{DepthMaps, READS, Settings, fit};
use super::hybrid::RayPass;
use crate::{DebugView, Effect, Error, FrameContext, MakeContext, Needs, Role, Statistic, Technique};
use kajo_params::{ParamValues, Params};
use kajo_render_graph::wgpu::BufferUsages;
use kajo_render_graph::{Access, Bindings, Buffer, ComputePipeline, Device, Graph, PipelineOptions, slot};

/// The technique.
pub const TECHNIQUE: Technique = Technique {
    id: "shadow/penumbra-rays",
    role: Role::DirectVisibility,
    title: "Shadow maps with rays in penumbrae",
    doc: include_str!("doc.md"),
    cites: &["Williams78", "Fernando05", "Cook84", "Roberts18"],
    reads: READS,
    needs: Needs::NONE,
    params: Params::SPEC,
    make: |context, values| Ok(Box::new(PenumbraRays::new(context, values)?)),
};

/// Its parameters.
#[derive(Params, Clone, Copy, Debug)]
pub struct Params {
    /// Side of a map; a cube has six of them.
    #[param(default = 2048, range = 16..=8192, unit = "px")]
    pub resolution: u32,
    /// Rays to each light that has an extent; points, spots and parallel lights take one.
    #[param(default = 4, range = 1..=1024)]
    pub samples: u32,
    /// Texels in which blockers are looked for.
    #[param(default = 48, range = 1..=256)]
    pub blocker_samples: u32,
    /// Texels that must all be dark where no ray is traced.
    #[param(default = 24, range = 1..=256)]
    pub filter_samples: u32,
    /// By how much wider than the penumbra they are spread.
    #[param(default = 0.25, range = 0.0..=4.0)]
    pub margin: f32,
    /// Share of the way from the light within which no blockers are looked for.
    #[param(default = 0.2, range = 0.01..=0.95)]
    pub nearest: f32,
    /// How far beside the pixels in which the map is not sure rays are traced, too.
    #[param(default = 2, range = 0..=16, unit = "px")]
    pub guard: u32,
}

/// What the sorting reads.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable, kajo_shader_lib::ShaderLayout)]
struct GpuSort {
    blocker_samples: u32,
    filter_samples: u32,
    nearest: f32,
    margin: f32,
}

/// What the trace reads.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable, kajo_shader_lib::ShaderLayout)]
struct GpuParams {
    samples: u32,
    first_light: u32,
    guard: i32,
    padding: u32,
}

struct PenumbraRays {
    params: Params,
    maps: DepthMaps,
    sort: ComputePipeline,
    sorting: Buffer,
    trace: RayPass,
}

impl PenumbraRays {
    fn new(context: &MakeContext, values: &ParamValues) -> Result<Self, Error> {
        let params = Params::from_values(values);
        let Params { blocker_samples, filter_samples, nearest, margin, .. } = params;
        let shader = context.shader("shadow/penumbra-rays/sort", include_str!("sort.wesl"))?;
        let options = PipelineOptions { list_length: context.textures, ..Default::default() };
        let sorting = GpuSort { blocker_samples, filter_samples, nearest, margin };
        // Each comparison lies on the receiver's plane, in one texel; as far from the point as the light is wide.
        let settings = Settings { near_points: false, border: 1.0, ..Settings::new(params.resolution, 0.5) };
        Ok(Self {
            params,
            maps: DepthMaps::new(context, TECHNIQUE.id, settings)?,
            sort: ComputePipeline::new(context.device, &shader, "sort", options)?,
            sorting: context.device.buffer_with("shadow/penumbra-rays/sort", &[sorting], BufferUsages::UNIFORM)?,
            trace: RayPass::new(context, TECHNIQUE.id, include_str!("penumbra_rays.wesl"), size_of::<GpuParams>())?,
        })
    }
}

impl Effect for PenumbraRays {
    fn prepare(&mut self, frame: &FrameContext) -> Result<(), Error> {
        let Params { samples, guard, .. } = self.params;
        self.trace.prepare(frame, &GpuParams { samples, first_light: frame.first_light, guard: guard as i32, padding: 0 });
        self.maps.prepare(frame, &fit)
    }

    fn record<'a>(&'a self, frame: &'a FrameContext<'a>, graph: &mut Graph<'a>) {
        self.maps.record(frame, graph, &["sort"], move |_, layer, pass| {
            let own = self.maps.bindings(layer, pass)?.with("params", &self.sorting);
            self.sort.dispatch(pass.device, pass.encoder, &frame.shared, &own, frame.size().extend(1))
        });
        // Pixels look at their neighbours, so what the map said is kept beside what rays say.
        let copy = Access::new("shadow/penumbra-rays/keep").updates(&[slot::SHADOW_VISIBILITY]).writes(&[slot::SHADOW_FILTERED]);
        graph.pass(copy, |pass| {
            let from = pass.texture(slot::SHADOW_VISIBILITY)?.wgpu.clone();
            let to = pass.texture(slot::SHADOW_FILTERED)?.wgpu.clone();
            pass.encoder.copy_texture_to_texture(from.as_image_copy(), to.as_image_copy(), from.size());
            Ok(())
        });
        let reads = [slot::DEPTH, slot::NORMAL, slot::SHADOW_FILTERED];
        let access = Access::new("shadow/penumbra-rays/trace").reads(&reads).updates(&[slot::SHADOW_VISIBILITY]);
        graph.pass(access, move |pass| {
            let more = Bindings::new().with("sorted", pass.view(slot::SHADOW_FILTERED)?);
            self.trace.dispatch(frame, pass, more)
        });
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

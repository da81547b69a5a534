//! Indirect light by probes in a grid.

mod bake;
mod grid;
#[cfg(test)]
mod tests;

use super::READS;
use crate::ray_count::RayCount;
use crate::still_life::StillLife;
use crate::{Effect, Error, FrameContext, MakeContext, Needs, Role, Statistic, Technique};
use bake::{Bake, Inputs};
use glam::{UVec3, Vec3};
use grid::grid_over;
use kajo_params::{ParamChoice, ParamValues, Params};
use kajo_render_graph::wgpu::BufferUsages;
use kajo_render_graph::{Access, Bindings, Buffer, ComputePipeline, Device, Graph, PipelineOptions, Pool, Timings, readback, slot};
use kajo_shader_lib::SourceFile;

/// The technique.
pub const TECHNIQUE: Technique = Technique {
    id: "gi/probes",
    role: Role::DiffuseIndirect,
    title: "Irradiance probes",
    doc: include_str!("doc.md"),
    cites: &["Greger98", "Ramamoorthi01", "Majercik19", "Roberts18"],
    reads: READS,
    needs: Needs::NONE,
    params: Params::SPEC,
    make: |context, values| Ok(Box::new(Probes::new(context, values)?)),
};

/// What keeps light from leaking through walls.
#[derive(ParamChoice, Clone, Copy, Debug, PartialEq, Eq)]
pub enum LeakGuard {
    /// Nothing.
    None,
    /// Mean and variance of distances.
    Distance,
    /// A ray to each probe.
    Rays,
}

/// Its parameters.
#[derive(Params, Clone, Copy, Debug)]
pub struct Params {
    /// Probes along the longest axis of the scene; the others have as many as keep the step. More show smaller detail and cost memory and rays of the bake by
    /// the third power.
    #[param(default = 16, range = 2..=40)]
    pub probes: u32,
    /// Rays of each probe.
    #[param(default = 256, range = 16..=4096)]
    pub rays: u32,
    /// Bounces of the light before it reaches what is seen.
    #[param(default = 8, range = 1..=64)]
    pub bounces: u32,
    /// How a surface knows which of the probes around it are on its side of the walls.
    #[param(default = LeakGuard::Rays)]
    pub leak_guard: LeakGuard,
}

/// What the shaders read.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable, kajo_shader_lib::ShaderLayout)]
struct GpuGrid {
    low: Vec3,
    rays: u32,
    step: Vec3,
    guard: u32,
    count: UVec3,
    reach: f32,
}

/// A probe as the shaders have it.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable, kajo_shader_lib::ShaderLayout)]
struct GpuProbe {
    position: Vec3,
    open: u32,
}

/// Modules of its shaders.
const FILES: &[SourceFile<'static>] = &[SourceFile { name: "probe_grid", source: include_str!("probe_grid.wesl") }];

struct Probes {
    params: Params,
    interpolate: ComputePipeline,
    bake: Bake,
    grid: Buffer,
    rays: RayCount,
    still: StillLife,
    /// The probes are to be baked in this frame.
    stale: bool,
}

impl Probes {
    fn new(context: &MakeContext, values: &ParamValues) -> Result<Self, Error> {
        let device = context.device;
        let shader = context.shader_with(TECHNIQUE.id, include_str!("probes.wesl"), FILES)?;
        let options = PipelineOptions { list_length: context.textures, ..Default::default() };
        Ok(Self {
            params: Params::from_values(values),
            interpolate: ComputePipeline::new(device, &shader, "interpolate", options)?,
            bake: Bake::new(context)?,
            grid: device.buffer("gi/probes grid", size_of::<GpuGrid>() as u64, BufferUsages::UNIFORM | BufferUsages::COPY_DST)?,
            rays: RayCount::new(context, "gi/probes rays")?,
            still: StillLife::default(),
            stale: true,
        })
    }
}

impl Effect for Probes {
    fn prepare(&mut self, frame: &FrameContext) -> Result<(), Error> {
        self.rays.prepare(frame);
        self.stale = self.still.changed(frame);
        if self.stale {
            let (count, low, step) = grid_over(frame.bounds, self.params.probes);
            let guard = self.params.leak_guard as u32;
            // Whatever is farther away than a cell is wide is no wall inside of it.
            let grid = GpuGrid { low, rays: self.params.rays, step, guard, count, reach: 1.5 * step.length() };
            self.grid.write(&frame.device.queue, bytemuck::bytes_of(&grid));
            self.bake.prepare(frame.device, count.element_product(), self.params.rays)?;
        }
        Ok(())
    }

    fn run(&mut self, frame: &FrameContext, _pool: &Pool) -> Result<Timings, Error> {
        if !self.stale {
            return Ok(Timings::default());
        }
        let mut graph = Graph::new();
        let inputs = Inputs { grid: &self.grid, rays: &self.rays };
        graph.pass(Access::new("gi/probes/bake"), |pass| self.bake.record(pass, frame, inputs, self.params.bounces));
        Ok(graph.execute(frame.device, &mut Pool::new(frame.size(), 1))?)
    }

    fn record<'a>(&'a self, frame: &'a FrameContext<'a>, graph: &mut Graph<'a>) {
        let access = Access::new("gi/probes/interpolate").reads(READS).writes(&[slot::DIFFUSE_INDIRECT]);
        graph.pass(access, move |pass| {
            let own = Bindings::new()
                .with("grid", &self.grid)
                .with("probes", self.bake.probes()?)
                .with("moments", self.bake.moments()?)
                .with("coefficients", self.bake.light(self.params.bounces)?)
                .with("depth", pass.view(slot::DEPTH)?)
                .with("normal", pass.view(slot::NORMAL)?)
                .with("irradiance", pass.view(slot::DIFFUSE_INDIRECT)?)
                .with(RayCount::BINDING, self.rays.buffer());
            self.interpolate.dispatch(pass.device, pass.encoder, &frame.shared, &own, frame.size().extend(1))
        });
    }

    fn rays(&self, device: &Device) -> Result<u64, Error> {
        self.rays.rays(device)
    }

    /// `probes`: all of them; `closed-probes`: those inside of solids.
    fn statistics(&self, frame: &FrameContext) -> Result<Vec<Statistic>, Error> {
        let probes: Vec<GpuProbe> = readback::read_buffer(frame.device, &self.bake.probes()?.wgpu)?;
        let count = grid_over(frame.bounds, self.params.probes).0.element_product() as usize;
        let closed = probes[..count].iter().filter(|probe| probe.open == 0).count();
        let told = |name, value: usize| Statistic { name, light: Statistic::NO_LIGHT, value: value as u64 };
        Ok(vec![told("probes", count), told("closed-probes", closed)])
    }
}

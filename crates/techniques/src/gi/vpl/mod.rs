//! Indirect light by virtual point lights.

mod sources;
#[cfg(test)]
mod tests;

use super::{READS, light_power::around};
use crate::ray_count::RayCount;
use crate::still_life::StillLife;
use crate::{Effect, Error, FrameContext, MakeContext, Needs, Role, Statistic, Technique};
use glam::{UVec2, UVec3, Vec3};
use kajo_params::{ParamChoice, ParamValues, Params};
use kajo_render_graph::wgpu::BufferUsages;
use kajo_render_graph::{Access, Bindings, Buffer, ComputePipeline, Device, Graph, PipelineOptions, Pool, Timings, readback, slot};
use sources::{Sky, Sources};

/// The technique.
pub const TECHNIQUE: Technique = Technique {
    id: "gi/vpl",
    role: Role::DiffuseIndirect,
    title: "Virtual point lights",
    doc: include_str!("doc.md"),
    cites: &["Keller97", "Roberts18"],
    reads: READS,
    needs: Needs::NONE,
    params: Params::SPEC,
    make: |context, values| Ok(Box::new(VirtualLights::new(context, values)?)),
};

/// When paths of light are followed anew.
#[derive(ParamChoice, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Renew {
    /// When something but the camera has moved.
    Scene,
    /// In every frame.
    Frame,
}

/// Its parameters.
#[derive(Params, Clone, Copy, Debug)]
pub struct Params {
    /// Paths of light; each leaves a virtual light at every surface that it meets.
    #[param(default = 4096, range = 1..=1048576)]
    pub paths: u32,
    /// Most surfaces that a path meets: the bounces of the light before it reaches what is seen.
    #[param(default = 6, range = 1..=16)]
    pub bounces: u32,
    /// Virtual lights of each pixel, others in each frame; 0 takes all of them.
    #[param(default = 128, range = 0..=1048576)]
    pub samples: u32,
    /// Distance below which virtual lights shine no brighter, as a share of the radius of the scene. Larger evens bright spots out and takes more light
    /// away.
    #[param(default = 0.05, range = 0.0001..=1.0)]
    pub nearest: f32,
    /// Paths that stay do not flicker; new ones in each frame let the mean of frames converge.
    #[param(default = Renew::Scene)]
    pub renew: Renew,
}

/// What the shader reads.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable, kajo_shader_lib::ShaderLayout)]
struct GpuParams {
    center: Vec3,
    radius: f32,
    paths: u32,
    bounces: u32,
    round: u32,
    sources: u32,
    samples: u32,
    sky: u32,
    greatest: f32,
    groups_x: u32,
}

/// A virtual light in memory, bytes.
const VPL_BYTES: u64 = 32;

/// Side of the workgroups that light pixels.
const GROUP: u32 = 8;

struct VirtualLights {
    params: Params,
    emit: ComputePipeline,
    pack: ComputePipeline,
    light: ComputePipeline,
    uniform: Buffer,
    left: Buffer,
    vpls: Buffer,
    count: Buffer,
    rays: RayCount,
    still: StillLife,
    /// The environment and all that paths start from; `None` before the first frame.
    sky: Option<Sky>,
    sources: Option<Sources>,
    /// Paths are to be followed in this frame.
    dark: bool,
    clamped: Option<Buffer>,
}

impl VirtualLights {
    fn new(context: &MakeContext, values: &ParamValues) -> Result<Self, Error> {
        let device = context.device;
        let params = Params::from_values(values);
        let shader = context.shader(TECHNIQUE.id, include_str!("vpl.wesl"))?;
        let options = PipelineOptions { list_length: context.textures, ..Default::default() };
        let pipeline = |entry| ComputePipeline::new(device, &shader, entry, options);
        let bytes = u64::from(params.paths) * u64::from(params.bounces) * VPL_BYTES;
        let buffer = |label, bytes, usage| device.buffer(label, bytes, usage);
        Ok(Self {
            params,
            emit: pipeline("emit")?,
            pack: pipeline("pack")?,
            light: pipeline("light")?,
            uniform: buffer(TECHNIQUE.id, size_of::<GpuParams>() as u64, BufferUsages::UNIFORM | BufferUsages::COPY_DST)?,
            left: buffer("gi/vpl paths", bytes, BufferUsages::STORAGE)?,
            vpls: buffer("gi/vpl lights", bytes, BufferUsages::STORAGE)?,
            count: buffer("gi/vpl count", 4, BufferUsages::STORAGE | BufferUsages::COPY_SRC)?,
            rays: RayCount::new(context, "gi/vpl rays")?,
            still: StillLife::default(),
            sky: None,
            sources: None,
            dark: true,
            clamped: None,
        })
    }

    /// Whether anything shines at all.
    fn shines(&self) -> bool {
        self.sources.as_ref().is_some_and(|sources| sources.count > 0)
    }

    fn groups(size: UVec2) -> UVec2 {
        size.map(|side| side.div_ceil(GROUP))
    }
}

impl Effect for VirtualLights {
    fn prepare(&mut self, frame: &FrameContext) -> Result<(), Error> {
        let (center, radius) = around(frame.bounds);
        let changed = self.still.changed(frame);
        if changed || self.sources.is_none() {
            let sky = match self.sky.take() {
                Some(sky) => sky,
                None => Sky::new(frame)?,
            };
            self.sources = Some(Sources::new(frame, self.sky.insert(sky), radius)?);
        }
        self.dark = changed || self.params.renew == Renew::Frame;
        let sources = self.sources.as_ref().expect("made above");
        let groups = Self::groups(frame.size());
        let bytes = u64::from(groups.x * groups.y) * 8;
        if self.clamped.as_ref().is_none_or(|buffer| buffer.wgpu.size() < bytes) {
            self.clamped = Some(frame.device.buffer("gi/vpl clamped", bytes, BufferUsages::STORAGE | BufferUsages::COPY_SRC)?);
        }
        let nearest = self.params.nearest * radius;
        let params = GpuParams {
            center,
            radius,
            paths: self.params.paths,
            bounces: self.params.bounces,
            round: if self.params.renew == Renew::Frame { frame.index } else { 0 },
            sources: sources.count,
            samples: self.params.samples,
            sky: u32::from(sources.sky_shines),
            greatest: 1.0 / (nearest * nearest).max(f32::MIN_POSITIVE),
            groups_x: groups.x,
        };
        self.rays.prepare(frame);
        self.uniform.write(&frame.device.queue, bytemuck::bytes_of(&params));
        Ok(())
    }

    fn run(&mut self, frame: &FrameContext, _pool: &Pool) -> Result<Timings, Error> {
        let (true, Some(sources), Some(sky)) = (self.dark && self.shines(), &self.sources, &self.sky) else {
            return Ok(Timings::default());
        };
        let mut graph = Graph::new();
        graph.pass(Access::new("gi/vpl/emit"), |pass| {
            let own = Bindings::new()
                .with("params", &self.uniform)
                .with("choices", &sources.choices)
                .with("sky", &sky.rays)
                .with("left", &self.left)
                .with(RayCount::BINDING, self.rays.buffer());
            self.emit.dispatch(pass.device, pass.encoder, &frame.shared, &own, UVec3::new(self.params.paths, 1, 1))?;
            let own = Bindings::new()
                .with("params", &self.uniform)
                .with("left", &self.left)
                .with("vpls", &self.vpls)
                .with("vpl_count", &self.count);
            self.pack.dispatch(pass.device, pass.encoder, &frame.shared, &own, UVec3::ONE)
        });
        Ok(graph.execute(frame.device, &mut Pool::new(frame.size(), 1))?)
    }

    fn record<'a>(&'a self, frame: &'a FrameContext<'a>, graph: &mut Graph<'a>) {
        let (true, Some(clamped)) = (self.shines(), &self.clamped) else {
            graph.clear("gi/vpl/nothing", slot::DIFFUSE_INDIRECT, kajo_render_graph::wgpu::Color::TRANSPARENT);
            return;
        };
        let access = Access::new("gi/vpl/light").reads(READS).writes(&[slot::DIFFUSE_INDIRECT]);
        graph.pass(access, move |pass| {
            let own = Bindings::new()
                .with("params", &self.uniform)
                .with("vpls", &self.vpls)
                .with("vpl_count", &self.count)
                .with("depth", pass.view(slot::DEPTH)?)
                .with("normal", pass.view(slot::NORMAL)?)
                .with("irradiance", pass.view(slot::DIFFUSE_INDIRECT)?)
                .with("clamped", clamped)
                .with(RayCount::BINDING, self.rays.buffer());
            self.light.dispatch(pass.device, pass.encoder, &frame.shared, &own, frame.size().extend(1))
        });
    }

    fn rays(&self, device: &Device) -> Result<u64, Error> {
        self.rays.rays(device)
    }

    /// `virtual-lights`: how many light the picture; `clamped-ppm`: what the clamp of the geometry term took, in millionths of what it left.
    fn statistics(&self, frame: &FrameContext) -> Result<Vec<Statistic>, Error> {
        let Some(clamped) = self.clamped.as_ref().filter(|_| self.shines()) else { return Ok(Vec::new()) };
        let count: Vec<u32> = readback::read_buffer(frame.device, &self.count.wgpu)?;
        let groups = Self::groups(frame.size());
        let sums: Vec<[f32; 2]> = readback::read_buffer(frame.device, &clamped.wgpu)?;
        let total = |k: usize| sums[..(groups.x * groups.y) as usize].iter().map(|sum| f64::from(sum[k])).sum::<f64>();
        let share = total(1) / total(0).max(f64::MIN_POSITIVE);
        let told = |name, value| Statistic { name, light: Statistic::NO_LIGHT, value };
        Ok(vec![told("virtual-lights", count[0].into()), told("clamped-ppm", (share * 1e6).round() as u64)])
    }
}

//! Side polygons and caps of each light's volumes, found by the device.

use super::SHARED;
use super::buffers::{STRIDE, append, grow, made, upload};
use super::casters::{GpuJob, Jobs};
use crate::{Error, FrameContext, MakeContext};
use bytemuck::{Pod, Zeroable};
use glam::UVec3;
use kajo_render_graph::wgpu::BufferUsages;
use kajo_render_graph::{Bindings, Buffer, ComputePipeline, Device, PassContext, PipelineOptions, Resource, readback};
use kajo_shader_lib::ShaderLayout;

/// Twin of `Extraction` in extract.wesl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable, ShaderLayout)]
pub(super) struct GpuExtraction {
    light: u32,
    jobs: u32,
    triangles: u32,
    edges: u32,
}

/// Twin of `Counts` in extract.wesl; the first four and the next four are what an indirect draw reads.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable, ShaderLayout)]
pub(super) struct GpuCounts {
    side_vertices: u32,
    side_instances: u32,
    side_first_vertex: u32,
    side_first_instance: u32,
    cap_vertices: u32,
    cap_instances: u32,
    cap_first_vertex: u32,
    cap_first_instance: u32,
    at_infinity: u32,
    padding_a: u32,
    padding_b: u32,
    padding_c: u32,
}

/// Vertices of a side polygon, and of both ends of a volume.
const VERTICES: u32 = 6;
/// Where the draw of the caps begins in [`GpuCounts`].
const CAPS: u64 = 16;

/// Extraction of the polygons of one light after the other.
pub(super) struct Extract {
    face_triangles: ComputePipeline,
    extrude_edges: ComputePipeline,
    /// What each light of the group extracts.
    jobs: Vec<Jobs>,
    uniforms: Option<Buffer>,
    /// Job lists one after the other, each begins at a multiple of [`STRIDE`].
    job_lists: Option<Buffer>,
    counts: Option<Buffer>,
    /// Of the triangles of one light's jobs.
    facing: Option<Buffer>,
    silhouette: Option<Buffer>,
    caps: Option<Buffer>,
}

/// The polygons of one light.
#[derive(Clone, Copy)]
pub(super) struct Lists<'a> {
    pub silhouette: &'a Buffer,
    pub caps: &'a Buffer,
    /// Draws of the sides and of the caps, and where in the buffer they stand.
    pub draws: &'a Buffer,
    pub side_draw: u64,
    pub cap_draw: u64,
}

impl Extract {
    pub fn new(context: &MakeContext) -> Result<Self, Error> {
        let shader = context.shader_with("shadow/volume/extract", include_str!("extract.wesl"), SHARED)?;
        let options = PipelineOptions { list_length: context.textures, ..Default::default() };
        let pipeline = |entry| ComputePipeline::new(context.device, &shader, entry, options);
        Ok(Self {
            face_triangles: pipeline("face_triangles")?,
            extrude_edges: pipeline("extrude_edges")?,
            jobs: Vec::new(),
            uniforms: None,
            job_lists: None,
            counts: None,
            facing: None,
            silhouette: None,
            caps: None,
        })
    }

    /// Uploads what each light extracts, and makes lists that are long enough for any outcome.
    pub fn prepare(&mut self, frame: &FrameContext, jobs: &[Jobs]) -> Result<(), Error> {
        let device = frame.device;
        let most = |of: &dyn Fn(&Jobs) -> u64| jobs.iter().map(of).max().unwrap_or(0).max(1);
        let storage = BufferUsages::STORAGE;
        grow(device, &mut self.facing, "shadow/volume facing", most(&|j| u64::from(j.triangles)) * 4, storage)?;
        grow(device, &mut self.silhouette, "shadow/volume silhouette", most(&|j| j.most_sides) * 12, storage)?;
        grow(device, &mut self.caps, "shadow/volume caps", most(&|j| u64::from(j.triangles)) * 8, storage)?;

        let nothing = [GpuJob::zeroed()];
        let (mut uniforms, mut lists, mut counts) = (Vec::new(), Vec::new(), Vec::new());
        for (layer, jobs) in jobs.iter().enumerate() {
            let light = frame.first_light + layer as u32;
            let uniform = GpuExtraction { light, jobs: jobs.list.len() as u32, triangles: jobs.triangles, edges: jobs.edges };
            append(&mut uniforms, bytemuck::bytes_of(&uniform));
            append(&mut lists, bytemuck::cast_slice(if jobs.list.is_empty() { &nothing[..] } else { &jobs.list[..] }));
            append(&mut counts, bytemuck::bytes_of(&GpuCounts { side_instances: 1, cap_instances: 1, ..GpuCounts::default() }));
        }
        upload(device, &mut self.uniforms, "shadow/volume extraction", &uniforms, BufferUsages::UNIFORM)?;
        upload(device, &mut self.job_lists, "shadow/volume jobs", &lists, storage)?;
        upload(device, &mut self.counts, "shadow/volume counts", &counts, storage | BufferUsages::INDIRECT | BufferUsages::COPY_SRC)?;
        self.jobs = jobs.to_vec();
        Ok(())
    }

    pub fn run(&self, frame: &FrameContext, layer: usize, edges: &Buffer, pass: &mut PassContext) -> Result<(), kajo_render_graph::Error> {
        let jobs = &self.jobs[layer];
        if jobs.list.is_empty() {
            return Ok(());
        }
        let first: u64 = self.jobs[..layer].iter().map(|jobs| list_bytes(jobs).next_multiple_of(STRIDE)).sum();
        let common = Bindings::new()
            .with("extraction", Resource::Range(&made(&self.uniforms).wgpu, layer as u64 * STRIDE, size_of::<GpuExtraction>() as u64))
            .with("jobs", Resource::Range(&made(&self.job_lists).wgpu, first, list_bytes(jobs)))
            .with("facing", made(&self.facing))
            .with("counts", self.counts(layer));
        let faces = common.clone().with("caps", made(&self.caps));
        self.face_triangles.dispatch(pass.device, pass.encoder, &frame.shared, &faces, spread(jobs.triangles))?;
        let edges = common.with("edges", edges).with("silhouette", made(&self.silhouette));
        self.extrude_edges.dispatch(pass.device, pass.encoder, &frame.shared, &edges, spread(jobs.edges))
    }

    /// The counts of a light, to be bound.
    pub fn counts(&self, layer: usize) -> Resource<'_> {
        Resource::Range(&made(&self.counts).wgpu, layer as u64 * STRIDE, size_of::<GpuCounts>() as u64)
    }

    /// The polygons of a light, valid until the next light's are extracted.
    pub fn lists(&self, layer: usize) -> Lists<'_> {
        let side_draw = layer as u64 * STRIDE;
        Lists {
            silhouette: made(&self.silhouette),
            caps: made(&self.caps),
            draws: made(&self.counts),
            side_draw,
            cap_draw: side_draw + CAPS,
        }
    }

    /// How many side polygons and volumes with caps each light of the group has.
    pub fn polygons(&self, device: &Device) -> Result<Vec<[u64; 2]>, Error> {
        let words: Vec<u32> = readback::read_buffer(device, &made(&self.counts).wgpu)?;
        let of = |layer: usize| {
            let counts: &GpuCounts = bytemuck::from_bytes(bytemuck::cast_slice(&words[layer * STRIDE as usize / 4..][..12]));
            [counts.side_vertices, counts.cap_vertices].map(|vertices| u64::from(vertices / VERTICES))
        };
        Ok((0..self.jobs.len()).map(of).collect())
    }
}

fn list_bytes(jobs: &Jobs) -> u64 {
    (jobs.list.len().max(1) * size_of::<GpuJob>()) as u64
}

/// As many invocations as there are things, over two dimensions where one is too short.
fn spread(count: u32) -> UVec3 {
    const GROUP: u32 = 64;
    const MOST_GROUPS: u32 = 65_535;
    let groups = count.div_ceil(GROUP);
    UVec3::new(groups.min(MOST_GROUPS) * GROUP, groups.div_ceil(MOST_GROUPS).max(1), 1)
}

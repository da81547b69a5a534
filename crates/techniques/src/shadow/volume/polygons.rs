//! Rasterising the polygons: into the stencil, and into pictures.

use super::Count;
use super::extract::Lists;
use super::{SHARED, buffers};
use crate::{Error, FrameContext, MakeContext};
use bytemuck::{Pod, Zeroable};
use kajo_render_graph::wgpu::{self, BufferUsages};
use kajo_render_graph::{
    Bindings, Buffer, Device, PassContext, PipelineOptions, RenderPipeline, RenderState, Resource, Shader, Texture, readback, slot,
};
use kajo_shader_lib::ShaderLayout;

/// Twin of `Counting` in count.wesl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable, ShaderLayout)]
pub(super) struct GpuCounting {
    light: u32,
    behind: u32,
    padding_a: u32,
    padding_b: u32,
}

/// Fragments that counted, by their place within a square of eight by eight pixels, so that neighbours do not wait for each other. Twin of `fragments` in
/// count.wesl.
pub(super) type GpuTally = [u32; 64];

/// Format of the pictures.
pub(super) const PICTURE: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// Rasterises the polygons.
pub(super) struct Polygons {
    count: Count,
    sides: RenderPipeline,
    caps: RenderPipeline,
    pictures: Pictures,
    uniforms: Option<Buffer>,
    /// [`GpuTally`] of each light.
    tallies: Option<Buffer>,
}

/// Pipelines of the debug views: made with the others, so that a broken one is noticed.
struct Pictures {
    backdrop: RenderPipeline,
    edges: RenderPipeline,
    wires: RenderPipeline,
    tint: RenderPipeline,
}

impl Polygons {
    pub fn new(context: &MakeContext, count: Count) -> Result<Self, Error> {
        let shader = context.shader_with("shadow/volume/count", include_str!("count.wesl"), SHARED)?;
        // Going away from the eye, a side that faces the viewer leads into a volume, one that faces away leads out of it. Before the visible point both are
        // summed, behind it what leads out is left over by the volumes that hold the point.
        let (enter, leave) = match count {
            Count::Before => (wgpu::StencilOperation::IncrementWrap, wgpu::StencilOperation::DecrementWrap),
            Count::Behind => (wgpu::StencilOperation::DecrementWrap, wgpu::StencilOperation::IncrementWrap),
        };
        let face = |operation| wgpu::StencilFaceState {
            compare: wgpu::CompareFunction::Always,
            fail_op: wgpu::StencilOperation::Keep,
            depth_fail_op: wgpu::StencilOperation::Keep,
            pass_op: operation,
        };
        let stencil = wgpu::DepthStencilState {
            format: wgpu::TextureFormat::Stencil8,
            depth_write_enabled: None,
            depth_compare: None,
            stencil: wgpu::StencilState { front: face(enter), back: face(leave), read_mask: 0xff, write_mask: 0xff },
            bias: wgpu::DepthBiasState::default(),
        };
        let most = wgpu::BlendComponent {
            src_factor: wgpu::BlendFactor::One,
            dst_factor: wgpu::BlendFactor::One,
            operation: wgpu::BlendOperation::Max,
        };
        let counting = |vertex, fragment, write_mask| {
            let blend = Some(wgpu::BlendState { color: most, alpha: most });
            let state = RenderState {
                vertex,
                fragment: Some(fragment),
                targets: &[wgpu::ColorTargetState { format: wgpu::TextureFormat::R8Unorm, blend, write_mask }],
                depth: Some(stencil.clone()),
                primitive: wgpu::PrimitiveState::default(),
            };
            pipeline(context, &shader, &state)
        };
        Ok(Self {
            count,
            sides: counting("side", "count", wgpu::ColorWrites::empty())?,
            caps: counting("cap", "count_cap", wgpu::ColorWrites::ALL)?,
            pictures: Pictures::new(context, &shader)?,
            uniforms: None,
            tallies: None,
        })
    }

    pub fn prepare(&mut self, frame: &FrameContext) -> Result<(), Error> {
        let behind = u32::from(self.count == Count::Behind);
        let uniform = |layer| GpuCounting { light: frame.first_light + layer, behind, padding_a: 0, padding_b: 0 };
        let uniforms: Vec<GpuCounting> = (0..frame.lights.len() as u32).map(uniform).collect();
        buffers::upload_uniforms(frame.device, &mut self.uniforms, "shadow/volume counting", &uniforms)?;
        let none = vec![GpuTally::zeroed(); frame.lights.len()];
        let usage = BufferUsages::STORAGE | BufferUsages::COPY_SRC;
        buffers::upload(frame.device, &mut self.tallies, "shadow/volume fragments", bytemuck::cast_slice(&none), usage)
    }

    /// Counts a light's polygons in `stencil`, by the depth in `limit`.
    pub fn count(
        &self,
        frame: &FrameContext,
        layer: usize,
        lists: Lists,
        [limit, stencil, dark]: [&Texture; 3],
        pass: &mut PassContext,
    ) -> Result<(), kajo_render_graph::Error> {
        let tallies = &self.tallies.as_ref().expect("prepared").wgpu;
        let bytes = size_of::<GpuTally>() as u64;
        let common = Bindings::new()
            .with("counting", buffers::uniform::<GpuCounting>(&self.uniforms, layer))
            .with("limit", limit)
            .with("fragments", Resource::Range(tallies, layer as u64 * bytes, bytes));
        let mut render = pass.encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("shadow/volume"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &dark.view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT), store: wgpu::StoreOp::Store },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &stencil.view,
                depth_ops: None,
                stencil_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0), store: wgpu::StoreOp::Store }),
            }),
            ..Default::default()
        });
        self.sides.set(pass.device, &mut render, &frame.shared, &common.clone().with("silhouette", lists.silhouette))?;
        render.draw_indirect(&lists.draws.wgpu, lists.side_draw);
        self.caps.set(pass.device, &mut render, &frame.shared, &common.with("caps", lists.caps))?;
        render.draw_indirect(&lists.draws.wgpu, lists.cap_draw);
        Ok(())
    }

    /// Fragments that counted, of each light of the group.
    pub fn fragments(&self, device: &Device) -> Result<Vec<u64>, Error> {
        let tallies: Vec<u32> = readback::read_buffer(device, &self.tallies.as_ref().expect("prepared").wgpu)?;
        let sum = |tally: &[u32]| tally.iter().map(|&n| u64::from(n)).sum();
        Ok(tallies.chunks_exact(size_of::<GpuTally>() / 4).map(sum).collect())
    }

    /// Draws the scene with a light's silhouettes, and with its volumes.
    pub fn show(
        &self,
        frame: &FrameContext,
        layer: usize,
        lists: Lists,
        [silhouettes, volumes]: [&Texture; 2],
        pass: &mut PassContext,
    ) -> Result<(), kajo_render_graph::Error> {
        let depth = pass.view(slot::DEPTH)?;
        let scene = Bindings::new().with("depth", &depth).with("normal", pass.view(slot::NORMAL)?);
        let polygons = Bindings::new()
            .with("counting", buffers::uniform::<GpuCounting>(&self.uniforms, layer))
            .with("silhouette", lists.silhouette)
            .with("depth", &depth);
        let pictures = &self.pictures;
        for (texture, pipelines) in
            [(silhouettes, &[&pictures.edges][..]), (volumes, &[&pictures.tint, &pictures.wires, &pictures.edges][..])]
        {
            let view = texture.layer(layer as u32);
            let mut render = pass.encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("shadow/volume debug"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &view,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store: wgpu::StoreOp::Store },
                })],
                ..Default::default()
            });
            pictures.backdrop.set(pass.device, &mut render, &frame.shared, &scene)?;
            render.draw(0..3, 0..1);
            for pipeline in pipelines {
                pipeline.set(pass.device, &mut render, &frame.shared, &polygons)?;
                render.draw_indirect(&lists.draws.wgpu, lists.side_draw);
            }
        }
        Ok(())
    }
}

impl Pictures {
    fn new(context: &MakeContext, shader: &Shader) -> Result<Self, Error> {
        let target =
            wgpu::ColorTargetState { format: PICTURE, blend: Some(wgpu::BlendState::ALPHA_BLENDING), write_mask: wgpu::ColorWrites::ALL };
        let make = |vertex, fragment, topology| {
            let primitive = wgpu::PrimitiveState { topology, ..Default::default() };
            let targets = std::slice::from_ref(&target);
            pipeline(context, shader, &RenderState { vertex, fragment: Some(fragment), targets, depth: None, primitive })
        };
        let (lines, triangles) = (wgpu::PrimitiveTopology::LineList, wgpu::PrimitiveTopology::TriangleList);
        Ok(Self {
            backdrop: make("whole_image", "backdrop", triangles)?,
            edges: make("edge_line", "bright_line", lines)?,
            wires: make("wire", "faint_line", lines)?,
            tint: make("side", "tint", triangles)?,
        })
    }
}

fn pipeline(context: &MakeContext, shader: &Shader, state: &RenderState) -> Result<RenderPipeline, Error> {
    let options = PipelineOptions { list_length: context.textures, ..Default::default() };
    Ok(RenderPipeline::new(context.device, shader, state, options)?)
}

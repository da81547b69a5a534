//! Shadow maps.

mod fit;
#[cfg(test)]
mod tests;

use crate::{Coverage, Draw, Effect, Error, FrameContext, MakeContext, Needs, Role, Technique};
use fit::{Projection, fit};
use kajo_params::{ParamValues, Params};
use kajo_render_graph::wgpu::{self, BufferUsages};
use kajo_render_graph::{
    Access, Bindings, Buffer, ComputePipeline, Graph, PassContext, PipelineOptions, RenderPipeline, RenderState, Resource, Texture, slot,
};
use kajo_units::Meters;

/// The technique.
pub const TECHNIQUE: Technique = Technique {
    id: "shadow/map",
    role: Role::DirectVisibility,
    title: "Shadow maps",
    doc: include_str!("doc.md"),
    cites: &["Williams78", "Reeves87"],
    reads: &[slot::DEPTH, slot::NORMAL, slot::IDS],
    needs: Needs::NONE,
    params: Params::SPEC,
    make: |context, values| Ok(Box::new(ShadowMap::new(context, values)?)),
};

/// Its parameters.
#[derive(Params, Clone, Copy, Debug)]
pub struct Params {
    /// Side of a map; a cube has six of them.
    #[param(default = 2048, range = 16..=8192, unit = "px")]
    pub resolution: u32,
    /// Half the side of the filter: 0 compares one texel, k averages (2k + 1)² comparisons.
    #[param(default = 1, range = 0..=8)]
    pub kernel: u32,
    /// Bias from the size of a texel and the angle of incidence; off, the three biases below are used.
    #[param(default = true)]
    pub automatic_bias: bool,
    /// Shift towards the light.
    #[param(default = 0.005, range = 0.0..=1.0, unit = "m")]
    pub constant_bias: Meters,
    /// Shift towards the light, in texels, times the tangent of the angle of incidence.
    #[param(default = 1.5, range = 0.0..=32.0)]
    pub slope_bias: f32,
    /// Shift along the normal, in texels, times the sine of the angle between the normal and the axis of the map.
    #[param(default = 0.0, range = 0.0..=32.0)]
    pub normal_offset: f32,
}

/// What the look-up reads.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable, kajo_shader_lib::ShaderLayout)]
struct GpuMap {
    clip_from_relative: [[[f32; 4]; 4]; 6],
    light: u32,
    layer: u32,
    faces: u32,
    parallel: u32,
    texel: f32,
    kernel: i32,
    constant_bias: f32,
    slope_bias: f32,
    normal_offset: f32,
    padding_a: u32,
    padding_b: u32,
    padding_c: u32,
}

/// Distance between the uniforms of two lights: a multiple of every device's offset alignment.
const STRIDE: u64 = 512;
/// Distance between the uniforms of two faces.
const FACE_STRIDE: u64 = 256;
/// Faces of a cube.
const FACES: u64 = 6;

struct ShadowMap {
    params: Params,
    opaque: RenderPipeline,
    covered: RenderPipeline,
    look_up: ComputePipeline,
    compare: wgpu::Sampler,
    /// One light's faces; lights use it one after the other.
    depth: Option<Texture>,
    maps: Option<Buffer>,
    faces: Option<Buffer>,
    projections: Vec<Projection>,
}

impl ShadowMap {
    fn new(context: &MakeContext, values: &ParamValues) -> Result<Self, Error> {
        let device = context.device;
        let cast = context.shader("shadow/map/cast", include_str!("cast.wesl"))?;
        let look_up = context.shader("shadow/map/look_up", include_str!("look_up.wesl"))?;
        let options = PipelineOptions { list_length: context.textures, ..Default::default() };
        let depth = wgpu::DepthStencilState {
            format: wgpu::TextureFormat::Depth32Float,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Greater),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        };
        let pipeline = |vertex, fragment| {
            let state =
                RenderState { vertex, fragment, targets: &[], depth: Some(depth.clone()), primitive: wgpu::PrimitiveState::default() };
            RenderPipeline::new(device, &cast, &state, options)
        };
        Ok(Self {
            params: Params::from_values(values),
            opaque: pipeline("opaque", None)?,
            covered: pipeline("covered", Some("covered_fragment"))?,
            look_up: ComputePipeline::new(device, &look_up, "look_up", options)?,
            compare: device.wgpu.create_sampler(&wgpu::SamplerDescriptor {
                label: Some("shadow/map"),
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                compare: Some(wgpu::CompareFunction::GreaterEqual),
                ..Default::default()
            }),
            depth: None,
            maps: None,
            faces: None,
            projections: Vec::new(),
        })
    }

    fn gpu_map(&self, frame: &FrameContext, layer: usize, projection: &Projection) -> GpuMap {
        let p = &self.params;
        let automatic = std::f32::consts::SQRT_2 * (p.kernel as f32 + 1.25);
        let (constant_bias, slope_bias, normal_offset) =
            if p.automatic_bias { (0.0, 0.0, automatic) } else { (p.constant_bias.0, p.slope_bias, p.normal_offset) };
        let mut clip_from_relative = [[[0.0; 4]; 4]; 6];
        for (to, from) in clip_from_relative.iter_mut().zip(&projection.clip_from_relative) {
            *to = from.to_cols_array_2d();
        }
        GpuMap {
            clip_from_relative,
            light: frame.first_light + layer as u32,
            layer: layer as u32,
            faces: projection.clip_from_relative.len() as u32,
            parallel: u32::from(projection.parallel),
            texel: projection.texel,
            kernel: p.kernel as i32,
            constant_bias,
            slope_bias,
            normal_offset,
            padding_a: 0,
            padding_b: 0,
            padding_c: 0,
        }
    }

    fn cast(&self, frame: &FrameContext, layer: usize, pass: &mut PassContext) -> Result<(), kajo_render_graph::Error> {
        let (depth, faces) = (self.depth.as_ref().expect("prepared"), self.faces.as_ref().expect("prepared"));
        for face in 0..self.projections[layer].clip_from_relative.len() {
            let view = depth.layer(face as u32);
            let offset = (layer as u64 * FACES + face as u64) * FACE_STRIDE;
            let own = Bindings::new().with("face", Resource::Range(&faces.wgpu, offset, 64));
            let mut render = pass.encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("shadow/map/cast"),
                depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                    view: &view,
                    depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Store }),
                    stencil_ops: None,
                }),
                ..Default::default()
            });
            // A lamp stands around its own centre, and must not block what it shines at.
            let casts = |draw: &Draw| !frame.lights[layer].is(draw.instance);
            self.opaque.set(pass.device, &mut render, &frame.shared, &own)?;
            frame.draw(&mut render, |draw| casts(draw) && draw.coverage == Coverage::Opaque);
            if frame.draws.iter().any(|draw| casts(draw) && draw.coverage != Coverage::Opaque) {
                self.covered.set(pass.device, &mut render, &frame.shared, &own)?;
                frame.draw(&mut render, |draw| casts(draw) && draw.coverage != Coverage::Opaque);
            }
        }
        Ok(())
    }

    fn look_up(&self, frame: &FrameContext, layer: usize, pass: &mut PassContext) -> Result<(), kajo_render_graph::Error> {
        let (depth, maps) = (self.depth.as_ref().expect("prepared"), self.maps.as_ref().expect("prepared"));
        let own = Bindings::new()
            .with("map", Resource::Range(&maps.wgpu, layer as u64 * STRIDE, size_of::<GpuMap>() as u64))
            .with("depth", pass.view(slot::DEPTH)?)
            .with("normal", pass.view(slot::NORMAL)?)
            .with("light_depth", depth.array())
            .with("compare", &self.compare)
            .with("ids", pass.view(slot::IDS)?)
            .with("visibility", pass.view(slot::SHADOW_VISIBILITY)?);
        self.look_up.dispatch(pass.device, pass.encoder, &frame.shared, &own, frame.size().extend(1))
    }
}

impl Effect for ShadowMap {
    fn prepare(&mut self, frame: &FrameContext) -> Result<(), Error> {
        let device = frame.device;
        let resolution = self.params.resolution.min(device.info().max_image_side);
        self.projections = frame.lights.iter().map(|light| fit(light, frame, resolution, self.params.kernel)).collect();
        let layers = self.projections.iter().map(|projection| projection.clip_from_relative.len() as u32).max().unwrap_or(1);
        if self.depth.as_ref().is_none_or(|depth| depth.wgpu.depth_or_array_layers() < layers) {
            self.depth = Some(device.texture(&wgpu::TextureDescriptor {
                label: Some("shadow/map"),
                size: wgpu::Extent3d { width: resolution, height: resolution, depth_or_array_layers: layers },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: wgpu::TextureFormat::Depth32Float,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_SRC,
                view_formats: &[],
            }));
        }
        let count = frame.lights.len() as u64;
        let mut maps = vec![0u8; (count * STRIDE) as usize];
        let mut faces = vec![0u8; (count * FACES * FACE_STRIDE) as usize];
        for (layer, projection) in self.projections.iter().enumerate() {
            let map = self.gpu_map(frame, layer, projection);
            maps[layer * STRIDE as usize..][..size_of::<GpuMap>()].copy_from_slice(bytemuck::bytes_of(&map));
            for (face, clip_from_relative) in projection.clip_from_relative.iter().enumerate() {
                let at = (layer as u64 * FACES + face as u64) * FACE_STRIDE;
                faces[at as usize..][..64].copy_from_slice(bytemuck::bytes_of(&clip_from_relative.to_cols_array()));
            }
        }
        upload(device, &mut self.maps, "shadow/map maps", &maps)?;
        upload(device, &mut self.faces, "shadow/map faces", &faces)?;
        Ok(())
    }

    fn record<'a>(&'a self, frame: &'a FrameContext<'a>, graph: &mut Graph<'a>) {
        for layer in 0..frame.lights.len() {
            // The map is made anew for each light, so cast and look-up take turns: each updates what the one before left.
            let turn = |name: &str| {
                let access = Access::new(name).reads(TECHNIQUE.reads);
                if layer == 0 && name.ends_with("cast") {
                    access.writes(&[slot::SHADOW_VISIBILITY])
                } else {
                    access.updates(&[slot::SHADOW_VISIBILITY])
                }
            };
            graph.pass(turn("shadow/map/cast"), move |pass| self.cast(frame, layer, pass));
            graph.pass(turn("shadow/map/look-up"), move |pass| self.look_up(frame, layer, pass));
        }
    }
}

/// Writes `bytes` into a uniform buffer, a new one where the old is too small.
fn upload(device: &kajo_render_graph::Device, buffer: &mut Option<Buffer>, label: &str, bytes: &[u8]) -> Result<(), Error> {
    if buffer.as_ref().is_none_or(|buffer| buffer.bytes() < bytes.len() as u64) {
        *buffer = Some(device.buffer(label, bytes.len() as u64, BufferUsages::UNIFORM | BufferUsages::COPY_DST)?);
    }
    if let Some(buffer) = buffer {
        buffer.write(&device.queue, bytes);
    }
    Ok(())
}

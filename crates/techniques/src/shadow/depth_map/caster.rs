//! Draws the depth of everything that casts shadows.

use super::projection::MAX_FAR;
use crate::{Coverage, Draw, Error, FrameContext, FrameLight, MakeContext};
use glam::Mat4;
use kajo_params::ParamChoice;
use kajo_render_graph::wgpu;
use kajo_render_graph::{Bindings, Device, PassContext, PipelineOptions, RenderPipeline, RenderState, Texture};

/// What depth means in maps with perspective; parallel maps are linear by nature.
#[derive(ParamChoice, Clone, Copy, Debug, PartialEq, Eq)]
pub enum DepthLayout {
    /// near / distance, as rasterisers have it.
    Perspective,
    /// 1 − distance / far: fragments write it.
    Linear,
}

/// How depth is stored.
#[derive(ParamChoice, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    /// 24 bits and an exponent.
    Float32,
    /// 65 535 equal steps.
    Unorm16,
}

impl Precision {
    fn format(self) -> wgpu::TextureFormat {
        match self {
            Self::Float32 => wgpu::TextureFormat::Depth32Float,
            Self::Unorm16 => wgpu::TextureFormat::Depth16Unorm,
        }
    }

    /// What a stored depth may be too great by, beyond the rounding of single precision.
    pub(super) fn quantum(self) -> f32 {
        match self {
            Self::Float32 => 0.0,
            Self::Unorm16 => 1.0 / 65535.0,
        }
    }
}

/// `DEPTH_…` in depth_map.wesl.
pub(super) fn depth_kind(layout: DepthLayout, parallel: bool) -> u32 {
    match (parallel, layout) {
        (false, DepthLayout::Perspective) => 0,
        (true, _) => 1,
        (false, DepthLayout::Linear) => 2,
    }
}

/// Bytes of [`face_bytes`].
pub(super) const FACE_BYTES: u64 = size_of::<GpuFace>() as u64;

/// Twin of `Face` in cast.wesl.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable, kajo_shader_lib::ShaderLayout)]
pub(super) struct GpuFace {
    clip_from_relative: [[f32; 4]; 4],
    far: f32,
    padding_a: u32,
    padding_b: u32,
    padding_c: u32,
}

/// What drawing one face reads.
pub(super) fn face_bytes(clip_from_relative: Mat4, far: f32) -> Vec<u8> {
    let clip_from_relative = clip_from_relative.to_cols_array_2d();
    bytemuck::bytes_of(&GpuFace { clip_from_relative, far: far.min(MAX_FAR), padding_a: 0, padding_b: 0, padding_c: 0 }).to_vec()
}

/// The pipelines and the texture they draw into: as many layers as one light has maps.
pub(super) struct Caster {
    precision: Precision,
    opaque: RenderPipeline,
    covered: RenderPipeline,
    /// For parallel maps, whose depth is linear as it is.
    plain: Option<[RenderPipeline; 2]>,
    depth: Option<Texture>,
}

impl Caster {
    pub fn new(context: &MakeContext, layout: DepthLayout, precision: Precision) -> Result<Self, Error> {
        let shader = context.shader("shadow/depth-map/cast", include_str!("cast.wesl"))?;
        let options = PipelineOptions { list_length: context.textures, ..Default::default() };
        let depth = wgpu::DepthStencilState {
            format: precision.format(),
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Greater),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        };
        let pipeline = |vertex, fragment| {
            let state =
                RenderState { vertex, fragment, targets: &[], depth: Some(depth.clone()), primitive: wgpu::PrimitiveState::default() };
            RenderPipeline::new(context.device, &shader, &state, options)
        };
        let perspective = || Ok::<_, Error>([pipeline("opaque", None)?, pipeline("covered", Some("covered_fragment"))?]);
        let ([opaque, covered], plain) = match layout {
            DepthLayout::Perspective => (perspective()?, None),
            DepthLayout::Linear => {
                let linear = [pipeline("opaque", Some("linear_fragment"))?, pipeline("covered", Some("covered_linear_fragment"))?];
                (linear, Some(perspective()?))
            }
        };
        Ok(Self { precision, opaque, covered, plain, depth: None })
    }

    /// Makes the texture, a new one where the old has too few layers.
    pub fn prepare(&mut self, device: &Device, resolution: u32, layers: u32) {
        if self.depth.as_ref().is_some_and(|depth| depth.wgpu.depth_or_array_layers() >= layers) {
            return;
        }
        self.depth = Some(device.texture(&wgpu::TextureDescriptor {
            label: Some("shadow/depth-map"),
            size: wgpu::Extent3d { width: resolution, height: resolution, depth_or_array_layers: layers },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: self.precision.format(),
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        }));
    }

    /// The texture.
    pub fn depth(&self) -> &Texture {
        self.depth.as_ref().expect("prepared")
    }

    /// Draws one face of a light.
    pub fn draw(
        &self,
        frame: &FrameContext,
        light: &FrameLight,
        (face, parallel): (u32, bool),
        own: &Bindings,
        pass: &mut PassContext,
    ) -> Result<(), kajo_render_graph::Error> {
        let view = self.depth().layer(face);
        let mut render = pass.encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("shadow/depth-map/cast"),
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &view,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Store }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        let [opaque, covered] = match &self.plain {
            Some([opaque, covered]) if parallel => [opaque, covered],
            _ => [&self.opaque, &self.covered],
        };
        // A lamp stands around its own centre, and must not block what it shines at.
        let casts = |draw: &Draw| !light.is(draw.instance);
        opaque.set(pass.device, &mut render, &frame.shared, own)?;
        frame.draw(&mut render, |draw| casts(draw) && draw.coverage == Coverage::Opaque);
        if frame.draws.iter().any(|draw| casts(draw) && draw.coverage != Coverage::Opaque) {
            covered.set(pass.device, &mut render, &frame.shared, own)?;
            frame.draw(&mut render, |draw| casts(draw) && draw.coverage != Coverage::Opaque);
        }
        Ok(())
    }
}

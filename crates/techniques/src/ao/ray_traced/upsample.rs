//! From one pixel of each 2 × 2 to all of them, along surfaces.    \[Kopf07]

use super::READS;
use crate::{Error, FrameContext, MakeContext};
use glam::UVec2;
use kajo_render_graph::wgpu;
use kajo_render_graph::{Access, Bindings, ComputePipeline, Graph, PipelineOptions, Slot, Texture, slot};

/// The image of the traced pixels, and the pass that fills in the others.
pub(super) struct Upsample {
    pipeline: ComputePipeline,
    half: Option<Texture>,
}

impl Upsample {
    /// # Errors
    /// When the device refuses.
    pub fn new(context: &MakeContext) -> Result<Self, Error> {
        let shader = context.shader("ao/ray-traced/upsample", include_str!("upsample.wesl"))?;
        let options = PipelineOptions { list_length: context.textures, ..Default::default() };
        Ok(Self { pipeline: ComputePipeline::new(context.device, &shader, "fill_in", options)?, half: None })
    }

    /// Makes or resizes the image.
    pub fn prepare(&mut self, frame: &FrameContext) {
        let UVec2 { x: width, y: height } = (frame.size() + 1) / 2;
        let size = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
        if self.half.as_ref().is_none_or(|half| half.wgpu.size() != size) {
            self.half = Some(frame.device.texture(&wgpu::TextureDescriptor {
                label: Some("ao/ray-traced half"),
                size,
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: wgpu::TextureFormat::R32Float,
                usage: wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::TEXTURE_BINDING,
                view_formats: &[],
            }));
        }
    }

    fn half(&self) -> &Texture {
        self.half.as_ref().expect("prepared")
    }

    /// Size of the image, px.
    pub fn size(&self) -> UVec2 {
        let size = self.half().wgpu.size();
        UVec2::new(size.width, size.height)
    }

    /// What the trace writes.
    pub fn target(&self) -> wgpu::TextureView {
        self.half().view.clone()
    }

    /// Adds the pass that writes `target`.
    pub fn record<'a>(&'a self, frame: &'a FrameContext<'a>, graph: &mut Graph<'a>, target: Slot) {
        graph.pass(Access::new("ao/ray-traced/upsample").reads(READS).updates(&[target]), move |pass| {
            let own = Bindings::new()
                .with("depth", pass.view(slot::DEPTH)?)
                .with("normal", pass.view(slot::NORMAL)?)
                .with("traced", self.target())
                .with("visibility", pass.view(target)?);
            self.pipeline.dispatch(pass.device, pass.encoder, &frame.shared, &own, frame.size().extend(1))
        });
    }
}

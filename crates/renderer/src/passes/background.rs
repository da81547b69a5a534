//! The environment, and the lights that are seen themselves.

use super::{Setup, TRIANGLES, attachment};
use kajo_render_graph::{Access, Bindings, Device, Error, Graph, PipelineOptions, RenderPipeline, RenderState, Texture, slot, wgpu};
use kajo_scene::{ColorSpace, Environment};
use kajo_techniques::FrameContext;

pub(crate) struct Background {
    pipeline: RenderPipeline,
    image: Texture,
    sampler: wgpu::Sampler,
}

impl Background {
    pub fn new(setup: Setup, environment: Option<&Environment>) -> Result<Self, Error> {
        let shader = setup.shader("passes/background", include_str!("background.wesl"))?;
        let state = RenderState {
            vertex: "vertex",
            fragment: Some("fragment"),
            targets: &[wgpu::ColorTargetState::from(slot::BACKGROUND.format)],
            depth: None,
            primitive: TRIANGLES,
        };
        let options = PipelineOptions { list_length: setup.textures, ..Default::default() };
        Ok(Self {
            pipeline: RenderPipeline::new(setup.device, &shader, &state, options)?,
            image: upload(setup.device, environment)?,
            sampler: setup.device.wgpu.create_sampler(&wgpu::SamplerDescriptor {
                label: Some("environment"),
                address_mode_u: wgpu::AddressMode::Repeat,
                address_mode_v: wgpu::AddressMode::ClampToEdge,
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                ..Default::default()
            }),
        })
    }

    pub fn record<'a>(&'a self, frame: &'a FrameContext<'a>, graph: &mut Graph<'a>) {
        graph.pass(Access::new("background").reads(&[slot::DEPTH]).writes(&[slot::BACKGROUND]), move |pass| {
            let target = pass.view(slot::BACKGROUND)?;
            let own = Bindings::new()
                .with("depth", pass.view(slot::DEPTH)?)
                .with("environment", &self.image)
                .with("environment_sampler", &self.sampler);
            let mut render = pass.encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("background"),
                color_attachments: &[attachment(&target, true)],
                ..Default::default()
            });
            self.pipeline.set(pass.device, &mut render, &frame.shared, &own)?;
            render.draw(0..3, 0..1);
            Ok(())
        });
    }
}

/// The image of an environment in half floats; one black texel where there is none.
fn upload(device: &Device, environment: Option<&Environment>) -> Result<Texture, Error> {
    let image = environment.and_then(|environment| environment.image.as_deref());
    let size = image.map_or(glam::UVec2::ONE, |image| glam::UVec2::new(image.width, image.height));
    device.check_size(size)?;
    let texture = device.texture(&wgpu::TextureDescriptor {
        label: Some("environment"),
        size: wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba16Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let Some(image) = image else { return Ok(texture) };
    let texels: Vec<u16> = (0..size.y)
        .flat_map(|y| (0..size.x).map(move |x| (x, y)))
        .flat_map(|(x, y)| image.texel(x, y, ColorSpace::Linear).to_array().map(|c| half::f16::from_f32(c.clamp(0.0, 65504.0)).to_bits()))
        .collect();
    device.queue.write_texture(
        texture.wgpu.as_image_copy(),
        bytemuck::cast_slice(&texels),
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(size.x * 8), rows_per_image: None },
        texture.wgpu.size(),
    );
    Ok(texture)
}

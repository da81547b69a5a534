//! Screen-space reflections by a march along pixels.

#[cfg(test)]
mod tests;

use super::surfaces::{self, READS_LIT};
use crate::{DebugPixels, DebugView, Effect, Error, FrameContext, MakeContext, Needs, Role, Statistic, Technique};
use kajo_image::Image;
use kajo_params::{ParamChoice, ParamValues, Params};
use kajo_render_graph::wgpu::{self, BufferUsages};
use kajo_render_graph::{Access, Buffer, ComputePipeline, Graph, PipelineOptions, Texture, readback, slot};

/// The technique.
pub const TECHNIQUE: Technique = Technique {
    id: "reflection/ssr-dda",
    role: Role::SpecularIndirect,
    title: "Screen-space reflections, march along pixels",
    doc: include_str!("doc.md"),
    cites: &["Sousa11", "McGuire14", "Heitz18"],
    reads: READS_LIT,
    needs: Needs::NONE,
    params: Params::SPEC,
    make: |context, values| Ok(Box::new(SsrDda::new(context, values)?)),
};

/// What rays see that find nothing in the picture.
#[derive(ParamChoice, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fallback {
    /// Black.
    None,
    /// The environment, as if nothing stood in the way.
    Environment,
}

/// Its parameters.
#[derive(Params, Clone, Copy, Debug)]
pub struct Params {
    /// Rays of each pixel, drawn from the specular lobes.
    #[param(default = 1, range = 1..=256)]
    pub samples: u32,
    /// Steps of a ray, at most.
    #[param(default = 512, range = 1..=8192)]
    pub steps: u32,
    /// Length of a step. Longer ones reach farther and pass over what is narrower.
    #[param(default = 1.0, range = 1.0..=64.0, unit = "px")]
    pub stride: f32,
    /// Share of a step by which rays of neighbouring pixels start apart: stairs become grain.
    #[param(default = 1.0, range = 0.0..=1.0)]
    pub jitter: f32,
    /// Halvings of the step that found a surface.
    #[param(default = 4, range = 0..=16)]
    pub bisections: u32,
    /// How thick everything is taken to be, along the viewing axis. Too thin, and rays pass through; too thick, and they meet what they pass behind.
    #[param(default = 0.1, range = 0.0..=100.0, unit = "m")]
    pub thickness: f32,
    /// Longest ray.
    #[param(default = 50.0, range = 0.01..=10000.0, unit = "m")]
    pub reach: f32,
    /// Rougher surfaces reflect nothing.
    #[param(default = 0.6, range = 0.0..=1.0)]
    pub max_roughness: f32,
    /// What rays see that find nothing.
    #[param(default = Fallback::Environment)]
    pub fallback: Fallback,
}

/// What the shader reads.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable, kajo_shader_lib::ShaderLayout)]
struct GpuParams {
    samples: u32,
    steps: u32,
    bisections: u32,
    environment: u32,
    stride: f32,
    jitter: f32,
    thickness: f32,
    reach: f32,
    max_roughness: f32,
    padding_a: u32,
    padding_b: u32,
    padding_c: u32,
}

struct SsrDda {
    params: Params,
    pipeline: ComputePipeline,
    uniform: Buffer,
    /// Rays, and those that found nothing.
    counts: Buffer,
    missed: Option<Texture>,
}

impl SsrDda {
    fn new(context: &MakeContext, values: &ParamValues) -> Result<Self, Error> {
        let device = context.device;
        let params = Params::from_values(values);
        let shader = context.shader(TECHNIQUE.id, include_str!("ssr_dda.wesl"))?;
        let options = PipelineOptions { list_length: context.textures, ..Default::default() };
        let uniform = GpuParams {
            samples: params.samples,
            steps: params.steps,
            bisections: params.bisections,
            environment: u32::from(params.fallback == Fallback::Environment),
            stride: params.stride,
            jitter: params.jitter,
            thickness: params.thickness,
            reach: params.reach,
            max_roughness: params.max_roughness,
            padding_a: 0,
            padding_b: 0,
            padding_c: 0,
        };
        Ok(Self {
            params,
            pipeline: ComputePipeline::new(device, &shader, "march_reflections", options)?,
            uniform: device.buffer_with(TECHNIQUE.id, &[uniform], BufferUsages::UNIFORM)?,
            counts: device.buffer("reflection/ssr-dda rays", 8, BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST)?,
            missed: None,
        })
    }
}

impl Effect for SsrDda {
    fn prepare(&mut self, frame: &FrameContext) -> Result<(), Error> {
        self.counts.write(&frame.device.queue, bytemuck::bytes_of(&[0u32; 2]));
        let size = frame.size();
        let size = wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: 1 };
        if self.missed.as_ref().is_none_or(|missed| missed.wgpu.size() != size) {
            self.missed = Some(frame.device.texture(&wgpu::TextureDescriptor {
                label: Some("reflection/ssr-dda missed"),
                size,
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: wgpu::TextureFormat::R32Float,
                usage: wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::COPY_SRC,
                view_formats: &[],
            }));
        }
        Ok(())
    }

    fn record<'a>(&'a self, frame: &'a FrameContext<'a>, graph: &mut Graph<'a>) {
        graph.pass(Access::new(TECHNIQUE.id).reads(READS_LIT).writes(&[slot::SPECULAR_INDIRECT]), move |pass| {
            let own = surfaces::bind(pass)?
                .with("params", &self.uniform)
                .with("lit", pass.view(slot::LIT)?)
                .with("reflected", pass.view(slot::SPECULAR_INDIRECT)?)
                .with("missed", self.missed.as_ref().expect("prepared").view.clone())
                .with("counts", &self.counts);
            self.pipeline.dispatch(pass.device, pass.encoder, &frame.shared, &own, frame.size().extend(1))
        });
    }

    fn mirrors_up_to(&self) -> Option<f32> {
        Some(self.params.max_roughness)
    }

    fn statistics(&self, frame: &FrameContext) -> Result<Vec<Statistic>, Error> {
        let counts: Vec<u32> = readback::read_buffer(frame.device, &self.counts.wgpu)?;
        let of = |name, value: u32| Statistic { name, light: Statistic::NO_LIGHT, value: value.into() };
        Ok(vec![of("reflection-rays", counts[0]), of("reflection-misses", counts[1])])
    }

    fn debug_views(&self, frame: &FrameContext) -> Result<Vec<DebugView>, Error> {
        let texels: Vec<f32> = readback::read_texture(frame.device, &self.missed.as_ref().expect("prepared").wgpu, 0)?;
        let pixels = DebugPixels::Scalar(Image::from_pixels(frame.size(), texels));
        Ok(vec![DebugView { name: "reflection-misses", light: Statistic::NO_LIGHT, pixels }])
    }
}

//! Temporal anti-aliasing.

use super::{History, halton_jitter};
use crate::{Effect, Error, FrameContext, MakeContext, Needs, Role, Technique};
use glam::Vec2;
use kajo_params::{ParamChoice, ParamValues, Params};
use kajo_render_graph::wgpu::{self, BufferUsages, TextureFormat};
use kajo_render_graph::{Access, Bindings, Buffer, Graph, PipelineOptions, RenderPipeline, RenderState, Texture, slot};

/// The technique.
pub const TECHNIQUE: Technique = Technique {
    id: "aa/taa",
    role: Role::AntiAlias,
    title: "Temporal anti-aliasing",
    doc: include_str!("doc.md"),
    cites: &["Yang20", "Karis14", "Salvi16", "Malvar03", "Catmull74", "Halton64"],
    reads: &[slot::COLOR, slot::DEPTH, slot::MOTION, slot::EMISSION],
    needs: Needs::NONE,
    params: Params::SPEC,
    make: |context, values| Ok(Box::new(Taa::new(context, values)?)),
};

/// How history that the new frame contradicts is found out.
#[derive(ParamChoice, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rejection {
    /// It is not: old colours fade.
    None,
    /// By the least and the greatest colour of the 3 × 3 pixels around.
    MinMax,
    /// By their mean and standard deviation.
    Variance,
}

/// What samples weigh.
#[derive(ParamChoice, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weights {
    /// All alike: the mean of radiance.
    Even,
    /// Bright ones less, by 1 / (1 + exposed luminance): smoother edges of lamps, darker than the mean.
    Display,
}

/// Its parameters.
#[derive(Params, Clone, Copy, Debug)]
pub struct Params {
    /// Least share of the newest frame. Smaller is smoother, and slower to follow.
    #[param(default = 0.1, range = 0.005..=1.0)]
    pub alpha: f32,
    /// What is done about colours that the new frame contradicts.
    #[param(default = Rejection::Variance)]
    pub rejection: Rejection,
    /// Half the width of the box that history is clipped to, in standard deviations. Smaller leaves fewer ghosts, and takes from smooth edges.
    #[param(default = 1.25, range = 0.0..=8.0)]
    pub gamma: f32,
    /// Relative difference of depth at which history shows another surface.
    #[param(default = 0.02, range = 0.0..=1.0)]
    pub depth_tolerance: f32,
    /// What samples weigh.
    #[param(default = Weights::Even)]
    pub weights: Weights,
    /// Points of the jitter.
    #[param(default = 16, range = 1..=1024)]
    pub jitter: u32,
}

/// What the shader reads.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable, kajo_shader_lib::ShaderLayout)]
struct GpuParams {
    alpha: f32,
    gamma: f32,
    depth_tolerance: f32,
    exposure: f32,
    rejection: u32,
    follows: u32,
    _padding: [u32; 2],
}

/// Images of the history: colour with the number of frames in it, even depth.
const FORMATS: [TextureFormat; 2] = [TextureFormat::Rgba32Float, TextureFormat::R32Float];

struct Taa {
    params: Params,
    pipeline: RenderPipeline,
    uniform: Buffer,
    history: History,
}

impl Taa {
    fn new(context: &MakeContext, values: &ParamValues) -> Result<Self, Error> {
        let shader = context.shader(TECHNIQUE.id, include_str!("taa.wesl"))?;
        let options = PipelineOptions { list_length: context.textures, ..Default::default() };
        let state = RenderState {
            vertex: "vertex",
            fragment: Some("resolve"),
            targets: &FORMATS.map(wgpu::ColorTargetState::from),
            depth: None,
            primitive: wgpu::PrimitiveState::default(),
        };
        let usage = BufferUsages::UNIFORM | BufferUsages::COPY_DST;
        Ok(Self {
            params: Params::from_values(values),
            pipeline: RenderPipeline::new(context.device, &shader, &state, options)?,
            uniform: context.device.buffer(TECHNIQUE.id, size_of::<GpuParams>() as u64, usage)?,
            history: History::new(&FORMATS),
        })
    }
}

impl Effect for Taa {
    fn prepare(&mut self, frame: &FrameContext) -> Result<(), Error> {
        let Params { alpha, rejection, gamma, depth_tolerance, weights, .. } = self.params;
        let params = GpuParams {
            alpha,
            gamma,
            depth_tolerance,
            exposure: if weights == Weights::Display { frame.exposure.exp2() } else { 0.0 },
            rejection: rejection as u32,
            follows: u32::from(self.history.begin(frame)),
            _padding: [0; 2],
        };
        self.uniform.write(&frame.device.queue, bytemuck::bytes_of(&params));
        Ok(())
    }

    fn record<'a>(&'a self, frame: &'a FrameContext<'a>, graph: &mut Graph<'a>) {
        graph.pass(Access::new(TECHNIQUE.id).reads(TECHNIQUE.reads).writes(&[slot::RESOLVED]), move |pass| {
            let ([colors, depths], [new_colors, new_depths]) = (self.history.before(), self.history.after()) else {
                unreachable!("prepared: two images a set")
            };
            let own = Bindings::new()
                .with("params", &self.uniform)
                .with("color", pass.view(slot::COLOR)?)
                .with("depth", pass.view(slot::DEPTH)?)
                .with("motion", pass.view(slot::MOTION)?)
                .with("emission", pass.view(slot::EMISSION)?)
                .with("color_before", colors)
                .with("depth_before", depths);
            let mut render = pass.encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some(TECHNIQUE.id),
                color_attachments: &[attachment(new_colors), attachment(new_depths)],
                ..Default::default()
            });
            self.pipeline.set(pass.device, &mut render, &frame.shared, &own)?;
            render.draw(0..3, 0..1);
            drop(render);
            let resolved = pass.texture(slot::RESOLVED)?.wgpu.clone();
            pass.encoder.copy_texture_to_texture(new_colors.wgpu.as_image_copy(), resolved.as_image_copy(), resolved.size());
            Ok(())
        });
    }

    fn jitter(&self, index: u32) -> Vec2 {
        halton_jitter(index, self.params.jitter)
    }

    /// Until the first frame weighs a twentieth: (1 − α)ⁿ ≤ 0.05.
    fn history(&self) -> u32 {
        if self.params.alpha < 1.0 { (0.05f32.ln() / (1.0 - self.params.alpha).ln()).ceil() as u32 } else { 1 }
    }
}

/// The whole image is written anew.
fn attachment(target: &Texture) -> Option<wgpu::RenderPassColorAttachment<'_>> {
    let ops = wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT), store: wgpu::StoreOp::Store };
    Some(wgpu::RenderPassColorAttachment { view: &target.view, depth_slice: None, resolve_target: None, ops })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{TraceBackend, shaders};

    #[test]
    fn the_uniform_is_laid_out_as_the_shader_reads_it() {
        let variant = shaders::Variant::without_models(TraceBackend::Compute, true);
        let source = include_str!("taa.wesl");
        shaders::link(TECHNIQUE.id, source, variant).unwrap().check_layout::<GpuParams>("Params").unwrap();
        for (name, value) in [("MIN_MAX", Rejection::MinMax), ("VARIANCE", Rejection::Variance)] {
            assert!(source.contains(&format!("const {name} = {}u;", value as u32)), "{name}");
        }
    }
}

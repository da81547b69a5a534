//! Temporal anti-aliasing.

use super::{History, halton_jitter};
use crate::{Effect, Error, FrameContext, MakeContext, Needs, Role, Technique};
use glam::Vec2;
use kajo_params::{ParamChoice, ParamValues, Params};
use kajo_render_graph::wgpu::{self, BufferUsages};
use kajo_render_graph::{Access, Bindings, Buffer, Graph, PipelineOptions, RenderPipeline, RenderState, slot};

/// The technique.
pub const TECHNIQUE: Technique = Technique {
    id: "aa/taa",
    role: Role::AntiAlias,
    title: "Temporal anti-aliasing",
    doc: include_str!("doc.md"),
    cites: &["Yang20", "Karis14", "Salvi16", "Malvar03", "Catmull74", "Jimenez16a", "Halton64"],
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
    follows: u32,
    _padding: [u32; 3],
}

struct Taa {
    params: Params,
    pipeline: RenderPipeline,
    uniform: Buffer,
    history: History,
}

impl Taa {
    fn new(context: &MakeContext, values: &ParamValues) -> Result<Self, Error> {
        let shader = context.shader(TECHNIQUE.id, include_str!("taa.wesl"))?;
        let params = Params::from_values(values);
        let constants = [("REJECTION", f64::from(params.rejection as u32))];
        let options = PipelineOptions { constants: &constants, list_length: context.textures };
        let state = RenderState {
            vertex: "vertex",
            fragment: Some("resolve"),
            targets: &[slot::RESOLVED.format.into()],
            depth: None,
            primitive: wgpu::PrimitiveState::default(),
        };
        let usage = BufferUsages::UNIFORM | BufferUsages::COPY_DST;
        Ok(Self {
            params,
            pipeline: RenderPipeline::new(context.device, &shader, &state, options)?,
            uniform: context.device.buffer(TECHNIQUE.id, size_of::<GpuParams>() as u64, usage)?,
            history: History::default(),
        })
    }
}

impl Effect for Taa {
    fn prepare(&mut self, frame: &FrameContext) -> Result<(), Error> {
        let Params { alpha, gamma, depth_tolerance, weights, .. } = self.params;
        let params = GpuParams {
            alpha,
            gamma,
            depth_tolerance,
            exposure: if weights == Weights::Display { frame.exposure.exp2() } else { 0.0 },
            follows: u32::from(self.history.begin(frame)),
            _padding: [0; 3],
        };
        self.uniform.write(&frame.device.queue, bytemuck::bytes_of(&params));
        Ok(())
    }

    fn record<'a>(&'a self, frame: &'a FrameContext<'a>, graph: &mut Graph<'a>) {
        graph.lend(slot::RESOLVED, self.history.after().clone());
        graph.pass(Access::new(TECHNIQUE.id).reads(TECHNIQUE.reads).writes(&[slot::RESOLVED]), move |pass| {
            let own = Bindings::new()
                .with("params", &self.uniform)
                .with("color", pass.view(slot::COLOR)?)
                .with("depth", pass.view(slot::DEPTH)?)
                .with("motion", pass.view(slot::MOTION)?)
                .with("emission", pass.view(slot::EMISSION)?)
                .with("before", &**self.history.before());
            // Every pixel is written: there is nothing to clear.
            let ops = wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store };
            let view = &pass.view(slot::RESOLVED)?;
            let mut render = pass.encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some(TECHNIQUE.id),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment { view, depth_slice: None, resolve_target: None, ops })],
                ..Default::default()
            });
            self.pipeline.set(pass.device, &mut render, &frame.shared, &own)?;
            render.draw(0..3, 0..1);
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

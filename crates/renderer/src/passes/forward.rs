//! Surfaces that are lit as they are drawn: blended ones, from far to near, over the picture; opaque ones when a check asks for it.

use super::{Setup, TRIANGLES, attachment, depth_state};
use kajo_render_graph::wgpu::{self, BufferUsages};
use kajo_render_graph::{Access, Bindings, Buffer, Error, Graph, PassContext, PipelineOptions, RenderPipeline, RenderState, Slot, slot};
use kajo_shader_lib::ShaderLayout;
use kajo_techniques::{Coverage, FrameContext};

/// Coverage times the surface plus the rest times what lies behind.
const OVER: wgpu::BlendState = wgpu::BlendState {
    color: wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::SrcAlpha,
        dst_factor: wgpu::BlendFactor::OneMinusSrcAlpha,
        operation: wgpu::BlendOperation::Add,
    },
    alpha: wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::Zero,
        dst_factor: wgpu::BlendFactor::One,
        operation: wgpu::BlendOperation::Add,
    },
};

/// Twin of `Params` in forward.wesl.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable, ShaderLayout)]
struct GpuParams {
    samples: u32,
    blended: u32,
    mirrored: f32,
    padding: u32,
}

pub(crate) struct Forward {
    samples: u32,
    blended: RenderPipeline,
    opaque: RenderPipeline,
    blended_params: Buffer,
    opaque_params: Buffer,
}

fn params(samples: u32, blended: bool, mirrored: Option<f32>) -> GpuParams {
    GpuParams { samples, blended: u32::from(blended), mirrored: mirrored.unwrap_or(-1.0), padding: 0 }
}

impl Forward {
    /// `samples` of the unshadowed integral over lights with an extent.
    pub fn new(setup: Setup, samples: u32) -> Result<Self, Error> {
        let shader = setup.shader("passes/forward", include_str!("forward.wesl"))?;
        let options = PipelineOptions { list_length: setup.textures, ..Default::default() };
        let pipeline = |blend, slot: Slot, compare| {
            let target = wgpu::ColorTargetState { blend, ..wgpu::ColorTargetState::from(slot.format) };
            let state = RenderState {
                vertex: "vertex",
                fragment: Some("fragment"),
                targets: &[target],
                depth: Some(wgpu::DepthStencilState { depth_compare: Some(compare), ..depth_state(false) }),
                primitive: TRIANGLES,
            };
            RenderPipeline::new(setup.device, &shader, &state, options)
        };
        Ok(Self {
            blended: pipeline(Some(OVER), slot::COLOR, wgpu::CompareFunction::Greater)?,
            opaque: pipeline(None, slot::DIRECT, wgpu::CompareFunction::Equal)?,
            blended_params: setup.device.buffer_with("forward", &[params(samples, true, None)], BufferUsages::UNIFORM)?,
            opaque_params: setup.device.buffer("forward", size_of::<GpuParams>() as u64, BufferUsages::UNIFORM | BufferUsages::COPY_DST)?,
            samples,
        })
    }

    /// Before the opaque surfaces of a frame: those up to the roughness `mirrored` get no highlights of emissive meshes.
    pub fn prepare_opaque(&self, frame: &FrameContext, mirrored: Option<f32>) {
        self.opaque_params.write(&frame.device.queue, bytemuck::bytes_of(&params(self.samples, false, mirrored)));
    }

    /// Lights every visible opaque surface again, in place of the deferred light; shows nothing but what the G-buffer's pass saw.
    /// `seen`: for each instance, whether it is drawn.
    pub fn record_opaque<'a>(&'a self, frame: &'a FrameContext<'a>, seen: &'a [bool], graph: &mut Graph<'a>) {
        graph.pass(Access::new("forward/opaque").reads(&[slot::DEPTH]).updates(&[slot::DIRECT]), move |pass| {
            let wanted = |draw: usize| frame.draws[draw].coverage == Coverage::Opaque && seen[draw];
            let draws: Vec<usize> = (0..frame.draws.len()).filter(|&draw| wanted(draw)).collect();
            self.draw(frame, pass, (&self.opaque, &self.opaque_params), slot::DIRECT, &draws)
        });
    }

    /// `order`: indices of the blended draws, farthest first.
    pub fn record_blended<'a>(&'a self, frame: &'a FrameContext<'a>, order: &'a [usize], graph: &mut Graph<'a>) {
        graph.pass(Access::new("forward/blended").reads(&[slot::DEPTH]).updates(&[slot::COLOR]), move |pass| {
            self.draw(frame, pass, (&self.blended, &self.blended_params), slot::COLOR, order)
        });
    }

    fn draw(
        &self,
        frame: &FrameContext,
        pass: &mut PassContext,
        (pipeline, params): (&RenderPipeline, &Buffer),
        target: Slot,
        draws: &[usize],
    ) -> Result<(), Error> {
        let (target, depth) = (pass.view(target)?, pass.view(slot::DEPTH)?);
        let mut render = pass.encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("forward"),
            color_attachments: &[attachment(&target, false)],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &depth,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pipeline.set(pass.device, &mut render, &frame.shared, &Bindings::new().with("params", params))?;
        for &index in draws {
            frame.draw(&mut render, |draw| std::ptr::eq(draw, &frame.draws[index]));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_techniques::{TraceBackend, shaders};

    #[test]
    fn the_uniform_is_laid_out_as_the_shader_reads_it() {
        let linked =
            shaders::link("passes/forward", include_str!("forward.wesl"), shaders::Variant::without_models(TraceBackend::Compute, true))
                .unwrap();
        linked.check_layout::<GpuParams>("Params").unwrap();
    }
}

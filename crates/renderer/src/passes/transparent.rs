//! Blended surfaces: lit as they are drawn, from far to near, over the picture.

use super::{Setup, TRIANGLES, attachment, depth_state};
use kajo_render_graph::wgpu::{self, BufferUsages};
use kajo_render_graph::{Access, Bindings, Buffer, Error, Graph, PipelineOptions, RenderPipeline, RenderState, slot};
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

pub(crate) struct Transparent {
    pipeline: RenderPipeline,
    params: Buffer,
}

impl Transparent {
    /// `samples` of the unshadowed integral over lights with an extent.
    pub fn new(setup: Setup, samples: u32) -> Result<Self, Error> {
        let shader = setup.shader("passes/forward", include_str!("forward.wesl"))?;
        let target = wgpu::ColorTargetState { blend: Some(OVER), ..wgpu::ColorTargetState::from(slot::COLOR.format) };
        let state = RenderState {
            vertex: "vertex",
            fragment: Some("fragment"),
            targets: &[target],
            depth: Some(depth_state(false)),
            primitive: TRIANGLES,
        };
        let options = PipelineOptions { list_length: setup.textures, ..Default::default() };
        Ok(Self {
            pipeline: RenderPipeline::new(setup.device, &shader, &state, options)?,
            params: setup.device.buffer_with("forward", &[samples, 0, 0, 0], BufferUsages::UNIFORM)?,
        })
    }

    /// `order`: indices of the blended draws, farthest first.
    pub fn record<'a>(&'a self, frame: &'a FrameContext<'a>, order: &'a [usize], graph: &mut Graph<'a>) {
        graph.pass(Access::new("transparent").reads(&[slot::DEPTH]).updates(&[slot::COLOR]), move |pass| {
            let (color, depth) = (pass.view(slot::COLOR)?, pass.view(slot::DEPTH)?);
            let mut render = pass.encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("transparent"),
                color_attachments: &[attachment(&color, false)],
                depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                    view: &depth,
                    depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store }),
                    stencil_ops: None,
                }),
                ..Default::default()
            });
            self.pipeline.set(pass.device, &mut render, &frame.shared, &Bindings::new().with("params", &self.params))?;
            for &index in order {
                debug_assert_eq!(frame.draws[index].coverage, Coverage::Blend);
                frame.draw(&mut render, |draw| std::ptr::eq(draw, &frame.draws[index]));
            }
            Ok(())
        });
    }
}

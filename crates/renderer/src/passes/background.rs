//! The environment, and the lights that are seen themselves.

use super::{Setup, TRIANGLES, attachment};
use kajo_render_graph::{Access, Bindings, Error, Graph, PipelineOptions, RenderPipeline, RenderState, slot, wgpu};
use kajo_techniques::FrameContext;

pub(crate) struct Background {
    pipeline: RenderPipeline,
}

impl Background {
    pub fn new(setup: Setup) -> Result<Self, Error> {
        let shader = setup.shader("passes/background", include_str!("background.wesl"))?;
        let state = RenderState {
            vertex: "vertex",
            fragment: Some("fragment"),
            targets: &[wgpu::ColorTargetState::from(slot::BACKGROUND.format)],
            depth: None,
            primitive: TRIANGLES,
        };
        let options = PipelineOptions { list_length: setup.textures, ..Default::default() };
        Ok(Self { pipeline: RenderPipeline::new(setup.device, &shader, &state, options)? })
    }

    pub fn record<'a>(&'a self, frame: &'a FrameContext<'a>, graph: &mut Graph<'a>) {
        graph.pass(Access::new("background").reads(&[slot::DEPTH]).writes(&[slot::BACKGROUND]), move |pass| {
            let target = pass.view(slot::BACKGROUND)?;
            let own = Bindings::new().with("depth", pass.view(slot::DEPTH)?);
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

//! No shadows.

use crate::{Effect, Error, FrameContext, Needs, Role, Technique};
use kajo_render_graph::wgpu;
use kajo_render_graph::{Access, Graph, slot};

/// The technique.
pub const TECHNIQUE: Technique = Technique {
    id: "shadow/none",
    role: Role::DirectVisibility,
    title: "No shadows",
    doc: include_str!("doc.md"),
    cites: &[],
    reads: &[],
    needs: Needs::NONE,
    params: &[],
    make: |_, _| Ok(Box::new(None)),
};

struct None;

impl Effect for None {
    fn prepare(&mut self, _: &FrameContext) -> Result<(), Error> {
        Ok(())
    }

    fn record<'a>(&'a self, frame: &'a FrameContext<'a>, graph: &mut Graph<'a>) {
        let lights = frame.lights.len() as u32;
        graph.pass(Access::new("shadow/none").writes(&[slot::SHADOW_VISIBILITY]), move |pass| {
            for layer in 0..lights {
                let view = pass.texture(slot::SHADOW_VISIBILITY)?.layer(layer);
                pass.encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                    label: Some("shadow/none"),
                    color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                        view: &view,
                        depth_slice: Option::None,
                        resolve_target: Option::None,
                        ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::WHITE), store: wgpu::StoreOp::Store },
                    })],
                    ..Default::default()
                });
            }
            Ok(())
        });
    }
}

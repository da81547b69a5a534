//! No ambient occlusion.

use crate::{Effect, Error, FrameContext, Needs, Role, Technique};
use kajo_render_graph::wgpu;
use kajo_render_graph::{Access, Graph, slot};

/// The technique.
pub const TECHNIQUE: Technique = Technique {
    id: "ao/none",
    role: Role::AmbientVisibility,
    title: "No ambient occlusion",
    doc: include_str!("doc.md"),
    cites: &[],
    reads: &[],
    needs: Needs::NONE,
    params: &[],
    make: |_, _| Ok(Box::new(Open)),
};

struct Open;

impl Effect for Open {
    fn prepare(&mut self, _frame: &FrameContext) -> Result<(), Error> {
        Ok(())
    }

    fn record<'a>(&'a self, _frame: &'a FrameContext<'a>, graph: &mut Graph<'a>) {
        graph.pass(Access::new("ao/none").writes(&[slot::AMBIENT_VISIBILITY]), |pass| {
            let view = pass.view(slot::AMBIENT_VISIBILITY)?;
            let ops = wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::WHITE), store: wgpu::StoreOp::Store };
            pass.encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("ao/none"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment { view: &view, depth_slice: None, resolve_target: None, ops })],
                ..Default::default()
            });
            Ok(())
        });
    }
}

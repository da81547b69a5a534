//! No ambient occlusion.

use crate::{Effect, Error, FrameContext, Needs, Role, Technique};
use kajo_render_graph::{Graph, slot, wgpu};

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
        graph.clear("ao/none", slot::AMBIENT_VISIBILITY, wgpu::Color::WHITE);
    }
}

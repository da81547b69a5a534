//! Surfaces mirror nothing but lights.

use crate::{Effect, Error, FrameContext, Needs, Role, Technique};
use kajo_render_graph::{Graph, slot, wgpu};

/// The technique.
pub const TECHNIQUE: Technique = Technique {
    id: "reflection/none",
    role: Role::SpecularIndirect,
    title: "No reflections",
    doc: include_str!("doc.md"),
    cites: &[],
    reads: &[],
    needs: Needs::NONE,
    params: &[],
    make: |_, _| Ok(Box::new(Nothing)),
};

struct Nothing;

impl Effect for Nothing {
    fn prepare(&mut self, _frame: &FrameContext) -> Result<(), Error> {
        Ok(())
    }

    fn record<'a>(&'a self, _frame: &'a FrameContext<'a>, graph: &mut Graph<'a>) {
        graph.clear("reflection/none", slot::SPECULAR_INDIRECT, wgpu::Color::TRANSPARENT);
    }
}

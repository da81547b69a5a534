//! No anti-aliasing.

use crate::{Effect, Error, FrameContext, Needs, Role, Technique};
use kajo_render_graph::{Access, Graph, slot};

/// The technique.
pub const TECHNIQUE: Technique = Technique {
    id: "aa/none",
    role: Role::AntiAlias,
    title: "No anti-aliasing",
    doc: include_str!("doc.md"),
    cites: &[],
    reads: &[slot::COLOR],
    needs: Needs::NONE,
    params: &[],
    make: |_, _| Ok(Box::new(NoAntiAliasing)),
};

struct NoAntiAliasing;

impl Effect for NoAntiAliasing {
    fn prepare(&mut self, _: &FrameContext) -> Result<(), Error> {
        Ok(())
    }

    fn record<'a>(&'a self, _: &'a FrameContext<'a>, graph: &mut Graph<'a>) {
        graph.pass(Access::new("aa/none").reads(TECHNIQUE.reads).writes(&[slot::RESOLVED]), |pass| {
            let [from, to] = [pass.texture(slot::COLOR)?.wgpu.clone(), pass.texture(slot::RESOLVED)?.wgpu.clone()];
            pass.encoder.copy_texture_to_texture(from.as_image_copy(), to.as_image_copy(), to.size());
            Ok(())
        });
    }
}

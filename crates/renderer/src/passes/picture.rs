//! The sum of everything before exposure.

use super::Setup;
use kajo_render_graph::{Access, Bindings, ComputePipeline, Error, Graph, PipelineOptions, slot};
use kajo_techniques::FrameContext;

pub(crate) struct Picture {
    pipeline: ComputePipeline,
}

impl Picture {
    pub fn new(setup: Setup) -> Result<Self, Error> {
        let shader = setup.shader("passes/picture", include_str!("picture.wesl"))?;
        let options = PipelineOptions { list_length: setup.textures, ..Default::default() };
        Ok(Self { pipeline: ComputePipeline::new(setup.device, &shader, "add", options)? })
    }

    pub fn record<'a>(&'a self, frame: &'a FrameContext<'a>, graph: &mut Graph<'a>) {
        let reads = [slot::LIT, slot::SPECULAR_INDIRECT];
        graph.pass(Access::new("picture").reads(&reads).writes(&[slot::COLOR]), move |pass| {
            let own = Bindings::new()
                .with("lit", pass.view(slot::LIT)?)
                .with("specular_indirect", pass.view(slot::SPECULAR_INDIRECT)?)
                .with("color", pass.view(slot::COLOR)?);
            self.pipeline.dispatch(pass.device, pass.encoder, &frame.shared, &own, frame.size().extend(1))
        });
    }
}

//! The picture without reflections.

use super::Setup;
use kajo_render_graph::{Access, Bindings, ComputePipeline, Error, Graph, PipelineOptions, Slot, slot};
use kajo_techniques::FrameContext;

/// What it reads, each bound by its name.
const READS: [Slot; 11] = [
    slot::DEPTH,
    slot::NORMAL,
    slot::ALBEDO,
    slot::F0_ROUGHNESS,
    slot::LAYERS,
    slot::IDS,
    slot::EMISSION,
    slot::DIRECT,
    slot::BACKGROUND,
    slot::DIFFUSE_INDIRECT,
    slot::AMBIENT_VISIBILITY,
];

pub(crate) struct Lit {
    pipeline: ComputePipeline,
}

impl Lit {
    pub fn new(setup: Setup) -> Result<Self, Error> {
        let shader = setup.shader("passes/lit", include_str!("lit.wesl"))?;
        let options = PipelineOptions { list_length: setup.textures, ..Default::default() };
        Ok(Self { pipeline: ComputePipeline::new(setup.device, &shader, "add", options)? })
    }

    pub fn record<'a>(&'a self, frame: &'a FrameContext<'a>, graph: &mut Graph<'a>) {
        graph.pass(Access::new("lit").reads(&READS).writes(&[slot::LIT]), move |pass| {
            let mut own = Bindings::new().with("lit", pass.view(slot::LIT)?);
            for slot in READS {
                own = own.with(slot.name, pass.view(slot)?);
            }
            self.pipeline.dispatch(pass.device, pass.encoder, &frame.shared, &own, frame.size().extend(1))
        });
    }
}

//! The G-buffer.

use super::{Setup, TRIANGLES, attachment, depth_state};
use kajo_render_graph::{Access, Bindings, Error, Graph, PipelineOptions, RenderPipeline, RenderState, Slot, slot, wgpu};
use kajo_techniques::{Coverage, Draw, FrameContext};

/// Slots it makes, in the order of the shader's outputs.
pub(crate) const TARGETS: [Slot; 7] =
    [slot::NORMAL, slot::ALBEDO, slot::F0_ROUGHNESS, slot::LAYERS, slot::EMISSION, slot::MOTION, slot::IDS];

pub(crate) struct GBuffer {
    opaque: RenderPipeline,
    masked: RenderPipeline,
}

impl GBuffer {
    pub fn new(setup: Setup) -> Result<Self, Error> {
        let shader = setup.shader("passes/gbuffer", include_str!("gbuffer.wesl"))?;
        let targets = TARGETS.map(|slot| wgpu::ColorTargetState::from(slot.format));
        let pipeline = |fragment| {
            let state = RenderState {
                vertex: "vertex",
                fragment: Some(fragment),
                targets: &targets,
                depth: Some(depth_state(true)),
                primitive: TRIANGLES,
            };
            RenderPipeline::new(setup.device, &shader, &state, PipelineOptions { list_length: setup.textures, ..Default::default() })
        };
        Ok(Self { opaque: pipeline("opaque")?, masked: pipeline("masked")? })
    }

    /// `seen`: for each instance, whether it is drawn.
    pub fn record<'a>(&'a self, frame: &'a FrameContext<'a>, seen: &'a [bool], graph: &mut Graph<'a>) {
        graph.pass(Access::new("gbuffer").writes(&TARGETS).writes(&[slot::DEPTH]), move |pass| {
            let depth = pass.view(slot::DEPTH)?;
            let views = TARGETS.iter().map(|slot| pass.view(*slot)).collect::<Result<Vec<_>, _>>()?;
            let attachments: Vec<_> = views.iter().map(|view| attachment(view, true)).collect();
            let mut render = pass.encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("gbuffer"),
                color_attachments: &attachments,
                depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                    view: &depth,
                    depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Store }),
                    stencil_ops: None,
                }),
                ..Default::default()
            });
            for (pipeline, coverage) in [(&self.opaque, Coverage::Opaque), (&self.masked, Coverage::Mask)] {
                let wanted = |draw: &Draw| draw.coverage == coverage && seen[draw.instance as usize];
                if frame.draws.iter().any(wanted) {
                    pipeline.set(pass.device, &mut render, &frame.shared, &Bindings::new())?;
                    frame.draw(&mut render, wanted);
                }
            }
            Ok(())
        });
    }
}

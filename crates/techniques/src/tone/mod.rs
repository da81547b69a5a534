//! Techniques of the role tone map: exposure, then a curve from radiance to display values, then the sRGB encoding.

pub mod aces;
pub mod agx;
pub mod linear;
pub mod pbr_neutral;

use crate::{Effect, Error, FrameContext, MakeContext, Technique};
use kajo_render_graph::wgpu::BufferUsages;
use kajo_render_graph::{Access, Bindings, Buffer, ComputePipeline, Graph, PipelineOptions, Slot, slot};

/// In the order of every list.
pub const ALL: &[&Technique] = &[&agx::TECHNIQUE, &pbr_neutral::TECHNIQUE, &aces::TECHNIQUE, &linear::TECHNIQUE];

/// What every curve reads.
const READS: &[Slot] = &[slot::RESOLVED];

/// Numbers of the curves, as in `shader_lib::tone_map`.
#[derive(Clone, Copy, Debug)]
enum Curve {
    Linear = 0,
    Aces = 1,
    Agx = 2,
    PbrNeutral = 3,
}

/// A curve at work.
struct ToneMap {
    id: &'static str,
    curve: Curve,
    pipeline: ComputePipeline,
    params: Buffer,
}

/// What the shader reads.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable, kajo_shader_lib::ShaderLayout)]
struct GpuParams {
    stops: f32,
    curve: u32,
    _padding: [u32; 2],
}

impl ToneMap {
    fn make(context: &MakeContext, id: &'static str, curve: Curve) -> Result<Box<dyn Effect>, Error> {
        let shader = context.shader("tone/tone_map", include_str!("tone_map.wesl"))?;
        let options = PipelineOptions { list_length: context.textures, ..Default::default() };
        Ok(Box::new(Self {
            id,
            curve,
            pipeline: ComputePipeline::new(context.device, &shader, "map_tones", options)?,
            params: context.device.buffer("tone map", size_of::<GpuParams>() as u64, BufferUsages::UNIFORM | BufferUsages::COPY_DST)?,
        }))
    }
}

impl Effect for ToneMap {
    fn prepare(&mut self, frame: &FrameContext) -> Result<(), Error> {
        let params = GpuParams { stops: frame.exposure, curve: self.curve as u32, _padding: [0; 2] };
        self.params.write(&frame.device.queue, bytemuck::bytes_of(&params));
        Ok(())
    }

    fn record<'a>(&'a self, frame: &'a FrameContext<'a>, graph: &mut Graph<'a>) {
        graph.pass(Access::new(self.id).reads(READS).writes(&[slot::DISPLAY]), move |pass| {
            let own = Bindings::new()
                .with("params", &self.params)
                .with("color", pass.view(slot::RESOLVED)?)
                .with("display", pass.view(slot::DISPLAY)?);
            self.pipeline.dispatch(pass.device, pass.encoder, &Bindings::new(), &own, frame.size().extend(1))
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{TraceBackend, shaders};

    #[test]
    fn the_uniform_is_laid_out_as_the_shader_reads_it() {
        let linked =
            shaders::link("tone/tone_map", include_str!("tone_map.wesl"), shaders::Variant::without_models(TraceBackend::Compute, true))
                .unwrap();
        linked.check_layout::<GpuParams>("Params").unwrap();
    }

    #[test]
    fn curves_have_the_numbers_of_the_library() {
        let source = kajo_shader_lib::module("tone_map").unwrap().source;
        for (name, curve) in [("LINEAR", Curve::Linear), ("ACES", Curve::Aces), ("AGX", Curve::Agx), ("PBR_NEUTRAL", Curve::PbrNeutral)] {
            assert!(source.contains(&format!("const {name} = {}u;", curve as u32)), "{name}");
        }
    }
}

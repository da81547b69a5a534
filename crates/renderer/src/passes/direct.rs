//! Direct light: for each group of lights, what the visibility technique found times unshadowed light.

use super::Setup;
use kajo_render_graph::wgpu::{self, BufferUsages};
use kajo_render_graph::{Access, Bindings, Buffer, ComputePipeline, Device, Error, Graph, PipelineOptions, readback, slot};
use kajo_shader_lib::ShaderLayout;
use kajo_techniques::FrameContext;

/// Twin of `Params` in direct.wesl.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable, ShaderLayout)]
struct GpuParams {
    first_light: u32,
    light_count: u32,
    samples: u32,
    mirrored: f32,
}

pub(crate) struct Direct {
    pipeline: ComputePipeline,
    params: Buffer,
    shaded: Buffer,
    samples: u32,
}

impl Direct {
    /// `samples` of the unshadowed integral over lights with an extent.
    pub fn new(setup: Setup, samples: u32) -> Result<Self, Error> {
        let shader = setup.shader("passes/direct", include_str!("direct.wesl"))?;
        let options = PipelineOptions { list_length: setup.textures, ..Default::default() };
        let device = setup.device;
        Ok(Self {
            pipeline: ComputePipeline::new(device, &shader, "light_pixels", options)?,
            params: device.buffer("direct", size_of::<GpuParams>() as u64, BufferUsages::UNIFORM | BufferUsages::COPY_DST)?,
            shaded: device.buffer_with("direct shaded", &[0u32], BufferUsages::STORAGE | BufferUsages::COPY_SRC)?,
            samples,
        })
    }

    /// Before the first group of lights of a frame.
    pub fn record_clear(graph: &mut Graph) {
        graph.clear("direct/clear", slot::DIRECT, wgpu::Color::TRANSPARENT);
    }

    /// Uploads what changes with the group of lights. Surfaces up to the roughness `mirrored` get no highlights of emissive meshes.
    pub fn prepare(&self, frame: &FrameContext, mirrored: Option<f32>) {
        let params = GpuParams {
            first_light: frame.first_light,
            light_count: frame.lights.len() as u32,
            samples: self.samples,
            mirrored: mirrored.unwrap_or(-1.0),
        };
        self.params.write(&frame.device.queue, bytemuck::bytes_of(&params));
        if frame.first_light == 0 {
            self.shaded.write(&frame.device.queue, bytemuck::bytes_of(&0u32));
        }
    }

    pub fn record<'a>(&'a self, frame: &'a FrameContext<'a>, graph: &mut Graph<'a>) {
        let reads = [slot::DEPTH, slot::NORMAL, slot::ALBEDO, slot::F0_ROUGHNESS, slot::LAYERS, slot::IDS, slot::SHADOW_VISIBILITY];
        let access = Access::new("direct/light").reads(&reads).writes(&[slot::DIRECT_BEFORE]).updates(&[slot::DIRECT]);
        graph.pass(access, move |pass| {
            let before = pass.texture(slot::DIRECT_BEFORE)?.wgpu.clone();
            let direct = pass.texture(slot::DIRECT)?.wgpu.clone();
            pass.encoder.copy_texture_to_texture(direct.as_image_copy(), before.as_image_copy(), direct.size());
            let own = Bindings::new()
                .with("params", &self.params)
                .with("depth", pass.view(slot::DEPTH)?)
                .with("normal", pass.view(slot::NORMAL)?)
                .with("albedo", pass.view(slot::ALBEDO)?)
                .with("f0_roughness", pass.view(slot::F0_ROUGHNESS)?)
                .with("layers", pass.view(slot::LAYERS)?)
                .with("ids", pass.view(slot::IDS)?)
                .with("visibility", pass.view(slot::SHADOW_VISIBILITY)?)
                .with("direct_before", pass.view(slot::DIRECT_BEFORE)?)
                .with("direct", pass.view(slot::DIRECT)?)
                .with("shaded", &self.shaded);
            self.pipeline.dispatch(pass.device, pass.encoder, &frame.shared, &own, frame.size().extend(1))
        });
    }

    /// Pixels shaded by the groups of lights of the last frame, together.
    pub fn shaded(&self, device: &Device) -> Result<u32, Error> {
        Ok(readback::read_buffer::<u32>(device, &self.shaded.wgpu)?[0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_techniques::{TraceBackend, shaders};

    #[test]
    fn the_uniform_is_laid_out_as_the_shader_reads_it() {
        let linked =
            shaders::link("passes/direct", include_str!("direct.wesl"), shaders::Variant::without_models(TraceBackend::Compute, true))
                .unwrap();
        linked.check_layout::<GpuParams>("Params").unwrap();
    }
}

//! Shadow maps that can be filtered: each texel holds moments of depth, and a bound on the share of nearer depths answers a look-up.
//!
//! The techniques `shadow/vsm`, `shadow/evsm` and `shadow/msm` differ in two functions of the module `package::moment_method`: `moments_of` a depth, and
//! `lit_share` of a point among filtered moments. Everything else is here.

use super::depth_map::{DepthMaps, Settings, fit};
use crate::{DebugView, Effect, Error, FrameContext, MakeContext};
use kajo_render_graph::wgpu::{self, BufferUsages};
use kajo_render_graph::{Buffer, ComputePipeline, Graph, PassContext, PipelineOptions, Resource, Texture};
use kajo_shader_lib::SourceFile;

/// Numbers that a method takes; which is which, its own `.wesl` says.
pub(super) type Constants = [f32; 4];

/// What the passes read.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable, kajo_shader_lib::ShaderLayout)]
pub(super) struct GpuParams {
    constants: [f32; 4],
    step: [i32; 2],
    radius: i32,
    padding: u32,
}

/// Distance between the uniforms of two passes.
const STRIDE: u64 = 256;

/// Passes after the casters were drawn.
const STEPS: &[&str] = &["moments", "filter-x", "filter-y", "look-up"];

/// A technique at work.
pub(super) struct MomentMaps {
    maps: DepthMaps,
    convert: ComputePipeline,
    filter: ComputePipeline,
    look_up: ComputePipeline,
    params: Buffer,
    /// The filter reads one and writes the other.
    moments: [Option<Texture>; 2],
}

/// What a technique brings.
pub(super) struct Method {
    /// Its id.
    pub id: &'static str,
    /// `package::moment_method`.
    pub source: &'static str,
    /// What that reads.
    pub constants: Constants,
}

impl MomentMaps {
    /// Maps of `resolution` px, filtered over 2 `radius` + 1 texels a side.
    ///
    /// # Errors
    /// When the device refuses.
    pub fn new(context: &MakeContext, method: &Method, resolution: u32, radius: u32) -> Result<Self, Error> {
        let files = [SourceFile { name: "moment_method", source: method.source }];
        let shader = context.shader_with(method.id, include_str!("moments.wesl"), &files)?;
        let options = PipelineOptions { list_length: context.textures, ..Default::default() };
        let pipeline = |entry| ComputePipeline::new(context.device, &shader, entry, options);
        let mut bytes = vec![0u8; 2 * STRIDE as usize];
        for (i, step) in [[1, 0], [0, 1]].into_iter().enumerate() {
            let params = GpuParams { constants: method.constants, step, radius: radius as i32, padding: 0 };
            bytes[i * STRIDE as usize..][..size_of::<GpuParams>()].copy_from_slice(bytemuck::bytes_of(&params));
        }
        // The four texels around a point are read; the rest of the filter is in their moments.
        let settings = Settings::new(resolution, 1.0);
        Ok(Self {
            maps: DepthMaps::new(context, method.id, Settings { border: radius as f32, ..settings })?,
            convert: pipeline("convert")?,
            filter: pipeline("filter_moments")?,
            look_up: pipeline("look_up")?,
            params: context.device.buffer_with(method.id, &bytes, BufferUsages::UNIFORM)?,
            moments: [None, None],
        })
    }

    fn params(&self, pass: u64) -> Resource<'_> {
        Resource::Range(&self.params.wgpu, pass * STRIDE, size_of::<GpuParams>() as u64)
    }

    fn step(&self, name: &str, layer: usize, frame: &FrameContext, pass: &mut PassContext) -> Result<(), kajo_render_graph::Error> {
        let [a, b] = self.moments.each_ref().map(|texture| texture.as_ref().expect("prepared"));
        let everywhere = glam::UVec2::splat(self.maps.resolution()).extend(self.maps.faces(layer) as u32);
        let filter = |turn: u64, source: &Texture, made: &Texture| {
            let own = self.maps.map_bindings(layer).without("light_depth");
            own.with("params", self.params(turn)).with("source", source.array()).with("made", made.array())
        };
        match name {
            "moments" => {
                let own = self.maps.map_bindings(layer).with("params", self.params(0)).with("made", a.array());
                self.convert.dispatch(pass.device, pass.encoder, &frame.shared, &own, everywhere)
            }
            "filter-x" => self.filter.dispatch(pass.device, pass.encoder, &frame.shared, &filter(0, a, b), everywhere),
            "filter-y" => self.filter.dispatch(pass.device, pass.encoder, &frame.shared, &filter(1, b, a), everywhere),
            _ => {
                let own = self.maps.receiver_bindings(layer, pass)?.with("params", self.params(0)).with("source", a.array());
                self.look_up.dispatch(pass.device, pass.encoder, &frame.shared, &own, frame.size().extend(1))
            }
        }
    }
}

impl Effect for MomentMaps {
    fn prepare(&mut self, frame: &FrameContext) -> Result<(), Error> {
        self.maps.prepare(frame, &fit)?;
        let resolution = self.maps.resolution();
        let layers = (0..frame.lights.len()).map(|layer| self.maps.faces(layer) as u32).max().unwrap_or(1);
        for texture in &mut self.moments {
            if texture.as_ref().is_none_or(|texture| texture.wgpu.depth_or_array_layers() < layers) {
                *texture = Some(frame.device.texture(&wgpu::TextureDescriptor {
                    label: Some("shadow moments"),
                    size: wgpu::Extent3d { width: resolution, height: resolution, depth_or_array_layers: layers },
                    mip_level_count: 1,
                    sample_count: 1,
                    dimension: wgpu::TextureDimension::D2,
                    format: wgpu::TextureFormat::Rgba32Float,
                    usage: wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::TEXTURE_BINDING,
                    view_formats: &[],
                }));
            }
        }
        Ok(())
    }

    fn record<'a>(&'a self, frame: &'a FrameContext<'a>, graph: &mut Graph<'a>) {
        self.maps.record(frame, graph, STEPS, move |name, layer, pass| self.step(name, layer, frame, pass));
    }

    fn debug_views(&self, frame: &FrameContext) -> Result<Vec<DebugView>, Error> {
        self.maps.debug_views(frame)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{TraceBackend, shaders};

    #[test]
    fn the_uniform_is_laid_out_as_the_shader_reads_it() {
        let variant = shaders::Variant::without_models(TraceBackend::Compute, true);
        let files = [SourceFile { name: "moment_method", source: include_str!("../vsm/vsm.wesl") }];
        let linked = shaders::link_with_files("moments", include_str!("moments.wesl"), &files, variant).unwrap();
        linked.check_layout::<GpuParams>("Params").unwrap();
    }
}

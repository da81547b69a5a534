//! Soft shadows: the mean of hard ones for many points of a light.

mod points;
#[cfg(test)]
mod tests;

use super::hard::Hard;
use crate::{Effect, Error, FrameContext, FrameLight, MakeContext, Needs, Role, Statistic, Technique};
use kajo_params::{ParamValues, Params};
use kajo_render_graph::wgpu::{self, BufferUsages};
use kajo_render_graph::{
    Access, Bindings, Buffer, ComputePipeline, Device, Graph, PipelineOptions, Pool, Resource, Slot, Texture, Timings, slot,
};
use kajo_scene::Ignored;
use kajo_shader_lib::light::GpuLight;
use points::points;

/// The technique.
pub const TECHNIQUE: Technique = Technique {
    id: "shadow/multi-sample",
    role: Role::DirectVisibility,
    title: "Multi-sampled soft shadows",
    doc: include_str!("doc.md"),
    cites: &["Arvo03", "Roberts18"],
    reads: &[slot::DEPTH, slot::NORMAL, slot::IDS],
    needs: Needs::NONE,
    params: Params::SPEC,
    make: |context, values| Ok(Box::new(MultiSample::new(context, values)?)),
};

/// Its parameters.
#[derive(Params, Clone, Copy, Debug)]
pub struct Params {
    /// The hard algorithm.
    #[param(default = 0)]
    pub over: Hard,
    /// Points of each light that has an extent.
    #[param(default = 32, range = 1..=4096)]
    pub samples: u32,
    /// Side of a map, for algorithms that have maps.
    #[param(default = 1024, range = 16..=8192, unit = "px")]
    pub resolution: u32,
}

/// What the shader reads.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable, kajo_shader_lib::ShaderLayout)]
struct GpuParams {
    count: u32,
    layer: u32,
    first: u32,
    total: u32,
}

/// Points whose hard shadows are made in one go: as many images of the frame's size are kept.
const BATCH: u32 = 16;

/// Slots that a hard algorithm may read.
const GBUFFER: [Slot; 3] = [slot::DEPTH, slot::NORMAL, slot::IDS];

/// Distance between the uniforms of two lights.
const STRIDE: u64 = 256;

struct MultiSample {
    params: Params,
    inner: Box<dyn Effect>,
    add: ComputePipeline,
    divide: ComputePipeline,
    adding: Buffer,
    dividing: Option<Buffer>,
    lights: Buffer,
    sums: Option<Texture>,
    /// What the hard algorithm counted for all points of each light.
    counted: Vec<Statistic>,
    /// The images of one batch, beside those of the G-buffer.
    pool: Option<Pool>,
}

impl MultiSample {
    fn new(context: &MakeContext, values: &ParamValues) -> Result<Self, Error> {
        let params = Params::from_values(values);
        let device = context.device;
        let shader = context.shader(TECHNIQUE.id, include_str!("accumulate.wesl"))?;
        let options = PipelineOptions { list_length: context.textures, ..Default::default() };
        let resolution = params.resolution.to_string();
        Ok(Self {
            params,
            inner: params.over.technique().build(context, &params.over.params(&[("resolution", &resolution)])?)?,
            add: ComputePipeline::new(device, &shader, "add", options)?,
            divide: ComputePipeline::new(device, &shader, "divide", options)?,
            adding: device.buffer(TECHNIQUE.id, size_of::<GpuParams>() as u64, BufferUsages::UNIFORM | BufferUsages::COPY_DST)?,
            dividing: None,
            lights: device.buffer(
                "shadow/multi-sample lights",
                u64::from(BATCH) * size_of::<GpuLight>() as u64,
                BufferUsages::STORAGE | BufferUsages::COPY_DST,
            )?,
            sums: None,
            counted: Vec::new(),
            pool: None,
        })
    }

    /// Hard shadows of one batch of lights, points of `light`, added to the sum of `params.layer`.
    fn batch(&mut self, frame: &FrameContext, light: u32, params: GpuParams, pool: &mut Pool) -> Result<Timings, Error> {
        self.adding.write(&frame.device.queue, bytemuck::bytes_of(&params));
        self.inner.prepare(frame)?;
        let mut timings = self.inner.run(frame, pool)?;
        let sums = self.sums.as_ref().expect("prepared");
        let (add, adding) = (&self.add, &self.adding);
        let mut graph = Graph::new();
        graph.import(&GBUFFER);
        self.inner.record(frame, &mut graph);
        graph.pass(Access::new("add").reads(&[slot::SHADOW_VISIBILITY]), |pass| {
            let own = Bindings::new().with("params", adding).with("hard", pass.view(slot::SHADOW_VISIBILITY)?).with("sums", sums.array());
            add.dispatch(pass.device, pass.encoder, &frame.shared, &own, frame.size().extend(1))
        });
        timings.merge(&graph.execute(frame.device, pool)?);
        for Statistic { name, value, .. } in self.inner.statistics(frame)? {
            match self.counted.iter_mut().find(|sum| (sum.name, sum.light) == (name, light)) {
                Some(sum) => sum.value += value,
                None => self.counted.push(Statistic { name, light, value }),
            }
        }
        Ok(timings)
    }
}

impl Effect for MultiSample {
    fn prepare(&mut self, frame: &FrameContext) -> Result<(), Error> {
        let layers = frame.lights.len().max(1) as u32;
        let size = wgpu::Extent3d { width: frame.size().x, height: frame.size().y, depth_or_array_layers: layers };
        if self.sums.as_ref().is_none_or(|sums| sums.wgpu.size() != size) {
            self.sums = Some(frame.device.texture(&wgpu::TextureDescriptor {
                label: Some("shadow/multi-sample sums"),
                size,
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: wgpu::TextureFormat::R32Float,
                usage: wgpu::TextureUsages::STORAGE_BINDING,
                view_formats: &[],
            }));
        }
        let bytes = frame.lights.len() as u64 * STRIDE;
        if self.dividing.as_ref().is_none_or(|buffer| buffer.bytes() < bytes) {
            self.dividing =
                Some(frame.device.buffer("shadow/multi-sample means", bytes, BufferUsages::UNIFORM | BufferUsages::COPY_DST)?);
        }
        Ok(())
    }

    fn run(&mut self, frame: &FrameContext, outer: &Pool) -> Result<Timings, Error> {
        let mut pool = match self.pool.take() {
            Some(pool) if pool.size() == outer.size() => pool,
            _ => Pool::new(outer.size(), BATCH.min(self.params.samples)),
        };
        pool.share(outer, &GBUFFER);
        self.counted.clear();
        let mut timings = Timings::default();
        let mut means = vec![0u8; frame.lights.len() * STRIDE as usize];
        for (layer, light) in frame.lights.iter().enumerate() {
            let spread = light.analytic().and_then(|placed| points(placed, self.params.samples));
            let total = spread.as_ref().map_or(1, |points| points.len() as u32);
            let mut params = GpuParams { count: 1, layer: layer as u32, first: 1, total };
            means[layer * STRIDE as usize..][..size_of::<GpuParams>()].copy_from_slice(bytemuck::bytes_of(&params));
            match spread {
                None => {
                    let alone = FrameContext {
                        lights: &frame.lights[layer..=layer],
                        first_light: frame.first_light + layer as u32,
                        shared: frame.shared.clone(),
                        debug: false,
                        ..*frame
                    };
                    timings.merge(&self.batch(&alone, frame.first_light + layer as u32, params, &mut pool)?);
                }
                Some(points) => {
                    for batch in points.chunks(BATCH as usize) {
                        let gpu: Vec<GpuLight> = batch.iter().map(|point| GpuLight::new(point, frame.view.position)).collect();
                        self.lights.write(&frame.device.queue, bytemuck::cast_slice(&gpu));
                        let lights: Vec<FrameLight> = batch.iter().cloned().map(FrameLight::Analytic).collect();
                        let own = self.lights.wgpu.clone();
                        let shared = frame.shared.clone().with("lights", Resource::Buffer(&own));
                        let part = FrameContext { lights: &lights, first_light: 0, shared, debug: false, ..*frame };
                        params.count = batch.len() as u32;
                        timings.merge(&self.batch(&part, frame.first_light + layer as u32, params, &mut pool)?);
                        params.first = 0;
                    }
                }
            }
        }
        self.dividing.as_ref().expect("prepared").write(&frame.device.queue, &means);
        self.pool = Some(pool);
        let passes = timings.passes.into_iter().map(|(name, ms)| (format!("{}/{name}", TECHNIQUE.id), ms)).collect();
        Ok(Timings { passes, on_device: timings.on_device })
    }

    fn record<'a>(&'a self, frame: &'a FrameContext<'a>, graph: &mut Graph<'a>) {
        let access = Access::new("shadow/multi-sample/divide").writes(&[slot::SHADOW_VISIBILITY]);
        graph.pass(access, move |pass| {
            let (sums, means) = (self.sums.as_ref().expect("prepared"), self.dividing.as_ref().expect("prepared"));
            for layer in 0..frame.lights.len() as u64 {
                let own = Bindings::new()
                    .with("params", Resource::Range(&means.wgpu, layer * STRIDE, size_of::<GpuParams>() as u64))
                    .with("sums", sums.array())
                    .with("visibility", pass.view(slot::SHADOW_VISIBILITY)?);
                self.divide.dispatch(pass.device, pass.encoder, &frame.shared, &own, frame.size().extend(1))?;
            }
            Ok(())
        });
    }

    fn rays(&self, device: &Device) -> Result<u64, Error> {
        self.inner.rays(device)
    }

    fn statistics(&self, _frame: &FrameContext) -> Result<Vec<Statistic>, Error> {
        Ok(self.counted.clone())
    }

    fn notes(&self) -> Vec<Ignored> {
        self.inner.notes()
    }
}

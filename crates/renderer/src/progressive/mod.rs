//! The path tracer on the device: a reference that gets better with every call, of the same light as the CPU's path tracer.
//!
//! It estimates the same integrals by the same two strategies (light sampling and sampling by reflection, combined by multiple importance sampling) over the
//! scene as the real-time renderer has it, with rays of the interface `trace`. What that scene does not hold, it refuses: see [`not_path_traced`].
//! `docs/decisions/0007-gpu-reference.md` says why it is what it is.

mod choices;
mod refused;

pub use refused::not_path_traced;

use crate::Error;
use crate::passes::Setup;
use crate::placement::Boxes;
use crate::upload::scene::{Seen, UploadedScene};
use choices::Choices;
use glam::UVec2;
use kajo_image::Image;
use kajo_render_graph::wgpu::{BufferUsages, CommandEncoderDescriptor};
use kajo_render_graph::{Bindings, Buffer, ComputePipeline, Device, PipelineOptions, readback};
use kajo_scene::{PlacedCamera, Scene, Snapshot};
use kajo_shader_lib::{ShaderLayout, SourceFile};
use kajo_techniques::TraceBackend;
use kajo_units::LinearRgb;

/// What to render.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProgressiveSettings {
    /// Size of the image, px.
    pub size: UVec2,
    /// Index of the camera.
    pub camera: usize,
    /// Largest number of surface bounces of a path, as the path tracer counts them.
    pub max_depth: u32,
    /// Samples lie in a square of this side about each pixel's centre, px: 1 is a box filter, 0 the centre alone.
    pub spread: f32,
    /// Chooses among equally good sets of random numbers.
    pub seed: u32,
    /// The irradiance of indirect light is wanted, too.
    pub irradiance: bool,
    /// Who traces rays; `None` takes ray queries where the adapter has them.
    pub backend: Option<TraceBackend>,
    /// Lets shaders choose textures by number where the adapter can.
    pub bindless: bool,
}

impl ProgressiveSettings {
    /// The path tracer's defaults for an image of `size`.
    pub fn new(size: UVec2) -> Self {
        Self { size, camera: 0, max_depth: 32, spread: 1.0, seed: 0, irradiance: false, backend: None, bindless: true }
    }
}

/// An image with its noise.
#[derive(Clone, Debug)]
pub struct Estimate {
    /// Mean of the samples.
    pub mean: Image<LinearRgb>,
    /// Variance of that mean; infinite for fewer than two samples.
    pub variance: Image<LinearRgb>,
}

/// What was found so far, W/(m² sr). The images are those of the path tracer by these names.
#[derive(Clone, Debug)]
pub struct Radiances {
    /// Samples of each pixel.
    pub samples: u32,
    /// Samples of all pixels that were not finite and count as black.
    pub invalid: u64,
    /// All light: `beauty`.
    pub beauty: Estimate,
    /// Emitters and background seen by the camera: `emission`.
    pub emission: Estimate,
    /// Light that bounced once: `direct`.
    pub direct: Estimate,
    /// The part of it from the environment and from unlit surfaces, which the role direct visibility knows nothing of.
    pub direct_by_others: Estimate,
    /// What specular lobes of the first surface reflect of everything but analytic lights: `specular-indirect`.
    pub specular_indirect: Estimate,
    /// Irradiance of the first surface by light that bounced before, W/m²: `diffuse-indirect`; where it was asked for.
    pub diffuse_indirect: Option<Estimate>,
}

/// Twin of `progressive::Params`.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable, ShaderLayout)]
struct GpuParams {
    first: u32,
    samples: u32,
    seed: u32,
    max_depth: u32,
    estimate: u32,
    spread: f32,
    can_choose: u32,
    padding: u32,
    sky: [u32; 2],
    padding_b: [u32; 2],
}

/// What one dispatch estimates, its number in the shader, and how many images that takes.
#[derive(Clone, Copy)]
enum Estimated {
    Radiance = 0,
    Irradiance = 1,
}

impl Estimated {
    const fn images(self) -> u64 {
        match self {
            Self::Radiance => 5,
            Self::Irradiance => 1,
        }
    }
}

/// A scene that is path traced on the device.
pub struct ProgressivePathTracer {
    device: Device,
    settings: ProgressiveSettings,
    scene: Scene,
    snapshot: Snapshot,
    uploaded: UploadedScene,
    boxes: Boxes,
    choices: Choices,
    table: Buffer,
    params: Buffer,
    pipeline: ComputePipeline,
    films: Vec<(Estimated, Buffer)>,
    samples: u32,
}

const SHADER: &str = include_str!("progressive.wesl");
const FILES: &[SourceFile] = &[SourceFile { name: "choices", source: include_str!("choices.wesl") }];

impl ProgressivePathTracer {
    /// Uploads the scene as `snapshot` has it; what [`not_path_traced`] lists is rendered as the real-time renderer has it.
    ///
    /// # Errors
    /// A size of 0 or beyond the adapter's limits, a camera that is not there, a backend the adapter lacks, or a scene that does not fit.
    pub fn new(device: &Device, scene: &Scene, snapshot: &Snapshot, settings: ProgressiveSettings) -> Result<Self, Error> {
        device.check_size(settings.size)?;
        if settings.camera >= snapshot.cameras.len() {
            return Err(Error::NoSuchCamera { got: settings.camera, count: snapshot.cameras.len() });
        }
        let kept = vec![true; snapshot.instances.len()];
        let uploaded = UploadedScene::new(device, scene, snapshot, &kept, (settings.backend, settings.bindless))?;
        let setup = Setup { device, variant: uploaded.variant(), textures: uploaded.textures.count() };
        let shader = setup.shader_with("progressive", SHADER, FILES)?;
        let options = PipelineOptions { list_length: setup.textures, ..Default::default() };
        let boxes = Boxes::new(snapshot);
        let choices = Choices::new(scene, snapshot, boxes.world);
        let out = Self {
            pipeline: ComputePipeline::new(device, &shader, "add_samples", options)?,
            table: device.buffer_with("light choices", &choices.ends, BufferUsages::STORAGE)?,
            params: device.buffer("progressive", size_of::<GpuParams>() as u64, BufferUsages::UNIFORM | BufferUsages::COPY_DST)?,
            films: films(device, &settings)?,
            device: device.clone(),
            scene: scene.clone(),
            snapshot: snapshot.clone(),
            samples: 0,
            settings,
            uploaded,
            boxes,
            choices,
        };
        out.place();
        Ok(out)
    }

    /// Looks through another camera, with images of another size, and begins anew.
    ///
    /// # Errors
    /// A size of 0 or beyond the adapter's limits; nothing has changed then.
    pub fn set_view(&mut self, camera: &PlacedCamera, size: UVec2) -> Result<(), Error> {
        self.device.check_size(size)?;
        if size != self.settings.size {
            let settings = ProgressiveSettings { size, ..self.settings };
            self.films = films(&self.device, &settings)?;
            self.settings = settings;
        }
        self.snapshot.cameras[self.settings.camera] = camera.clone();
        self.samples = 0;
        self.place();
        Ok(())
    }

    /// Samples of each pixel so far.
    pub fn samples(&self) -> u32 {
        self.samples
    }

    /// Adds samples to each pixel and waits for them; the result does not depend on how many calls they are spread over.
    ///
    /// # Errors
    /// When the device refuses or is lost.
    pub fn add(&mut self, samples: u32) -> Result<(), Error> {
        let shared = self.uploaded.bind();
        for (estimated, film) in &self.films {
            let params = GpuParams {
                first: self.samples,
                samples,
                // Each has random numbers of its own.
                seed: self.settings.seed.wrapping_mul(2).wrapping_add(*estimated as u32),
                max_depth: self.settings.max_depth,
                estimate: *estimated as u32,
                spread: self.settings.spread,
                can_choose: u32::from(self.choices.any),
                padding: 0,
                sky: self.choices.sky.to_array(),
                padding_b: [0; 2],
            };
            self.params.write(&self.device.queue, bytemuck::bytes_of(&params));
            let mut encoder = self.device.wgpu.create_command_encoder(&CommandEncoderDescriptor { label: Some("progressive") });
            let own = Bindings::new().with("params", &self.params).with("film", film).with("choices", &self.table);
            self.pipeline.dispatch(&self.device, &mut encoder, &shared, &own, self.settings.size.extend(1))?;
            self.device.queue.submit([encoder.finish()]);
        }
        self.device.wait()?;
        self.samples += samples;
        Ok(())
    }

    /// Reads the images back; before the first sample they are black.
    ///
    /// # Errors
    /// When the device is lost.
    pub fn read(&self) -> Result<Radiances, Error> {
        let mut found = Vec::new();
        let mut invalid = 0;
        for (estimated, film) in &self.films {
            let texels: Vec<[f32; 4]> = readback::read_buffer(&self.device, &film.wgpu)?;
            let pixels = self.settings.size.element_product() as usize;
            invalid += texels[..pixels].iter().map(|texel| texel[3] as u64).sum::<u64>();
            found.extend((0..estimated.images() as usize).map(|image| self.estimate(&texels[2 * image * pixels..], pixels)));
        }
        let mut found = found.into_iter();
        let mut next = || found.next().expect("the films hold every image");
        Ok(Radiances {
            samples: self.samples,
            invalid,
            beauty: next(),
            emission: next(),
            direct: next(),
            direct_by_others: next(),
            specular_indirect: next(),
            diffuse_indirect: self.settings.irradiance.then(next),
        })
    }

    fn estimate(&self, texels: &[[f32; 4]], pixels: usize) -> Estimate {
        let n = self.samples as f32;
        let image = |from: usize, scale: f32| {
            let pixel = |[r, g, b, _]: &[f32; 4]| if self.samples > 0 { LinearRgb::new(*r, *g, *b) * scale } else { LinearRgb::BLACK };
            Image::from_pixels(self.settings.size, texels[from..from + pixels].iter().map(pixel).collect())
        };
        let variance =
            if self.samples > 1 { image(pixels, 1.0 / (n * (n - 1.0))) } else { image(0, 0.0).map(|_| LinearRgb::splat(f32::INFINITY)) };
        Estimate { mean: image(0, 1.0), variance }
    }

    /// Uploads what depends on the camera.
    fn place(&self) {
        let view = self.boxes.view(&self.snapshot.cameras[self.settings.camera], self.settings.size);
        let seen = Seen { snapshot: &self.snapshot, view };
        self.uploaded.place(&self.device, &self.scene, &seen, &seen, 0, true);
    }
}

/// For each image the means and the squares of all pixels.
fn films(device: &Device, settings: &ProgressiveSettings) -> Result<Vec<(Estimated, Buffer)>, Error> {
    let pixels = u64::from(settings.size.x) * u64::from(settings.size.y);
    let film = |of: Estimated| {
        let usage = BufferUsages::STORAGE | BufferUsages::COPY_SRC;
        Ok((of, device.buffer("film", 2 * 16 * of.images() * pixels, usage)?))
    };
    [Some(Estimated::Radiance), settings.irradiance.then_some(Estimated::Irradiance)].into_iter().flatten().map(film).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_techniques::shaders::{self, Variant};

    #[test]
    fn the_shader_links_on_both_backends_and_its_struct_matches() {
        for backend in [TraceBackend::RayQuery, TraceBackend::Compute] {
            for bindless in [false, true] {
                let linked = shaders::link_with_files("progressive", SHADER, FILES, Variant::without_models(backend, bindless)).unwrap();
                linked.check_layout::<GpuParams>("Params").unwrap();
            }
        }
    }
}

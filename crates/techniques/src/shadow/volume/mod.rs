//! What the techniques of shadow volumes share: casters, the extraction of their polygons on the device, counting, and the answer.
//!
//! For each light of the group: [`extract`] turns the meshes that are drawn into side polygons and caps, a pass finds where each visible point lies, the
//! polygons are rasterised into a stencil, and where the count is 0 the point sees the light.

mod buffers;
mod casters;
mod cull;
mod extract;
mod polygons;
mod receive;
mod soften;
#[cfg(test)]
mod tests;

use crate::{DebugPixels, DebugView, Effect, Error, FrameContext, MakeContext, Statistic};
use casters::Casters;
use extract::Extract;
use glam::UVec2;
use kajo_image::Image;
use kajo_render_graph::{Access, Graph, Slot, Texture, readback, slot, wgpu};
use kajo_scene::Ignored;
use kajo_shader_lib::SourceFile;
use kajo_units::LinearRgb;
use polygons::Polygons;
use receive::Receive;
use soften::Soften;

/// Which polygons count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Count {
    /// Those between the near plane and the visible point.
    Before,
    /// Those behind the visible point; volumes are closed by caps.
    Behind,
}

/// What the shaders have in common.
const SHARED: &[SourceFile] = &[SourceFile { name: "volume", source: include_str!("volume.wesl") }];

/// Slots that the passes read.
pub(super) const READS: &[Slot] = &[slot::DEPTH, slot::NORMAL, slot::IDS];

/// A technique of shadow volumes at work.
pub(super) struct ShadowVolumes {
    id: &'static str,
    count: Count,
    culling: bool,
    casters: Casters,
    extract: Extract,
    polygons: Polygons,
    receive: Receive,
    /// Corrects the answer where the light has an extent.
    soften: Option<Soften>,
    images: Option<Images>,
}

/// Images of one size; lights use them one after the other.
struct Images {
    stencil: Texture,
    /// Depth that polygons are compared with.
    limit: Texture,
    /// 1 where a cap found its own triangle turned away from the light.
    dark: Texture,
    /// Pictures for the light's debug views, one layer a light.
    debug: Option<DebugImages>,
}

struct DebugImages {
    counts: Texture,
    silhouettes: Texture,
    volumes: Texture,
}

impl ShadowVolumes {
    pub fn new(context: &MakeContext, id: &'static str, count: Count, culling: bool) -> Result<Self, Error> {
        Ok(Self {
            id,
            count,
            culling,
            casters: Casters::default(),
            extract: Extract::new(context)?,
            polygons: Polygons::new(context, count)?,
            receive: Receive::new(context)?,
            soften: None,
            images: None,
        })
    }

    /// The same with penumbrae.
    pub fn softened(self, context: &MakeContext) -> Result<Self, Error> {
        Ok(Self { soften: Some(Soften::new(context)?), ..self })
    }

    fn make_images(&mut self, frame: &FrameContext) {
        let size = frame.size();
        let layers = frame.lights.len().max(1) as u32;
        let texture = |label, format, layers, usage| image(frame, label, size, layers, format, usage);
        let (target, bound, storage) =
            (wgpu::TextureUsages::RENDER_ATTACHMENT, wgpu::TextureUsages::TEXTURE_BINDING, wgpu::TextureUsages::STORAGE_BINDING);
        let fits = |images: &Images| UVec2::new(images.stencil.wgpu.width(), images.stencil.wgpu.height()) == size;
        if !self.images.as_ref().is_some_and(fits) {
            self.images = Some(Images {
                stencil: texture("shadow/volume stencil", wgpu::TextureFormat::Stencil8, 1, target | bound),
                limit: texture("shadow/volume limit", wgpu::TextureFormat::Rg32Float, 1, storage | bound),
                dark: texture("shadow/volume dark", wgpu::TextureFormat::R8Unorm, 1, target | bound),
                debug: None,
            });
        }
        let images = self.images.as_mut().expect("made above");
        if !frame.debug {
            images.debug = None;
        } else if images.debug.as_ref().is_none_or(|debug| debug.counts.wgpu.depth_or_array_layers() < layers) {
            let copied = wgpu::TextureUsages::COPY_SRC;
            let drawing = |label| texture(label, polygons::PICTURE, layers, target | copied);
            images.debug = Some(DebugImages {
                counts: texture("shadow/volume counts", wgpu::TextureFormat::R32Float, layers, storage | copied),
                silhouettes: drawing("shadow/volume silhouettes"),
                volumes: drawing("shadow/volume polygons"),
            });
        }
    }
}

fn image(frame: &FrameContext, label: &str, size: UVec2, layers: u32, format: wgpu::TextureFormat, usage: wgpu::TextureUsages) -> Texture {
    frame.device.texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: layers },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    })
}

impl Effect for ShadowVolumes {
    fn prepare(&mut self, frame: &FrameContext) -> Result<(), Error> {
        self.casters.update(frame)?;
        self.make_images(frame);
        let jobs: Vec<_> =
            frame.lights.iter().map(|light| self.casters.jobs(frame, light, (self.count, self.culling, self.soften.is_some()))).collect();
        self.extract.prepare(frame, &jobs)?;
        self.polygons.prepare(frame)?;
        if let Some(soften) = &mut self.soften {
            soften.prepare(frame)?;
        }
        self.receive.prepare(frame, self.count, self.culling)
    }

    fn record<'a>(&'a self, frame: &'a FrameContext<'a>, graph: &mut Graph<'a>) {
        let images = self.images.as_ref().expect("prepared");
        let edges = self.casters.edges();
        for layer in 0..frame.lights.len() {
            // Lights take turns with the images and the lists, so each pass changes what the one before left.
            let turn = |name: &str| {
                let access = Access::new(format!("{}/{name}", self.id)).reads(READS);
                if layer == 0 && name == "extract" {
                    access.writes(&[slot::SHADOW_VISIBILITY])
                } else {
                    access.updates(&[slot::SHADOW_VISIBILITY])
                }
            };
            graph.pass(turn("extract"), move |pass| self.extract.run(frame, layer, edges, pass));
            graph.pass(turn("limit"), move |pass| self.receive.find_limits(frame, layer, &images.limit, pass));
            graph.pass(turn("count"), move |pass| {
                self.polygons.count(frame, layer, self.extract.lists(layer), [&images.limit, &images.stencil, &images.dark], pass)
            });
            graph.pass(turn("answer"), move |pass| {
                if let Some(soften) = &self.soften {
                    let found = (self.extract.lists(layer), self.extract.counts(layer));
                    return soften.run(frame, layer, &images.stencil, found, pass);
                }
                self.receive.answer(frame, layer, [&images.stencil, &images.dark], self.extract.counts(layer), pass)
            });
            if let Some(debug) = &images.debug {
                graph.pass(turn("debug"), move |pass| {
                    self.receive.show_counts(frame, layer, [&images.stencil, &debug.counts], self.extract.counts(layer), pass)?;
                    self.polygons.show(frame, layer, self.extract.lists(layer), [&debug.silhouettes, &debug.volumes], pass)
                });
            }
        }
    }

    fn statistics(&self, frame: &FrameContext) -> Result<Vec<Statistic>, Error> {
        let fragments = self.polygons.fragments(frame.device)?;
        let polygons = self.extract.polygons(frame.device)?;
        let mut out = Vec::new();
        for layer in 0..frame.lights.len() {
            let light = frame.first_light + layer as u32;
            let [sides, volumes] = polygons[layer];
            // Volumes of parallel light end in a point.
            let caps = if cull::light_point(&frame.lights[layer], frame.view.position).w == 0.0 { volumes } else { 2 * volumes };
            let counts = [("shadow polygons", sides + caps), ("stencil fragments", fragments[layer])];
            out.extend(counts.map(|(name, value)| Statistic { name, light, value }));
        }
        Ok(out)
    }

    fn debug_views(&self, frame: &FrameContext) -> Result<Vec<DebugView>, Error> {
        let Some(debug) = self.images.as_ref().and_then(|images| images.debug.as_ref()) else { return Ok(Vec::new()) };
        let mut out = Vec::new();
        for layer in 0..frame.lights.len() as u32 {
            let light = frame.first_light + layer;
            let counts: Vec<f32> = readback::read_texture(frame.device, &debug.counts.wgpu, layer)?;
            let counts = DebugPixels::Scalar(Image::from_pixels(frame.size(), counts));
            out.push(DebugView { name: "stencil-count", light, pixels: counts });
            for (name, texture) in [("silhouettes", &debug.silhouettes), ("shadow-volumes", &debug.volumes)] {
                let texels: Vec<[u8; 4]> = readback::read_texture(frame.device, &texture.wgpu, layer)?;
                let color = |[r, g, b, _]: [u8; 4]| LinearRgb::new(f32::from(r), f32::from(g), f32::from(b)) * (1.0 / 255.0);
                let pixels = DebugPixels::Color(Image::from_pixels(frame.size(), texels.into_iter().map(color).collect()));
                out.push(DebugView { name, light, pixels });
            }
        }
        Ok(out)
    }

    fn notes(&self) -> Vec<Ignored> {
        self.casters.notes(self.id)
    }
}

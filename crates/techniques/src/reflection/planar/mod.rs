//! Flat mirrors by drawing the scene mirrored.

mod planes;
#[cfg(test)]
mod tests;

use super::surfaces::{self, READS};
use crate::ray_count::RayCount;
use crate::still_life::StillLife;
use crate::{Effect, Error, FrameContext, MakeContext, Needs, Role, Technique};
use kajo_params::{ParamValues, Params};
use kajo_render_graph::wgpu::{self, BufferUsages, TextureFormat};
use kajo_render_graph::{
    Access, Bindings, Buffer, ComputePipeline, Device, Graph, PassContext, PipelineOptions, RenderPipeline, RenderState, Texture, slot,
};
use kajo_scene::Ignored;
use planes::{Mirrors, Plane};

/// The technique.
pub const TECHNIQUE: Technique = Technique {
    id: "reflection/planar",
    role: Role::SpecularIndirect,
    title: "Planar reflections",
    doc: include_str!("doc.md"),
    cites: &["Kilgard99"],
    reads: READS,
    needs: Needs::NONE,
    params: Params::SPEC,
    make: |context, values| Ok(Box::new(Planar::new(context, values)?)),
};

/// Its parameters.
#[derive(Params, Clone, Copy, Debug)]
pub struct Params {
    /// Flat mirrors that are shown, the largest of the scene; each draws the scene once more.
    #[param(default = 2, range = 1..=16)]
    pub mirrors: u32,
    /// Rougher surfaces are no mirrors.
    #[param(default = 0.1, range = 0.0..=1.0)]
    pub max_roughness: f32,
    /// Shadow rays to each light with an extent, from each surface in the mirror.
    #[param(default = 4, range = 1..=64)]
    pub light_samples: u32,
    /// Lights asked at each surface in the mirror; of more than that, as many are chosen at random.
    #[param(default = 16, range = 1..=1024)]
    pub lights: u32,
}

/// What the shader reads.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable, kajo_shader_lib::ShaderLayout)]
struct GpuMirror {
    normal: [f32; 3],
    height: f32,
    clearance: f32,
    max_roughness: f32,
    light_samples: u32,
    lights: u32,
}

/// Height over a mirror up to which things lie in it, in units of the greatest coordinate: what rounds positions through the depth buffer.
const CLEARANCE: f32 = 2e-5;

/// What a pixel of a mirror shows, and its depth.
struct MirrorImage {
    color: Texture,
    depth: Texture,
}

struct Planar {
    params: Params,
    draw: RenderPipeline,
    resolve: ComputePipeline,
    uniforms: Vec<Buffer>,
    image: Option<MirrorImage>,
    mirrors: Option<Mirrors>,
    still: StillLife,
    rays: RayCount,
    file: String,
}

impl Planar {
    fn new(context: &MakeContext, values: &ParamValues) -> Result<Self, Error> {
        let device = context.device;
        let params = Params::from_values(values);
        let shader = context.shader(TECHNIQUE.id, include_str!("planar.wesl"))?;
        let options = PipelineOptions { list_length: context.textures, ..Default::default() };
        let state = RenderState {
            vertex: "vertex",
            fragment: Some("fragment"),
            targets: &[wgpu::ColorTargetState::from(TextureFormat::Rgba32Uint)],
            depth: Some(wgpu::DepthStencilState {
                format: TextureFormat::Depth32Float,
                depth_write_enabled: Some(true),
                depth_compare: Some(wgpu::CompareFunction::Greater),
                stencil: wgpu::StencilState::default(),
                bias: wgpu::DepthBiasState::default(),
            }),
            primitive: wgpu::PrimitiveState::default(),
        };
        let usage = BufferUsages::UNIFORM | BufferUsages::COPY_DST;
        let uniform = |_| device.buffer("reflection/planar mirror", size_of::<GpuMirror>() as u64, usage);
        Ok(Self {
            params,
            draw: RenderPipeline::new(device, &shader, &state, options)?,
            resolve: ComputePipeline::new(device, &shader, "reflect_plane", options)?,
            uniforms: (0..params.mirrors).map(uniform).collect::<Result<_, _>>()?,
            image: None,
            mirrors: None,
            still: StillLife::default(),
            rays: RayCount::new(context, "reflection/planar rays")?,
            file: String::new(),
        })
    }

    fn planes(&self) -> &[Plane] {
        self.mirrors.as_ref().map_or(&[], |mirrors| &mirrors.planes)
    }

    /// Draws what one mirror shows, and lights it where the mirror is seen.
    fn reflect(&self, frame: &FrameContext, pass: &mut PassContext, uniform: &Buffer) -> Result<(), kajo_render_graph::Error> {
        let image = self.image.as_ref().expect("prepared");
        let clear = |value| wgpu::LoadOp::Clear(value);
        let mut render = pass.encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("reflection/planar"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &image.color.view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: clear(wgpu::Color::TRANSPARENT), store: wgpu::StoreOp::Store },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &image.depth.view,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Store }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        self.draw.set(pass.device, &mut render, &frame.shared, &Bindings::new().with("mirror", uniform))?;
        for draw in frame.draws {
            // Vertices are pulled by the number of the corner, so that fragments know their triangle.
            render.draw(0..draw.index_count, draw.instance..draw.instance + 1);
        }
        drop(render);
        let own = surfaces::bind(pass)?
            .with("mirror", uniform)
            .with("image", image.color.view.clone())
            .with("image_depth", image.depth.view.clone())
            .with("reflected", pass.view(slot::SPECULAR_INDIRECT)?)
            .with(RayCount::BINDING, self.rays.buffer());
        self.resolve.dispatch(pass.device, pass.encoder, &frame.shared, &own, frame.size().extend(1))
    }
}

impl MirrorImage {
    fn new(device: &Device, size: wgpu::Extent3d) -> Self {
        let texture = |format| {
            device.texture(&wgpu::TextureDescriptor {
                label: Some("reflection/planar image"),
                size,
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
                view_formats: &[],
            })
        };
        Self { color: texture(TextureFormat::Rgba32Uint), depth: texture(TextureFormat::Depth32Float) }
    }
}

impl Effect for Planar {
    fn prepare(&mut self, frame: &FrameContext) -> Result<(), Error> {
        self.rays.prepare(frame);
        let size = wgpu::Extent3d { width: frame.size().x, height: frame.size().y, depth_or_array_layers: 1 };
        if self.image.as_ref().is_none_or(|image| image.color.wgpu.size() != size) {
            self.image = Some(MirrorImage::new(frame.device, size));
        }
        let Params { mirrors, max_roughness, light_samples, lights } = self.params;
        let [low, high] = frame.bounds;
        if self.still.changed(frame) {
            let diagonal = (high - low).length();
            self.mirrors = Some(planes::find(frame.scene, frame.snapshot, diagonal, max_roughness, mirrors as usize));
            self.file = frame.scene.name.clone();
        }
        let eye = frame.view.position;
        let reach = low.abs().max(high.abs()).max(eye.abs()).max_element();
        for (plane, uniform) in self.planes().iter().zip(&self.uniforms) {
            let height = plane.height - plane.normal.dot(eye);
            // Parallel views look at a plane from the side that they face.
            let behind = if frame.view.perspective { height > 0.0 } else { plane.normal.dot(forward(frame)) > 0.0 };
            let side = if behind { -1.0 } else { 1.0 };
            let mirror = GpuMirror {
                normal: (plane.normal * side).to_array(),
                height: height * side,
                clearance: CLEARANCE * reach,
                max_roughness,
                light_samples,
                lights,
            };
            uniform.write(&frame.device.queue, bytemuck::bytes_of(&mirror));
        }
        Ok(())
    }

    fn record<'a>(&'a self, frame: &'a FrameContext<'a>, graph: &mut Graph<'a>) {
        graph.clear("reflection/planar/clear", slot::SPECULAR_INDIRECT, wgpu::Color::TRANSPARENT);
        for (i, (_, uniform)) in self.planes().iter().zip(&self.uniforms).enumerate() {
            let access = Access::new(format!("reflection/planar/mirror-{i}")).reads(READS).updates(&[slot::SPECULAR_INDIRECT]);
            graph.pass(access, move |pass| self.reflect(frame, pass, uniform));
        }
    }

    /// Of the surfaces that it reflects those without roughness alone: others, and those in other planes, keep their highlights.
    fn mirrors_up_to(&self) -> Option<f32> {
        Some(0.0)
    }

    fn rays(&self, device: &Device) -> Result<u64, Error> {
        self.rays.rays(device)
    }

    fn notes(&self) -> Vec<Ignored> {
        let Some(mirrors) = &self.mirrors else { return Vec::new() };
        let note = |feature: &str, consequence: String| Ignored {
            file: self.file.clone(),
            place: String::new(),
            feature: feature.to_owned(),
            consequence: format!("{}: {consequence}", TECHNIQUE.id),
        };
        let mut out = Vec::new();
        if mirrors.planes.is_empty() {
            out.push(note("flat mirrors", "the scene has none as smooth as `max_roughness`; nothing is reflected".to_owned()));
        }
        if mirrors.left_out > 0.0 {
            let consequence = format!("{:.2} m² of smooth surfaces are curved or beyond `mirrors` and reflect nothing", mirrors.left_out);
            out.push(note("smooth surfaces in other planes", consequence));
        }
        out
    }
}

/// Viewing axis, world, unit.
fn forward(frame: &FrameContext) -> glam::Vec3 {
    frame.view.relative_from_view.transform_vector3(glam::Vec3::NEG_Z)
}

//! The depth of the scene seen from a light: what every shadow map starts from.
//!
//! A `DepthMaps` belongs to one technique. For each light of a frame it holds a `Projection` of one map or six, draws the casters into one
//! texture that the lights use one after the other, and binds what `package::depth_map` declares. A technique adds how it looks a point up.

mod caster;
mod debug;
mod filtered;
mod projection;
#[cfg(test)]
mod tests;

pub use caster::{DepthLayout, Precision};
pub(in crate::shadow) use filtered::{FilteredMaps, reach_of};
pub(in crate::shadow) use projection::{
    Fit, Frustum, Projection, axes, axis, corners, depth_of, fit, parallel, range, relative_bounds, rotation,
};

use crate::{Error, FrameContext, MakeContext};
use caster::Caster;
use debug::Copies;
use kajo_render_graph::wgpu::{self, BufferUsages};
use kajo_render_graph::{Access, Bindings, Buffer, Device, Graph, PassContext, Resource, Slot, slot};

/// Slots that `package::depth_map` reads.
pub(in crate::shadow) const READS: &[Slot] = &[slot::DEPTH, slot::NORMAL, slot::IDS];

/// Most maps of a light: the faces of a cube.
pub(in crate::shadow) const MAX_FACES: usize = 6;

/// How far a visible point is moved before it is looked up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::shadow) enum Shift {
    /// As far along the normal as the filter needs and no further.
    Automatic,
    /// By hand: towards the light in m and in texels times tan θ, along the normal in texels times sin ψ.
    ByHand { constant: f32, slope: f32, normal: f32 },
}

/// What a technique asks of its maps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::shadow) struct Settings {
    /// Side of a map, px.
    pub resolution: u32,
    /// Texels from a point to the furthest that is read for it, along an axis.
    pub reach: f32,
    /// Texels beyond the reach that must hold depth because a filter before the look-up reads them.
    pub border: f32,
    /// How far points are moved.
    pub shift: Shift,
    /// What a texel holds.
    pub layout: DepthLayout,
    /// How it is stored.
    pub precision: Precision,
    /// Maps are read only near where visible points lie in them: those in which none lies are not drawn.
    pub near_points: bool,
}

impl Settings {
    /// Maps with automatic bias in single precision, depth as the rasteriser has it.
    pub fn new(resolution: u32, reach: f32) -> Self {
        Self {
            resolution,
            reach,
            border: 0.0,
            shift: Shift::Automatic,
            layout: DepthLayout::Perspective,
            precision: Precision::Float32,
            near_points: true,
        }
    }
}

/// Added to the reach, texels: vertices are rounded to 1/256 px, and depth to 24 bits.
const SLACK: f32 = 0.0625;

/// Twin of `Face` in depth_map.wesl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, bytemuck::Pod, bytemuck::Zeroable, kajo_shader_lib::ShaderLayout)]
struct GpuFace {
    clip_from_relative: [[f32; 4]; 4],
    across_x: [f32; 4],
    across_y: [f32; 4],
}

/// Twin of `Map` in depth_map.wesl.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable, kajo_shader_lib::ShaderLayout)]
struct GpuMap {
    faces: [GpuFace; MAX_FACES],
    light: u32,
    layer: u32,
    face_count: u32,
    cube: u32,
    edge: f32,
    depth_kind: u32,
    near: f32,
    far: f32,
    automatic_bias: f32,
    constant_bias: f32,
    slope_bias: f32,
    normal_offset: f32,
    quantum: f32,
    used_faces: u32,
    padding_a: u32,
    padding_b: u32,
}

/// Distance between the uniforms of two lights: a multiple of every device's offset alignment.
const STRIDE: u64 = 768;
/// Distance between the uniforms of two faces.
const FACE_STRIDE: u64 = 256;

/// A sampler that compares with the four texels around and interpolates the answers.
pub(in crate::shadow) fn comparison(device: &Device) -> wgpu::Sampler {
    device.wgpu.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("depth map"),
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        compare: Some(wgpu::CompareFunction::GreaterEqual),
        ..Default::default()
    })
}

/// The maps of a technique.
pub(in crate::shadow) struct DepthMaps {
    id: &'static str,
    settings: Settings,
    caster: Caster,
    maps: Option<Buffer>,
    faces: Option<Buffer>,
    projections: Vec<Projection>,
    /// Side of a map, px: what was asked for, or what the device can do.
    resolution: u32,
    /// Of each light, for pictures; only when they are wanted.
    copies: Vec<Copies>,
}

impl DepthMaps {
    /// Makes the pipelines that draw casters; `id` names the passes.
    ///
    /// # Errors
    /// When the device refuses.
    pub fn new(context: &MakeContext, id: &'static str, settings: Settings) -> Result<Self, Error> {
        let caster = Caster::new(context, settings.layout, settings.precision)?;
        Ok(Self {
            id,
            settings,
            caster,
            maps: None,
            faces: None,
            projections: Vec::new(),
            resolution: settings.resolution,
            copies: Vec::new(),
        })
    }

    /// Fits the maps of every light of the frame by `fit` and uploads them.
    ///
    /// # Errors
    /// When the device refuses.
    pub fn prepare(&mut self, frame: &FrameContext, fit: &dyn Fn(&Fit) -> Projection) -> Result<(), Error> {
        let resolution = self.settings.resolution.min(frame.device.info().max_image_side);
        self.resolution = resolution;
        let fit_of = |light| fit(&Fit { light, frame, resolution, reach: self.settings.reach + self.settings.border });
        let used = |projection: Projection| if self.settings.near_points { projection.used_by(frame) } else { projection };
        self.projections = frame.lights.iter().map(fit_of).map(used).collect();
        let layers = self.projections.iter().map(|projection| projection.faces.len() as u32).max().unwrap_or(1);
        self.caster.prepare(frame.device, resolution, layers);
        let copies = |projection: &Projection| {
            Copies::new(frame.device, [resolution, projection.faces.len() as u32], frame.size(), self.settings.precision)
        };
        self.copies = if frame.debug { self.projections.iter().map(copies).collect::<Result<_, _>>()? } else { Vec::new() };

        let mut maps = vec![0u8; frame.lights.len() * STRIDE as usize];
        let mut faces = vec![0u8; frame.lights.len() * MAX_FACES * FACE_STRIDE as usize];
        for (layer, projection) in self.projections.iter().enumerate() {
            let map = self.gpu_map(frame, layer, resolution);
            maps[layer * STRIDE as usize..][..size_of::<GpuMap>()].copy_from_slice(bytemuck::bytes_of(&map));
            for (face, clip_from_relative) in projection.faces.iter().enumerate() {
                let bytes = caster::face_bytes(*clip_from_relative, projection.far);
                faces[face_offset(layer, face) as usize..][..bytes.len()].copy_from_slice(&bytes);
            }
        }
        upload(frame.device, &mut self.maps, "depth maps", &maps)?;
        upload(frame.device, &mut self.faces, "depth map faces", &faces)
    }

    fn gpu_map(&self, frame: &FrameContext, layer: usize, resolution: u32) -> GpuMap {
        let (settings, projection) = (&self.settings, &self.projections[layer]);
        let texel = 2.0 / resolution as f32;
        let mut faces = [GpuFace::default(); MAX_FACES];
        for (to, from) in faces.iter_mut().zip(&projection.faces) {
            let relative_from_clip = from.as_dmat4().inverse().as_mat4();
            to.clip_from_relative = from.to_cols_array_2d();
            to.across_x = (relative_from_clip.x_axis * texel).to_array();
            to.across_y = (relative_from_clip.y_axis * texel).to_array();
        }
        let (automatic_bias, [constant_bias, slope_bias, normal_offset]) = match settings.shift {
            Shift::Automatic => (settings.reach + SLACK, [0.0; 3]),
            Shift::ByHand { constant, slope, normal } => (0.0, [constant, slope, normal]),
        };
        GpuMap {
            faces,
            light: frame.first_light + layer as u32,
            layer: layer as u32,
            face_count: projection.faces.len() as u32,
            cube: u32::from(projection.cube),
            edge: 1.0 - projection.margin * texel,
            depth_kind: caster::depth_kind(settings.layout, projection.parallel),
            near: projection.near,
            far: projection.far,
            automatic_bias,
            constant_bias,
            slope_bias,
            normal_offset,
            quantum: settings.precision.quantum(),
            used_faces: (0..MAX_FACES).filter(|&face| projection.is_used[face]).map(|face| 1 << face).sum(),
            padding_a: 0,
            padding_b: 0,
        }
    }

    /// What `package::depth_map` declares, for one light. A shader that uses less of it is bound with [`Bindings::with`] alone.
    ///
    /// # Errors
    /// When the pass has not declared [`READS`] and the role's slot.
    pub fn bindings(&self, layer: usize, pass: &PassContext) -> Result<Bindings<'_>, kajo_render_graph::Error> {
        Ok(self
            .map_bindings(layer)
            .with("depth", pass.view(slot::DEPTH)?)
            .with("normal", pass.view(slot::NORMAL)?)
            .with("ids", pass.view(slot::IDS)?)
            .with("visibility", pass.view(slot::SHADOW_VISIBILITY)?))
    }

    /// The same without the map's texture: for techniques that look up something made from it.
    ///
    /// # Errors
    /// As [`Self::bindings`].
    pub fn receiver_bindings(&self, layer: usize, pass: &PassContext) -> Result<Bindings<'_>, kajo_render_graph::Error> {
        Ok(self.bindings(layer, pass)?.without("light_depth"))
    }

    /// Side of a map, px: what was asked for, or what the device can do; known once prepared.
    pub fn resolution(&self) -> u32 {
        self.resolution
    }

    /// Maps of a light of the frame.
    pub fn faces(&self, layer: usize) -> usize {
        self.projections[layer].faces.len()
    }

    /// The map itself: its uniform and its texture.
    pub fn map_bindings(&self, layer: usize) -> Bindings<'_> {
        let maps = self.maps.as_ref().expect("prepared");
        Bindings::new()
            .with("map", Resource::Range(&maps.wgpu, layer as u64 * STRIDE, size_of::<GpuMap>() as u64))
            .with("light_depth", self.caster.depth().array())
    }

    /// Adds for each light the pass that draws its casters and then `steps` by name, which `run` carries out for the light's layer. The maps
    /// are made anew for each light, so the passes of the lights take turns: each updates what the one before left.
    pub fn record<'a>(
        &'a self,
        frame: &'a FrameContext<'a>,
        graph: &mut Graph<'a>,
        steps: &'static [&'static str],
        run: impl Fn(&'static str, usize, &mut PassContext) -> Result<(), kajo_render_graph::Error> + Copy + 'a,
    ) {
        for layer in 0..frame.lights.len() {
            let access = Access::new(format!("{}/cast", self.id)).reads(READS);
            let access = if layer == 0 { access.writes(&[slot::SHADOW_VISIBILITY]) } else { access.updates(&[slot::SHADOW_VISIBILITY]) };
            graph.pass(access, move |pass| self.cast(frame, layer, pass));
            for &name in steps {
                let access = Access::new(format!("{}/{name}", self.id)).reads(READS).updates(&[slot::SHADOW_VISIBILITY]);
                graph.pass(access, move |pass| run(name, layer, pass));
            }
        }
    }

    fn cast(&self, frame: &FrameContext, layer: usize, pass: &mut PassContext) -> Result<(), kajo_render_graph::Error> {
        let faces = &self.faces.as_ref().expect("prepared").wgpu;
        for face in 0..self.projections[layer].faces.len() {
            if !self.projections[layer].is_used[face] {
                continue;
            }
            let own = Bindings::new().with("face", Resource::Range(faces, face_offset(layer, face), caster::FACE_BYTES));
            self.caster.draw(frame, &frame.lights[layer], (face as u32, self.projections[layer].parallel), &own, pass)?;
        }
        match self.copies.get(layer) {
            Some(copies) => copies.take(self, self.projections[layer].faces.len() as u32, pass),
            None => Ok(()),
        }
    }
}

fn face_offset(layer: usize, face: usize) -> u64 {
    (layer * MAX_FACES + face) as u64 * FACE_STRIDE
}

/// Writes `bytes` into a uniform buffer, a new one where the old is too small.
pub(in crate::shadow) fn upload(device: &Device, buffer: &mut Option<Buffer>, label: &str, bytes: &[u8]) -> Result<(), Error> {
    if buffer.as_ref().is_none_or(|buffer| buffer.bytes() < bytes.len() as u64) {
        *buffer = Some(device.buffer(label, bytes.len() as u64, BufferUsages::UNIFORM | BufferUsages::COPY_DST)?);
    }
    if let Some(buffer) = buffer {
        buffer.write(&device.queue, bytes);
    }
    Ok(())
}

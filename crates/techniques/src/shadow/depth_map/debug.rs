//! Pictures of what a look-up sees: depth from the light, depth from the camera, and one carried over to the other (Fig. 5 of \[Arvo03\]).

use super::caster::{DepthLayout, Precision};
use super::{DepthMaps, Projection};
use crate::{DebugPixels, DebugView, Error, FrameContext};
use glam::{UVec2, Vec3};
use kajo_image::Image;
use kajo_render_graph::wgpu;
use kajo_render_graph::{Buffer, Device, PassContext, readback, slot};

/// Copies for one light.
pub(super) struct Copies {
    light: Buffer,
    camera: Buffer,
}

/// Bytes of a row of a copied texture.
fn row_bytes(width: u32, texel: u32) -> u32 {
    (width * texel).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT)
}

fn texel_bytes(precision: Precision) -> u32 {
    match precision {
        Precision::Float32 => 4,
        Precision::Unorm16 => 2,
    }
}

impl Copies {
    pub fn new(device: &Device, [resolution, faces]: [u32; 2], size: UVec2, precision: Precision) -> Result<Self, Error> {
        let buffer = |row: u32, rows: u32| {
            let usage = wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC;
            device.buffer("depth map copy", u64::from(row) * u64::from(rows), usage)
        };
        Ok(Self {
            light: buffer(row_bytes(resolution, texel_bytes(precision)), resolution * faces)?,
            camera: buffer(row_bytes(size.x, 4), size.y)?,
        })
    }

    /// Copies the map of a light, as it was just drawn, and the depth of the camera.
    pub fn take(&self, maps: &DepthMaps, faces: u32, pass: &mut PassContext) -> Result<(), kajo_render_graph::Error> {
        let camera = pass.texture(slot::DEPTH)?.wgpu.clone();
        let mut copy = |texture: &wgpu::Texture, layers: u32, texel: u32, buffer: &Buffer| {
            let (width, height) = (texture.width(), texture.height());
            let layout =
                wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row_bytes(width, texel)), rows_per_image: Some(height) };
            pass.encoder.copy_texture_to_buffer(
                wgpu::TexelCopyTextureInfo { aspect: wgpu::TextureAspect::DepthOnly, ..texture.as_image_copy() },
                wgpu::TexelCopyBufferInfo { buffer: &buffer.wgpu, layout },
                wgpu::Extent3d { width, height, depth_or_array_layers: layers },
            );
        };
        copy(&maps.caster.depth().wgpu, faces, texel_bytes(maps.settings.precision), &self.light);
        copy(&camera, 1, 4, &self.camera);
        Ok(())
    }
}

impl DepthMaps {
    /// For each light of the frame: `light-depth`, distance from the light along the axis of the map, m, faces of a cube side by side; `camera-depth`, distance
    /// along the viewing axis, m; `reprojection`, how far each visible point lies behind what the light sees in its direction, m, 0 where it is lit. What
    /// nothing fills is infinite.
    ///
    /// # Errors
    /// When the device is lost.
    pub fn debug_views(&self, frame: &FrameContext) -> Result<Vec<DebugView>, Error> {
        let mut views = Vec::new();
        for (layer, copies) in self.copies.iter().enumerate() {
            let projection = &self.projections[layer];
            let light_depth = self.light_depth(frame.device, copies, projection)?;
            let camera: Vec<f32> = readback::read_buffer(frame.device, &copies.camera.wgpu)?;
            let stride = row_bytes(frame.size().x, 4) / 4;
            let stored = Image::from_fn(frame.size(), |x, y| camera[(y * stride + x) as usize]);
            let positions = positions(frame, &stored);
            let forward = frame.view.relative_from_view.transform_vector3(Vec3::NEG_Z);
            let camera_depth = positions.map(|p| p.map_or(f32::INFINITY, |p| p.dot(forward)));
            let reprojection = positions.map(|p| p.map_or(f32::INFINITY, |p| self.behind(p, projection, &light_depth)));
            let light = frame.first_light + layer as u32;
            for (name, image) in [("light-depth", light_depth), ("camera-depth", camera_depth), ("reprojection", reprojection)] {
                views.push(DebugView { name, light, pixels: DebugPixels::Scalar(image) });
            }
        }
        Ok(views)
    }

    /// Distances along the axis of the map, the faces side by side.
    fn light_depth(&self, device: &Device, copies: &Copies, projection: &Projection) -> Result<Image<f32>, Error> {
        let (resolution, faces) = (self.resolution, projection.faces.len() as u32);
        let stride = row_bytes(resolution, texel_bytes(self.settings.precision)) / texel_bytes(self.settings.precision);
        let at = |x: u32, y: u32| ((x / resolution * resolution + y) * stride + x % resolution) as usize;
        let stored: Vec<f32> = match self.settings.precision {
            Precision::Float32 => readback::read_buffer(device, &copies.light.wgpu)?,
            Precision::Unorm16 => {
                let steps: Vec<u16> = readback::read_buffer(device, &copies.light.wgpu)?;
                steps.iter().map(|step| f32::from(*step) / 65535.0).collect()
            }
        };
        Ok(Image::from_fn(UVec2::new(resolution * faces, resolution), |x, y| match stored[at(x, y)] {
            empty if empty <= 0.0 || !projection.is_used[(x / resolution) as usize] => f32::INFINITY,
            depth => self.distance_of(depth, projection),
        }))
    }

    /// Twin of `distance_of` in depth_map.wesl.
    fn distance_of(&self, stored: f32, projection: &Projection) -> f32 {
        match (self.settings.layout, projection.parallel) {
            (DepthLayout::Perspective, false) => projection.near / stored.max(projection.near / projection.far),
            _ => (1.0 - stored) * projection.far,
        }
    }

    /// How far a point lies behind what the light sees in its direction, along the axis of the map, m.
    fn behind(&self, relative: Vec3, projection: &Projection, light_depth: &Image<f32>) -> f32 {
        for (face, clip_from_relative) in projection.faces.iter().enumerate() {
            let clip = *clip_from_relative * relative.extend(1.0);
            if clip.w <= 0.0 || clip.x.abs() > clip.w || clip.y.abs() > clip.w {
                continue;
            }
            let side = self.resolution as f32;
            let texel = |ndc: f32| (((ndc * 0.5 + 0.5) * side) as u32).min(self.resolution - 1);
            let seen = *light_depth.get(texel(clip.x / clip.w) + face as u32 * self.resolution, texel(-clip.y / clip.w));
            let own = if projection.parallel { (1.0 - clip.z / clip.w) * projection.far } else { clip.w };
            return if seen.is_finite() { (own - seen).max(0.0) } else { 0.0 };
        }
        0.0
    }
}

/// Camera-relative points behind the pixels.
fn positions(frame: &FrameContext, stored: &Image<f32>) -> Image<Option<Vec3>> {
    let relative_from_clip = frame.view.jittered_clip_from_relative().as_dmat4().inverse();
    let size = stored.size().as_dvec2();
    Image::from_fn(stored.size(), |x, y| {
        let depth = *stored.get(x, y);
        let ndc = (glam::dvec2(f64::from(x), f64::from(y)) + 0.5) / size * 2.0 - 1.0;
        let p = relative_from_clip * glam::dvec4(ndc.x, -ndc.y, f64::from(depth), 1.0);
        (depth > 0.0).then(|| (p.truncate() / p.w).as_vec3())
    })
}

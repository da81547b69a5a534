//! A window that nobody sees: a texture of its size, read back as a picture.

use crate::Error;
use crate::paint::{Brush, Shapes};
use egui_wgpu::wgpu;
use glam::UVec2;
use kajo_image::Image;
use kajo_units::Srgb8;

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// Where frames are painted that go to a file, or to a test.
pub(crate) struct Canvas {
    /// Paints.
    pub brush: Brush,
    texture: wgpu::Texture,
}

impl Canvas {
    /// A canvas of `size`.
    ///
    /// # Errors
    /// [`Error::NoAdapter`].
    pub fn new(size: UVec2) -> Result<Self, Error> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        let brush = Brush::new(instance, None)?;
        let texture = texture(&brush.device, size, FORMAT);
        Ok(Self { brush, texture })
    }

    /// Has another size from now on; sides are at least 1.
    pub fn resize(&mut self, size: UVec2) {
        let now = UVec2::new(self.texture.width(), self.texture.height());
        if size.max(UVec2::ONE) != now {
            self.texture = texture(&self.brush.device, size, FORMAT);
        }
    }

    /// Paints a frame.
    pub fn paint(&mut self, context: &egui::Context, frame: Shapes) {
        self.brush.paint(context, frame, &self.texture);
    }

    /// Leaves a frame out.
    pub fn skip(&mut self, frame: Shapes) {
        self.brush.absorb(frame, FORMAT);
    }

    /// What was painted.
    ///
    /// # Errors
    /// [`Error::PaintingLost`].
    pub fn read(&self) -> Result<Image<Srgb8>, Error> {
        read(&self.brush, &self.texture)
    }
}

/// The pixels of a texture of [`texture`].
///
/// # Errors
/// [`Error::PaintingLost`].
pub(crate) fn read(brush: &Brush, texture: &wgpu::Texture) -> Result<Image<Srgb8>, Error> {
    let lost = |reason: String| Error::PaintingLost { reason };
    let (device, size) = (&brush.device, texture.size());
    let row = (size.width * 4).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("screenshot"),
        size: u64::from(row) * u64::from(size.height),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("screenshot") });
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: None };
    encoder.copy_texture_to_buffer(texture.as_image_copy(), wgpu::TexelCopyBufferInfo { buffer: &buffer, layout }, size);
    brush.queue.submit([encoder.finish()]);
    buffer.slice(..).map_async(wgpu::MapMode::Read, |_| ());
    device.poll(wgpu::PollType::wait_indefinitely()).map_err(|error| lost(error.to_string()))?;
    if let Some(reason) = brush.trouble() {
        return Err(lost(reason));
    }
    let bytes = buffer.slice(..).get_mapped_range().map_err(|error| lost(error.to_string()))?;
    let swapped = matches!(texture.format(), wgpu::TextureFormat::Bgra8Unorm | wgpu::TextureFormat::Bgra8UnormSrgb);
    let pixel = |x: u32, y: u32| {
        let at = (y * row + x * 4) as usize;
        let [a, g, b] = [bytes[at], bytes[at + 1], bytes[at + 2]];
        Srgb8(if swapped { [b, g, a] } else { [a, g, b] })
    };
    Ok(Image::from_fn(UVec2::new(size.width, size.height), pixel))
}

/// A texture to paint and to read.
pub(crate) fn texture(device: &wgpu::Device, size: UVec2, format: wgpu::TextureFormat) -> wgpu::Texture {
    let size = size.max(UVec2::ONE);
    device.create_texture(&wgpu::TextureDescriptor {
        label: Some("canvas"),
        size: wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    })
}

//! egui's shapes on a texture: of a window, or of none.

use crate::Error;
use egui::{Context, TexturesDelta, epaint::ClippedShape};
use egui_wgpu::{Renderer, RendererOptions, ScreenDescriptor, wgpu};
use std::sync::{Arc, Mutex, PoisonError};

/// A device that paints, apart from the one that renders scenes.
pub(crate) struct Brush {
    pub instance: wgpu::Instance,
    pub adapter: wgpu::Adapter,
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
    /// The first thing that went wrong on the device.
    trouble: Arc<Mutex<Option<String>>>,
    /// Made with the format of the first target.
    renderer: Option<(wgpu::TextureFormat, Renderer)>,
}

/// One frame of the window.
pub(crate) struct Shapes {
    pub textures: TexturesDelta,
    pub shapes: Vec<ClippedShape>,
    pub pixels_per_point: f32,
}

impl Shapes {
    /// The same shapes for another target; the textures come with the first.
    pub fn copy(&mut self) -> Self {
        Self { textures: std::mem::take(&mut self.textures), shapes: self.shapes.clone(), pixels_per_point: self.pixels_per_point }
    }
}

impl Brush {
    /// A device that can paint `surface`, or none.
    ///
    /// # Errors
    /// [`Error::NoAdapter`].
    pub fn new(instance: wgpu::Instance, surface: Option<&wgpu::Surface<'_>>) -> Result<Self, Error> {
        let none = |reason: String| Error::NoAdapter { reason };
        let options = wgpu::RequestAdapterOptions { compatible_surface: surface, ..Default::default() };
        let adapter = pollster::block_on(instance.request_adapter(&options)).map_err(|error| none(error.to_string()))?;
        let limits = adapter.limits();
        let request = wgpu::DeviceDescriptor {
            label: Some("window"),
            required_limits: wgpu::Limits {
                max_texture_dimension_2d: limits.max_texture_dimension_2d,
                ..wgpu::Limits::downlevel_defaults()
            },
            ..Default::default()
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&request)).map_err(|error| none(error.to_string()))?;
        let trouble = Arc::new(Mutex::new(None));
        let keep = |slot: &Arc<Mutex<Option<String>>>| {
            let slot = slot.clone();
            move |text: String| {
                tracing::debug!("{text}");
                slot.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(text);
            }
        };
        let (lost, refused) = (keep(&trouble), keep(&trouble));
        device.set_device_lost_callback(move |_, reason| lost(reason));
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| refused(error.to_string())));
        Ok(Self { instance, adapter, device, queue, trouble, renderer: None })
    }

    /// Largest side of a texture, px.
    pub fn max_side(&self) -> u32 {
        self.device.limits().max_texture_dimension_2d
    }

    /// Paints a frame.
    pub fn paint(&mut self, context: &Context, frame: Shapes, target: &wgpu::Texture) {
        let mut textures = frame.textures;
        self.upload(&mut textures, target.format());
        let (device, queue) = (&self.device, &self.queue);
        let Some((_, renderer)) = &mut self.renderer else { return };
        let jobs = context.tessellate(frame.shapes, frame.pixels_per_point);
        let size = target.size();
        let screen = ScreenDescriptor { size_in_pixels: [size.width, size.height], pixels_per_point: frame.pixels_per_point };
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("window") });
        let before = renderer.update_buffers(device, queue, &mut encoder, &jobs, &screen);
        let view = target.create_view(&wgpu::TextureViewDescriptor::default());
        let attachment = wgpu::RenderPassColorAttachment {
            view: &view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store: wgpu::StoreOp::Store },
        };
        let pass = wgpu::RenderPassDescriptor { label: Some("window"), color_attachments: &[Some(attachment)], ..Default::default() };
        let mut pass = encoder.begin_render_pass(&pass).forget_lifetime();
        renderer.render(&mut pass, &jobs, &screen);
        drop(pass);
        queue.submit(before.into_iter().chain([encoder.finish()]));
        textures.free.drain().for_each(|id| renderer.free_texture(&id));
    }

    /// Takes the textures of a frame that is not painted: later ones rely on them.
    pub fn absorb(&mut self, frame: Shapes, format: wgpu::TextureFormat) {
        let mut textures = frame.textures;
        self.upload(&mut textures, format);
        if let Some((_, renderer)) = &mut self.renderer {
            textures.free.drain().for_each(|id| renderer.free_texture(&id));
        }
    }

    fn upload(&mut self, textures: &mut TexturesDelta, format: wgpu::TextureFormat) {
        if self.renderer.as_ref().is_none_or(|(made_for, _)| *made_for != format) {
            self.renderer = Some((format, Renderer::new(&self.device, format, RendererOptions::default())));
        }
        let Some((_, renderer)) = &mut self.renderer else { return };
        for (id, deltas) in textures.set.drain() {
            deltas.iter().for_each(|delta| renderer.update_texture(&self.device, &self.queue, id, delta));
        }
    }

    /// What went wrong since the last look.
    pub fn trouble(&self) -> Option<String> {
        self.trouble.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}

/// Gamma-encoded values are stored as they are: egui blends in them.
pub(crate) fn format_of(formats: &[wgpu::TextureFormat]) -> Option<wgpu::TextureFormat> {
    let plain = [wgpu::TextureFormat::Rgba8Unorm, wgpu::TextureFormat::Bgra8Unorm];
    formats.iter().copied().find(|format| plain.contains(format)).or_else(|| formats.first().copied())
}

//! The window: winit's events in, frames out. It sleeps until something happens.

use crate::app::App;
use crate::paint::{Brush, Shapes, format_of};
use crate::script::{Next, Runner};
use crate::usage::Usage;
use crate::{Error, Options, canvas, save};
use egui::ViewportId;
use egui_wgpu::wgpu;
use glam::UVec2;
use kajo_image::write_png;
use std::sync::Arc;
use std::time::{Duration, Instant};
use winit::application::ApplicationHandler;
use winit::dpi::PhysicalSize;
use winit::event::{StartCause, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop, EventLoopProxy};
use winit::window::{Window, WindowId};

/// Time between the frames of a script, and between looks at threads.
const PACE: Duration = Duration::from_millis(8);
const NAP: Duration = Duration::from_millis(200);

/// A thread has an answer, or egui wants another frame after a while.
#[derive(Clone, Copy, Debug)]
struct Repaint {
    after: Duration,
}

/// Opens the window and stays until it is closed.
///
/// # Errors
/// When the system has no place for a window, or nothing can paint it.
pub(crate) fn run(options: &Options, app: App, script: Option<Runner>) -> Result<(), Error> {
    let no_window = |error: winit::error::EventLoopError| Error::NoWindow { reason: reason(&error) };
    let events = EventLoop::<Repaint>::with_user_event().build().map_err(no_window)?;
    let proxy: EventLoopProxy<Repaint> = events.create_proxy();
    app.context.set_request_repaint_callback(move |info| {
        // The window is gone when nobody listens.
        let _ = proxy.send_event(Repaint { after: info.delay });
    });
    let size = PhysicalSize::new(options.size.x, options.size.y);
    let mut handler = Handler { app, script, size, open: None, wake: None, failed: None };
    events.run_app(&mut handler).map_err(no_window)?;
    handler.failed.map_or(Ok(()), Err)
}

/// In one line, without the place in winit's source.
fn reason(error: &winit::error::EventLoopError) -> String {
    let text = error.to_string();
    let after_place = text.split_once(".rs:").and_then(|(_, rest)| rest.split_once(": "));
    let short = after_place.map_or(text.as_str(), |(_, short)| short);
    short.lines().next().unwrap_or(short).trim_end_matches('.').to_owned()
}

struct Handler {
    app: App,
    /// Instead of a person.
    script: Option<Runner>,
    size: PhysicalSize<u32>,
    open: Option<Open>,
    /// When the next frame is due without an event.
    wake: Option<Instant>,
    failed: Option<Error>,
}

/// A window that stands.
struct Open {
    window: Arc<Window>,
    surface: wgpu::Surface<'static>,
    format: wgpu::TextureFormat,
    configured: PhysicalSize<u32>,
    brush: Brush,
    input: egui_winit::State,
}

impl Open {
    fn new(events: &ActiveEventLoop, app: &App, size: PhysicalSize<u32>) -> Result<Self, Error> {
        let attributes =
            Window::default_attributes().with_title("Kajo").with_inner_size(size).with_min_inner_size(PhysicalSize::new(320, 200));
        let window = events.create_window(attributes).map_err(|error| Error::NoWindow { reason: error.to_string() })?;
        let window = Arc::new(window);
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        let surface = instance.create_surface(window.clone()).map_err(|error| Error::NoAdapter { reason: error.to_string() })?;
        let brush = Brush::new(instance, Some(&surface))?;
        let format = format_of(&surface.get_capabilities(&brush.adapter).formats);
        let format = format.ok_or_else(|| Error::NoAdapter { reason: "the adapter cannot show anything on this screen".into() })?;
        let side = Some(brush.max_side() as usize);
        let scale = Some(window.scale_factor() as f32);
        let input = egui_winit::State::new(app.context.clone(), ViewportId::ROOT, events, scale, window.theme(), side);
        Ok(Self { window, surface, format, configured: PhysicalSize::new(0, 0), brush, input })
    }

    /// Gives the surface the window's size. False for a window without pixels.
    fn configure(&mut self) -> bool {
        let size = self.window.inner_size();
        let limit = self.brush.max_side();
        let size = PhysicalSize::new(size.width.min(limit), size.height.min(limit));
        if size.width == 0 || size.height == 0 {
            return false;
        }
        if size != self.configured {
            let Some(config) = self.surface.get_default_config(&self.brush.adapter, size.width, size.height) else { return false };
            let config = wgpu::SurfaceConfiguration { format: self.format, desired_maximum_frame_latency: 1, ..config };
            self.surface.configure(&self.brush.device, &config);
            self.configured = size;
        }
        true
    }

    /// The texture to paint, made anew where the system wants it; `None` when this frame is to be left out.
    fn target(&mut self) -> Result<Option<wgpu::SurfaceTexture>, Error> {
        for _ in 0..2 {
            if !self.configure() {
                return Ok(None);
            }
            match self.surface.get_current_texture() {
                wgpu::CurrentSurfaceTexture::Success(texture) | wgpu::CurrentSurfaceTexture::Suboptimal(texture) => {
                    return Ok(Some(texture));
                }
                wgpu::CurrentSurfaceTexture::Timeout | wgpu::CurrentSurfaceTexture::Occluded => return Ok(None),
                wgpu::CurrentSurfaceTexture::Outdated | wgpu::CurrentSurfaceTexture::Validation => {
                    self.configured = PhysicalSize::new(0, 0);
                }
                wgpu::CurrentSurfaceTexture::Lost => {
                    let surface = self.brush.instance.create_surface(self.window.clone());
                    self.surface = surface.map_err(|error| Error::PaintingLost { reason: error.to_string() })?;
                    self.configured = PhysicalSize::new(0, 0);
                }
            }
        }
        Ok(None)
    }
}

impl Handler {
    /// Carries out what the script says until it wants a frame; `None` without a script.
    fn follow(&mut self) -> Result<Option<Next>, Error> {
        let (Some(script), Some(open)) = (&mut self.script, &self.open) else { return Ok(None) };
        loop {
            let next = script.advance(&mut self.app)?;
            match &next {
                Next::Measure => script.measured(Usage::of(&self.app, &open.brush)),
                Next::Resize(size) => {
                    let _ = open.window.request_inner_size(PhysicalSize::new(size.x, size.y));
                    return Ok(Some(next));
                }
                _ => return Ok(Some(next)),
            }
        }
    }

    fn draw(&mut self, events: &ActiveEventLoop) -> Result<(), Error> {
        let next = self.follow()?;
        if next == Some(Next::Close) {
            events.exit();
            return Ok(());
        }
        let Some(open) = &mut self.open else { return Ok(()) };
        // A window without pixels keeps its answers until it is seen again.
        if open.window.inner_size().width == 0 || open.window.inner_size().height == 0 {
            return Ok(());
        }
        let input = open.input.take_egui_input(&open.window);
        let output = self.app.frame(input);
        let mut shapes = Shapes { textures: output.textures_delta, shapes: output.shapes, pixels_per_point: output.pixels_per_point };
        open.input.handle_platform_output(&open.window, output.platform_output);
        if let Some(delay) = output.viewport_output.get(&ViewportId::ROOT).map(|viewport| viewport.repaint_delay) {
            self.wake = Instant::now().checked_add(delay);
        }
        if let Some(next) = &next {
            let pause = Instant::now() + if *next == Next::Sleep { NAP } else { PACE };
            self.wake = Some(self.wake.map_or(pause, |wake| wake.min(pause)));
        }
        if let Some(Next::Screenshot(path)) = next {
            let size = open.window.inner_size();
            let canvas = canvas::texture(&open.brush.device, UVec2::new(size.width, size.height), open.format);
            open.brush.paint(&self.app.context, shapes.copy(), &canvas);
            write_png(&path, &canvas::read(&open.brush, &canvas)?, &save::provenance(&self.app.model))?;
        }
        match open.target()? {
            Some(target) => {
                open.brush.paint(&self.app.context, shapes, &target.texture);
                open.window.pre_present_notify();
                open.brush.queue.present(target);
            }
            // Textures must not be missed, whether or not they are seen.
            None => open.brush.absorb(shapes, open.format),
        }
        open.brush.trouble().map_or(Ok(()), |reason| Err(Error::PaintingLost { reason }))
    }

    fn fail(&mut self, events: &ActiveEventLoop, error: Error) {
        self.failed.get_or_insert(error);
        events.exit();
    }
}

impl ApplicationHandler<Repaint> for Handler {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        if self.open.is_some() {
            return;
        }
        match Open::new(events, &self.app, self.size) {
            Ok(open) => {
                open.window.request_redraw();
                self.open = Some(open);
            }
            Err(error) => self.fail(events, error),
        }
    }

    fn new_events(&mut self, _: &ActiveEventLoop, cause: StartCause) {
        if let (StartCause::ResumeTimeReached { .. }, Some(open)) = (cause, &self.open) {
            self.wake = None;
            open.window.request_redraw();
        }
    }

    fn user_event(&mut self, _: &ActiveEventLoop, Repaint { after }: Repaint) {
        let due = Instant::now().checked_add(after);
        self.wake = match (self.wake, due) {
            (Some(a), Some(b)) => Some(a.min(b)),
            (a, b) => a.or(b),
        };
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let Some(open) = &mut self.open else { return };
        let response = open.input.on_window_event(&open.window, &event);
        if response.repaint {
            open.window.request_redraw();
        }
        match event {
            WindowEvent::CloseRequested => events.exit(),
            WindowEvent::Resized(_) | WindowEvent::Occluded(false) | WindowEvent::ScaleFactorChanged { .. } => open.window.request_redraw(),
            WindowEvent::RedrawRequested => {
                if let Err(error) = self.draw(events) {
                    self.fail(events, error);
                }
            }
            _ => {}
        }
    }

    fn about_to_wait(&mut self, events: &ActiveEventLoop) {
        match self.wake {
            Some(due) if due <= Instant::now() => {
                self.wake = None;
                if let Some(open) = &self.open {
                    open.window.request_redraw();
                }
                events.set_control_flow(ControlFlow::Wait);
            }
            Some(due) => events.set_control_flow(ControlFlow::WaitUntil(due)),
            None => events.set_control_flow(ControlFlow::Wait),
        }
    }
}

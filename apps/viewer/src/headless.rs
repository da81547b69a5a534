//! A script without a window: frames are painted on a canvas.

use crate::app::App;
use crate::canvas::Canvas;
use crate::paint::Shapes;
use crate::script::{Next, Runner};
use crate::usage::Usage;
use crate::{Error, save};
use egui::{RawInput, Rect, ViewportId, pos2};
use glam::UVec2;
use kajo_image::write_png;
use std::time::Duration;

/// How long to wait for a thread.
const NAP: Duration = Duration::from_millis(10);

/// Runs a script to its end.
///
/// # Errors
/// Those of the script, and of a device that cannot paint.
pub(crate) fn run(app: &mut App, script: &mut Runner, size: UVec2) -> Result<(), Error> {
    let mut canvas = Canvas::new(size)?;
    let mut size = size;
    let mut time = 0.0;
    loop {
        let next = script.advance(app)?;
        match &next {
            Next::Close => return Ok(()),
            Next::Sleep => std::thread::sleep(NAP),
            Next::Measure => {
                script.measured(Usage::of(app, &canvas.brush));
                continue;
            }
            Next::Resize(to) => {
                size = *to;
                canvas.resize(size);
            }
            Next::Paint | Next::Screenshot(_) => {}
        }
        time += 1.0 / 60.0;
        let output = app.frame(input(size, time, canvas.brush.max_side()));
        let shapes = Shapes { textures: output.textures_delta, shapes: output.shapes, pixels_per_point: output.pixels_per_point };
        if next == Next::Sleep {
            canvas.skip(shapes);
        } else {
            canvas.paint(&app.context, shapes);
        }
        if let Next::Screenshot(path) = next {
            write_png(&path, &canvas.read()?, &save::provenance(&app.model))?;
        }
    }
}

/// What egui is told of a window of that size at that time, s.
pub(crate) fn input(size: UVec2, time: f64, max_side: u32) -> RawInput {
    let mut input = RawInput { time: Some(time), max_texture_side: Some(max_side as usize), ..RawInput::default() };
    input.screen_rect = Some(Rect::from_min_max(pos2(0.0, 0.0), pos2(size.x as f32, size.y as f32)));
    input.viewports.entry(ViewportId::ROOT).or_default().native_pixels_per_point = Some(1.0);
    input
}

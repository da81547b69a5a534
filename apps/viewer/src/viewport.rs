//! The picture: strips, sliders between them, and the hand on the camera.

use crate::camera::{Mode, Rig};
use crate::layout::Pane;
use crate::model::Model;
use crate::textures::Textures;
use egui::{
    Align2, CentralPanel, Color32, CursorIcon, FontId, Frame, Id, Key, PointerButton, Rect, Response, Sense, Stroke, Ui, pos2, vec2,
};
use glam::{UVec2, Vec2, Vec3};

/// Half the width of the place where a slider can be taken, points.
const GRIP: f32 = 5.0;
/// Points of the wheel that are one step.
const STEP: f32 = 50.0;
/// With shift, flight is this much faster.
const HASTE: f32 = 4.0;

/// Shows the picture in what the panels leave.
pub(crate) fn show(ui: &mut Ui, model: &mut Model, textures: &Textures) {
    CentralPanel::no_frame().frame(Frame::NONE.fill(Color32::from_gray(12))).show(ui, |ui| {
        let whole = ui.available_rect_before_wrap();
        let pixels = whole.size().max(egui::Vec2::ZERO) * ui.pixels_per_point();
        model.screen = UVec2::new(pixels.x.round() as u32, pixels.y.round() as u32);
        let response = ui.allocate_rect(whole, Sense::click_and_drag());
        strips(ui, model, textures, whole);
        sliders(ui, model, whole);
        if let Some(rig) = &mut model.rig {
            steer(ui, rig, &response, whole);
        }
        message(ui, model, whole);
    });
}

fn strips(ui: &Ui, model: &Model, textures: &Textures, whole: Rect) {
    let strips = model.layout.strips(whole);
    for (pane, strip) in &strips {
        let painter = ui.painter().with_clip_rect(*strip);
        match textures.get(*pane) {
            Some((texture, size)) => {
                painter.image(texture, fitted(whole, size), Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0)), Color32::WHITE);
            }
            None if model.moment.is_some() => label(&painter, strip.center(), Align2::CENTER_CENTER, &waiting(model, *pane)),
            None => {}
        }
        if strips.len() > 1 {
            label(&painter, strip.left_bottom() + vec2(8.0, -8.0), Align2::LEFT_BOTTOM, &title(model, *pane));
        }
    }
}

/// Where a picture of another shape than the window stands: whole, in the middle. Pictures of the window's shape fill it to the last pixel.
fn fitted(whole: Rect, [width, height]: [usize; 2]) -> Rect {
    let shape = |width: f32, height: f32| width / height.max(1.0);
    let ratio = shape(width as f32, height as f32) / shape(whole.width(), whole.height()).max(1e-6);
    if (0.95..=1.05).contains(&ratio) || width == 0 || height == 0 {
        return whole;
    }
    let scale = (whole.width() / width as f32).min(whole.height() / height as f32);
    Rect::from_center_size(whole.center(), vec2(width as f32, height as f32) * scale)
}

/// What stands in a strip without a picture.
fn waiting(model: &Model, pane: Pane) -> String {
    let side = usize::from(pane == Pane::B);
    match pane {
        Pane::A | Pane::B => match model.frames.as_ref().and_then(|frames| frames.sides.get(side)) {
            Some(Err(reason)) => reason.clone(),
            Some(Ok(_)) => "this technique does not have this picture".to_owned(),
            None => "rendering …".to_owned(),
        },
        Pane::Reference if !model.show.has_reference() => "there is no reference for this".to_owned(),
        Pane::Reference | Pane::HeatA | Pane::HeatB => model.reference_failed.clone().unwrap_or_else(|| "path tracing …".to_owned()),
    }
}

fn title(model: &Model, pane: Pane) -> String {
    match pane {
        Pane::A => model.selection.champion().technique.title.to_owned(),
        Pane::B => model.selection.rival.technique.title.to_owned(),
        Pane::Reference => match model.current_reference() {
            Some(reference) => format!("Path traced, {} samples", reference.spp),
            None => "Path traced".to_owned(),
        },
        Pane::HeatA => format!("FLIP of {}", model.selection.champion().technique.title),
        Pane::HeatB => format!("FLIP of {}", model.selection.rival.technique.title),
    }
}

/// Light text on a dark plate: readable over any picture.
fn label(painter: &egui::Painter, at: egui::Pos2, anchor: Align2, text: &str) {
    let width = painter.clip_rect().width() - 24.0;
    let text = painter.layout(text.to_owned(), FontId::proportional(13.0), Color32::from_gray(235), width.max(40.0));
    let rect = anchor.anchor_size(at, text.size());
    painter.rect_filled(rect.expand(4.0), 3.0, Color32::from_black_alpha(170));
    painter.galley(rect.min, text, Color32::WHITE);
}

fn sliders(ui: &Ui, model: &mut Model, whole: Rect) {
    for index in 0..model.layout.dividers().len() {
        let x = whole.left() + model.layout.dividers()[index] * whole.width();
        let grip = Rect::from_min_max(pos2(x - GRIP, whole.top()), pos2(x + GRIP, whole.bottom()));
        let response =
            ui.interact(grip, Id::unique(("slider", index)), Sense::drag()).on_hover_and_drag_cursor(CursorIcon::ResizeHorizontal);
        if let Some(pointer) = response.interact_pointer_pos().filter(|_| response.dragged()) {
            model.layout.drag(index, (pointer.x - whole.left()) / whole.width().max(1.0));
        }
        let strong = response.hovered() || response.dragged();
        let color = if strong { Color32::WHITE } else { Color32::from_white_alpha(150) };
        ui.painter().with_clip_rect(whole).vline(x, whole.y_range(), Stroke::new(if strong { 2.0 } else { 1.0 }, color));
    }
}

/// Mouse and keys move the camera.
fn steer(ui: &Ui, rig: &mut Rig, response: &Response, whole: Rect) {
    let drag = Vec2::new(response.drag_delta().x, response.drag_delta().y);
    let shift = ui.input(|input| input.modifiers.shift);
    if response.dragged_by(PointerButton::Middle) || (shift && response.dragged_by(PointerButton::Primary)) {
        rig.pan(drag, whole.height());
    } else if response.dragged_by(PointerButton::Secondary) || (rig.mode == Mode::Fly && response.dragged()) {
        rig.look(drag);
    } else if response.dragged() {
        rig.orbit(drag);
    }
    if response.hovered() {
        let steps = ui.input(|input| input.smooth_scroll_delta().y) / STEP;
        match rig.mode {
            _ if steps == 0.0 => {}
            Mode::Orbit => rig.zoom(steps),
            Mode::Fly => rig.hasten(steps),
        }
    }
    if !ui.ctx().egui_wants_keyboard_input() {
        let direction = ui.input(|input| walk(|key| input.key_down(key)));
        if direction != Vec3::ZERO {
            let seconds = ui.input(|input| input.stable_dt).min(0.1);
            rig.fly(direction * if shift { HASTE } else { 1.0 }, seconds);
            ui.ctx().request_repaint();
        }
    }
}

/// Where the keys lead: x right, y up, z back.
fn walk(down: impl Fn(Key) -> bool) -> Vec3 {
    let axis = |plus: Key, minus: Key| f32::from(u8::from(down(plus))) - f32::from(u8::from(down(minus)));
    Vec3::new(axis(Key::D, Key::A), axis(Key::E, Key::Q), axis(Key::S, Key::W))
}

/// What to do when there is nothing to see.
fn message(ui: &Ui, model: &Model, whole: Rect) {
    let painter = ui.painter().with_clip_rect(whole);
    let hovering = ui.input(|input| !input.raw.hovered_files.is_empty());
    let text = if hovering {
        "Drop it to look at it".to_owned()
    } else if let Some(reason) = &model.frames_failed {
        reason.clone()
    } else if let (None, Some(source)) = (&model.moment, &model.loading) {
        format!("Loading {} …", source.reference)
    } else if model.moment.is_none() {
        "Drop a scene here: .gltf, .glb, .obj or .kajo.toml\nAn environment, .hdr or .exr, lights it".to_owned()
    } else {
        return;
    };
    label(&painter, whole.center(), Align2::CENTER_CENTER, &text);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_of_another_shape_are_shown_whole() {
        let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(400.0, 200.0));
        assert_eq!(fitted(whole, [200, 101]), whole);
        assert_eq!(fitted(whole, [512, 512]), Rect::from_min_max(pos2(100.0, 0.0), pos2(300.0, 200.0)));
        assert_eq!(fitted(whole, [800, 100]), Rect::from_min_max(pos2(0.0, 75.0), pos2(400.0, 125.0)));
    }

    #[test]
    fn keys_lead_where_they_say() {
        let keys = |down: &'static [Key]| walk(move |key| down.contains(&key));
        assert_eq!(keys(&[Key::W, Key::D]), Vec3::new(1.0, 0.0, -1.0));
        assert_eq!(keys(&[Key::W, Key::S, Key::E]), Vec3::Y);
    }
}

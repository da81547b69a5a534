//! Messages above the picture; each stays until it is closed.

use crate::model::Model;
use egui::{Color32, RichText, Ui};

pub(crate) fn show(ui: &mut Ui, model: &mut Model) {
    let mut closed = None;
    for (index, notice) in model.notices.iter().enumerate() {
        let color = if notice.error { Color32::from_rgb(255, 170, 120) } else { Color32::from_rgb(160, 200, 255) };
        ui.horizontal_wrapped(|ui| {
            if ui.small_button("×").on_hover_text("Close").clicked() {
                closed = Some(index);
            }
            ui.label(RichText::new(&notice.text).color(color));
        });
    }
    if let Some(index) = closed {
        model.notices.remove(index);
    }
}

//! The list of what the picture leaves out.

use crate::model::Model;
use egui::{RichText, Ui};

pub(crate) fn show(ui: &mut Ui, model: &Model) {
    let ignored = model.ignored();
    if ignored.is_empty() {
        ui.label("Nothing that is known.");
    }
    for note in ignored {
        let place = if note.place.is_empty() { note.feature.clone() } else { format!("{}: {}", note.place, note.feature) };
        ui.label(RichText::new(place).small().strong());
        ui.label(RichText::new(&note.consequence).small());
    }
}

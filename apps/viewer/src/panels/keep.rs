//! What is taken away from the window: pictures, and the command that repeats what is seen.

use crate::model::Model;
use crate::{command, save};
use egui::{RichText, Ui};

pub(crate) fn show(ui: &mut Ui, model: &mut Model) {
    ui.horizontal(|ui| {
        for (ending, text) in [("png", "A as it is shown"), ("exr", "A with its numbers: light, visibility of each light, reference")] {
            if ui.button(format!("save .{ending}")).on_hover_text(format!("{text}, into the current folder")).clicked() {
                let path = save::free_name(ending);
                match save::picture(model, &path) {
                    Ok(()) => model.notify(format!("Saved {}.", path.display()), false),
                    Err(reason) => model.notify(reason, true),
                }
            }
        }
    });
    for (name, command) in [("kajo render", command::render(model)), ("kajo compare", command::compare(model))] {
        let Some(command) = command else { continue };
        if ui.button(format!("copy `{name} …`")).on_hover_text(&command).clicked() {
            ui.ctx().copy_text(command);
        }
    }
    if let Some(left_out) = command::left_out(model) {
        ui.label(RichText::new(left_out).small().weak());
    }
}

//! The error against the reference, live.

use super::table;
use crate::layout::Pane;
use crate::model::Model;
use crate::reference::TracedBy;
use egui::{DragValue, ProgressBar, RichText, Slider, Ui};
use kajo_techniques::Role;

pub(crate) fn show(ui: &mut Ui, model: &mut Model) {
    ui.horizontal(|ui| {
        ui.checkbox(&mut model.judging, "path trace the reference")
            .on_hover_text("At pixel centres, only the light that the judged role is about. It starts again when the camera moves.");
    });
    ui.horizontal(|ui| {
        ui.label("by");
        for (name, by) in TracedBy::ALL {
            ui.selectable_value(&mut model.traced_by, by, name);
        }
    });
    ui.horizontal(|ui| {
        ui.label("until");
        ui.add(DragValue::new(&mut model.spp).range(1..=65_536).speed(4.0).suffix(" samples a pixel"));
    });
    let role = model.selection.judged;
    ui.label(RichText::new(format!("judged by the image {}", role.judged_by())).small().weak());
    if let Some(reason) = &model.reference_failed {
        ui.label(reason);
        return;
    }
    let Some(reference) = model.current_reference() else {
        if model.reference_question().is_some() {
            ui.label("path tracing …");
        }
        return;
    };
    let share = reference.spp as f32 / reference.question.spp.max(1) as f32;
    ui.add(ProgressBar::new(share).text(format!("{} of {} samples, {:.1} s", reference.spp, reference.question.spp, reference.seconds)));
    let by = match &reference.on_device {
        Ok(device) => format!("traced by {device}"),
        Err(reason) => format!("traced by the CPU: {reason}"),
    };
    ui.label(RichText::new(by).small().weak());
    if reference.invalid > 0 {
        ui.label(format!("{} samples were not finite", reference.invalid));
    }
    numbers(ui, model, role);
    if model.layout.shows(Pane::HeatA) || model.layout.shows(Pane::HeatB) {
        ui.add(Slider::new(&mut model.heat_full, 0.02..=1.0).text("FLIP of the lightest").logarithmic(true));
    }
}

fn numbers(ui: &mut Ui, model: &Model, role: Role) {
    for (side, errors) in ["A", "B"].iter().zip(&model.errors) {
        match errors {
            None => {}
            Some(Err(reason)) => {
                ui.label(format!("{side}: {reason}"));
            }
            Some(Ok(errors)) => table(ui, side, |ui| {
                ui.label(RichText::new(format!("{side}  RMSE")).strong()).on_hover_text(format!("Unit: {}", role.unit()));
                ui.label(RichText::new(format!("{:.5}", errors.rmse)).monospace());
                ui.end_row();
                ui.label("of it noise of the reference").on_hover_text("The RMSE that a perfect technique has against this reference");
                ui.label(RichText::new(errors.floor.map_or_else(|| "not known yet".to_owned(), |floor| format!("{floor:.5}"))).monospace());
                ui.end_row();
                ui.label(RichText::new(format!("{side}  FLIP")).strong()).on_hover_text("Mean difference that an eye sees, 0 to 1");
                ui.label(RichText::new(format!("{:.4}", errors.flip)).monospace());
                ui.end_row();
                ui.label("mean / reference's mean");
                ui.label(RichText::new(errors.mean_ratio.map_or_else(|| "—".to_owned(), |ratio| format!("{ratio:.4}"))).monospace());
                ui.end_row();
                if errors.floor.is_some() && !errors.distinguishable {
                    ui.label(RichText::new("not to be told from the truth yet").weak());
                    ui.end_row();
                }
            }),
        }
    }
}

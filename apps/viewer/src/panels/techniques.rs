//! A technique for each role, from the registry.

use super::parameter;
use crate::model::Model;
use crate::selection::{Choice, filled_roles, judged_roles};
use egui::{ComboBox, RichText, Ui};
use kajo_techniques::Role;

pub(crate) fn show(ui: &mut Ui, model: &mut Model) {
    for role in filled_roles() {
        let mut choice = model.selection.chosen[&role].clone();
        let judged = role == model.selection.judged;
        let title = if judged { format!("{}: A", role.title()) } else { role.title().to_owned() };
        ui.label(RichText::new(title).strong()).on_hover_text(format!("estimates {}\nunit: {}", role.estimates(), role.unit()));
        if choose(ui, role.id(), role, &mut choice, &model.missing) {
            model.selection.chosen.insert(role, choice);
        }
        if judged && model.layout.needs_rival() {
            let mut rival = model.selection.rival.clone();
            ui.label(RichText::new(format!("{}: B", role.title())).strong());
            if choose(ui, "rival", role, &mut rival, &model.missing) {
                model.selection.rival = rival;
            }
        }
        ui.add_space(4.0);
    }
    if judged_roles().count() > 1 {
        let mut judged = model.selection.judged;
        ComboBox::from_label("is judged").selected_text(judged.title()).show_ui(ui, |ui| {
            judged_roles().for_each(|role| {
                ui.selectable_value(&mut judged, role, role.title());
            });
        });
        model.selection.judge(judged);
    }
}

/// The technique and its parameters. True when something was changed.
fn choose(ui: &mut Ui, name: &str, role: Role, choice: &mut Choice, missing: &[(&'static str, String)]) -> bool {
    let before = choice.technique.id;
    let shown = ComboBox::from_id_salt(("technique", name)).width(ui.available_width() - 8.0).selected_text(choice.technique.title);
    shown.show_ui(ui, |ui| {
        for technique in kajo_techniques::of_role(role) {
            let needs = missing.iter().find(|(id, _)| *id == technique.id).map(|(_, needs)| needs);
            ui.add_enabled_ui(needs.is_none(), |ui| {
                let entry = ui.selectable_label(technique.id == before, technique.title).on_hover_text(technique.id);
                let entry = entry.on_disabled_hover_text(format!("skipped: needs {}", needs.map_or("", String::as_str)));
                if entry.clicked() && technique.id != before {
                    *choice = Choice::new(technique);
                }
            });
        }
    });
    ui.label(RichText::new(choice.technique.id).small().weak()).on_hover_text(summary(choice.technique.doc));
    let edited = ui.indent(("parameters", name), |ui| parameter::show_all(ui, choice.technique.id, &mut choice.params)).inner;
    edited || choice.technique.id != before
}

/// The first paragraph of a document that is no heading.
fn summary(doc: &str) -> &str {
    doc.split("\n\n").map(str::trim).find(|paragraph| !paragraph.is_empty() && !paragraph.starts_with('#')).unwrap_or("")
}

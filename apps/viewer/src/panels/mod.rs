//! The panels around the picture, one file each. They read the model and change it, and know nothing of threads and windows.

mod compare;
mod cost;
mod footer;
mod keep;
mod notes;
mod notices;
mod parameter;
mod scene;
mod techniques;
mod view;

use crate::model::Model;
use egui::{CollapsingHeader, Context, Panel, ScrollArea, Ui, Visuals};

/// Width of the panel, points.
const WIDTH: f32 = 330.0;

/// Dark, so that pictures are judged beside a dim surround, as films are.
pub(crate) fn style(context: &Context) {
    context.set_theme(egui::Theme::Dark);
    let mut visuals = Visuals::dark();
    visuals.panel_fill = egui::Color32::from_gray(24);
    visuals.override_text_color = Some(egui::Color32::from_gray(215));
    context.set_visuals(visuals);
    context.all_styles_mut(|style| {
        style.text_styles.insert(egui::TextStyle::Small, egui::FontId::proportional(11.0));
    });
}

/// All panels; the picture takes what is left.
pub(crate) fn show(ui: &mut Ui, model: &mut Model) {
    Panel::bottom("footer").show(ui, |ui| footer::show(ui, model));
    if !model.notices.is_empty() {
        Panel::top("notices").show(ui, |ui| notices::show(ui, model));
    }
    Panel::right("panel").default_size(WIDTH).min_size(240.0).resizable(true).show(ui, |ui| {
        ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
            section(ui, "Scene", true, |ui| scene::show(ui, model));
            section(ui, "View", true, |ui| view::show(ui, model));
            section(ui, "Techniques", true, |ui| techniques::show(ui, model));
            section(ui, "Error", true, |ui| compare::show(ui, model));
            section(ui, "Cost", false, |ui| cost::show(ui, model));
            section(ui, "Keep", false, |ui| keep::show(ui, model));
            section(ui, "Not simulated", false, |ui| notes::show(ui, model));
        });
    });
}

fn section(ui: &mut Ui, title: &str, open: bool, contents: impl FnOnce(&mut Ui)) {
    CollapsingHeader::new(egui::RichText::new(title).strong()).default_open(open).show_unindented(ui, |ui| {
        contents(ui);
        ui.add_space(6.0);
    });
    ui.separator();
}

/// Two columns: what, and how much.
fn table(ui: &mut Ui, name: &str, rows: impl FnOnce(&mut Ui)) {
    egui::Grid::new(name).num_columns(2).spacing([12.0, 4.0]).show(ui, rows);
}

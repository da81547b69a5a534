//! What the window shows: strips, picture, size, exposure.

use crate::layout::{Layout, PRESETS};
use crate::metering::Metering;
use crate::model::Model;
use crate::show::{CHANNELS, Show};
use egui::{Color32, ComboBox, RichText, Slider, Ui};
use kajo_techniques::Role;

/// Pixels of the screen along a side of one that is rendered.
const COARSENESS: [u32; 4] = [1, 2, 4, 8];

pub(crate) fn show(ui: &mut Ui, model: &mut Model) {
    let mut preset = model.layout.preset();
    labelled(ui, "window", |ui| {
        ComboBox::from_id_salt("window").selected_text(preset.name).show_ui(ui, |ui| {
            for choice in PRESETS {
                ui.selectable_value(&mut preset, choice, choice.name);
            }
        });
    });
    if preset != model.layout.preset() {
        model.layout = Layout::new(preset);
    }
    labelled(ui, "shows", |ui| pictures(ui, model));
    legend(ui, model);
    labelled(ui, "pixels", |ui| {
        for side in COARSENESS {
            let name = if side == 1 { "1:1".to_owned() } else { format!("1/{side}") };
            let text = format!("Render one pixel for {side}×{side} of the screen");
            ui.selectable_value(&mut model.coarseness, side, name).on_hover_text(text);
        }
    });
    labelled(ui, "exposure", |ui| {
        ui.spacing_mut().slider_width = (ui.available_width() - 130.0).max(60.0);
        // Sliders round what they show.
        let rounded = (model.exposure * 10.0).round() / 10.0;
        let mut shown = rounded;
        ui.add(Slider::new(&mut shown, -16.0..=16.0).suffix(" stops").max_decimals(1));
        if (shown - rounded).abs() > 0.01 {
            (model.exposure, model.metering) = (shown, Metering::Fixed);
        }
        let mut follows = model.metering == Metering::Following;
        if ui.toggle_value(&mut follows, "auto").on_hover_text("Middle grey for the mean of what is seen, as it changes").changed() {
            model.meter(if follows { Metering::Following } else { Metering::Fixed });
        }
    });
}

fn pictures(ui: &mut Ui, model: &mut Model) {
    let lights = model.frames.as_ref().map(|frames| frames.lights.clone()).unwrap_or_default();
    let views = debug_views(model);
    let shown = name(&model.show, model.selection.judged.title(), &lights);
    ComboBox::from_id_salt("picture").width(ui.available_width() - 8.0).selected_text(shown).show_ui(ui, |ui| {
        let mut entry = |ui: &mut Ui, show: Show| {
            let text = name(&show, model.selection.judged.title(), &lights);
            ui.selectable_value(&mut model.show, show, text);
        };
        [Show::Picture, Show::Direct, Show::Role].into_iter().for_each(|show| entry(ui, show));
        let watched = model.frames.as_ref().map(|frames| frames.watched.clone()).unwrap_or_default();
        watched.iter().for_each(|light| entry(ui, Show::Light(*light)));
        watched.iter().for_each(|light| entry(ui, Show::Classes(*light)));
        entry(ui, Show::Failures);
        ui.separator();
        (0..CHANNELS.len()).for_each(|index| entry(ui, Show::Channel(index)));
        ui.separator();
        // The technique is asked for its views when they are first looked at.
        if views.is_empty() {
            entry(ui, Show::Debug { name: String::new(), light: 0 });
        }
        views.into_iter().for_each(|show| entry(ui, show));
    });
    // The first view that the technique has, once it is known.
    if matches!(&model.show, Show::Debug { name, .. } if name.is_empty())
        && let Some(first) = debug_views(model).into_iter().next()
    {
        model.show = first;
    }
}

/// What the colours mean; of faults with their shares on side A.
fn legend(ui: &mut Ui, model: &Model) {
    if model.show.legend().is_empty() {
        return;
    }
    let failures = model.errors.first().and_then(|side| side.as_ref()?.as_ref().ok()?.failures.as_ref());
    let shares = failures.filter(|_| model.show == Show::Failures).map(|(_, found)| found.by_id()).unwrap_or_default();
    ui.horizontal_wrapped(|ui| {
        for (color, name, meaning) in model.show.legend() {
            let [r, g, b] = color.0;
            let share = shares.get(name).map_or_else(String::new, |share| format!(" {:.2} %", 100.0 * share));
            ui.label(RichText::new("■").color(Color32::from_rgb(r, g, b)));
            let label = ui.label(format!("{name}{share}"));
            if !meaning.is_empty() {
                label.on_hover_text(meaning);
            }
        }
    });
    if model.show == Show::Failures && model.selection.judged != Role::DirectVisibility {
        ui.label("Shadows are told by the role direct visibility: judge that.");
    } else if model.show == Show::Failures && failures.is_none() {
        ui.label("needs the reference …");
    }
}

/// The views that the last frame has.
fn debug_views(model: &Model) -> Vec<Show> {
    let frame = model.frames.as_ref().and_then(|frames| frames.sides.first()?.as_ref().ok());
    let views = frame.into_iter().flat_map(|frame| &frame.debug);
    views.map(|view| Show::Debug { name: view.name.to_owned(), light: view.light }).collect()
}

fn name(show: &Show, role: &str, lights: &[String]) -> String {
    let light = |index: usize| lights.get(index).map_or_else(|| format!("light {index}"), Clone::clone);
    match show {
        Show::Picture => "picture".to_owned(),
        Show::Direct => "direct light".to_owned(),
        Show::Role => format!("{}, all lights", role.to_lowercase()),
        Show::Light(index) => format!("visibility of {}", light(*index)),
        Show::Classes(index) => format!("umbra, penumbra and lit of {}", light(*index)),
        Show::Failures => "how shadows fail".to_owned(),
        Show::Channel(index) => format!("G-buffer: {}", CHANNELS[*index].0),
        Show::Debug { name, .. } if name.is_empty() => "inner workings of A".to_owned(),
        Show::Debug { name, light } if *light == kajo_techniques::Statistic::NO_LIGHT => name.replace('-', " "),
        Show::Debug { name, light: index } => format!("{} of {}", name.replace('-', " "), light(*index as usize)),
    }
}

fn labelled(ui: &mut Ui, label: &str, contents: impl FnOnce(&mut Ui)) {
    ui.horizontal(|ui| {
        ui.add_sized([62.0, 18.0], egui::Label::new(label).halign(egui::Align::LEFT));
        contents(ui);
    });
}

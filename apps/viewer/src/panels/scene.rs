//! The scene: where it comes from, its cameras, its lights, its time.

use crate::camera::Mode;
use crate::model::Model;
use egui::{ComboBox, RichText, Slider, Ui};

pub(crate) fn show(ui: &mut Ui, model: &mut Model) {
    if let Some(source) = &model.loading {
        ui.horizontal(|ui| {
            ui.spinner();
            ui.label(format!("loading {}", source.reference));
        });
    }
    let Some(moment) = model.moment.clone() else {
        ui.label("No scene. Drop a .gltf, .glb, .obj or .kajo.toml file on the window.");
        return;
    };
    let source = &moment.stage.source;
    ui.label(RichText::new(short(&source.reference)).strong()).on_hover_text(&source.reference);
    if let Some(environment) = &source.environment {
        ui.label(format!("lit by {}", short(&environment.display().to_string())));
    }
    cameras(ui, model, &moment);
    let duration = moment.stage.duration;
    if duration > 0.0 && ui.add(Slider::new(&mut model.time, 0.0..=duration).text("time").suffix(" s")).changed() {
        model.refresh();
    }
    lights(ui, model);
}

fn cameras(ui: &mut Ui, model: &mut Model, moment: &crate::stage::Moment) {
    let Some(rig) = &mut model.rig else { return };
    let standing = rig.placed();
    let cameras = &moment.snapshot.cameras;
    let at = cameras.iter().position(|camera| camera.world_from_view == standing.world_from_view && camera.camera == standing.camera);
    let name = at.map_or_else(|| "moved".to_owned(), |index| name_of(&cameras[index].camera.name, index));
    ui.horizontal(|ui| {
        ui.label("camera");
        ComboBox::from_id_salt("camera").selected_text(name).show_ui(ui, |ui| {
            for (index, camera) in cameras.iter().enumerate() {
                if ui.selectable_label(at == Some(index), name_of(&camera.camera.name, index)).clicked() {
                    rig.place(camera, 0.5 * (moment.bounds[0] + moment.bounds[1]));
                }
            }
        });
        ui.selectable_value(&mut rig.mode, Mode::Orbit, "orbit")
            .on_hover_text("Drag: turn around the scene. Right drag: turn the head. Middle or shift drag: move sideways. Wheel: nearer.");
        ui.selectable_value(&mut rig.mode, Mode::Fly, "fly")
            .on_hover_text("Drag: turn the head. W A S D: move, E up, Q down, shift: four times as fast. Wheel: speed.");
    });
    if rig.mode == Mode::Fly {
        ui.label(RichText::new(format!("speed {:.3} m/s", rig.speed)).small().weak());
    }
}

fn lights(ui: &mut Ui, model: &mut Model) {
    if model.lights.is_empty() {
        return;
    }
    let mut changed = false;
    egui::CollapsingHeader::new(format!("{} lights", model.lights.len())).default_open(model.lights.len() < 6).show(ui, |ui| {
        for (index, name) in model.lights.iter().enumerate() {
            let mut lit = !model.dark.contains(&index);
            if ui.checkbox(&mut lit, name).on_hover_text("Off: the light is not there, for both renderers").changed() {
                changed = true;
                if lit {
                    model.dark.remove(&index)
                } else {
                    model.dark.insert(index)
                };
            }
        }
    });
    if changed {
        model.refresh();
    }
}

fn name_of(name: &str, index: usize) -> String {
    if name.is_empty() { format!("camera {index}") } else { name.to_owned() }
}

/// The last part of a path.
fn short(reference: &str) -> &str {
    reference.rsplit(['/', '\\']).next().unwrap_or(reference)
}

//! One line: device, size, time, memory, error.

use crate::model::Model;
use egui::{RichText, Ui};

pub(crate) fn show(ui: &mut Ui, model: &Model) {
    ui.horizontal(|ui| {
        let mut words = Vec::new();
        if let Some(device) = &model.device {
            words.push(format!("{} ({}, {})", device.name, device.kind, device.backend));
        }
        if let Some(shot) = model.shot() {
            words.push(format!("{}×{} px", shot.size.x, shot.size.y));
        }
        if let Some(Ok(frame)) = model.frames.as_ref().and_then(|frames| frames.sides.first()) {
            words.push(format!("{:.1} ms", frame.timings.total_ms()));
            words.push(format!("{:.0} MB", frame.memory_bytes as f64 / 1e6));
        }
        for (side, errors) in ["A", "B"].iter().zip(&model.errors) {
            if let Some(Ok(errors)) = errors {
                words.push(format!("{side}: RMSE {:.4}, FLIP {:.3}", errors.rmse, errors.flip));
            }
        }
        ui.label(RichText::new(words.join("   ·   ")).small());
    });
}

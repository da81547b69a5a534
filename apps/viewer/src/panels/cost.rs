//! What a frame of A costs, pass by pass.

use super::table;
use crate::model::Model;
use egui::{RichText, Ui};

pub(crate) fn show(ui: &mut Ui, model: &Model) {
    let Some(frames) = &model.frames else {
        ui.label("No frame yet.");
        return;
    };
    for (name, side) in ["A", "B"].iter().zip(&frames.sides) {
        let Ok(frame) = side else { continue };
        let on = if frame.timings.on_device { "by the device's timers" } else { "timed from outside" };
        ui.label(RichText::new(format!("{name}: {:.2} ms, {} rays", frame.timings.total_ms(), grouped(frame.rays))).strong())
            .on_hover_text(on);
        table(ui, name, |ui| {
            for (pass, ms) in &frame.timings.passes {
                ui.label(RichText::new(pass).small());
                ui.label(RichText::new(format!("{ms:.3} ms")).small().monospace());
                ui.end_row();
            }
            for (id, bytes) in &frame.technique_bytes {
                ui.label(RichText::new(format!("memory of {id}")).small());
                ui.label(RichText::new(format!("{:.2} MB", *bytes as f64 / 1e6)).small().monospace());
                ui.end_row();
            }
            for statistic in &frame.statistics {
                let of = frames.lights.get(statistic.light as usize).map_or(String::new(), |light| format!(" of {light}"));
                ui.label(RichText::new(format!("{}{of}", statistic.name.replace('-', " "))).small());
                ui.label(RichText::new(grouped(statistic.value)).small().monospace());
                ui.end_row();
            }
        });
    }
    ui.label(
        RichText::new(format!("rays by {}, {:.0} ms a frame with readback", frames.backend, frames.elapsed.as_secs_f64() * 1e3))
            .small()
            .weak(),
    );
}

/// `1 234 567`.
fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let groups: Vec<&str> = digits.as_bytes().rchunks(3).rev().map(|group| std::str::from_utf8(group).expect("digits")).collect();
    groups.join("\u{2009}")
}

#[cfg(test)]
mod tests {
    use super::grouped;

    #[test]
    fn digits_stand_in_threes() {
        assert_eq!([grouped(0), grouped(999), grouped(1_234_567)], ["0", "999", "1\u{2009}234\u{2009}567"]);
    }
}

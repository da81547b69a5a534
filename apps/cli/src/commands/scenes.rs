//! `kajo scenes`: the built-in scenes.

use crate::arguments::Common;
use crate::failure::Outcome;
use crate::output;
use kajo_scene::builtin;
use serde_json::json;

/// Prints names and descriptions.
pub fn run(common: &Common) -> Outcome {
    if common.json {
        let scenes: Vec<_> = builtin::all()
            .iter()
            .map(|scene| {
                let count = scene.count.map(|c| json!({ "what": c.what, "default": c.default, "max": c.max }));
                json!({ "reference": format!("builtin:{}", scene.name), "description": scene.description, "count": count })
            })
            .collect();
        return output::json(&scenes);
    }
    let rows: Vec<Vec<String>> = builtin::all()
        .iter()
        .map(|scene| {
            let number = scene.count.map(|count| format!("[:N] ({}; default {})", count.what, count.default)).unwrap_or_default();
            vec![format!("builtin:{}", scene.name), scene.description.into(), number]
        })
        .collect();
    output::text(&output::table(&["scene", "what", "number"], &rows))
}

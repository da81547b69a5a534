//! `kajo devices`: the GPU adapters.

use crate::arguments::Common;
use crate::failure::{Failure, Outcome};
use crate::output;
use kajo_render_graph::{Device, DeviceInfo};
use serde_json::json;

/// Prints what each adapter is and can do, the preferred one first.
pub fn run(common: &Common, plain: bool) -> Outcome {
    let adapters = Device::list();
    if common.json {
        return output::json(&adapters.iter().map(as_json).collect::<Vec<_>>());
    }
    let rows: Vec<Vec<String>> = adapters.iter().map(row).collect();
    if plain {
        return output::text(&rows.iter().map(|row| row.join("\t") + "\n").collect::<String>());
    }
    if rows.is_empty() {
        return Err(Failure::run("no GPU adapter answers; `cargo xtask setup` installs a software driver (the path tracer needs none)"));
    }
    output::text(&output::table(&["adapter", "type", "driver", "interface", "features"], &rows))
}

fn row(info: &DeviceInfo) -> Vec<String> {
    let features = [("ray-query", info.ray_query), ("timestamps", info.timestamps), ("bindless", info.max_bindless_textures > 0)];
    let features: Vec<&str> = features.iter().filter(|(_, there)| *there).map(|(name, _)| *name).collect();
    vec![info.name.clone(), info.kind.into(), info.driver.clone(), info.backend.clone(), features.join(" ")]
}

fn as_json(info: &DeviceInfo) -> serde_json::Value {
    json!({
        "name": info.name, "type": info.kind, "driver": info.driver, "interface": info.backend,
        "ray_query": info.ray_query, "timestamps": info.timestamps, "max_image_side": info.max_image_side,
        "max_buffer_bytes": info.max_buffer_bytes, "max_bindless_textures": info.max_bindless_textures,
    })
}

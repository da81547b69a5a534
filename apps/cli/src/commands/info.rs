//! `kajo info`: what a scene contains, and what of it is ignored.

use crate::arguments::{Common, Info};
use crate::failure::Outcome;
use crate::{output, view};
use kajo_scene::{LoadOptions, Summary};

/// Prints contents, sizes and the list of everything ignored.
pub fn run(common: &Common, arguments: &Info) -> Outcome {
    let summary = view::load(&arguments.scene, &LoadOptions::default())?.summary();
    if common.json { output::json(&summary) } else { output::text(&as_text(&summary)) }
}

fn as_text(scene: &Summary) -> String {
    let [low, high] = scene.bounds;
    let mut lines = vec![
        format!("{}\n", scene.name),
        field(
            "triangles",
            format!("{} ({} placed in {} instances of {} meshes)", scene.triangles, scene.placed_triangles, scene.instances, scene.meshes),
        ),
        field("vertices", format!("{} ({})", scene.vertices, output::bytes(scene.geometry_bytes as u64))),
        field("bounds", format!("{low:?} … {high:?} m")),
        field("nodes, skins", format!("{}, {}", scene.nodes, scene.skins)),
        field("materials", list(&scene.materials)),
        field("emissive", format!("{} materials", scene.emissive_materials)),
        field("exposure", scene.exposure.map_or("automatic".into(), |stops| format!("{stops} stops"))),
    ];
    lines.push(field("images", format!("{} ({})", scene.images.len(), output::bytes(scene.image_bytes as u64))));
    lines.extend(scene.images.iter().map(|image| item(format!("{} {}x{} {}", image.name, image.width, image.height, image.format))));
    lines.push(field("lights", scene.lights.len().to_string()));
    lines.extend(scene.lights.iter().map(|light| item(format!("{} {}, {:?} {}", light.name, light.shape, light.emission, light.unit))));
    let environment = scene.environment.as_ref().map(|environment| match &environment.image {
        Some(image) => format!("{} {}x{}, factor {:?}", image.name, image.width, image.height, environment.scale),
        None => format!("uniform, radiance {:?} W/(m² sr)", environment.scale),
    });
    lines.push(field("environment", environment.unwrap_or("none".into())));
    lines.push(field("cameras", scene.cameras.len().to_string()));
    lines.extend(scene.cameras.iter().enumerate().map(|(index, camera)| item(format!("{index} {} ({})", camera.name, camera.projection))));
    lines.push(field("animations", scene.animations.len().to_string()));
    let animations = scene.animations.iter().enumerate();
    lines.extend(animations.map(|(index, a)| item(format!("{index} {} ({:.3} s, {} channels)", a.name, a.duration, a.channels))));
    lines.push(field("ignored", scene.ignored.len().to_string()));
    lines.extend(scene.ignored.iter().map(|ignored| item(ignored.to_string())));
    lines.concat()
}

fn field(name: &str, value: String) -> String {
    format!("  {name:<14}{value}\n")
}

fn item(value: String) -> String {
    format!("    - {value}\n")
}

fn list(names: &[String]) -> String {
    format!("{}: {}", names.len(), names.join(", "))
}

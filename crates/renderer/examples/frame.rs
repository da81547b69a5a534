//! Renders one frame: `cargo run --release -p kajo-renderer --example frame -- SCENE OUT.png [WIDTHxHEIGHT] [TECHNIQUE[:PARAM=VALUE,…]] [TIME]`.

use kajo_render_graph::Device;
use kajo_renderer::{FrameSettings, Renderer, RendererSettings, RoleSelection};
use kajo_scene::Snapshot;
use kajo_units::Seconds;
use std::path::Path;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let text = |index: usize, default: &str| arguments.get(index).cloned().unwrap_or_else(|| default.to_owned());
    let size = text(2, "640x360");
    let (width, height) = size.split_once('x').ok_or("a size is written WIDTHxHEIGHT")?;
    let technique = text(3, "shadow/ray-traced");
    let (id, params) = technique.split_once(':').unwrap_or((&technique, ""));
    let pairs: Vec<(&str, &str)> = params.split(',').filter_map(|pair| pair.split_once('=')).collect();

    let scene = kajo_scene::load(&text(0, "builtin:cornell"), &kajo_scene::LoadOptions::default())?;
    let snapshot = Snapshot::new(&scene, Seconds(text(4, "0").parse()?));
    let device = Device::new()?;
    let settings = RendererSettings::new(glam::uvec2(width.parse()?, height.parse()?));
    let mut renderer = Renderer::new(&device, &scene, &snapshot, settings)?;
    let roles = RoleSelection::new().choose(id, &pairs)?;
    let frame = renderer.render(&roles, &FrameSettings::default())?;
    kajo_image::write_png(Path::new(&text(1, "frame.png")), &frame.display, &Default::default())?;
    for (name, ms) in &frame.timings.passes {
        println!("{ms:9.3} ms  {name}");
    }
    println!("{} rays, {:.1} MiB, {}", frame.rays, frame.memory_bytes as f64 / 1048576.0, renderer.backend().id());
    for ignored in &frame.ignored {
        println!("not simulated: {ignored}");
    }
    Ok(())
}

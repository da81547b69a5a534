//! Whole frames.

use crate::*;
use kajo_render_graph::Device;
use kajo_scene::{Snapshot, builtin};
use kajo_units::Seconds;

#[test]
fn cornell_renders() {
    let device = Device::new().unwrap();
    let scene = builtin::load("cornell").unwrap();
    let snapshot = Snapshot::new(&scene, Seconds(0.0));
    let mut renderer = Renderer::new(&device, &scene, &snapshot, RendererSettings::new(glam::uvec2(256, 256))).unwrap();
    let settings = FrameSettings { gbuffer: true, ..Default::default() };
    let out = renderer.render(&RoleSelection::new(), &settings).unwrap();
    println!("{:?} rays {} memory {} ignored {:?}", out.timings, out.rays, out.memory_bytes, out.ignored);
    let out = renderer.render(&RoleSelection::new(), &settings).unwrap();
    println!("{:?}", out.timings);
}

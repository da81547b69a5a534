//! A renderer that is resized and looks elsewhere draws what a new one draws.

use crate::{FrameOutput, FrameSettings, Renderer, RendererSettings, RoleSelection};
use glam::{Mat4, UVec2, Vec3};
use kajo_render_graph::Device;
use kajo_scene::{PlacedCamera, Snapshot, builtin};
use kajo_units::Seconds;

const BEFORE: UVec2 = UVec2::new(48, 32);
const AFTER: UVec2 = UVec2::new(33, 40);

fn frame(renderer: &mut Renderer) -> FrameOutput {
    renderer.render(&RoleSelection::new(), &FrameSettings { gbuffer: true, ..Default::default() }).unwrap()
}

fn moved(camera: &PlacedCamera) -> PlacedCamera {
    let shift = Mat4::from_translation(Vec3::new(0.3, 0.1, -0.2)) * Mat4::from_rotation_y(0.05);
    PlacedCamera { world_from_view: shift * camera.world_from_view, ..camera.clone() }
}

#[test]
fn resized_and_aimed_elsewhere_equals_made_so() {
    let device = Device::new().unwrap();
    let scene = builtin::load("shadows").unwrap();
    let snapshot = Snapshot::new(&scene, Seconds(0.0));
    let mut changed = Renderer::new(&device, &scene, &snapshot, RendererSettings::new(BEFORE)).unwrap();
    let first = frame(&mut changed);
    changed.resize(AFTER).unwrap();
    changed.set_camera(&moved(&snapshot.cameras[0]), &snapshot.cameras[0]);
    let after = frame(&mut changed);

    let (mut there, before) = (snapshot.clone(), snapshot.clone());
    there.cameras[0] = moved(&snapshot.cameras[0]);
    let mut made = Renderer::new(&device, &scene, &snapshot, RendererSettings::new(AFTER)).unwrap();
    made.set_snapshot(&there, &before).unwrap();
    let expected = frame(&mut made);
    assert_eq!(after.color, expected.color);
    assert_eq!(after.gbuffer.unwrap().motion, expected.gbuffer.unwrap().motion);

    // And back again; a size that cannot be is refused and changes nothing.
    assert!(changed.resize(UVec2::new(0, 9)).is_err());
    changed.resize(BEFORE).unwrap();
    changed.set_camera(&snapshot.cameras[0], &snapshot.cameras[0]);
    assert_eq!(frame(&mut changed).color, first.color);
}

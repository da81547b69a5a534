//! A renderer that is resized and looks elsewhere draws what a new one draws.

use super::scenes::*;
use crate::{FrameOutput, FrameSettings, Renderer, RendererSettings, RoleSelection};
use glam::{Affine3A, Mat4, Quat, UVec2, Vec3};
use kajo_render_graph::Device;
use kajo_scene::{LightShape, PlacedCamera, Scene, Snapshot, builtin, shapes};
use kajo_units::Seconds;
use std::f32::consts::FRAC_PI_2;

const BEFORE: UVec2 = UVec2::new(48, 32);
const AFTER: UVec2 = UVec2::new(33, 40);

fn drawn(renderer: &mut Renderer) -> FrameOutput {
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
    let first = drawn(&mut changed);
    changed.resize(AFTER).unwrap();
    changed.set_camera(&moved(&snapshot.cameras[0]), &snapshot.cameras[0]).unwrap();
    let after = drawn(&mut changed);

    let (mut there, before) = (snapshot.clone(), snapshot.clone());
    there.cameras[0] = moved(&snapshot.cameras[0]);
    let mut made = Renderer::new(&device, &scene, &snapshot, RendererSettings::new(AFTER)).unwrap();
    made.set_snapshot(&there, &before).unwrap();
    let expected = drawn(&mut made);
    assert_eq!(after.color, expected.color);
    assert_eq!(after.gbuffer.unwrap().motion, expected.gbuffer.unwrap().motion);

    // And back again; a size that cannot be is refused and changes nothing.
    assert!(changed.resize(UVec2::new(0, 9)).is_err());
    changed.resize(BEFORE).unwrap();
    changed.set_camera(&snapshot.cameras[0], &snapshot.cameras[0]).unwrap();
    assert_eq!(drawn(&mut changed).color, first.color);
}

/// Instances that rays leave out follow the camera: a box that was behind it is met again, so that it casts its shadow, once it is in view.
#[test]
fn what_rays_leave_out_follows_the_camera() {
    let device = Device::new().unwrap();
    let mut scene = Scene::default();
    let flat = Affine3A::from_rotation_translation(Quat::from_rotation_x(-FRAC_PI_2), Vec3::new(0.0, 0.0, -4.0));
    place(&mut scene, shapes::rectangle(8.0, 8.0), lambert(0.5), flat);
    place(&mut scene, shapes::cuboid(Vec3::new(0.4, 0.2, 0.4)), lambert(0.5), Affine3A::from_translation(Vec3::new(0.0, 0.6, -3.0)));
    light(&mut scene, LightShape::Point, 10.0, Vec3::new(0.5, 3.0, -3.0), Vec3::NEG_Y);
    camera(&mut scene, PERSPECTIVE, Vec3::new(0.0, 1.5, 0.0), Vec3::new(0.0, 0.0, -3.0));
    let snapshot = Snapshot::new(&scene, Seconds(0.0));
    let ahead = &snapshot.cameras[0];
    let aside = PlacedCamera { world_from_view: ahead.world_from_view * Mat4::from_rotation_y(2.0), ..ahead.clone() };
    let looking = |camera: &PlacedCamera, culling: &str| {
        let at = Snapshot { cameras: vec![camera.clone()], ..snapshot.clone() };
        let settings = RendererSettings { ray_culling: culling.parse().unwrap(), ..RendererSettings::new(BEFORE) };
        Renderer::new(&device, &scene, &at, settings).unwrap()
    };
    let mut changed = looking(&aside, "frustum:0");
    changed.set_camera(ahead, ahead).unwrap();
    let after = drawn(&mut changed).color;
    assert!(after == drawn(&mut looking(ahead, "frustum:0")).color, "it is as if made there");
    assert!(after != drawn(&mut looking(ahead, "size:2")).color, "planted fault: the box is left out");
}

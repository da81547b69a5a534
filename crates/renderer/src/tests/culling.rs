//! What is out of view is not drawn, and nothing in the picture shows it.

use super::scenes::*;
use super::tracing::{Query, on_device};
use crate::{FrameOutput, FrameSettings, RoleSelection};
use glam::{Affine3A, Mat4, UVec2, Vec3};
use kajo_render_graph::Device;
use kajo_scene::{LightShape, Scene, Snapshot, builtin, shapes};
use kajo_techniques::TraceBackend;

const SIZE: UVec2 = UVec2::new(80, 45);

/// Middle of the box.
const BOX: Vec3 = Vec3::new(0.0, 2.4, 1.0);

/// A floor in view, a box behind the camera, and a lamp behind that: its shadow falls on the floor.
fn box_behind_the_camera() -> Scene {
    let mut scene = Scene::default();
    let flat = glam::Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2);
    place(&mut scene, shapes::rectangle(8.0, 8.0), lambert(0.5), Affine3A::from_rotation_translation(flat, Vec3::new(0.0, 0.0, -4.0)));
    place(&mut scene, shapes::cuboid(Vec3::new(0.4, 0.2, 0.4)), lambert(0.5), Affine3A::from_translation(BOX));
    light(&mut scene, LightShape::Point, 50.0, Vec3::new(0.0, 3.5, 3.0), Vec3::NEG_Y);
    camera(&mut scene, PERSPECTIVE, Vec3::new(0.0, 1.5, 0.0), Vec3::new(0.0, 0.0, -3.0));
    scene
}

/// Row R-13: the box is in no draw and in no pixel, yet shadow maps and shadow rays see it, and so do rays reflected by the floor.
#[test]
fn what_is_culled_still_casts_shadows_and_is_met_by_reflection_rays() {
    let device = Device::new().unwrap();
    let scene = box_behind_the_camera();
    for technique in ["shadow/map", "shadow/ray-traced", "shadow/volume-zfail"] {
        let out = frame(&device, &scene, SIZE, technique, &[]);
        assert_eq!((out.draws, out.culled_draws), (1, 1), "{technique}");
        let images = out.gbuffer.unwrap();
        assert!(images.instance.pixels().iter().all(|id| *id != Some(1)), "the box is not in the raster");
        let floor = images.instance.pixels().iter().zip(out.visibility[0].pixels()).filter(|(id, _)| **id == Some(0));
        let (dark, lit) = floor.fold((0, 0), |(dark, lit), (_, &v)| (dark + u32::from(v < 0.5), lit + u32::from(v >= 0.5)));
        assert!(dark > 100 && lit > 100, "{technique}: {dark} in shadow, {lit} not");
    }
    let out = frame(&device, &scene, SIZE, "shadow/none", &[]);
    let images = out.gbuffer.unwrap();
    let eye = Vec3::new(0.0, 1.5, 0.0);
    // Facets of a mirror on the floor, each turned so that it shows the box.
    let reflected = |(point, id): (&Vec3, &Option<u32>)| {
        let to_eye = (eye - *point).normalize();
        let normal = (to_eye + (BOX - *point).normalize()).normalize();
        let direction = 2.0 * to_eye.dot(normal) * normal - to_eye;
        (*id == Some(0)).then(|| Query {
            origin: (*point + 1e-3 * Vec3::Y).to_array(),
            t_max: 1e18,
            direction: direction.to_array(),
            padding: 0.0,
        })
    };
    let queries: Vec<Query> = images.position.pixels().iter().zip(images.instance.pixels()).filter_map(reflected).collect();
    for backend in [TraceBackend::RayQuery, TraceBackend::Compute] {
        if backend == TraceBackend::Compute || device.has_ray_query() {
            let met = on_device(&device, &scene, backend, &queries).iter().filter(|hit| hit.found == 1 && hit.instance == 1).count();
            assert!(met > 1000 && met == queries.len(), "{}: {met} of {} rays meet the box", backend.id(), queries.len());
        }
    }
}

/// Pictures with culling equal those without, bit by bit, in all directions; most things are culled in some.
#[test]
fn pictures_are_the_same_with_and_without_culling() {
    let device = Device::new().unwrap();
    let helmet = asset("FlightHelmet/FlightHelmet.gltf");
    let scenes = ["moving", "shadows", "spheres"].map(|name| builtin::load(name).unwrap());
    let mut culled = 0;
    for scene in scenes.into_iter().chain(helmet) {
        let mut renderer = renderer(&device, &scene, SIZE, None);
        let roles = RoleSelection::new().choose("shadow/map", &[("resolution", "256")]).unwrap();
        for turn in 0..5 {
            let mut snapshot = Snapshot::new(&scene, START);
            let camera = &mut snapshot.cameras[0].world_from_view;
            *camera = *camera * Mat4::from_rotation_y(turn as f32 * 1.1) * Mat4::from_rotation_x(0.2 * turn as f32);
            renderer.set_snapshot(&snapshot, &snapshot).unwrap();
            let mut of = |culling: bool| renderer.render(&roles, &FrameSettings { culling, gbuffer: true, ..Default::default() }).unwrap();
            let (with, without) = (of(true), of(false));
            assert_eq!(without.culled_draws, 0);
            assert_eq!(with.draws + with.culled_draws, without.draws);
            culled += with.culled_draws;
            let bits = |out: &FrameOutput| {
                let color = out.color.pixels().iter().flat_map(|c| c.0.to_array());
                let depth = out.gbuffer.as_ref().unwrap().depth.pixels().iter().copied();
                color.chain(depth).map(f32::to_bits).collect::<Vec<_>>()
            };
            assert_eq!(bits(&with), bits(&without), "{} turned {turn}", scene.name);
        }
    }
    assert!(culled > 20, "{culled} draws were culled");
}

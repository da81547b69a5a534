//! The family of shadow maps against the path tracer's `visibility.<light>` and against closed forms.

use super::scenes::*;
use crate::{FrameOutput, FrameSettings, RoleSelection};
use glam::{Affine3A, UVec2, Vec3};
use kajo_image::Image;
use kajo_image_metrics::shadow_border;
use kajo_path_tracer::Aov;
use kajo_render_graph::Device;
use kajo_scene::{LightShape, Projection, Scene, Snapshot, builtin, shapes};
use kajo_techniques::Role;
use kajo_units::{Meters, Radians};

const SUN: LightShape = LightShape::Directional { half_angle: Radians(0.0) };

fn truth(scene: &Scene, size: UVec2, spp: u32) -> Image<f32> {
    let frame = reference(scene, START, None, size, spp, vec![Aov::Visibility("*".into())]);
    let image = frame.images.iter().find(|image| image.name.starts_with("visibility.")).unwrap();
    Image::from_fn(size, |x, y| image.pixels.get(x, y).x)
}

/// Posts along a road, from two metres to a hundred.
fn road() -> Scene {
    let mut scene = Scene::default();
    place(&mut scene, shapes::floor(80.0, 260.0, 1.0), lambert(0.7), Affine3A::IDENTITY);
    let mut z = 2.6f32;
    while z < 110.0 {
        for side in [-1.0, 1.0] {
            let post = shapes::cuboid(Vec3::new(0.06, 0.5, 0.06) * z.sqrt());
            place(&mut scene, post, lambert(0.5), Affine3A::from_translation(Vec3::new(side * 0.3 * z, 0.5 * z.sqrt(), 10.0 - z)));
        }
        z *= 1.5;
    }
    light(&mut scene, SUN, 1.0, Vec3::ZERO, Vec3::new(-1.0, -1.2, 0.5));
    camera(&mut scene, PERSPECTIVE, Vec3::new(0.0, 1.1, 10.0), Vec3::new(0.0, 0.2, 4.0));
    scene.cameras[0].near = Meters(0.1);
    scene
}

/// Distances between the shadow borders of a frame and the path tracer's, px, in bands of distance from the camera.
fn border_by_distance(out: &FrameOutput, truth: &Image<f32>, bands: &[[f32; 2]]) -> Vec<f64> {
    let depth = &out.gbuffer.as_ref().unwrap().depth;
    let instance = &out.gbuffer.as_ref().unwrap().instance;
    bands
        .iter()
        .map(|[from, to]| {
            // The road alone: on the posts light and dark meet at edges of the surface.
            let within = Image::from_fn(truth.size(), |x, y| (*from..*to).contains(depth.get(x, y)) && *instance.get(x, y) == Some(0));
            shadow_border(&out.visibility[0], truth, Some(&within)).unwrap().border_px.expect("borders in every band")
        })
        .collect()
}

const BANDS: [[f32; 2]; 4] = [[2.0, 6.0], [6.0, 16.0], [16.0, 45.0], [45.0, 120.0]];

/// Row SH-12: borders are right to two pixels from the nearest to the farthest part of the view, where one map is not.
#[test]
fn cascades_have_sharp_borders_through_the_whole_view() {
    let device = Device::new().unwrap();
    let size = UVec2::new(320, 180);
    let scene = road();
    let truth = truth(&scene, size, 1);
    let errors = |technique, params: &[(&str, &str)]| border_by_distance(&frame(&device, &scene, size, technique, params), &truth, &BANDS);
    for kernel in ["0", "1"] {
        let cascaded = errors("shadow/cascades", &[("resolution", "1024"), ("kernel", kernel)]);
        assert!(cascaded.iter().all(|px| *px <= 2.0), "kernel {kernel}: {cascaded:?}");
    }
    let coarse = errors("shadow/map", &[("resolution", "256"), ("kernel", "0")]);
    assert!(coarse[0] > 2.0, "the test sees coarse borders: {coarse:?}");
    let plain = errors("shadow/map", &[("resolution", "1024"), ("kernel", "0")]);
    let warped = errors("shadow/light-space-perspective", &[("resolution", "1024"), ("kernel", "0")]);
    assert!(warped[0] < 0.6 * plain[0], "a warped one is finer there: {warped:?} {plain:?}");
}

/// Row SH-12: a camera that moves by whole pixels over the ground sees the same shadow in every frame, moved by as many pixels.
#[test]
fn borders_of_stable_cascades_stand_still() {
    let device = Device::new().unwrap();
    let size = UVec2::new(160, 120);
    let height = 6.0f32;
    let mut scene = Scene::default();
    place(&mut scene, shapes::floor(60.0, 60.0, 1.0), lambert(0.7), Affine3A::IDENTITY);
    place(
        &mut scene,
        shapes::cuboid(Vec3::new(0.9, 0.6, 0.5)),
        lambert(0.5),
        Affine3A::from_rotation_translation(glam::Quat::from_rotation_y(0.5), Vec3::Y * 0.6),
    );
    light(&mut scene, SUN, 1.0, Vec3::ZERO, Vec3::new(-1.0, -1.1, 0.4));
    camera(&mut scene, PERSPECTIVE, Vec3::new(-0.6, height, 0.2), Vec3::new(-0.6, 0.0, 0.2));
    let Projection::Perspective { yfov, .. } = PERSPECTIVE else { unreachable!() };
    let pixel = 2.0 * height * (0.5 * yfov.0).tan() / size.y as f32;
    let snapshot = Snapshot::new(&scene, START);
    let mut renderer = renderer(&device, &scene, size, None);
    let mut frame_at = |right: i32, stable: &str| {
        let mut moved = snapshot.clone();
        moved.cameras[0].world_from_view.w_axis.x += right as f32 * pixel;
        renderer.set_snapshot(&moved, &moved).unwrap();
        let roles = RoleSelection::new().choose("shadow/cascades", &[("resolution", "512"), ("kernel", "0"), ("stable", stable)]).unwrap();
        renderer.render(&roles, &FrameSettings { gbuffer: true, ..Default::default() }).unwrap()
    };
    let mut moved_px = |stable: &str| {
        let still = frame_at(0, stable);
        let on_floor = |out: &FrameOutput, x: u32, y: u32| *out.gbuffer.as_ref().unwrap().instance.get(x, y) == Some(0);
        let border = (0..size.y)
            .flat_map(|y| (1..size.x).map(move |x| (x, y)))
            .filter(|&(x, y)| on_floor(&still, x, y) && on_floor(&still, x - 1, y))
            .filter(|&(x, y)| still.visibility[0].get(x, y) != still.visibility[0].get(x - 1, y))
            .count();
        assert!(border > 50, "{border}");
        let shifts = [3i32, 7, 11, 20];
        let changed: usize = shifts
            .iter()
            .map(|&right| {
                let then = frame_at(right, stable);
                (0..size.y)
                    .flat_map(|y| (0..size.x - right as u32).map(move |x| (x, y)))
                    .filter(|&(x, y)| on_floor(&then, x, y) && on_floor(&still, x + right as u32, y))
                    .filter(|&(x, y)| then.visibility[0].get(x, y) != still.visibility[0].get(x + right as u32, y))
                    .count()
            })
            .sum();
        changed as f32 / (border * shifts.len()) as f32
    };
    let (stable, unstable) = (moved_px("true"), moved_px("false"));
    assert!(stable < 0.1, "the border moves by {stable} px");
    assert!(unstable > 3.0 * stable && unstable > 0.15, "without stabilisation it crawls by {unstable} px: the test sees it");
}

/// The techniques that filter, at filters of about seven texels.
const FILTERS: [(&str, &[(&str, &str)]); 4] = [
    ("shadow/map", &[("resolution", "512"), ("kernel", "3")]),
    ("shadow/vsm", &[("resolution", "512"), ("radius", "3")]),
    ("shadow/evsm", &[("resolution", "512"), ("radius", "3")]),
    ("shadow/msm", &[("resolution", "512"), ("radius", "3")]),
];

/// Row SH-13: across the shadow of an edge visibility rises from 0 to 1 and never falls.
#[test]
fn filtered_penumbrae_are_monotone() {
    let device = Device::new().unwrap();
    let size = UVec2::new(200, 8);
    let mut scene = Scene::default();
    place(&mut scene, shapes::floor(4.0, 4.0, 1.0), lambert(0.7), Affine3A::IDENTITY);
    place(&mut scene, shapes::cuboid(Vec3::new(0.5, 0.02, 2.0)), lambert(0.5), Affine3A::from_translation(Vec3::new(-0.5, 0.8, 0.0)));
    light(&mut scene, LightShape::Spot { inner: Radians(0.5), outer: Radians(0.6) }, 1.0, Vec3::new(0.0, 3.0, 0.0), Vec3::NEG_Y);
    let view = Projection::Orthographic { xmag: Meters(0.15), ymag: Meters(0.006) };
    camera(&mut scene, view, Vec3::new(0.05, 0.5, 0.013), Vec3::new(0.05, 0.0, 0.013));
    for (technique, params) in FILTERS {
        let out = frame(&device, &scene, size, technique, params);
        let profile: Vec<f32> = (0..size.x).map(|x| *out.visibility[0].get(x, 4)).collect();
        let grey = profile.iter().filter(|v| (0.02..0.98).contains(*v)).count();
        assert!(profile[0] < 0.02 && profile[199] > 0.98, "{technique}: from {} to {}", profile[0], profile[199]);
        assert!(grey > 10, "{technique}: {grey} pixels of penumbra");
        let fall = profile.windows(2).map(|pair| pair[0] - pair[1]).fold(0.0, f32::max);
        assert!(fall < 2e-3, "{technique}: falls by {fall}");
    }
}

/// Row SH-13: light in the shadow of both of two stacked boards, for each method. What is leaked is what is known of the methods: variance leaks, warps and more
/// moments leak less, comparing does not.
#[test]
fn leaks_under_stacked_boards_are_those_of_the_methods() {
    let device = Device::new().unwrap();
    let size = UVec2::new(256, 144);
    let mut scene = builtin::load("stacked").unwrap();
    // From under the lower board to the floor below it.
    let view = scene.nodes.iter_mut().find(|node| node.camera.is_some()).unwrap();
    let look = glam::camera::rh::view::look_at_mat4(Vec3::new(1.7, 1.1, 1.7), Vec3::new(0.0, 0.12, 0.0), Vec3::Y).inverse();
    view.transform = kajo_scene::Transform::Matrix(look);
    let truth = truth(&scene, size, 1);
    let dark = |x: i32, y: i32| {
        let inside = x >= 0 && y >= 0 && x < size.x as i32 && y < size.y as i32;
        inside && *truth.get(x as u32, y as u32) == 0.0
    };
    // Pixels in shadow, some pixels from where it ends: no filter of the right width reaches them.
    let deep: Vec<(u32, u32)> = (0..size.y as i32)
        .flat_map(|y| (0..size.x as i32).map(move |x| (x, y)))
        .filter(|&(x, y)| (-3..=3).all(|v| (-6..=6).all(|u| dark(x + u, y + v))))
        .map(|(x, y)| (x as u32, y as u32))
        .collect();
    assert!(deep.len() > 300, "{}", deep.len());
    let leak = FILTERS.map(|(technique, params)| {
        let out = frame(&device, &scene, size, technique, params);
        deep.iter().map(|&(x, y)| *out.visibility[0].get(x, y)).sum::<f32>() / deep.len() as f32
    });
    assert!(leak[0] < 1e-3, "{leak:?}");
    assert!(leak[1] > 3.0 * leak[2] && leak[1] > 1.5 * leak[3], "{leak:?}");
    assert!(leak[1] > 0.003, "the scene makes variance leak: {leak:?}");
}

/// Row SH-14: the penumbra of a strip light at height H over an edge at height h is W h/(H − h) wide, within a quarter.
#[test]
fn percentage_closer_penumbrae_have_the_width_of_geometry() {
    let device = Device::new().unwrap();
    let size = UVec2::new(160, 40);
    let (light_height, strip) = (3.0f32, 0.3f32);
    for edge in [0.4f32, 0.9, 1.5] {
        let expected = strip * edge / (light_height - edge);
        let mut scene = Scene::default();
        place(&mut scene, shapes::floor(6.0, 6.0, 1.0), lambert(0.7), Affine3A::IDENTITY);
        let board = Vec3::new(-1.0, edge + 0.005, 0.0);
        place(&mut scene, shapes::cuboid(Vec3::new(1.0, 0.005, 2.0)), lambert(0.5), Affine3A::from_translation(board));
        let shape = LightShape::Rectangle { width: Meters(strip), height: Meters(1.2) };
        light(&mut scene, shape, 1.0, Vec3::new(0.0, light_height, 0.0), Vec3::NEG_Y);
        let view = Projection::Orthographic { xmag: Meters(expected), ymag: Meters(expected * 0.25) };
        camera(&mut scene, view, Vec3::new(0.0, 0.5 * edge, 0.0), Vec3::ZERO);
        let mut renderer = renderer(&device, &scene, size, None);
        let roles = RoleSelection::new().choose("shadow/pcss", &[("resolution", "1024")]).unwrap();
        let mut profile = vec![0.0f32; size.x as usize];
        for index in 0..4 {
            let out = renderer.render(&roles, &FrameSettings { index, ..Default::default() }).unwrap();
            for x in 0..size.x {
                profile[x as usize] += (0..size.y).map(|y| *out.visibility[0].get(x, y)).sum::<f32>() / (4 * size.y) as f32;
            }
        }
        let crossing = |level: f32| {
            let x = profile.iter().position(|v| *v >= level).unwrap_or_else(|| panic!("edge at {edge}: {profile:?}"));
            (x as f32 + 0.5) * 2.0 * expected / size.x as f32
        };
        let width = (crossing(0.85) - crossing(0.15)) / 0.7;
        assert!((width / expected - 1.0).abs() < 0.25, "edge at {edge}: {width} m instead of {expected}");
        let middle = crossing(0.5) - expected;
        assert!(middle.abs() < 0.25 * expected, "edge at {edge}: the border lies {middle} m off");
    }
}

/// A shadow that map and bias lose is found in the depth buffer.
#[test]
fn contact_shadows_find_what_coarse_maps_lose() {
    let device = Device::new().unwrap();
    let size = UVec2::new(240, 180);
    let mut scene = Scene::default();
    place(&mut scene, shapes::floor(30.0, 30.0, 1.0), lambert(0.7), Affine3A::IDENTITY);
    for i in 0..5 {
        let block = Affine3A::from_translation(Vec3::new(0.3 * i as f32 - 0.6, 0.05, 0.0));
        place(&mut scene, shapes::cuboid(Vec3::new(0.03, 0.05, 0.08)), lambert(0.5), block);
    }
    light(&mut scene, LightShape::Point, 1.0, Vec3::new(2.5, 4.0, 1.0), Vec3::NEG_Y);
    camera(&mut scene, PERSPECTIVE, Vec3::new(0.0, 1.1, 1.7), Vec3::ZERO);
    let truth = truth(&scene, size, 1);
    let error = |technique, params: &[(&str, &str)]| {
        let out = frame(&device, &scene, size, technique, params);
        let pairs = out.visibility[0].pixels().iter().zip(truth.pixels());
        pairs.map(|(v, r)| (v - r).powi(2)).sum::<f32>()
    };
    let map = error("shadow/map", &[("resolution", "64")]);
    let contact = error("shadow/contact", &[("resolution", "64"), ("length", "0.15"), ("steps", "32"), ("thickness", "0.1")]);
    assert!(contact < 0.65 * map, "{contact} of {map}");
}

/// Row SH-22: light and occluder move, and each technique gives in the same frame what it gives for a scene that was always so.
#[test]
fn every_technique_follows_a_moving_scene_in_the_same_frame() {
    let device = Device::new().unwrap();
    let size = UVec2::new(64, 48);
    let strip = LightShape::Rectangle { width: Meters(0.6), height: Meters(0.4) };
    for shape in [SUN, strip] {
        let mut scene = Scene::default();
        place(&mut scene, shapes::floor(8.0, 8.0, 1.0), lambert(0.7), Affine3A::IDENTITY);
        place(&mut scene, shapes::cuboid(Vec3::new(0.5, 0.1, 0.4)), lambert(0.5), Affine3A::from_translation(Vec3::new(0.0, 0.7, 0.0)));
        light(&mut scene, shape, 1.0, Vec3::new(0.3, 3.0, 0.4), Vec3::new(-0.1, -1.0, -0.13));
        camera(&mut scene, PERSPECTIVE, Vec3::new(0.3, 2.6, 3.2), Vec3::new(0.0, 0.2, 0.0));
        let before = Snapshot::new(&scene, START);
        let mut after = before.clone();
        after.instances[1].world_from_object.translation.x += 0.4;
        let turned = Affine3A::from_rotation_z(0.2) * after.lights[0].world_from_light;
        after.lights[0].world_from_light = Affine3A::from_translation(Vec3::new(0.5, 0.0, -0.3)) * turned;
        let (mut moving, mut fresh) = (renderer(&device, &scene, size, None), renderer(&device, &scene, size, None));
        fresh.set_snapshot(&after, &after).unwrap();
        for technique in kajo_techniques::of_role(Role::DirectVisibility) {
            if technique.id == "shadow/none" {
                continue;
            }
            let params: &[(&str, &str)] =
                if technique.id == "shadow/multi-sample" { &[("samples", "4"), ("resolution", "256")] } else { &[] };
            let roles = RoleSelection::new().choose(technique.id, params).unwrap();
            let settings = FrameSettings { index: 5, ..Default::default() };
            moving.set_snapshot(&before, &before).unwrap();
            let first = moving.render(&roles, &settings).unwrap();
            moving.set_snapshot(&after, &before).unwrap();
            let moved = moving.render(&roles, &settings).unwrap();
            let expected = fresh.render(&roles, &settings).unwrap();
            assert_eq!(moved.visibility[0].pixels(), expected.visibility[0].pixels(), "{}, {shape:?}", technique.id);
            assert_ne!(first.visibility[0].pixels(), moved.visibility[0].pixels(), "{} sees the motion, {shape:?}", technique.id);
        }
    }
}

/// Row SH-21: distances from the light, distances from the camera, and how far each point lies behind what the light sees, for each layout of depth.
#[test]
fn debug_views_show_what_light_and_camera_see() {
    let device = Device::new().unwrap();
    let size = UVec2::new(64, 48);
    let mut scene = Scene::default();
    place(&mut scene, shapes::floor(6.0, 6.0, 1.0), lambert(0.7), Affine3A::IDENTITY);
    place(&mut scene, shapes::cuboid(Vec3::new(0.4, 0.02, 0.4)), lambert(0.5), Affine3A::from_translation(Vec3::new(0.0, 0.7, 0.0)));
    let spot = LightShape::Spot { inner: Radians(0.5), outer: Radians(0.6) };
    light(&mut scene, spot, 1.0, Vec3::new(0.0, 3.0, 0.0), Vec3::NEG_Y);
    camera(&mut scene, PERSPECTIVE, Vec3::new(0.0, 1.4, 2.6), Vec3::new(0.0, 0.2, 0.0));
    let mut renderer = renderer(&device, &scene, size, None);
    for params in [&[("kernel", "0")][..], &[("kernel", "0"), ("depth", "linear"), ("precision", "unorm16")]] {
        let roles = RoleSelection::new().choose("shadow/map", params).unwrap();
        let out = renderer.render(&roles, &FrameSettings { gbuffer: true, debug: true, ..Default::default() }).unwrap();
        let scalar = |name: &str| match &out.debug.iter().find(|view| view.name == name && view.light == 0).unwrap().pixels {
            kajo_techniques::DebugPixels::Scalar(image) => image.clone(),
            other => panic!("{other:?}"),
        };
        let (from_light, from_camera, behind) = (scalar("light-depth"), scalar("camera-depth"), scalar("reprojection"));
        let side = from_light.width();
        assert!((from_light.get(side / 2, side / 2) - 2.28).abs() < 1e-3, "{params:?}: {}", from_light.get(side / 2, side / 2));
        assert!((from_light.get(side / 8, side / 2) - 3.0).abs() < 1e-3, "{params:?}");
        let images = out.gbuffer.as_ref().unwrap();
        let (mut dark, mut lit) = (0, 0);
        for (x, y) in (0..size.y).flat_map(|y| (0..size.x).map(move |x| (x, y))) {
            let (near, far) = (*from_camera.get(x, y), *images.depth.get(x, y));
            assert!(near == far || (near / far - 1.0).abs() < 1e-4, "{params:?}: {near} {far}");
            let inside = images.position.get(x, y).with_y(0.0).length() < 1.2;
            if *images.instance.get(x, y) != Some(0) || !inside {
                continue;
            }
            if *out.visibility[0].get(x, y) == 0.0 {
                dark += 1;
                assert!((behind.get(x, y) - 0.72).abs() < 0.01, "{params:?}: {}", behind.get(x, y));
            } else {
                lit += 1;
                assert!(*behind.get(x, y) < 1e-3, "{params:?}: {}", behind.get(x, y));
            }
        }
        assert!(dark > 50 && lit > 200, "{dark} dark, {lit} lit");
    }
}

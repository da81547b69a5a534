//! The G-buffer against primary hits of the path tracer.

use super::scenes::*;
use crate::{FrameSettings, GBufferImages, Renderer, RendererSettings, RoleSelection};
use glam::{UVec2, Vec2, Vec3};
use kajo_path_tracer::{Aov, Frame};
use kajo_render_graph::Device;
use kajo_scene::{Scene, Snapshot, builtin};
use kajo_units::Seconds;

/// One side even, one odd: the edges of a room seen along its axis then do not run through pixel centres.
const SIZE: UVec2 = UVec2::new(164, 89);

const AOVS: [Aov; 8] =
    [Aov::Position, Aov::Depth, Aov::Normal, Aov::ShadingNormal, Aov::Albedo, Aov::InstanceId, Aov::MaterialId, Aov::Motion];

fn gbuffer(device: &Device, scene: &Scene, now: Seconds, before: Seconds, size: UVec2) -> (GBufferImages, Renderer) {
    let (current, previous) = (Snapshot::new(scene, now), Snapshot::new(scene, before));
    let mut renderer = Renderer::new(device, scene, &previous, RendererSettings::new(size)).unwrap();
    renderer.set_snapshot(&current, &previous).unwrap();
    let roles = RoleSelection::new().choose("shadow/none", &[]).unwrap();
    let out = renderer.render(&roles, &FrameSettings { gbuffer: true, ..Default::default() }).unwrap();
    (out.gbuffer.unwrap(), renderer)
}

/// Share of pixels at which G-buffer and ray agree in everything, and the first that do not.
fn agreement(images: &GBufferImages, reference: &Frame, size: UVec2, scale: f32) -> (f32, Vec<String>) {
    let get = |name: &str, x, y| reference.image(name).unwrap().pixels.get(x, y);
    let mut bad = Vec::new();
    for (x, y) in (0..size.y).flat_map(|y| (0..size.x).map(move |x| (x, y))) {
        let instance = get("instance-id", x, y).x;
        let same = match *images.instance.get(x, y) {
            None => instance < 0.0,
            Some(id) => {
                let depth = get("depth", x, y).x;
                let motion = get("motion", x, y).truncate();
                id as f32 == instance
                    && images.material.get(x, y).unwrap() as f32 == get("material-id", x, y).x
                    && images.position.get(x, y).distance(get("position", x, y)) < 1e-3 * scale
                    && (images.depth.get(x, y) - depth).abs() < 1e-3 * depth.max(scale)
                    && images.normal.get(x, y).dot(get("normal", x, y)) > 0.9999
                    && images.motion.get(x, y).distance(motion) < 0.05
            }
        };
        if !same {
            bad.push(format!(
                "({x}, {y}): {:?}/{instance} n {}/{} motion {}/{} z {}/{}",
                images.instance.get(x, y),
                images.normal.get(x, y),
                get("normal", x, y),
                images.motion.get(x, y),
                get("motion", x, y),
                images.depth.get(x, y),
                get("depth", x, y).x,
            ));
        }
    }
    (1.0 - bad.len() as f32 / (size.x * size.y) as f32, bad)
}

/// Row R-01.
#[test]
fn gbuffer_equals_primary_hits() {
    let device = Device::new().unwrap();
    let fox = asset("Fox/Fox.glb").map(|fox| ("Fox", fox, 100.0));
    let scenes = ["shadows", "moving", "cornell"].map(|name| (name, builtin::load(name).unwrap(), 6.0));
    for (name, scene, scale) in scenes.into_iter().chain(fox) {
        let (now, before) = (Seconds(0.52), Seconds(0.5));
        let images = gbuffer(&device, &scene, now, before, SIZE).0;
        let reference = reference(&scene, now, Some(before), SIZE, 1, AOVS.to_vec());
        let (share, bad) = agreement(&images, &reference, SIZE, scale);
        assert!(share >= 0.999, "{name}: {share}\n{}", bad[..bad.len().min(8)].join("\n"));
    }
}

/// The comparison above sees a camera that is one pixel off.
#[test]
fn a_shifted_gbuffer_is_noticed() {
    let device = Device::new().unwrap();
    let scene = builtin::load("shadows").unwrap();
    let snapshot = Snapshot::new(&scene, START);
    let mut renderer = Renderer::new(&device, &scene, &snapshot, RendererSettings::new(SIZE)).unwrap();
    let settings = FrameSettings { gbuffer: true, jitter: Vec2::new(1.0, 0.0), ..Default::default() };
    let images = renderer.render(&RoleSelection::new(), &settings).unwrap().gbuffer.unwrap();
    let reference = reference(&scene, START, Some(START), SIZE, 1, AOVS.to_vec());
    assert!(agreement(&images, &reference, SIZE, 6.0).0 < 0.99);
}

/// Row R-04: where a point was, by its motion vector, is where the camera of then saw it; points that it did not see are flagged.
#[test]
fn motion_vectors_lead_back_to_the_same_point() {
    let device = Device::new().unwrap();
    let scene = builtin::load("moving").unwrap();
    let (now, before) = (Seconds(0.6), Seconds(0.5));
    let (images, _) = gbuffer(&device, &scene, now, before, SIZE);
    let (earlier, renderer) = gbuffer(&device, &scene, before, before, SIZE);
    let previous_view = renderer.view(&FrameSettings::default());
    let (current, previous) = (Snapshot::new(&scene, now), Snapshot::new(&scene, before));
    let (mut flagged, mut wrong, mut same_place, mut visible) = (0, 0, 0, 0);
    for (x, y) in (0..SIZE.y).flat_map(|y| (0..SIZE.x).map(move |x| (x, y))) {
        let Some(instance) = *images.instance.get(x, y) else { continue };
        // Rigid bodies: from the world of now to the world of then.
        let [to, from] = [&previous, &current].map(|snapshot| snapshot.instances[instance as usize].world_from_object);
        let then: Vec3 = to.transform_point3(from.inverse().transform_point3(*images.position.get(x, y)));
        let expected = previous_view.project(then);
        let inside = expected.is_some_and(|p| p.cmpge(Vec2::ZERO).all() && p.cmplt(SIZE.as_vec2()).all());
        match images.reprojected(x, y) {
            None => {
                flagged += 1;
                let edge = expected.is_some_and(|p| p.cmpge(Vec2::splat(0.5)).all() && p.cmplt(SIZE.as_vec2() - 0.5).all());
                wrong += u32::from(edge);
            }
            Some(pixel) => {
                wrong += u32::from(!inside || pixel.distance(expected.unwrap()) >= 0.5);
                let (u, v) = (pixel.x as u32, pixel.y as u32);
                if *earlier.instance.get(u, v) == Some(instance) {
                    visible += 1;
                    // The pixel of then shows the same surface within its own footprint.
                    let footprint = 3.0 * earlier.depth.get(u, v) / SIZE.y as f32;
                    same_place += u32::from(earlier.position.get(u, v).distance(then) < 3.0 * footprint);
                }
            }
        }
    }
    assert_eq!(wrong, 0);
    assert!(flagged > 50, "the camera pans: {flagged} pixels were not in the image before");
    assert!(same_place as f32 >= 0.97 * visible as f32, "{same_place} of {visible}");
}

#[test]
fn albedo_and_shading_normals_are_those_of_the_path_tracer() {
    let device = Device::new().unwrap();
    for scene in [Some(builtin::load("shadows").unwrap()), asset("FlightHelmet/FlightHelmet.gltf")].into_iter().flatten() {
        let images = gbuffer(&device, &scene, START, START, SIZE).0;
        let reference = reference(&scene, START, None, SIZE, 1, AOVS[..7].to_vec());
        let get = |name: &str, x, y| reference.image(name).unwrap().pixels.get(x, y);
        let (mut color, mut normal, mut count) = (0.0, 0.0, 0.0);
        for (x, y) in (0..SIZE.y).flat_map(|y| (0..SIZE.x).map(move |x| (x, y))) {
            if images.instance.get(x, y).map(|id| id as f32) == Some(get("instance-id", x, y).x) {
                count += 1.0;
                color += (images.albedo.get(x, y).0 - get("albedo", x, y)).abs().max_element();
                normal += 1.0 - images.shading_normal.get(x, y).dot(get("shading-normal", x, y));
            }
        }
        // Textures are filtered here and read at the finest level there.
        assert!(count > 1000.0 && color / count < 0.02, "{}: colour differs by {}", scene.name, color / count);
        assert!(normal / count < 0.01, "{}: normals differ by {}", scene.name, normal / count);
    }
}

#[test]
fn images_of_one_pixel_and_of_odd_sizes_render() {
    let device = Device::new().unwrap();
    let scene = builtin::load("cornell").unwrap();
    for size in [UVec2::new(1, 1), UVec2::new(7, 3), UVec2::new(65, 1)] {
        let out = frame(&device, &scene, size, "shadow/ray-traced", &[]);
        assert_eq!((out.color.size(), out.display.size(), out.visibility[0].size()), (size, size, size));
        assert!(out.color.pixels().iter().all(|c| c.is_finite()));
    }
    for size in [UVec2::new(0, 4), UVec2::new(4, 1 << 20)] {
        let made = Renderer::new(&device, &scene, &Snapshot::new(&scene, START), RendererSettings::new(size));
        assert!(made.err().unwrap().to_string().contains("each side must be 1 to"));
    }
}

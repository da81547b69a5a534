//! Rays over a shadow map: how many, where, and how near to rays everywhere.

use super::scenes::*;
use crate::FrameOutput;
use glam::{Affine3A, UVec2, Vec2, Vec3};
use kajo_bvh::{Blas, BuildOptions, BvhInstance, Filter, Ray, Tlas};
use kajo_image::Image;
use kajo_render_graph::Device;
use kajo_scene::{LightShape, Scene, Snapshot, builtin, shapes};
use kajo_units::Meters;
use std::sync::Arc;

fn rmse(a: &Image<f32>, b: &Image<f32>) -> f32 {
    let squares: f32 = a.pixels().iter().zip(b.pixels()).map(|(a, b)| (a - b) * (a - b)).sum();
    (squares / a.pixels().len() as f32).sqrt()
}

fn rays_of(output: &FrameOutput, light: u32) -> u64 {
    output.statistics.iter().find(|s| s.name == "rays" && s.light == light).unwrap().value
}

/// Pixels in which a light is seen in part, and those beside a hard border, of which a pixel may show either side.
fn penumbra_pixels(truth: &Image<f32>) -> usize {
    let in_part = |v: f32| v > 0.0 && v < 1.0;
    let size = truth.size();
    let off = off_border(&|x, y| *truth.get(x, y), size);
    let sure = off.into_iter().filter(|p| !in_part(*truth.get(p.x, p.y))).count();
    size.element_product() as usize - sure
}

/// Rows SH-18 and RM-21: rays are traced in penumbrae and little beside, and the image is that of rays everywhere.
#[test]
fn rays_in_penumbrae_give_the_image_of_rays_everywhere() {
    let device = Device::new().unwrap();
    let helmet = asset("FlightHelmet/FlightHelmet.gltf").map(|mut scene| {
        let shape = LightShape::Sphere { radius: Meters(0.15) };
        light(&mut scene, shape, 5.0, Vec3::new(0.6, 1.2, 0.8), Vec3::new(-0.6, -1.0, -0.8));
        ("FlightHelmet", scene)
    });
    let built_in = ["penumbra", "shadows"].map(|name| (name, builtin::load(name).unwrap()));
    for (name, scene) in built_in.into_iter().chain(helmet) {
        let size = UVec2::new(320, 180);
        let truth = frame(&device, &scene, size, "shadow/ray-traced", &[("samples", "256")]);
        let all = frame(&device, &scene, size, "shadow/ray-traced", &[("samples", "4")]);
        let some = frame(&device, &scene, size, "shadow/penumbra-rays", &[("samples", "4")]);
        let lights = &Snapshot::new(&scene, START).lights;
        assert_eq!(truth.visibility.len(), lights.len());
        for (light, placed) in lights.iter().enumerate() {
            let samples = match placed.light.shape {
                LightShape::Point | LightShape::Spot { .. } => 1,
                LightShape::Directional { half_angle } if half_angle.0 == 0.0 => 1,
                _ => 4,
            };
            let penumbra = penumbra_pixels(&truth.visibility[light]);
            let rays = rays_of(&some, light as u32);
            // A spot's map ends where its cone does; nothing beyond is lit.
            let images = some.gbuffer.as_ref().unwrap();
            let in_cone = |p: &Vec3| match placed.light.shape {
                LightShape::Spot { outer, .. } => {
                    let axis: Vec3 = placed.world_from_light.transform_vector3(Vec3::NEG_Z);
                    (*p - Vec3::from(placed.world_from_light.translation)).normalize().dot(axis.normalize()) > outer.0.cos()
                }
                _ => true,
            };
            let lit = |output: &FrameOutput| {
                let pixels = output.visibility[light].pixels().iter().zip(images.position.pixels());
                Image::from_pixels(size, pixels.map(|(v, p)| if in_cone(p) { *v } else { 1.0 }).collect())
            };
            let error = rmse(&lit(&some), &lit(&all));
            assert!(rays > 0 && rays <= 2 * penumbra as u64 * samples, "{name}, light {light}: {rays} rays, {penumbra} pixels of penumbra");
            assert!(error < 0.02, "{name}, light {light}: {error}");
        }
        assert_eq!(some.rays, (0..truth.visibility.len()).map(|light| rays_of(&some, light as u32)).sum::<u64>());
    }
}

/// A row of posts that leads away from the camera.
fn posts() -> Scene {
    let mut scene = Scene::default();
    place(&mut scene, shapes::floor(30.0, 30.0, 1.0), lambert(0.7), Affine3A::IDENTITY);
    for i in 0..8 {
        let at = Vec3::new(if i % 2 == 0 { -0.6 } else { 0.6 }, 0.5, -1.5 * i as f32);
        place(&mut scene, shapes::cuboid(Vec3::new(0.15, 0.5, 0.15)), lambert(0.5), Affine3A::from_translation(at));
    }
    light(&mut scene, LightShape::Sphere { radius: Meters(0.4) }, 50.0, Vec3::new(4.0, 5.0, -4.0), Vec3::NEG_Y);
    light(&mut scene, LightShape::Point, 20.0, Vec3::new(-1.5, 2.5, -2.0), Vec3::NEG_Y);
    camera(&mut scene, PERSPECTIVE, Vec3::new(0.0, 1.8, 3.0), Vec3::new(0.0, 0.3, -3.0));
    scene
}

/// Row RM-16: rays start in pixels nearer than the limit and nowhere else; beyond it the image is the map's, well within it that of rays, and nothing
/// jumps at the limit.
#[test]
fn near_rays_end_at_their_distance_without_a_seam() {
    let device = Device::new().unwrap();
    let size = UVec2::new(192, 144);
    let scene = posts();
    let map = frame(&device, &scene, size, "shadow/map", &[("resolution", "1024")]);
    let all = frame(&device, &scene, size, "shadow/ray-traced", &[]);
    let (limit, fade) = (6.0f32, 0.5f32);
    let middles: Vec<Vec3> = Snapshot::new(&scene, START).lights.iter().map(|light| light.world_from_light.translation.into()).collect();
    for from in ["camera", "light"] {
        let near = frame(&device, &scene, size, "shadow/near-rays", &[("from", from), ("distance", "6"), ("fade", "0.5")]);
        let images = near.gbuffer.as_ref().unwrap();
        for (light, samples) in [(0usize, 4u64), (1, 1)] {
            let away = |i: usize| match (from, images.depth.pixels()[i]) {
                (_, f32::INFINITY) => f32::INFINITY,
                ("camera", depth) => depth,
                _ => images.position.pixels()[i].distance(middles[light]),
            };
            let of = |output: &FrameOutput, i: usize| output.visibility[light].pixels()[i];
            let (mut inside, mut ring, mut squares) = (0u64, 0u32, 0.0f32);
            for i in 0..images.depth.pixels().len() {
                let d = away(i);
                if (d - limit).abs() < 1e-3 || (d - limit * (1.0 - fade)).abs() < 1e-3 {
                    continue;
                }
                inside += u64::from(d < limit);
                if d > limit {
                    assert_eq!(of(&near, i), of(&map, i), "{from}, light {light}: {d} m");
                } else if d < limit * (1.0 - fade) {
                    assert_eq!(of(&near, i), of(&all, i), "{from}, light {light}: {d} m");
                } else if d > limit * (1.0 - 0.02 * fade) {
                    ring += 1;
                    squares += (of(&near, i) - of(&map, i)).powi(2);
                }
            }
            let rays = rays_of(&near, light as u32);
            assert!(rays > 0 && rays <= inside * samples, "{from}, light {light}: {rays} rays from {inside} pixels");
            assert!(rays < rays_of(&all, light as u32), "{from}, light {light}: {rays}");
            if ring > 0 {
                assert!((squares / ring as f32).sqrt() < 0.01, "{from}, light {light}: a step of {}", (squares / ring as f32).sqrt());
            }
        }
    }
}

/// Row RM-17: the lights that are chosen are traced, the others have their map.
#[test]
fn near_rays_go_to_the_chosen_lights_only() {
    let device = Device::new().unwrap();
    let size = UVec2::new(96, 72);
    let scene = posts();
    let map = frame(&device, &scene, size, "shadow/map", &[("resolution", "1024")]);
    let all = frame(&device, &scene, size, "shadow/ray-traced", &[]);
    for chosen in 0..=2u32 {
        let count = chosen.to_string();
        let some = frame(&device, &scene, size, "shadow/near-rays", &[("distance", "1000"), ("lights", &count)]);
        for light in 0..2u32 {
            let expected = if light < chosen { &all } else { &map };
            assert_eq!(some.visibility[light as usize].pixels(), expected.visibility[light as usize].pixels(), "{chosen} lights, {light}");
            assert_eq!(rays_of(&some, light), if light < chosen { rays_of(&all, light) } else { 0 }, "{chosen} lights, {light}");
        }
    }
}

/// Row RM-22: rays no longer than the limit find what the reference finds that ends there, for a light without and one with an extent; over a map they
/// find contact that it misses.
#[test]
fn contact_rays_are_the_reference_that_ends_where_they_do() {
    let device = Device::new().unwrap();
    let size = UVec2::new(64, 48);
    let (length, samples) = (0.4f32, 256usize);
    let (width, height) = (0.8f32, 0.8f32);
    let middle = Vec3::new(0.0, 3.0, -1.0);
    for shape in [LightShape::Point, LightShape::Rectangle { width: Meters(width), height: Meters(height) }] {
        let mut scene = Scene::default();
        place(&mut scene, shapes::floor(6.0, 6.0, 1.0), lambert(0.7), Affine3A::IDENTITY);
        place(&mut scene, shapes::cuboid(Vec3::new(0.3, 0.3, 0.3)), lambert(0.5), Affine3A::from_translation(Vec3::new(-0.6, 0.3, 0.0)));
        // Too high for short rays from the floor.
        place(&mut scene, shapes::cuboid(Vec3::new(0.4, 0.05, 0.4)), lambert(0.5), Affine3A::from_translation(Vec3::new(0.7, 1.0, 0.0)));
        light(&mut scene, shape, 10.0, middle, Vec3::NEG_Y);
        camera(&mut scene, PERSPECTIVE, Vec3::new(0.0, 2.2, 3.6), Vec3::new(0.0, 0.3, 0.0));
        let snapshot = Snapshot::new(&scene, START);
        let blases =
            snapshot.meshes.iter().map(|mesh| Arc::new(Blas::build(&mesh.positions, &mesh.indices, &BuildOptions::default()).unwrap()));
        let instances = snapshot.instances.iter().map(|instance| BvhInstance::new(instance.mesh, instance.world_from_object));
        let tlas = Tlas::build(blases.collect(), instances.collect()).unwrap();
        let world_from_light = snapshot.lights[0].world_from_light;
        let side = (samples as f32).sqrt() as usize;
        let points: Vec<Vec3> = match shape {
            LightShape::Point => vec![middle],
            _ => (0..samples)
                .map(|i| (Vec2::new((i % side) as f32, (i / side) as f32) + 0.5) / side as f32 - 0.5)
                .map(|u| world_from_light.transform_point3(Vec3::new(u.x * width, u.y * height, 0.0)))
                .collect(),
        };
        let of = |params: &[(&str, &str)]| frame(&device, &scene, size, "shadow/contact-rays", params);
        let short = of(&[("length", "0.4"), ("samples", "256"), ("beyond", "nothing")]);
        let images = short.gbuffer.as_ref().unwrap();
        let truncated = Image::from_fn(size, |x, y| {
            if images.depth.get(x, y).is_infinite() {
                return 1.0;
            }
            let (n, origin) = (*images.normal.get(x, y), *images.position.get(x, y) + *images.normal.get(x, y) * 1e-4);
            let free = |to: &&Vec3| {
                let way = **to - origin;
                let reach = way.length();
                let ray = Ray { t_max: reach.min(length), ..Ray::new(origin, way / reach) };
                way.dot(n) > 0.0 && tlas.closest_hit_opaque(&ray, Filter::ALL).is_none()
            };
            points.iter().filter(free).count() as f32 / points.len() as f32
        });
        let error = rmse(&short.visibility[0], &truncated);
        assert!(error < 0.02, "{shape:?}: {error}");
        let whole = frame(&device, &scene, size, "shadow/ray-traced", &[("samples", "64")]);
        assert!(rmse(&short.visibility[0], &whole.visibility[0]) > 0.1, "{shape:?}: what is far does not block");
        // Contact that a coarse map misses.
        let coarse = frame(&device, &scene, size, "shadow/map", &[("resolution", "32")]);
        let over_map = of(&[("length", "0.4"), ("samples", "256"), ("resolution", "32")]);
        let near: Vec<usize> = (0..truncated.pixels().len()).filter(|&i| truncated.pixels()[i] == 0.0).collect();
        let light_in = |output: &FrameOutput| near.iter().map(|&i| output.visibility[0].pixels()[i]).sum::<f32>() / near.len() as f32;
        assert!(
            near.len() > 30 && light_in(&coarse) > 0.005 && light_in(&over_map) < 0.0005,
            "{} {}",
            light_in(&coarse),
            light_in(&over_map)
        );
    }
}

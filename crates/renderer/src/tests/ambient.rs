//! Techniques of the role ambient visibility against closed forms and the path tracer's `ambient-visibility`.

use super::scenes::*;
use crate::{FrameOutput, FrameSettings, Read, RoleSelection};
use glam::{Affine3A, Quat, UVec2, Vec3};
use kajo_image::Image;
use kajo_path_tracer::{Aov, Filter, Settings, Stop, Tracer, render, uncontrolled};
use kajo_render_graph::Device;
use kajo_scene::{Projection, Scene, Snapshot, shapes};
use kajo_techniques::{Role, TraceBackend};
use kajo_units::Meters;
use std::f32::consts::{FRAC_PI_2, PI};

fn backends(device: &Device) -> impl Iterator<Item = TraceBackend> + use<> {
    let ray_query = device.has_ray_query();
    [TraceBackend::RayQuery, TraceBackend::Compute].into_iter().filter(move |b| *b == TraceBackend::Compute || ray_query)
}

/// One frame with one technique, where surfaces block up to `distance`.
fn around(
    device: &Device,
    scene: &Scene,
    size: UVec2,
    backend: Option<TraceBackend>,
    (technique, params): (&str, &[(&str, &str)]),
    distance: f32,
) -> FrameOutput {
    let roles = RoleSelection::new().choose("shadow/none", &[]).unwrap().choose(technique, params).unwrap();
    let settings =
        FrameSettings { ambient_distance: distance, read: Read::One(Role::AmbientVisibility), gbuffer: true, ..Default::default() };
    renderer(device, scene, size, backend).render(&roles, &settings).unwrap()
}

fn open(output: &FrameOutput) -> Image<f32> {
    output.estimate(Role::AmbientVisibility).expect("asked for").map(|v| v.0.x)
}

fn mean(image: &Image<f32>) -> f32 {
    (image.pixels().iter().map(|&v| f64::from(v)).sum::<f64>() / image.pixels().len() as f64) as f32
}

/// The path tracer's image at pixel centres.
fn truth(scene: &Scene, size: UVec2, spp: u32, distance: f32) -> Image<f32> {
    let tracer = Tracer::new(scene, Snapshot::new(scene, START)).unwrap();
    let settings = Settings {
        size,
        filter: Filter::Center,
        max_depth: 1,
        aovs: vec![Aov::AmbientVisibility],
        smooth_terminator: false,
        ambient_distance: distance,
        ..Settings::default()
    };
    let frame = render(&tracer, &settings, Stop::at_spp(spp), None, &uncontrolled).unwrap().develop();
    let image = &frame.image("ambient-visibility").unwrap().pixels;
    Image::from_fn(size, |x, y| image.get(x, y).x)
}

fn rmse(a: &Image<f32>, b: &Image<f32>) -> f32 {
    let squares: f32 = a.pixels().iter().zip(b.pixels()).map(|(a, b)| (a - b) * (a - b)).sum();
    (squares / a.pixels().len() as f32).sqrt()
}

/// A floor, and where it is wanted an endless wall in the plane x = 0.
fn corner(wall: bool) -> Scene {
    let mut scene = Scene::default();
    place(&mut scene, shapes::floor(60.0, 60.0, 1.0), lambert(0.5), Affine3A::IDENTITY);
    if wall {
        let standing = Affine3A::from_rotation_translation(Quat::from_rotation_y(FRAC_PI_2), Vec3::ZERO);
        place(&mut scene, shapes::rectangle(60.0, 60.0), lambert(0.5), standing);
    }
    scene
}

/// The corner with a camera that sees nothing but the floor around x.
fn spot_of_floor(wall: bool, x: f32) -> Scene {
    let mut scene = corner(wall);
    let narrow = Projection::Orthographic { xmag: Meters(1e-3), ymag: Meters(1e-3) };
    camera(&mut scene, narrow, Vec3::new(x, 0.2, 0.0), Vec3::new(x, 0.0, 0.0));
    scene
}

/// What a wall at distance a · r leaves of the cosine-weighted hemisphere.
fn beside_a_wall(a: f32) -> f32 {
    let a = a.min(1.0);
    1.0 - (a.acos() - a * (1.0 - a * a).sqrt()) / PI
}

/// Row L-14 on the device: the open plane, and a wall at distance d with a longest ray r, a = d / r, by 10⁵ rays.
#[test]
fn ambient_rays_beside_a_wall_give_the_closed_form() {
    let device = Device::new().unwrap();
    let size = UVec2::splat(16);
    for backend in backends(&device) {
        let measured = |wall, directions, reach| {
            let params = [("samples", "400"), ("directions", directions)];
            let out = around(&device, &spot_of_floor(wall, 0.5), size, Some(backend), ("ao/ray-traced", &params), reach);
            assert!(out.rays > 100_000 && out.technique_rays.contains(&("ao/ray-traced", out.rays)), "{}", out.rays);
            mean(&open(&out))
        };
        for directions in ["uniform", "cosine"] {
            assert_eq!(measured(false, directions, f32::INFINITY), 1.0);
        }
        for (a, uniform, cosine) in [(0.5f32, 0.750, 0.8045), (0.25, 0.625, 0.6575)] {
            for (directions, expected) in [("uniform", uniform), ("cosine", cosine)] {
                let got = measured(true, directions, 0.5 / a);
                assert!((got - expected).abs() < 0.005, "{} {directions}, a = {a}: {got}", backend.id());
            }
        }
    }
}

/// Row RM-23: 256 rays beside a wall are the closed form within 2 %, at full and at half resolution; half takes a quarter of the rays.
#[test]
fn ambient_rays_at_half_resolution_are_a_quarter_and_as_right() {
    let device = Device::new().unwrap();
    let size = UVec2::new(64, 16);
    let mut scene = corner(true);
    let wide = Projection::Orthographic { xmag: Meters(0.6), ymag: Meters(0.15) };
    camera(&mut scene, wide, Vec3::new(0.62, 0.2, 0.0), Vec3::new(0.62, 0.0, 0.0));
    let mut rays = Vec::new();
    for resolution in ["full", "half"] {
        let out = around(&device, &scene, size, None, ("ao/ray-traced", &[("samples", "256"), ("resolution", resolution)]), 1.0);
        let positions = &out.gbuffer.as_ref().unwrap().position;
        for x in 0..size.x {
            let column = (0..size.y).map(|y| *open(&out).get(x, y)).sum::<f32>() / size.y as f32;
            let expected = beside_a_wall(positions.get(x, 0).x);
            assert!((column / expected - 1.0).abs() < 0.02, "{resolution}, x = {}: {column} instead of {expected}", positions.get(x, 0).x);
        }
        rays.push(out.rays);
    }
    assert!(rays[0] == 4 * rays[1] && rays[0] == 256 * u64::from(size.x * size.y), "{rays:?}");
}

/// Objects that stand close together on a floor, seen from the side.
fn still_life() -> Scene {
    let mut scene = Scene::default();
    place(&mut scene, shapes::floor(6.0, 6.0, 1.0), lambert(0.7), Affine3A::IDENTITY);
    place(&mut scene, shapes::cuboid(Vec3::new(0.3, 0.5, 0.3)), lambert(0.5), Affine3A::from_translation(Vec3::new(-0.7, 0.5, 0.1)));
    let turned = Affine3A::from_rotation_translation(Quat::from_rotation_y(0.6), Vec3::new(0.6, 0.25, -0.2));
    place(&mut scene, shapes::cuboid(Vec3::new(0.5, 0.25, 0.3)), lambert(0.5), turned);
    place(&mut scene, shapes::sphere(0.35, 48), lambert(0.5), Affine3A::from_translation(Vec3::new(0.0, 0.35, 0.9)));
    camera(&mut scene, PERSPECTIVE, Vec3::new(1.0, 2.2, 4.2), Vec3::new(0.0, 0.3, 0.0));
    scene
}

/// Row RM-22 for ambient light: short rays give what the reference gives that ends at the same distance, and nothing else; on both backends.
#[test]
fn ambient_rays_are_the_reference_that_ends_where_they_do() {
    let device = Device::new().unwrap();
    let scene = still_life();
    let size = UVec2::new(48, 36);
    let spp = 1024u32;
    for distance in [0.3f32, f32::INFINITY] {
        let truth = truth(&scene, size, spp, distance);
        for backend in backends(&device) {
            let out = around(&device, &scene, size, Some(backend), ("ao/ray-traced", &[("samples", "1024")]), distance);
            let error = rmse(&open(&out), &truth);
            assert!(error < 0.02, "{} {distance} m: {error}", backend.id());
            assert!(
                (mean(&open(&out)) - mean(&truth)).abs() < 0.002,
                "{} {distance} m: {}, {}",
                backend.id(),
                mean(&open(&out)),
                mean(&truth)
            );
        }
        let other = around(&device, &scene, size, None, ("ao/ray-traced", &[("samples", "64")]), 1.0);
        assert!(rmse(&open(&other), &truth) > 0.04, "another distance is another image");
    }
}

/// The filter lowers the error of few rays without darkening, and half resolution costs less than a quarter of the rays lose.
#[test]
fn ambient_filters_lower_the_error_of_few_rays() {
    let device = Device::new().unwrap();
    let scene = still_life();
    let size = UVec2::new(160, 120);
    let looked = |params: &[(&str, &str)]| open(&around(&device, &scene, size, None, ("ao/ray-traced", params), 0.5)).clone();
    let truth = looked(&[("samples", "256")]);
    let raw = rmse(&looked(&[]), &truth);
    let filtered = looked(&[("denoise", "3")]);
    assert!(rmse(&filtered, &truth) < 0.5 * raw, "{} of {raw}", rmse(&filtered, &truth));
    assert!((mean(&filtered) - mean(&truth)).abs() < 0.005, "{} of {}", mean(&filtered), mean(&truth));
    let [one, half] =
        [[("samples", "1"), ("resolution", "full")], [("samples", "4"), ("resolution", "half")]].map(|p| rmse(&looked(&p), &truth));
    assert!(half < 0.8 * one, "the same rays: {half} at half resolution, {one} spread over all pixels");
}

/// The corner as seen from the side: floor and wall fill the image.
fn corner_from_the_side(wall: bool) -> Scene {
    let mut scene = corner(wall);
    camera(&mut scene, PERSPECTIVE, Vec3::new(4.0, 3.0, 0.7), Vec3::new(0.6, 0.4, 0.0));
    scene
}

/// Row R-08: the hemisphere leaves a plane open, the full sphere finds half of it inside, and a corner is darker than a plane.
#[test]
fn ssao_leaves_planes_open_by_the_hemisphere_and_half_by_the_sphere() {
    let device = Device::new().unwrap();
    let size = UVec2::new(96, 72);
    for (distance, slanted) in [(0.2, false), (0.6, false), (0.6, true)] {
        let mut plane = corner(false);
        let eye = if slanted { Vec3::new(0.0, 0.6, 3.0) } else { Vec3::new(0.0, 3.0, 1.0) };
        camera(&mut plane, PERSPECTIVE, eye, Vec3::ZERO);
        let of = |scene: &Scene, kernel| {
            let params = [("kernel", kernel), ("denoise", "0")];
            let out = around(&device, scene, size, None, ("ao/ssao", &params), distance);
            // Where no point is lost beyond the border of the image.
            mean(&Image::from_fn(size / 3, |x, y| *open(&out).get(x + size.x / 3, y + size.y / 3)))
        };
        let (hemisphere, sphere) = (of(&plane, "hemisphere"), of(&plane, "sphere"));
        assert!(hemisphere >= 0.97, "{distance} m, slanted {slanted}: {hemisphere}");
        // Seen at a slant, points in the plane lie behind parts of it that are farther away than what may block.
        assert!(if slanted { sphere < 0.9 } else { (sphere - 0.5).abs() < 0.05 }, "{distance} m, slanted {slanted}: {sphere}");
    }
    let seen = |wall| around(&device, &corner_from_the_side(wall), size, None, ("ao/ssao", &[]), 0.5);
    let (with, without) = (seen(true), seen(false));
    let positions = &with.gbuffer.as_ref().unwrap().position;
    let near = |p: &Vec3| p.y < 1e-3 && p.x > 0.02 && p.x < 0.1;
    let mean_near = |image: &Image<f32>| {
        let values: Vec<f32> = image.pixels().iter().zip(positions.pixels()).filter(|(_, p)| near(p)).map(|(v, _)| *v).collect();
        assert!(values.len() > 40, "{}", values.len());
        values.iter().sum::<f32>() / values.len() as f32
    };
    assert!(mean_near(&open(&with)) < mean_near(&open(&without)) - 0.15, "{} {}", mean_near(&open(&with)), mean_near(&open(&without)));
}

/// Horizons give the closed form beside an endless wall, on the wall and on the floor; a plane is open whatever the number of slices.
#[test]
fn gtao_beside_a_wall_gives_the_closed_form() {
    let device = Device::new().unwrap();
    let size = UVec2::new(192, 144);
    for (slices, steps, tolerance) in [("32", "64", 0.01), ("2", "8", 0.04)] {
        let params = [("slices", slices), ("steps", steps), ("denoise", "0")];
        let plane = around(&device, &corner_from_the_side(false), size, None, ("ao/gtao", &params), 1.0);
        assert!(open(&plane).pixels().iter().all(|v| (v - 1.0).abs() < 1e-4));
        let out = around(&device, &corner_from_the_side(true), size, None, ("ao/gtao", &params), 1.0);
        let positions = &out.gbuffer.as_ref().unwrap().position;
        for on_wall in [false, true] {
            for bin in 0..12 {
                let a = 0.1 * bin as f32;
                let of = |p: &Vec3| if on_wall { p.y } else { p.x };
                let inside = |p: &Vec3| {
                    let here = if on_wall { p.x < 1e-3 && p.y < 1.2 } else { p.y < 1e-3 };
                    here && p.z.abs() < 0.4 && of(p) > a + 0.01 && of(p) < a + 0.1
                };
                let seen = open(&out);
                let pairs: Vec<_> = seen.pixels().iter().zip(positions.pixels()).filter(|(_, p)| inside(p)).collect();
                assert!(pairs.len() > 20, "{on_wall} {a}: {}", pairs.len());
                let error = pairs.iter().map(|(v, p)| *v - beside_a_wall(of(p))).sum::<f32>() / pairs.len() as f32;
                assert!(error.abs() < tolerance, "{slices} slices, {steps} steps, wall {on_wall}, a = {a}: {error}");
            }
        }
    }
}

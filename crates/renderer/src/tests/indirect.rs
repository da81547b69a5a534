//! Techniques of the role diffuse indirect against the path tracer's `diffuse-indirect`.

use super::scenes::*;
use crate::{FrameOutput, FrameSettings, Read, RoleSelection};
use glam::{Affine3A, UVec2, Vec3, Vec3Swizzles};
use kajo_image::Image;
use kajo_path_tracer::Aov;
use kajo_render_graph::Device;
use kajo_scene::{Environment, LightShape, Projection, Scene, Snapshot, builtin, shapes};
use kajo_techniques::{Role, TraceBackend};
use kajo_units::{LinearRgb, Meters};
use std::f32::consts::PI;

const SIZE: UVec2 = UVec2::new(48, 36);

fn roles(technique: &str, params: &[(&str, &str)]) -> RoleSelection {
    RoleSelection::new().choose("shadow/none", &[]).unwrap().choose(technique, params).unwrap()
}

fn settings() -> FrameSettings {
    FrameSettings { read: Read::One(Role::DiffuseIndirect), gbuffer: true, ..Default::default() }
}

/// One frame.
fn indirect(device: &Device, scene: &Scene, size: UVec2, technique: &str, params: &[(&str, &str)]) -> FrameOutput {
    renderer(device, scene, size, None).render(&roles(technique, params), &settings()).unwrap()
}

fn irradiance(output: &FrameOutput) -> &Image<LinearRgb> {
    &output.estimates.iter().find(|(role, _)| *role == Role::DiffuseIndirect).expect("asked for").1
}

/// The path tracer's image; 2 for `depth` is light that bounced once.
fn truth(scene: &Scene, size: UVec2, depth: u32, spp: u32) -> Image<LinearRgb> {
    bounced(scene, size, depth, spp, Aov::DiffuseIndirect)
}

/// Mean of all channels over the pixels for which `wanted` holds.
fn mean_where(image: &Image<LinearRgb>, wanted: impl Fn(usize) -> bool) -> f64 {
    let chosen = || image.pixels().iter().enumerate().filter(|(i, _)| wanted(*i));
    let sum: f64 = chosen().map(|(_, p)| f64::from(p.0.element_sum()) / 3.0).sum();
    sum / chosen().count().max(1) as f64
}

fn mean(image: &Image<LinearRgb>) -> f64 {
    mean_where(image, |_| true)
}

/// RMSE over the mean of `truth`.
fn error(image: &Image<LinearRgb>, truth: &Image<LinearRgb>) -> f64 {
    let squares: f64 = image.pixels().iter().zip(truth.pixels()).map(|(a, b)| f64::from((a.0 - b.0).length_squared()) / 3.0).sum();
    (squares / image.pixels().len() as f64).sqrt() / mean(truth)
}

fn statistic(output: &FrameOutput, name: &str) -> u64 {
    output.statistics.iter().find(|s| s.name == name).unwrap_or_else(|| panic!("no {name}")).value
}

/// Row R-12: the Cornell box after one bounce, 4096 paths: mean within 5 % of the path tracer, and the clamp says what it took.
#[test]
fn virtual_lights_give_the_light_of_one_bounce() {
    let device = Device::new().unwrap();
    let scene = builtin::load("cornell").unwrap();
    let size = UVec2::splat(32);
    let truth = truth(&scene, size, 2, 512);
    let with = |params: &[(&str, &str)]| {
        let all = [&[("paths", "4096"), ("bounces", "1"), ("samples", "256")], params].concat();
        indirect(&device, &scene, size, "gi/vpl", &all)
    };
    let out = with(&[]);
    let ratio = mean(irradiance(&out)) / mean(&truth);
    assert!((ratio - 1.0).abs() < 0.05, "{ratio}");
    assert!(error(irradiance(&out), &truth) < 0.35, "{}", error(irradiance(&out), &truth));
    let (lights, clamped) = (statistic(&out, "virtual-lights"), statistic(&out, "clamped-ppm"));
    assert!((3000..=4096).contains(&lights), "one for each path that hits the box: {lights}");
    assert!(out.rays > lights && out.technique_rays.contains(&("gi/vpl", out.rays)), "{}", out.rays);
    // A stronger clamp takes more, says so, and what it took is what is missing.
    let dark = with(&[("nearest", "0.3")]);
    let (lost, ratio_dark) = (statistic(&dark, "clamped-ppm"), mean(irradiance(&dark)) / mean(&truth));
    assert!(lost > 4 * clamped.max(1) && ratio_dark < ratio - 0.03, "{clamped}, {lost} ppm: {ratio}, {ratio_dark}");
    let restored = mean(irradiance(&dark)) * (1.0 + lost as f64 / 1e6) / mean(irradiance(&out)) / (1.0 + clamped as f64 / 1e6);
    assert!((restored - 1.0).abs() < 0.01, "{restored}");
}

/// A white room with things in it that is lit by a light of any kind; the light shines to the floor.
fn lit_room(shape: LightShape, emission: f32) -> Scene {
    let mut scene = Scene::default();
    place(&mut scene, shapes::cuboid(Vec3::new(1.5, 1.0, 1.5)).inside_out(), lambert(0.6), Affine3A::from_translation(Vec3::Y));
    place(&mut scene, shapes::cuboid(Vec3::new(0.3, 0.4, 0.3)), lambert(0.5), Affine3A::from_translation(Vec3::new(0.6, 0.4, -0.3)));
    light(&mut scene, shape, emission, Vec3::new(-0.3, 1.7, 0.0), Vec3::new(0.1, -1.0, 0.2));
    camera(&mut scene, PERSPECTIVE, Vec3::new(0.0, 1.0, 1.4), Vec3::new(0.0, 0.7, 0.0));
    scene
}

/// Paths leave every kind of light with its power, and go on as often as light does.
#[test]
fn virtual_lights_are_lit_by_every_kind_of_light() {
    let device = Device::new().unwrap();
    let glowing = {
        let mut scene = lit_room(LightShape::Point, 0.0);
        let lamp = kajo_scene::Material { emission: LinearRgb::splat(20.0), double_sided: true, ..lambert(0.0) };
        place(&mut scene, shapes::sphere(0.1, 16), lamp, Affine3A::from_translation(Vec3::new(-0.3, 1.4, 0.0)));
        scene
    };
    let angle = kajo_units::Radians;
    let shapes = [
        ("point", LightShape::Point, 1.0),
        ("spot", LightShape::Spot { inner: angle(0.4), outer: angle(0.9) }, 3.0),
        ("rectangle", LightShape::Rectangle { width: Meters(0.5), height: Meters(0.3) }, 8.0),
        ("disk", LightShape::Disk { radius: Meters(0.2) }, 8.0),
        ("sphere", LightShape::Sphere { radius: Meters(0.1) }, 20.0),
    ];
    let size = UVec2::splat(16);
    let chosen = roles("gi/vpl", &[("paths", "4096"), ("bounces", "3"), ("samples", "256"), ("nearest", "0.02")]);
    let check = |name: &str, scene: &Scene, out: &FrameOutput| {
        let truth = mean(&truth(scene, size, 4, 256));
        let ratio = mean(irradiance(out)) / truth;
        assert!((ratio - 1.0).abs() < 0.06, "{name}: {ratio} of {truth}");
    };
    check("mesh", &glowing, &renderer(&device, &glowing, size, None).render(&chosen, &settings()).unwrap());
    let mut room = renderer(&device, &lit_room(LightShape::Point, 0.0), size, None);
    for (name, shape, emission) in shapes {
        let scene = lit_room(shape, emission);
        let snapshot = Snapshot::new(&scene, START);
        room.set_snapshot(&snapshot, &snapshot).unwrap();
        check(name, &scene, &room.render(&chosen, &settings()).unwrap());
    }
}

/// A floor with a wall, in the open.
fn open_corner() -> Scene {
    let mut scene = Scene::default();
    place(&mut scene, shapes::floor(3.0, 3.0, 1.0), lambert(0.7), Affine3A::IDENTITY);
    place(&mut scene, shapes::cuboid(Vec3::new(1.0, 0.7, 0.1)), lambert(0.7), Affine3A::from_translation(Vec3::new(0.0, 0.7, -0.5)));
    camera(&mut scene, PERSPECTIVE, Vec3::new(0.5, 1.2, 2.6), Vec3::new(0.0, 0.5, -0.3));
    scene
}

/// Suns and the environment shine on a disc that covers the scene; what bounces from floor to wall and back is the path tracer's.
#[test]
fn virtual_lights_are_lit_by_the_sun_and_by_the_sky() {
    let device = Device::new().unwrap();
    let mut sun = open_corner();
    light(&mut sun, LightShape::Directional { half_angle: kajo_units::Radians(0.05) }, 3.0, Vec3::ZERO, Vec3::new(-0.3, -1.0, -0.8));
    let mut sky = open_corner();
    sky.environment = Some(Environment::uniform(LinearRgb::new(0.5, 0.8, 1.2)));
    let size = UVec2::splat(16);
    for (name, scene) in [("sun", sun), ("sky", sky)] {
        let truth = mean(&truth(&scene, size, 4, 512));
        let params = [("paths", "8192"), ("bounces", "3"), ("samples", "256"), ("nearest", "0.01")];
        let ratio = mean(irradiance(&indirect(&device, &scene, size, "gi/vpl", &params))) / truth;
        assert!((ratio - 1.0).abs() < 0.08, "{name}: {ratio} of {truth}");
        let paths = [("samples", "256"), ("bounces", "3")];
        let ratio = mean(irradiance(&indirect(&device, &scene, size, "gi/ray-traced", &paths))) / truth;
        assert!((ratio - 1.0).abs() < 0.03, "{name}, paths: {ratio} of {truth}");
    }
}

/// Paths stay for as long as nothing moves, or are others in each frame; the other trace backend gives the same picture.
#[test]
fn virtual_lights_stay_or_are_renewed() {
    let device = Device::new().unwrap();
    let scene = builtin::load("cornell").unwrap();
    // No pixel of which lies on a crease.
    let size = UVec2::new(13, 11);
    let frames = |renew, backend| {
        let chosen = roles("gi/vpl", &[("paths", "256"), ("bounces", "1"), ("samples", "0"), ("renew", renew)]);
        let mut renderer = renderer(&device, &scene, size, backend);
        [0, 1].map(|index| irradiance(&renderer.render(&chosen, &FrameSettings { index, ..settings() }).unwrap()).clone())
    };
    let [first, second] = frames("scene", None);
    assert_eq!(first.pixels(), second.pixels());
    let [one, other] = frames("frame", None);
    assert!(error(&other, &one) > 0.02, "{}", error(&other, &one));
    let [compute, _] = frames("scene", Some(TraceBackend::Compute));
    assert!(error(&compute, &first) < 0.01, "{}", error(&compute, &first));
}

/// The largest difference of the pixels that show a surface from `expected`, as a share of it.
fn farthest(output: &FrameOutput, expected: f32) -> f32 {
    let seen = &output.gbuffer.as_ref().unwrap().instance;
    let pixels = irradiance(output).pixels().iter().zip(seen.pixels()).filter(|(_, instance)| instance.is_some());
    pixels.map(|(e, _)| (e.0 / expected - 1.0).abs().max_element()).fold(0.0, f32::max)
}

/// Row R-11: a sphere lit from its centre has the same radiance L everywhere, after one bounce and after any number: probes in it give the
/// irradiance π L within 1 % to normals all around, also those that a wall of no thickness parts from probes behind it. After n bounces that is E₀ (ρ + … + ρⁿ), of the lamp's E₀.
#[test]
fn probes_under_constant_radiance_give_its_irradiance_for_every_normal() {
    let device = Device::new().unwrap();
    let sphere = |lamp: Vec3| {
        let mut scene = Scene::default();
        place(&mut scene, shapes::sphere(1.0, 96).inside_out(), lambert(0.5), Affine3A::IDENTITY);
        light(&mut scene, LightShape::Point, 1.0, lamp, Vec3::NEG_Y);
        camera(&mut scene, PERSPECTIVE, Vec3::new(0.0, 0.0, 0.9), Vec3::ZERO);
        scene.cameras[0].projection = Projection::Perspective { yfov: kajo_units::Radians(2.0), aspect: None };
        scene
    };
    let of = |lamp, bounces| {
        let params = [("probes", "5"), ("rays", "1024"), ("bounces", bounces), ("leak_guard", "rays")];
        indirect(&device, &sphere(lamp), SIZE, "gi/probes", &params)
    };
    for (bounces, expected) in [("1", 0.5), ("8", 1.0 - 0.5f32.powi(8))] {
        let out = of(Vec3::ZERO, bounces);
        let normals = out.gbuffer.as_ref().unwrap().shading_normal.pixels();
        for axis in [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z] {
            assert!(normals.iter().any(|n| n.dot(axis) > 0.9), "{axis} is seen");
        }
        let off = farthest(&out, expected);
        assert!(off < 0.01, "{bounces} bounces: {off}");
    }
    let off = farthest(&of(Vec3::new(0.1, 0.0, 0.0), "1"), 0.5);
    assert!(off > 0.02, "planted fault, a lamp 10 cm from the centre: {off}");
}

/// Light that bounces many times in a closed white box: E = Φ ρ / (A (1 − ρ)) on average over its walls; probes, virtual lights and the constant agree.
#[test]
fn probes_reach_the_even_exchange_of_a_closed_box() {
    let device = Device::new().unwrap();
    let mut scene = Scene::default();
    place(&mut scene, shapes::cuboid(Vec3::ONE).inside_out(), lambert(0.5), Affine3A::IDENTITY);
    light(&mut scene, LightShape::Point, 6.0, Vec3::ZERO, Vec3::NEG_Y);
    camera(&mut scene, PERSPECTIVE, Vec3::new(0.0, 0.0, 0.95), Vec3::ZERO);
    let size = UVec2::splat(24);
    let truth = truth(&scene, size, 16, 256);
    let constant = indirect(&device, &scene, size, "gi/constant", &[]);
    assert!(irradiance(&constant).pixels().iter().all(|p| (p[0] - PI).abs() < 1e-4));
    let given = indirect(&device, &scene, size, "gi/constant", &[("of", "given"), ("radiance", "0.25")]);
    assert!((mean(irradiance(&given)) - 0.25 * f64::from(PI)).abs() < 1e-5);
    for (guard, bounces, expected) in [("rays", "16", 1.0), ("distance", "16", 1.0), ("none", "16", 1.0), ("rays", "1", 0.5)] {
        let out = indirect(&device, &scene, size, "gi/probes", &[("probes", "6"), ("leak_guard", guard), ("bounces", bounces)]);
        let ratio = mean(irradiance(&out)) / mean(&truth);
        assert!((ratio - expected).abs() < 0.03, "{guard}, {bounces}: {ratio}");
        assert_eq!((statistic(&out, "probes"), statistic(&out, "closed-probes")), (216, 0));
    }
}

/// The Cornell box, all bounces: an image near the path tracer's, and far nearer than a constant.
#[test]
fn probes_are_near_the_path_tracer() {
    let device = Device::new().unwrap();
    let scene = builtin::load("cornell").unwrap();
    let size = UVec2::splat(48);
    let truth = truth(&scene, size, 16, 256);
    let of = |technique, params: &[(&str, &str)]| indirect(&device, &scene, size, technique, params);
    let probes = of("gi/probes", &[("probes", "12"), ("bounces", "16")]);
    let (near, flat) = (error(irradiance(&probes), &truth), error(irradiance(&of("gi/constant", &[])), &truth));
    let ratio = mean(irradiance(&probes)) / mean(&truth);
    assert!(near < 0.2 && near < 0.4 * flat, "{near} of {flat}");
    assert!((ratio - 1.0).abs() < 0.06, "{ratio}");
}

/// Rows R-11 and RM-25: two rooms, the dark one without its candle, so that all light there is leak.
#[test]
fn probes_leak_through_a_thin_wall_unless_they_are_guarded() {
    let device = Device::new().unwrap();
    let mut scene = builtin::load("two-rooms").unwrap();
    scene.lights.iter_mut().filter(|light| light.name == "candle").for_each(|light| light.emission = LinearRgb::BLACK);
    let leak = |guard: &str| {
        let out = indirect(&device, &scene, SIZE, "gi/probes", &[("probes", "16"), ("rays", "64"), ("leak_guard", guard)]);
        let gbuffer = out.gbuffer.as_ref().unwrap();
        let seen = |i: usize| gbuffer.instance.pixels()[i].is_some();
        let x = |i: usize| gbuffer.position.pixels()[i].x;
        let image = irradiance(&out);
        let [dark, bright] = [mean_where(image, |i| seen(i) && x(i) > 0.02), mean_where(image, |i| seen(i) && x(i) < -0.02)];
        assert!(bright > 0.1, "{bright}");
        dark / bright
    };
    let [none, distance, rays] = ["none", "distance", "rays"].map(leak);
    assert!(none > 0.01, "planted fault, no guard: {none}");
    assert!(distance < 0.5 * none && distance < 0.05, "{distance} of {none}");
    assert!(rays < 0.01, "{rays}");
}

/// Probes are baked when something moves and not when the camera does; a second frame traces the guard's rays alone.
#[test]
fn probes_are_baked_once() {
    let device = Device::new().unwrap();
    let scene = builtin::load("cornell").unwrap();
    let chosen = roles("gi/probes", &[("probes", "4"), ("rays", "32"), ("leak_guard", "none")]);
    let mut renderer = renderer(&device, &scene, SIZE, None);
    let first = renderer.render(&chosen, &settings()).unwrap();
    assert!(first.rays > 64 * 32 && first.timings.passes.iter().any(|(name, _)| name == "gi/probes/bake"));
    let second = renderer.render(&chosen, &FrameSettings { index: 1, ..settings() }).unwrap();
    assert_eq!(second.rays, 0);
    assert_eq!(irradiance(&first).pixels(), irradiance(&second).pixels());
    let mut darker = scene.clone();
    darker.lights[0].emission *= 0.5;
    let snapshot = Snapshot::new(&darker, START);
    renderer.set_snapshot(&snapshot, &snapshot).unwrap();
    let third = renderer.render(&chosen, &settings()).unwrap();
    let ratio = mean(irradiance(&third)) / mean(irradiance(&first));
    assert!(third.rays > 64 * 32 && (ratio - 0.5).abs() < 1e-3, "{ratio}");
}

/// The environment that probes see is all that lights a floor and what stands on it; what bounces is the path tracer's.
#[test]
fn probes_bounce_the_light_of_the_environment() {
    let device = Device::new().unwrap();
    let mut scene = open_corner();
    scene.environment = Some(Environment::uniform(LinearRgb::splat(1.0)));
    let truth = truth(&scene, SIZE, 8, 256);
    let out = indirect(&device, &scene, SIZE, "gi/probes", &[("probes", "12")]);
    let ratio = mean(irradiance(&out)) / mean(&truth);
    assert!((ratio - 1.0).abs() < 0.15, "{ratio}");
    let dark = renderer(&device, &scene, SIZE, None)
        .render(&roles("gi/probes", &[]), &FrameSettings { environment_light: false, ..settings() })
        .unwrap();
    assert_eq!(mean(irradiance(&dark)), 0.0, "an environment that lights nothing");
}

/// Paths are the path tracer's light: the more of them, the nearer, and each bounce adds its part.
#[test]
fn paths_converge_to_the_path_tracer() {
    let device = Device::new().unwrap();
    let scene = builtin::load("cornell").unwrap();
    let size = UVec2::splat(24);
    for (bounces, depth) in [("1", 2), ("3", 4)] {
        let truth = truth(&scene, size, depth, 1024);
        let of = |samples| indirect(&device, &scene, size, "gi/ray-traced", &[("samples", samples), ("bounces", bounces)]);
        let (few, many) = (of("4"), of("128"));
        let ratio = mean(irradiance(&many)) / mean(&truth);
        assert!((ratio - 1.0).abs() < 0.02, "{bounces} bounces: {ratio}");
        let [rough, fine] = [&few, &many].map(|out| error(irradiance(out), &truth));
        assert!(fine < 0.35 * rough && fine < 0.2, "{bounces} bounces: {rough}, {fine}");
        assert!(many.rays > 16 * few.rays && few.technique_rays.contains(&("gi/ray-traced", few.rays)));
    }
}

/// Points in a crease, which rounding may put behind the other wall, see their probes and virtual lights.
#[test]
fn creases_are_lit() {
    let device = Device::new().unwrap();
    let scene = builtin::load("cornell").unwrap();
    // The diagonals of the image run along the edges between walls.
    let size = UVec2::splat(12);
    for (technique, params) in [("gi/probes", [("probes", "8"), ("rays", "64")]), ("gi/vpl", [("paths", "512"), ("samples", "0")])] {
        let out = indirect(&device, &scene, size, technique, &params);
        let gbuffer = out.gbuffer.as_ref().unwrap();
        // The lamp hides the ceiling above it.
        let counts = |i: usize| gbuffer.instance.pixels()[i].is_some() && gbuffer.position.pixels()[i].xz().abs().max_element() > 0.25;
        let dark = irradiance(&out).pixels().iter().enumerate().filter(|(i, e)| counts(*i) && e.0.max_element() < 1e-3).count();
        assert_eq!(dark, 0, "{technique}");
    }
}

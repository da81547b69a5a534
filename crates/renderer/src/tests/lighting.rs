//! Direct light: deferred against forward, against the path tracer, and against closed forms.

use super::scenes::*;
use crate::{FrameSettings, RoleSelection};
use glam::{Affine3A, Quat, UVec2, Vec3};
use kajo_path_tracer::Aov;
use kajo_render_graph::Device;
use kajo_scene::{AlphaMode, LightShape, Material, Projection, Scene, builtin, shapes};
use kajo_units::{LinearRgb, Meters, Radians};
use std::f32::consts::PI;

/// Row R-02: each visible pixel is lit once, and looks as if it had been lit while it was drawn.
#[test]
fn deferred_light_equals_forward_light() {
    let device = Device::new().unwrap();
    let size = UVec2::new(96, 96);
    // With reflections, which show glowing meshes in smooth surfaces in the place of highlights.
    for (name, reflection) in [("shadows", "reflection/none"), ("moving", "reflection/none"), ("glossy-floor", "reflection/ray-traced")] {
        let scene = builtin::load(name).unwrap();
        let mut renderer = renderer(&device, &scene, size, None);
        let roles = RoleSelection::new().choose("shadow/none", &[]).unwrap().choose(reflection, &[]).unwrap();
        let deferred = renderer.render(&roles, &FrameSettings { gbuffer: true, ..Default::default() }).unwrap();
        let forward = renderer.render(&roles, &FrameSettings { forward: true, ..Default::default() }).unwrap();
        let images = deferred.gbuffer.unwrap();
        let covered: Vec<usize> = (0..images.instance.pixels().len()).filter(|&i| images.instance.pixels()[i].is_some()).collect();
        assert_eq!(deferred.shaded_pixels as usize, covered.len(), "{name}");
        let worst = covered
            .iter()
            .map(|&i| {
                let (a, b) = (deferred.direct.pixels()[i].0, forward.direct.pixels()[i].0);
                ((a - b).abs() / a.max(b).max(Vec3::ONE)).max_element()
            })
            .fold(0.0, f32::max);
        assert!(worst <= 1.0 / 255.0, "{name}: {worst}");
        assert!(deferred.direct.pixels().iter().any(|c| c.luminance() > 0.05), "{name} is lit");
    }
}

/// Row R-03: transparent quads over an opaque one are α · quad + (1 − α) · what lies behind, from the farthest to the nearest, with the radiance
/// ρ/π · I cos θ / r² of a matt surface.
#[test]
fn a_transparent_quad_blends_as_arithmetic_says() {
    let device = Device::new().unwrap();
    let size = UVec2::new(33, 33);
    let (intensity, light_at) = (120.0, Vec3::new(1.0, 2.0, 4.0));
    // In the order of the scene: the nearest first, so that the order of drawing is not that of the list.
    let quads = [(2.0, Vec3::new(0.8, 0.1, 0.05), 2.0), (1.0, Vec3::new(0.1, 0.2, 0.9), 3.0), (0.0, Vec3::new(0.6, 0.6, 0.1), 8.0)];
    for alphas in [[0.4, 0.0, 1.0], [0.0, 0.75, 1.0], [0.4, 0.75, 1.0], [0.9, 0.3, 1.0]] {
        let mut scene = Scene::default();
        for (&(z, color, side), alpha) in quads.iter().zip(alphas) {
            let alpha_mode = if z > 0.0 { AlphaMode::Blend } else { AlphaMode::Opaque };
            let material = Material { base_color: LinearRgb(color), alpha, alpha_mode, ..lambert(0.5) };
            place(&mut scene, shapes::rectangle(side, side), material, Affine3A::from_translation(Vec3::Z * z));
        }
        light(&mut scene, LightShape::Point, intensity, light_at, Vec3::NEG_Z);
        camera(&mut scene, PERSPECTIVE, Vec3::Z * 5.0, Vec3::ZERO);
        let color = frame(&device, &scene, size, "shadow/none", &[]).color;
        for (x, y) in [(16, 16), (14, 18), (12, 12), (20, 17)] {
            let ray = Vec3::new((x as f32 + 0.5) / 16.5 - 1.0, 1.0 - (y as f32 + 0.5) / 16.5, 0.0) * 0.35f32.tan() - Vec3::Z;
            let expected = quads.iter().zip(alphas).rev().fold(Vec3::ZERO, |behind, (&(z, albedo, _), alpha)| {
                let to_light = light_at - (Vec3::Z * 5.0 + ray * (5.0 - z));
                let radiance = albedo / PI * intensity * to_light.normalize().z / to_light.length_squared();
                alpha * radiance + (1.0 - alpha) * behind
            });
            let got = color.get(x, y).0;
            assert!((got - expected).abs().max_element() <= 1.0 / 255.0, "{alphas:?} at ({x}, {y}): {got} instead of {expected}");
            assert!(expected.max_element() > 0.8, "a fault of one part in a hundred is seen");
        }
    }
}

/// Irradiance at the middle of a white floor.
fn irradiance(device: &Device, shape: LightShape, emission: f32, position: Vec3, direction: Vec3) -> f32 {
    let mut scene = Scene::default();
    let down = Affine3A::from_quat(Quat::from_rotation_x(-0.5 * PI));
    place(&mut scene, shapes::rectangle(4.0, 4.0), lambert(1.0), down);
    light(&mut scene, shape, emission, position, direction);
    let parallel = Projection::Orthographic { xmag: Meters(0.001), ymag: Meters(0.001) };
    camera(&mut scene, parallel, Vec3::Y * 20.0, Vec3::ZERO);
    let settings = crate::RendererSettings { light_samples: 4096, ..crate::RendererSettings::new(UVec2::new(3, 3)) };
    let snapshot = kajo_scene::Snapshot::new(&scene, START);
    let mut renderer = crate::Renderer::new(device, &scene, &snapshot, settings).unwrap();
    let roles = RoleSelection::new().choose("shadow/none", &[]).unwrap();
    renderer.render(&roles, &FrameSettings::default()).unwrap().direct.get(1, 1).0.x * PI
}

/// Row SH-01: irradiance of every kind of light on the device.
#[test]
fn irradiance_of_every_light_is_analytic() {
    let device = Device::new().unwrap();
    let (h, down) = (2.0f32, Vec3::NEG_Y);
    let above = Vec3::Y * h;
    let side = Vec3::new(1.0, h, 0.0);
    let cos3 = (h / side.length()).powi(3);
    let (w, l) = (0.6f32, 0.8f32);
    // A rectangle over its middle: four times a quarter, E = L · 2 Σ of Lambert's formula.
    let quarter = {
        let (a, b) = (0.5 * w / h, 0.5 * l / h);
        let term = |a: f32, b: f32| a / (1.0 + a * a).sqrt() * (b / (1.0 + a * a).sqrt()).atan();
        0.5 * (term(a, b) + term(b, a))
    };
    let angle = 0.05f32;
    let spot = LightShape::Spot { inner: Radians(0.3), outer: Radians(0.6) };
    let half_way = 0.5 * (0.3f32.cos() + 0.6f32.cos());
    let at_half_way = Vec3::new(half_way.acos().tan() * h, h, 0.0);
    let cases = [
        ("point", LightShape::Point, 8.0, above, down, 8.0 / (h * h)),
        ("point at a slant", LightShape::Point, 8.0, side, down, 8.0 / (h * h) * cos3),
        ("spot", spot, 8.0, above, down, 8.0 / (h * h)),
        ("spot half way between its cones", spot, 8.0, at_half_way, down, 8.0 / (h * h) * half_way.powi(3) * 0.25),
        (
            "directional",
            LightShape::Directional { half_angle: Radians(0.0) },
            3.0,
            above,
            Vec3::new(1.0, -2.0, 0.0),
            3.0 * 2.0 / 5f32.sqrt(),
        ),
        ("sun", LightShape::Directional { half_angle: Radians(angle) }, 3.0, above, down, 3.0),
        ("disk", LightShape::Disk { radius: Meters(0.5) }, 5.0, above, down, 5.0 * PI * 0.25 / (0.25 + h * h)),
        ("sphere", LightShape::Sphere { radius: Meters(0.5) }, 5.0, above, down, 5.0 * PI * 0.25 / (h * h)),
        ("rectangle", LightShape::Rectangle { width: Meters(w), height: Meters(l) }, 5.0, above, down, 5.0 * 4.0 * quarter),
        ("rectangle from behind", LightShape::Rectangle { width: Meters(w), height: Meters(l) }, 5.0, above, Vec3::Y, 0.0),
    ];
    for (name, shape, emission, position, direction, expected) in cases {
        let got = irradiance(&device, shape, emission, position, direction);
        assert!((got - expected).abs() <= 0.005 * expected, "{name}: {got} instead of {expected}");
    }
}

/// Without shadows a light that stands half below the horizon of a surface still lights it with its upper half, and not at all from behind:
/// V is the share above, and the lighting pass gives it back its light.
#[test]
fn without_shadows_only_the_horizon_hides_a_light() {
    let device = Device::new().unwrap();
    let size = UVec2::new(9, 9);
    let rectangle = LightShape::Rectangle { width: Meters(0.5), height: Meters(1.0) };
    let cases = [
        ("in front", LightShape::Point, Vec3::new(0.0, 0.5, 2.0), 1.0),
        ("behind", LightShape::Point, Vec3::new(0.0, 0.5, -2.0), 0.0),
        ("sun in front", LightShape::Directional { half_angle: Radians(0.0) }, Vec3::new(0.0, 0.5, 2.0), 1.0),
        ("sun behind", LightShape::Directional { half_angle: Radians(0.0) }, Vec3::new(0.0, 0.5, -2.0), 0.0),
        ("disk of the sun, half set", LightShape::Directional { half_angle: Radians(0.2) }, Vec3::new(0.0, 3.0, 0.0), 0.5),
        ("rectangle, a quarter above", rectangle, Vec3::new(0.0, 3.0, -0.25), 0.25),
        ("sphere, half above", LightShape::Sphere { radius: Meters(0.4) }, Vec3::new(0.0, 3.0, 0.0), 0.5),
    ];
    for (name, shape, position, share) in cases {
        let mut scene = Scene::default();
        place(&mut scene, shapes::rectangle(1.0, 1.0), lambert(0.5), Affine3A::IDENTITY);
        // Its shadow would cover everything.
        place(&mut scene, shapes::rectangle(0.1, 0.1), lambert(0.5), Affine3A::from_translation(0.5 * position));
        // The rectangle shines down, its height along z.
        light(&mut scene, shape, 1.0, position, if shape == rectangle { Vec3::NEG_Y } else { -position });
        camera(&mut scene, PERSPECTIVE, Vec3::Z * 0.5, Vec3::ZERO);
        let out = frame(&device, &scene, size, "shadow/none", &[("samples", "256")]);
        for (x, y) in [(3, 4), (4, 4), (5, 5)] {
            let got = *out.visibility[0].get(x, y);
            // The point is not quite below the middle of the light.
            assert!((got - share).abs() <= if share == 0.0 || share == 1.0 { 0.0 } else { 0.02 }, "{name}: {got} instead of {share}");
            assert_eq!(share == 0.0, out.direct.get(x, y).luminance() == 0.0, "{name}: lit where it is seen");
        }
    }
}

/// Direct light of points, spots and suns with ray-traced shadows is the path tracer's, pixel by pixel; of areas in the mean.
#[test]
fn direct_light_is_that_of_the_path_tracer() {
    let device = Device::new().unwrap();
    let size = UVec2::new(80, 45);
    for (name, tolerance) in [("shadows", 0.02), ("cornell", 0.04), ("penumbra", 0.04)] {
        let scene = builtin::load(name).unwrap();
        let snapshot = kajo_scene::Snapshot::new(&scene, START);
        let direct = frame(&device, &scene, size, "shadow/ray-traced", &[("samples", "64")]).direct;
        let tracer = kajo_path_tracer::Tracer::new(&scene, snapshot.clone()).unwrap();
        let lights: Vec<String> = tracer.light_names()[..snapshot.lights.len()].to_vec();
        let reference = reference(&scene, START, None, size, 64, lights.iter().map(|light| Aov::DirectLight(light.clone())).collect());
        let sum = |x, y| lights.iter().map(|light| reference.image(&format!("direct.{light}")).unwrap().pixels.get(x, y)).sum::<Vec3>();
        let (mut ours, mut theirs, mut difference) = (0.0, 0.0, 0.0);
        for (x, y) in (0..size.y).flat_map(|y| (0..size.x).map(move |x| (x, y))) {
            let (a, b) = (direct.get(x, y).0.element_sum(), sum(x, y).element_sum());
            ours += a;
            theirs += b;
            difference += (a - b).abs();
        }
        assert!((ours / theirs - 1.0).abs() < 0.5 * tolerance, "{name}: mean ratio {}", ours / theirs);
        assert!(difference / theirs < 2.0 * tolerance, "{name}: mean difference {}", difference / theirs);
    }
}

//! What lies around the surfaces, and what a display shows.

use super::scenes::*;
use crate::{FrameSettings, RoleSelection};
use glam::{Affine3A, Quat, UVec2, Vec3};
use kajo_image::{ToneMap, tone_map};
use kajo_path_tracer::Aov;
use kajo_render_graph::Device;
use kajo_scene::{Environment, LightShape, Material, Scene, Texels, TextureImage, builtin, shapes};
use kajo_units::{LinearRgb, Meters, Radians};
use std::f32::consts::PI;
use std::sync::Arc;

/// Every curve and exposure: the display is the curve of the picture as the CPU computes it, encoded once.
#[test]
fn the_display_is_the_curve_of_the_picture() {
    let device = Device::new().unwrap();
    let mut scene = builtin::load("shadows").unwrap();
    scene.exposure = Some(-1.0);
    let mut renderer = renderer(&device, &scene, UVec2::new(48, 27), None);
    let curves = [
        ("tone/agx", ToneMap::Agx),
        ("tone/pbr-neutral", ToneMap::PbrNeutral),
        ("tone/aces", ToneMap::Aces),
        ("tone/linear", ToneMap::Linear),
    ];
    for (id, curve) in curves {
        let roles = RoleSelection::new().choose(id, &[]).unwrap();
        // What the frame asks for comes before what the scene has.
        for (exposure, stops) in [(Some(2.0), 2.0), (None, -1.0)] {
            let out = renderer.render(&roles, &FrameSettings { exposure, ..Default::default() }).unwrap();
            let expected = tone_map(&out.color, stops, curve);
            let worst =
                out.display.pixels().iter().zip(expected.pixels()).flat_map(|(a, b)| (0..3).map(move |c| a.0[c].abs_diff(b.0[c]))).max();
            assert!(worst <= Some(1), "{id} at {stops} stops: off by {worst:?} of 255");
            assert!(expected.pixels().iter().any(|c| c.0[0] > 60 && c.0[0] != c.0[2]), "there is a picture in colour");
        }
    }
}

/// The environment under a turn and a scale, lights with an extent seen from both sides and behind a thing, emissive surfaces: as the path tracer.
#[test]
fn what_shines_looks_as_in_the_path_tracer() {
    let device = Device::new().unwrap();
    let size = UVec2::new(128, 96);
    let texel = |i: u32| [0.2 + 0.1 * (i % 8) as f32, 0.3 + 0.2 * (i / 8) as f32, 0.9 - 0.1 * ((i * 5) % 8) as f32, 1.0];
    let image = TextureImage { name: String::new(), width: 8, height: 4, texels: Texels::Rgba32F((0..32).map(texel).collect()) };
    for image in [Some(Arc::new(image)), None] {
        let mut scene = Scene::default();
        let rotation = Radians(2.1);
        scene.environment = Some(Environment { image, scale: LinearRgb::new(0.5, 0.7, 1.1), rotation });
        let black = || Material { base_color: LinearRgb::BLACK, specular: 0.0, ..lambert(0.0) };
        place(&mut scene, shapes::cuboid(Vec3::new(0.3, 0.3, 0.3)), black(), Affine3A::from_translation(Vec3::new(-0.9, 0.7, 0.0)));
        for (x, turn, double_sided) in [(0.2, 0.4, false), (0.8, PI + 0.4, false), (1.4, PI + 0.4, true)] {
            let glow = Material { emission: LinearRgb::new(3.0, 2.0, 1.0), double_sided, ..black() };
            place(
                &mut scene,
                shapes::rectangle(0.5, 0.5),
                glow,
                Affine3A::from_rotation_translation(Quat::from_rotation_y(turn), Vec3::new(x, 0.9, 0.0)),
            );
        }
        let (width, height, radius) = (Meters(0.5), Meters(0.3), Meters(0.3));
        light(&mut scene, LightShape::Rectangle { width, height }, 4.0, Vec3::new(-1.2, -0.3, 0.0), Vec3::new(0.3, 0.1, 1.0));
        light(&mut scene, LightShape::Rectangle { width, height }, 4.0, Vec3::new(-0.5, -0.3, 0.0), Vec3::NEG_Z);
        light(&mut scene, LightShape::Disk { radius }, 2.0, Vec3::new(0.3, -0.3, 0.0), Vec3::new(-0.5, 0.2, 1.0));
        light(&mut scene, LightShape::Sphere { radius }, 5.0, Vec3::new(1.1, -0.3, 0.0), Vec3::NEG_Z);
        // One behind the cuboid, and a sun in the sky.
        light(&mut scene, LightShape::Sphere { radius }, 6.0, Vec3::new(-1.1, 0.8, -1.0), Vec3::NEG_Z);
        light(&mut scene, LightShape::Directional { half_angle: Radians(0.06) }, 0.1, Vec3::ZERO, Vec3::new(-0.05, 0.02, 1.0));
        camera(&mut scene, PERSPECTIVE, Vec3::new(0.1, 0.2, 4.5), Vec3::new(0.0, 0.1, 0.0));
        let color = frame(&device, &scene, size, "shadow/none", &[]).color;
        let reference = reference(&scene, START, None, size, 1, vec![Aov::Emission]);
        let emission = &reference.image("emission").unwrap().pixels;
        let wrong: Vec<String> = (0..size.y)
            .flat_map(|y| (0..size.x).map(move |x| (x, y)))
            .map(|(x, y)| (x, y, color.get(x, y).0, emission.get(x, y)))
            .filter(|(_, _, a, b)| (*a - *b).abs().max_element() > 0.01 * b.max_element().max(1.0))
            .map(|(x, y, a, b)| format!("({x}, {y}): {a} instead of {b}"))
            .collect();
        assert!(wrong.len() < 30, "{} of {} pixels\n{}", wrong.len(), size.element_product(), wrong[..12].join("\n"));
        let brightest = color.pixels().iter().map(|c| c.0.x).fold(0.0, f32::max);
        assert!(brightest > 5.9, "the lights are in the picture: {brightest}");
    }
}

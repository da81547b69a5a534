//! Techniques of the role specular indirect against the path tracer's `specular-indirect` and against what mirrors must show.

use super::scenes::*;
use crate::{FrameOutput, FrameSettings, Read, RoleSelection};
use glam::{Affine3A, Quat, UVec2, Vec3};
use kajo_image::Image;
use kajo_path_tracer::Aov;
use kajo_render_graph::Device;
use kajo_scene::{Environment, LightShape, Material, Projection, Scene, Texels, TextureImage, builtin, shapes};
use kajo_techniques::Role;
use kajo_units::{LinearRgb, Meters, Radians};
use std::f32::consts::FRAC_PI_2;
use std::sync::Arc;

fn reflected(device: &Device, scene: &Scene, size: UVec2, technique: &str, params: &[(&str, &str)]) -> FrameOutput {
    let roles = RoleSelection::new().choose("shadow/none", &[]).unwrap().choose(technique, params).unwrap();
    let settings = FrameSettings { read: Read::One(Role::SpecularIndirect), gbuffer: true, debug: true, ..Default::default() };
    renderer(device, scene, size, None).render(&roles, &settings).unwrap()
}

fn shown(output: &FrameOutput) -> &Image<LinearRgb> {
    output.estimate(Role::SpecularIndirect).expect("asked for")
}

fn mean(image: &Image<LinearRgb>) -> f32 {
    image.pixels().iter().map(|c| c.0.element_sum()).sum::<f32>() / image.pixels().len() as f32
}

/// Mean difference of two images over the mean of the second.
fn difference(a: &Image<LinearRgb>, b: &Image<LinearRgb>) -> f32 {
    let sum: f32 = a.pixels().iter().zip(b.pixels()).map(|(a, b)| (a.0 - b.0).abs().element_sum()).sum();
    sum / b.pixels().len() as f32 / mean(b)
}

/// The same image, black where light comes through the surface: what comes through is no reflection.
fn opaque(scene: &Scene, output: &FrameOutput, image: &Image<LinearRgb>) -> Image<LinearRgb> {
    let materials = &output.gbuffer.as_ref().unwrap().material;
    let through = |x, y| materials.get(x, y).is_some_and(|material| scene.materials[material as usize].transmission > 0.0);
    Image::from_fn(image.size(), |x, y| if through(x, y) { LinearRgb::BLACK } else { *image.get(x, y) })
}

/// Reflections by rays are those of the path tracer, with direct light at what is reflected and with light that bounces on: mirrors, gloss in four
/// widths, emissive meshes, clear coats and a sky.
#[test]
fn ray_traced_reflections_are_those_of_the_path_tracer() {
    let device = Device::new().unwrap();
    let size = UVec2::new(48, 27);
    let cases = [("mirror-room", 1, 0.04, 0.1), ("mirror-room", 4, 0.08, 0.3), ("glossy-floor", 1, 0.04, 0.2), ("spheres", 1, 0.04, 0.2)];
    for (name, bounces, bias, noise) in cases {
        let scene = builtin::load(name).unwrap();
        let text = bounces.to_string();
        let params = [("samples", "64"), ("bounces", text.as_str())];
        let out = reflected(&device, &scene, size, "reflection/ray-traced", &params);
        assert!(out.technique_rays.iter().any(|(id, rays)| *id == "reflection/ray-traced" && *rays > 10_000), "{:?}", out.technique_rays);
        // The last vertex of ours sees the environment, too.
        let truth = opaque(&scene, &out, &bounced(&scene, size, bounces + 1, 256, Aov::SpecularIndirect));
        let shown = opaque(&scene, &out, shown(&out));
        let (ratio, off) = (mean(&shown) / mean(&truth), difference(&shown, &truth));
        assert!((ratio - 1.0).abs() < bias, "{name} with {bounces} bounces: {ratio} times as bright");
        assert!(off < noise, "{name} with {bounces} bounces: pixels differ by {off}");
        let flipped = Image::from_fn(size, |x, y| *shown.get(x, size.y - 1 - y));
        assert!(difference(&flipped, &truth) > 2.0 * noise, "upside down must not pass");
    }
}

/// An environment whose radiance tells the axis that a direction is nearest to: +x, −x, +y, −y, +z, −z.
fn six_faces() -> (Environment, [Vec3; 6]) {
    let colors =
        [Vec3::X, Vec3::new(0.0, 1.0, 1.0), Vec3::Y, Vec3::new(1.0, 0.0, 1.0), Vec3::Z, Vec3::new(1.0, 1.0, 0.0)].map(|c| c + 0.25);
    let (width, height) = (128, 64);
    let direction = |x: u32, y: u32| {
        let (phi, theta) =
            ((x as f32 + 0.5) / width as f32 * std::f32::consts::TAU, (y as f32 + 0.5) / height as f32 * std::f32::consts::PI);
        // As Environment::uv has it: u = 0.5 looks along −z.
        Vec3::new(-phi.sin() * theta.sin(), theta.cos(), phi.cos() * theta.sin())
    };
    let face = |d: Vec3| {
        let a = d.abs();
        let axis = if a.x >= a.y && a.x >= a.z {
            0
        } else if a.y >= a.z {
            1
        } else {
            2
        };
        2 * axis + usize::from(d[axis] < 0.0)
    };
    let texels = (0..width * height).map(|i| {
        let c = colors[face(direction(i % width, i / width))];
        [c.x, c.y, c.z, 1.0]
    });
    let image = TextureImage { name: "faces".into(), width, height, texels: Texels::Rgba32F(texels.collect()) };
    (Environment { image: Some(Arc::new(image)), scale: LinearRgb::splat(1.0), rotation: Radians(0.0) }, colors)
}

fn mirror(color: f32) -> Material {
    Material { base_color: LinearRgb::splat(color), metallic: 1.0, roughness: 0.0, ..Material::default() }
}

/// Row R-10: mirrors turned so that they reflect along each of the six axes show the colour of that face, whichever way the environment is read.
#[test]
fn mirrors_show_the_face_of_the_environment_they_reflect_towards() {
    let device = Device::new().unwrap();
    let size = UVec2::new(96, 96);
    let axes = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];
    let along = Vec3::new(1.0, -2.0, -3.0).normalize();
    let side = along.any_orthonormal_vector();
    let (environment, colors) = six_faces();
    let mut scene = Scene { environment: Some(environment), ..Scene::default() };
    let places: Vec<Vec3> = (0..6).map(|i| side * (i as f32 - 2.5)).collect();
    for (axis, place_of) in axes.iter().zip(&places) {
        let normal = (*axis - along).normalize();
        let turn = Quat::from_rotation_arc(Vec3::Z, normal);
        place(&mut scene, shapes::rectangle(0.4, 0.4), mirror(1.0), Affine3A::from_rotation_translation(turn, *place_of));
    }
    let parallel = Projection::Orthographic { xmag: Meters(3.2), ymag: Meters(3.2) };
    camera(&mut scene, parallel, along * -10.0, Vec3::ZERO);
    for lookup in ["direction", "lobe"] {
        let out = reflected(&device, &scene, size, "reflection/environment", &[("lookup", lookup)]);
        let view = renderer(&device, &scene, size, None).view(&FrameSettings::default());
        for (i, place_of) in places.iter().enumerate() {
            let pixel = view.project(*place_of).unwrap().as_uvec2();
            let got = shown(&out).get(pixel.x, pixel.y).0;
            let nearest = (0..6).min_by(|a, b| got.distance(colors[*a]).total_cmp(&got.distance(colors[*b]))).unwrap();
            assert_eq!(nearest, i, "{lookup}: along {} {got} is seen", axes[i]);
            assert!(got.distance(colors[i]) < 0.01, "{lookup}: along {} {got} in the place of {}", axes[i], colors[i]);
        }
    }
}

/// In the open, what the environment gives is what the path tracer finds: every roughness, metals, coats.
#[test]
fn the_environment_is_reflected_as_the_path_tracer_reflects_it() {
    let device = Device::new().unwrap();
    let size = UVec2::new(64, 64);
    for (roughness, coat) in [(0.0, 0.0), (0.3, 0.0), (0.8, 0.0), (0.6, 1.0)] {
        let mut scene = Scene { environment: Some(six_faces().0), ..Scene::default() };
        let color = LinearRgb::new(0.9, 0.5, 0.2);
        let material = Material { base_color: color, metallic: 1.0, roughness, clearcoat: coat, ..Material::default() };
        place(&mut scene, shapes::sphere(1.0, 96), material, Affine3A::IDENTITY);
        camera(&mut scene, PERSPECTIVE, Vec3::new(1.0, 2.0, 3.5), Vec3::ZERO);
        let truth = bounced(&scene, size, 1, 256, Aov::SpecularIndirect);
        let out = reflected(&device, &scene, size, "reflection/environment", &[("samples", "256")]);
        let (ratio, off) = (mean(shown(&out)) / mean(&truth), difference(shown(&out), &truth));
        assert!((ratio - 1.0).abs() < 0.01, "roughness {roughness}, coat {coat}: {ratio} times as bright");
        assert!(off < 0.05, "roughness {roughness}, coat {coat}: pixels differ by {off}");
        if coat == 0.0 {
            // One direction is exact for mirrors only, its brightness is right in the mean.
            let one = reflected(&device, &scene, size, "reflection/environment", &[("lookup", "direction")]);
            assert!((mean(shown(&one)) / mean(&truth) - 1.0).abs() < 0.1, "roughness {roughness}");
            assert_eq!(difference(shown(&one), &truth) < 0.05, roughness == 0.0, "roughness {roughness}");
        }
    }
}

/// A mirror floor before two glowing panels; a third one hangs above what the camera sees.
fn panels() -> (Scene, [(Vec3, Vec3, Vec3); 3]) {
    let mut scene = Scene::default();
    let floor = Affine3A::from_rotation_translation(Quat::from_rotation_x(-FRAC_PI_2), Vec3::ZERO);
    place(&mut scene, shapes::rectangle(8.0, 12.0), mirror(1.0), floor);
    let panels = [
        (Vec3::new(-0.6, 0.6, -2.0), Vec3::new(0.5, 0.5, 0.0), Vec3::new(2.0, 0.5, 0.25)),
        (Vec3::new(0.6, 0.6, -2.0), Vec3::new(0.5, 0.5, 0.0), Vec3::new(0.25, 1.5, 3.0)),
        (Vec3::new(0.0, 2.6, -2.0), Vec3::new(1.5, 1.2, 0.0), Vec3::new(5.0, 5.0, 5.0)),
    ];
    for (centre, half, emission) in panels {
        let material = Material { emission: LinearRgb(emission), ..lambert(0.0) };
        place(&mut scene, shapes::rectangle(2.0 * half.x, 2.0 * half.y), material, Affine3A::from_translation(centre));
    }
    light(&mut scene, LightShape::Point, 1.0, Vec3::new(0.0, 20.0, 0.0), Vec3::NEG_Y);
    camera(&mut scene, PERSPECTIVE, Vec3::new(0.0, 0.8, 2.5), Vec3::new(0.0, -0.35, -2.0));
    (scene, panels)
}

/// Row R-09: what a mirror shows and the picture holds is found with its colour; what lies beyond the picture is a miss and stays black.
#[test]
fn screen_space_rays_find_what_is_in_the_picture_and_tell_what_is_not() {
    let device = Device::new().unwrap();
    let size = UVec2::new(192, 144);
    let (scene, panels) = panels();
    for stride in ["1", "4"] {
        let params = [("fallback", "none"), ("stride", stride), ("thickness", "0.05")];
        let out = reflected(&device, &scene, size, "reflection/ssr-dda", &params);
        let images = out.gbuffer.as_ref().unwrap();
        let missed = out.debug.iter().find(|view| view.name == "reflection-misses").unwrap().pixels.to_color();
        let view = renderer(&device, &scene, size, None).view(&FrameSettings::default());
        let eye = view.position;
        let (mut in_view, mut outside, mut nothing) = (0u64, 0u64, 0u64);
        let (mut wrong, mut invented) = (0u32, 0u32);
        for (x, y) in (0..size.y).flat_map(|y| (0..size.x).map(move |x| (x, y))) {
            if *images.instance.get(x, y) != Some(0) {
                continue;
            }
            let at = *images.position.get(x, y);
            let ray = (at - eye).normalize() * Vec3::new(1.0, -1.0, 1.0);
            let met = at + ray * ((-2.0 - at.z) / ray.z);
            let inside =
                |&(centre, half, _): &(Vec3, Vec3, Vec3), room: f32| (met - centre).abs().truncate().cmple(half.truncate() * room).all();
            let (got, miss) = (shown(&out).get(x, y).0, missed.get(x, y).0.x);
            let seen = view.project(met).is_some_and(|p| p.cmpge(glam::Vec2::ONE).all() && p.cmplt(size.as_vec2() - 1.0).all());
            // A rim of a few px is left to rounding.
            if let Some((_, _, color)) = panels.iter().find(|panel| inside(panel, 0.93)) {
                if seen {
                    in_view += 1;
                    wrong += u32::from((got - *color).abs().max_element() > 0.05 * color.max_element());
                } else if !view.project(met).is_some_and(|p| p.cmpge(glam::Vec2::splat(-2.0)).all() && p.cmplt(size.as_vec2() + 2.0).all())
                {
                    outside += 1;
                    invented += u32::from(got != Vec3::ZERO || miss != 1.0);
                }
            } else if !panels.iter().any(|panel| inside(panel, 1.1)) {
                nothing += 1;
                invented += u32::from(got != Vec3::ZERO || miss != 1.0);
            }
        }
        assert!(in_view > 500 && outside > 100 && nothing > 1000, "{in_view} in view, {outside} outside, {nothing} of nothing");
        // Long steps pass over rims.
        let allowed = if stride == "1" { 0.0 } else { 0.01 };
        assert!(f64::from(wrong) <= allowed * in_view as f64, "stride {stride}: {wrong} of {in_view} colours are wrong");
        assert_eq!(invented, 0, "stride {stride}: colours of what is not in the picture");
        let count = |name: &str| out.statistics.iter().find(|s| s.name == name).unwrap().value;
        let (rays, misses) = (count("reflection-rays"), count("reflection-misses"));
        assert!(misses >= outside + nothing && rays - misses >= in_view, "{rays} rays, {misses} misses");
    }
    // With a sky the misses see it, hits do not.
    let bright = Scene { environment: Some(Environment { image: None, scale: LinearRgb::splat(9.0), rotation: Radians(0.0) }), ..scene };
    let with = |fallback| reflected(&device, &bright, size, "reflection/ssr-dda", &[("fallback", fallback)]);
    let (sky, none) = (with("environment"), with("none"));
    let pairs = shown(&sky).pixels().iter().zip(shown(&none).pixels());
    let (changed, same) = pairs.fold((0, 0), |(changed, same), (a, b)| if a == b { (changed, same + 1) } else { (changed + 1, same) });
    assert!(changed > 1000 && same > 500, "{changed} {same}");
}

/// Of the pixels that show a mirror, the share whose colours differ by at most 2 %.
fn alike(a: &Image<LinearRgb>, b: &Image<LinearRgb>) -> (f32, usize) {
    let in_mirrors: Vec<_> = a.pixels().iter().zip(b.pixels()).filter(|(a, b)| a.luminance() > 0.0 || b.luminance() > 0.0).collect();
    let same = |(a, b): &&(&LinearRgb, &LinearRgb)| (a.0 - b.0).abs().max_element() <= 0.02 * a.0.max(b.0).max_element();
    (in_mirrors.iter().filter(same).count() as f32 / in_mirrors.len() as f32, in_mirrors.len())
}

/// Row R-14: flat mirrors drawn show what rays find in them, on at least 99 % of their pixels: things in view, out of view, behind the camera, and cut at
/// the plane.
#[test]
fn planar_reflections_are_those_of_rays() {
    let device = Device::new().unwrap();
    let size = UVec2::new(192, 108);
    let mut scene = builtin::load("mirror-room").unwrap();
    // One point: light without noise.
    scene.lights[0].shape = LightShape::Point;
    // Through the left mirror, from a wall that it must not show.
    let behind = Affine3A::from_translation(Vec3::new(-2.6, 1.2, 0.4));
    place(&mut scene, shapes::cuboid(Vec3::new(0.3, 0.3, 0.3)), lambert(0.5), behind);
    let traced = reflected(&device, &scene, size, "reflection/ray-traced", &[("samples", "1"), ("max_roughness", "0.1")]);
    let drawn = reflected(&device, &scene, size, "reflection/planar", &[]);
    let (share, count) = alike(shown(&drawn), shown(&traced));
    assert!(count > 2000 && share >= 0.99, "{share} of {count} pixels are alike");
    let shifted = Image::from_fn(size, |x, y| *shown(&drawn).get(x.saturating_sub(2), y));
    assert!(alike(&shifted, shown(&traced)).0 < 0.9, "two pixels off must not pass");
    assert!(drawn.ignored.iter().all(|note| !note.consequence.starts_with("reflection/planar")), "{:?}", drawn.ignored);
    let one = reflected(&device, &scene, size, "reflection/planar", &[("mirrors", "1")]);
    assert!(one.ignored.iter().any(|note| note.consequence.contains("2.38 m²")), "{:?}", one.ignored);
    assert!(alike(shown(&one), shown(&traced)).0 < 0.95, "a mirror is missing");
}

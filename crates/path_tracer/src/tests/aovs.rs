//! Images of light add up, and images of the first hit are what they say.

use super::scenes::{Stage, at, cornell, floor, glowing, lambert, render_at, sized, tracer};
use crate::{Aov, Filter, Frame, RussianRoulette, Settings, Stop, render, uncontrolled};
use glam::Vec3;
use kajo_scene::{LightShape, Material, Snapshot, shapes};
use kajo_units::{LinearRgb, Meters, Seconds};

/// A Cornell box with a shiny ball, a second light, a glowing block and a sky: every image has something in it.
fn busy() -> Frame {
    let mut scene = cornell();
    let shiny = Material { metallic: 0.0, roughness: 0.2, base_color: LinearRgb::new(0.5, 0.4, 0.8), ..Material::default() };
    let more = Stage(scene)
        .mesh(shapes::sphere(0.3, 32), shiny, at(Vec3::new(0.3, -0.1, 0.4)))
        .mesh(shapes::cuboid(Vec3::splat(0.1)), glowing(2.0, 0.5), at(Vec3::new(-0.6, -0.8, 0.5)))
        .mesh(shapes::cuboid(Vec3::splat(0.1)), Material { unlit: true, ..Material::default() }, at(Vec3::new(0.0, -0.85, 0.7)))
        .light(LightShape::Point, 0.4, at(Vec3::new(0.6, 0.5, 0.2)))
        .environment(0.3);
    scene = more.0;
    let tracer = tracer(&scene);
    let settings = Settings { aovs: tracer.all_aovs(6), max_depth: 6, russian_roulette: RussianRoulette::Off, ..sized(32, 32) };
    render(&tracer, &settings, Stop::at_spp(8), None, &uncontrolled).unwrap().develop()
}

fn relative_difference(frame: &Frame, whole: &str, parts: &[&str]) -> f32 {
    let mut largest = 0.0f32;
    for y in 0..frame.size.y {
        for x in 0..frame.size.x {
            let at = |name: &&str| frame.image(name).unwrap_or_else(|| panic!("image {name}")).pixels.get(x, y);
            let (whole, sum) = (at(&whole), parts.iter().map(at).sum::<Vec3>());
            largest = largest.max(((whole - sum).abs() / whole.abs().max(Vec3::splat(1e-3))).max_element());
        }
    }
    largest
}

/// Row L-11: on the same random streams the parts are the whole within 1e-4.
#[test]
fn images_of_light_add_up_to_beauty() {
    let frame = busy();
    let names: Vec<_> = frame.images.iter().map(|image| image.name.as_str()).collect();
    let starting = |prefix: &str| -> Vec<&str> { names.iter().copied().filter(|name| name.starts_with(prefix)).collect() };
    assert_eq!(starting("direct.").len(), 5, "two lights, a mesh, the sky, the unlit block: {names:?}");
    for (whole, parts) in [
        ("beauty", vec!["emission", "direct", "indirect-diffuse", "indirect-specular"]),
        ("beauty", starting("bounce.")),
        ("direct", vec!["direct-diffuse", "direct-specular"]),
        ("direct", starting("direct.")),
        ("emission", vec!["bounce.0"]),
        ("direct", vec!["bounce.1"]),
    ] {
        let difference = relative_difference(&frame, whole, &parts);
        assert!(difference < 1e-4, "{whole} and {parts:?}: {difference}");
        for part in parts.iter().filter(|part| **part != "bounce.6") {
            let image = &frame.image(part).unwrap().pixels;
            assert!(image.to_color().pixels().iter().any(|p| p.max_component() > 0.0), "{part} is black");
        }
    }
}

#[test]
fn planted_fault_a_missing_light_breaks_the_sum() {
    assert!(relative_difference(&busy(), "beauty", &["emission", "direct", "indirect-diffuse"]) > 0.1);
}

/// Row L-11: with independent streams the means agree, and no emission counts twice.
#[test]
fn direct_and_indirect_light_of_other_streams_have_the_same_mean() {
    let aovs = ["direct", "emission", "indirect-diffuse", "indirect-specular"].map(|name| name.parse().unwrap());
    let whole = render_at(&cornell(), &Settings { max_depth: 5, ..sized(24, 24) }, 256);
    let parts = render_at(&cornell(), &Settings { max_depth: 5, seed: 5, aovs: aovs.into(), ..sized(24, 24) }, 256);
    let sum: f64 = parts.images[1..].iter().map(|image| mean_of(&image.pixels.to_color())).sum();
    let (mean, half) = (mean_of(whole.beauty()), f64::from(whole.mean_luminance.1));
    assert!((sum - mean).abs() < 3.0 * half, "{sum} for {mean} ± {half}");
}

fn mean_of(image: &kajo_image::Image<LinearRgb>) -> f64 {
    image.pixels().iter().map(|p| f64::from(p.luminance())).sum::<f64>() / image.pixels().len() as f64
}

/// `diffuse-indirect` is the irradiance whose reflection is `indirect-diffuse`: on a Lambert surface E = π L / ρ.
#[test]
fn diffuse_indirect_is_the_irradiance_of_indirect_light() {
    let scene = Stage::default()
        .mesh(shapes::cuboid(Vec3::splat(1.0)).inside_out(), lambert(0.6), at(Vec3::ZERO))
        .light(LightShape::Sphere { radius: Meters(0.2) }, 5.0, at(Vec3::new(0.0, 0.5, 0.0)))
        .perspective(Vec3::new(0.0, -0.2, 0.9), Vec3::new(0.0, -0.4, 0.0), 70.0)
        .0;
    let aovs = ["diffuse-indirect", "indirect-diffuse", "specular-indirect"].map(|name| name.parse().unwrap());
    let frame = render_at(&scene, &Settings { max_depth: 5, aovs: aovs.into(), ..sized(16, 16) }, 512);
    let mean = |name: &str| mean_of(&frame.image(name).unwrap().pixels.to_color());
    let (irradiance, radiance) = (mean("diffuse-indirect"), mean("indirect-diffuse"));
    assert!((irradiance * 0.6 / std::f64::consts::PI / radiance - 1.0).abs() < 0.01, "{irradiance} and {radiance}");
    assert_eq!(mean("specular-indirect"), 0.0);
}

/// `specular-indirect` is everything in a mirror but analytic lights.
#[test]
fn specular_indirect_shows_what_a_reflection_technique_shows() {
    let mirror = super::scenes::mirror();
    let stage = |light: bool| {
        let stage = Stage::default().mesh(shapes::rectangle(4.0, 4.0), mirror.clone(), at(Vec3::ZERO)).environment(0.7).orthographic(
            Vec3::Z * 2.0,
            Vec3::ZERO,
            1.0,
        );
        let turned = super::scenes::looking(Vec3::Z * 3.0, Vec3::ZERO);
        if light { stage.light(LightShape::Disk { radius: Meters(5.0) }, 2.0, turned) } else { stage }
    };
    for light in [false, true] {
        let settings = Settings { aovs: vec![Aov::SpecularIndirect], ..sized(2, 2) };
        let frame = render_at(&stage(light).0, &settings, 4);
        assert!((frame.image("specular-indirect").unwrap().pixels.get(0, 0).x - 0.7).abs() < 1e-5);
        assert!((frame.beauty().get(0, 0)[0] - if light { 2.7 } else { 0.7 }).abs() < 1e-5);
    }
}

/// Depth, position, normals, ids, coverage and albedo of a known scene.
#[test]
fn images_of_the_first_hit_describe_it() {
    let scene = Stage::default()
        .mesh(floor(), lambert(0.5), at(Vec3::ZERO))
        .mesh(shapes::rectangle(1.0, 1.0), lambert(0.25), at(Vec3::new(0.0, 1.0, 0.5)))
        .perspective(Vec3::new(0.0, 1.0, 4.0), Vec3::new(0.0, 1.0, 0.0), 60.0)
        .0;
    let names = ["depth", "position", "normal", "shading-normal", "instance-id", "material-id", "coverage", "albedo"];
    let aovs = names.map(|name| name.parse().unwrap()).into();
    let frame = render_at(&scene, &Settings { aovs, filter: Filter::Center, ..sized(33, 33) }, 2);
    let at = |name: &str, x, y| frame.image(name).unwrap().pixels.get(x, y);
    assert!((at("depth", 16, 16).x - 3.5).abs() < 1e-5);
    assert!(at("position", 16, 16).abs_diff_eq(Vec3::new(0.0, 1.0, 0.5), 1e-5));
    assert!(at("normal", 16, 16).abs_diff_eq(Vec3::Z, 1e-6) && at("shading-normal", 16, 16).abs_diff_eq(Vec3::Z, 1e-6));
    assert_eq!((at("instance-id", 16, 16).x, at("material-id", 16, 16).x, at("albedo", 16, 16).x), (1.0, 1.0, 0.25));
    assert_eq!((at("instance-id", 16, 31).x, at("coverage", 16, 31).x, at("albedo", 16, 31).x), (0.0, 1.0, 0.5));
    assert!(at("normal", 16, 31).abs_diff_eq(Vec3::Y, 1e-6) && at("position", 16, 31).y.abs() < 1e-5);
    assert_eq!((at("instance-id", 16, 0).x, at("coverage", 16, 0).x, at("depth", 16, 0).x), (-1.0, 0.0, 0.0));
}

/// A body that moved 0.1 m to the right, 2 m away, moved 0.1 / (2 · 2 tan 30°) of the picture.
#[test]
fn motion_is_measured_in_pixels_against_the_previous_snapshot() {
    let scene = |x: f32| {
        Stage::default()
            .mesh(shapes::rectangle(3.0, 3.0), lambert(0.5), at(Vec3::new(x, 0.0, 0.0)))
            .perspective(Vec3::Z * 2.0, Vec3::ZERO, 60.0)
            .0
    };
    let previous = scene(-0.1);
    let tracer = tracer(&scene(0.0)).with_previous(Snapshot::new(&previous, Seconds(0.0))).unwrap();
    let settings = Settings { aovs: vec![Aov::Motion], filter: Filter::Center, ..sized(16, 16) };
    let frame = render(&tracer, &settings, Stop::at_spp(1), None, &uncontrolled).unwrap().develop();
    let expected = 0.1 / (4.0 * 30f32.to_radians().tan()) * 16.0;
    let motion = frame.image("motion").unwrap().pixels.get(9, 4);
    assert!(motion.abs_diff_eq(Vec3::new(expected, 0.0, 0.0), 1e-3), "{motion}");
}

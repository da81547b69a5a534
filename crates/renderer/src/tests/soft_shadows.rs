//! Techniques that soften hard shadows, against the path tracer's `visibility.<light>`.

use super::scenes::*;
use glam::{Affine3A, UVec2, Vec3};
use kajo_path_tracer::Aov;
use kajo_render_graph::Device;
use kajo_scene::{LightShape, Scene, shapes};
use kajo_units::{Meters, Radians};
use std::collections::BTreeSet;

/// A board over a floor under a light of some extent.
fn board(shape: LightShape) -> Scene {
    let mut scene = Scene::default();
    place(&mut scene, shapes::floor(8.0, 8.0, 1.0), lambert(0.7), Affine3A::IDENTITY);
    place(&mut scene, shapes::cuboid(Vec3::new(0.5, 0.02, 0.4)), lambert(0.5), Affine3A::from_translation(Vec3::new(0.0, 0.7, 0.0)));
    light(&mut scene, shape, 1.0, Vec3::new(0.3, 3.0, 0.4), Vec3::new(-0.1, -1.0, -0.13));
    camera(&mut scene, PERSPECTIVE, Vec3::new(0.3, 2.6, 3.2), Vec3::new(0.0, 0.2, 0.0));
    scene
}

/// Root mean square error of a technique's first light against `truth`.
fn rmse(image: &[f32], truth: &[f32]) -> f32 {
    (image.iter().zip(truth).map(|(a, b)| (a - b) * (a - b)).sum::<f32>() / truth.len() as f32).sqrt()
}

fn visibility(scene: &Scene, size: UVec2, spp: u32) -> Vec<f32> {
    let frame = reference(scene, START, None, size, spp, vec![Aov::Visibility("*".into())]);
    let image = frame.images.iter().find(|image| image.name.starts_with("visibility.")).unwrap();
    (0..size.y).flat_map(|y| (0..size.x).map(move |x| (x, y))).map(|(x, y)| image.pixels.get(x, y).x).collect()
}

/// Row SH-15: N samples give at most N + 1 levels, and the error falls as N grows, for every kind of light with an extent.
#[test]
fn multi_sampled_shadows_have_few_levels_and_converge() {
    let device = Device::new().unwrap();
    let size = UVec2::new(80, 60);
    let shapes = [
        LightShape::Rectangle { width: Meters(0.8), height: Meters(0.4) },
        LightShape::Disk { radius: Meters(0.4) },
        LightShape::Sphere { radius: Meters(0.4) },
        LightShape::Directional { half_angle: Radians(0.12) },
    ];
    for shape in shapes {
        let scene = board(shape);
        let truth = visibility(&scene, size, 256);
        let mut errors = Vec::new();
        for samples in [1u32, 8, 32] {
            let params = [("samples", samples.to_string()), ("resolution", "512".to_owned())];
            let params: Vec<(&str, &str)> = params.iter().map(|(name, value)| (*name, value.as_str())).collect();
            let out = frame(&device, &scene, size, "shadow/multi-sample", &params);
            let levels: BTreeSet<u32> = out.visibility[0].pixels().iter().map(|v| v.to_bits()).collect();
            assert!(levels.len() <= samples as usize + 1, "{shape:?}: {} levels of {samples} samples", levels.len());
            assert!(samples == 1 || levels.len() > samples as usize / 2, "{shape:?}: {} levels of {samples} samples", levels.len());
            errors.push(rmse(out.visibility[0].pixels(), &truth));
        }
        assert!(errors[1] < 0.5 * errors[0] && errors[2] < 0.6 * errors[1] && errors[2] < 0.01, "{shape:?}: {errors:?}");
    }
}

/// Row SH-15: the numbers of samples of the article's pictures, a small light with 128 and a larger one with 1024, against 1024 rays a pixel.
#[test]
fn the_articles_numbers_of_samples_make_smooth_penumbrae() {
    let device = Device::new().unwrap();
    let size = UVec2::new(48, 36);
    for (width, samples) in [(0.25, 128u32), (1.0, 1024)] {
        let scene = board(LightShape::Rectangle { width: Meters(width), height: Meters(0.6 * width) });
        let truth = visibility(&scene, size, 1024);
        let samples_text = samples.to_string();
        let out = frame(&device, &scene, size, "shadow/multi-sample", &[("samples", &samples_text), ("resolution", "512")]);
        let levels: BTreeSet<u32> = out.visibility[0].pixels().iter().map(|v| v.to_bits()).collect();
        let penumbra = truth.iter().filter(|v| (0.01..0.99).contains(*v)).count();
        assert!(penumbra > 20, "{penumbra} pixels of penumbra");
        assert!(levels.len() <= samples as usize + 1, "{} levels of {samples} samples", levels.len());
        assert!(2 * levels.len() > penumbra.min(samples as usize), "{} levels in {penumbra} pixels of penumbra", levels.len());
        let error = rmse(out.visibility[0].pixels(), &truth);
        assert!(error < 0.005, "{samples} samples: {error}");
    }
}

/// What the hard algorithm counts is summed over the points of the light.
#[test]
fn multi_sampling_counts_what_the_hard_algorithm_does() {
    let device = Device::new().unwrap();
    let size = UVec2::new(32, 24);
    let scene = board(LightShape::Rectangle { width: Meters(0.2), height: Meters(0.2) });
    let polygons = |technique, params: &[(&str, &str)]| {
        let out = frame(&device, &scene, size, technique, params);
        let found: Vec<u64> = out.statistics.iter().filter(|s| s.name == "shadow polygons" && s.light == 0).map(|s| s.value).collect();
        assert_eq!(found.len(), 1, "{technique}: {:?}", out.statistics);
        found[0]
    };
    let one = polygons("shadow/volume-zfail", &[]);
    let many = polygons("shadow/multi-sample", &[("over", "shadow/volume-zfail"), ("samples", "20")]);
    assert!(one > 0 && many > 15 * one && many < 25 * one, "{many} polygons for 20 points, {one} for the middle");
}

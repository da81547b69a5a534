//! The two estimators agree, noise falls as it must, and roulette changes nothing but noise.

use super::compare::assert_same_mean;
use super::scenes::{Stage, at, cornell, downwards, film_at, floor, glowing, lambert, looking, mean, mirror, render_at, sized, tracer};
use crate::{Frame, Integrator, RussianRoulette, Settings, Stop, Strategy, render, uncontrolled};
use glam::{Affine2, UVec2, Vec3};
use kajo_sampling::SamplerKind;
use kajo_scene::{
    AlphaMode, ColorSpace, Environment, Filter, LightShape, Material, Scene, Texels, Texture, TextureImage, TextureRef, Wrap, shapes,
};
use kajo_units::{LinearRgb, Meters, Radians};
use std::sync::Arc;

/// A texture of 2 × 2 texels.
fn texture(stage: &mut Stage, texels: [[f32; 4]; 4]) -> TextureRef {
    let image = TextureImage { name: "test".into(), width: 2, height: 2, texels: Texels::Rgba32F(texels.to_vec()) };
    stage.0.images.push(Arc::new(image));
    let image = stage.0.images.len() - 1;
    stage.0.textures.push(Texture { image, wrap: [Wrap::Repeat; 2], filter: Filter::Nearest, color_space: ColorSpace::Linear });
    TextureRef { texture: stage.0.textures.len() - 1, uv_set: 0, transform: Affine2::IDENTITY }
}

/// Large lights of every kind that rays can meet, over surfaces of every kind; paths of BSDF sampling alone converge quickly here.
fn scenes() -> Vec<(&'static str, Scene)> {
    let rough = Material { metallic: 1.0, roughness: 0.5, base_color: LinearRgb::new(0.9, 0.6, 0.3), ..Material::default() };
    let plastic = Material { metallic: 0.0, roughness: 0.4, base_color: LinearRgb::new(0.2, 0.5, 0.7), ..Material::default() };
    let stage = |object: Material| {
        Stage::default()
            .mesh(floor(), lambert(0.6), at(Vec3::ZERO))
            .mesh(shapes::sphere(0.5, 24), object, at(Vec3::new(0.0, 0.5, 0.0)))
            .perspective(Vec3::new(0.0, 1.2, 3.0), Vec3::new(0.0, 0.5, 0.0), 40.0)
    };
    let area = |shape| stage(plastic.clone()).light(shape, 3.0, downwards(Vec3::new(0.4, 2.0, 0.3))).0;
    let mut glow = stage(rough.clone());
    let emission = texture(&mut glow, [[3.0, 0.5, 0.0, 1.0], [0.0, 0.0, 0.0, 1.0], [0.0, 0.2, 1.0, 1.0], [0.5, 0.5, 0.5, 1.0]]);
    let glow = glow.mesh(
        shapes::sphere(0.8, 12),
        Material { emission_texture: Some(emission), double_sided: true, ..glowing(4.0, 0.2) },
        at(Vec3::new(-1.0, 1.6, -0.8)),
    );
    let mut sky = stage(Material { transmission: 1.0, thickness: 1.0, roughness: 0.3, attenuation_distance: 0.5, ..plastic.clone() });
    let texels = (0..32).map(|i| [0.2 + (i % 8) as f32, 1.0, (i / 8) as f32, 1.0]).collect();
    let image = TextureImage { name: "sky".into(), width: 8, height: 4, texels: Texels::Rgba32F(texels) };
    sky.0.environment = Some(Environment { image: Some(Arc::new(image)), scale: LinearRgb::splat(0.4), rotation: Radians(0.7) });
    let leaf = Material { alpha_mode: AlphaMode::Blend, alpha: 0.4, double_sided: true, ..lambert(0.8) };
    let veil = stage(plastic.clone())
        .mesh(shapes::rectangle(2.0, 2.0), leaf, downwards(Vec3::new(0.0, 1.4, 0.0)))
        .light(LightShape::Sphere { radius: Meters(0.6) }, 4.0, at(Vec3::new(0.5, 2.6, 0.5)))
        .0;
    let sun = LightShape::Directional { half_angle: Radians(0.5) };
    vec![
        ("rectangle", area(LightShape::Rectangle { width: Meters(2.0), height: Meters(1.5) })),
        ("disk", area(LightShape::Disk { radius: Meters(1.0) })),
        ("sphere", area(LightShape::Sphere { radius: Meters(0.7) })),
        ("sun", stage(rough).light(sun, 2.0, looking(Vec3::ZERO, Vec3::new(0.5, -1.0, -0.4))).environment(0.2).0),
        ("textured emissive mesh", glow.0),
        ("environment through rough glass", sky.0),
        ("blended veil", veil),
    ]
}

fn settings(integrator: Integrator, seed: u64) -> Settings {
    Settings { integrator, seed, max_depth: 4, sampler: SamplerKind::Independent, ..sized(32, 32) }
}

/// Row M-07: light sampling with MIS, light sampling alone, and BSDF sampling alone have one mean.
#[test]
fn path_tracer_agrees_with_bsdf_sampling_alone() {
    for (name, scene) in scenes() {
        let bsdf_only = render_at(&scene, &settings(Integrator::BsdfOnly, 1), 400);
        let mis = render_at(&scene, &settings(Integrator::Path, 2), 150);
        assert_same_mean(name, &mis, &bsdf_only);
        let lights = Settings { strategy: Strategy::Lights, ..settings(Integrator::Path, 3) };
        assert_same_mean(name, &render_at(&scene, &lights, 150), &bsdf_only);
    }
}

/// The same on the Cornell box, whose lamp is small.
#[test]
fn estimators_agree_on_the_cornell_box() {
    let scene = cornell();
    let a = render_at(&scene, &settings(Integrator::Path, 1), 200);
    assert_same_mean("cornell", &a, &render_at(&scene, &settings(Integrator::BsdfOnly, 2), 1000));
}

fn mean_variance(frame: &Frame) -> f64 {
    frame.beauty_variance().pixels().iter().map(|v| f64::from(v.0.element_sum())).sum::<f64>() * f64::from(frame.spp)
}

/// A closed room, with a light below 1 % of the hemisphere or with a point light.
fn room(light: LightShape) -> Scene {
    Stage::default()
        .mesh(shapes::cuboid(Vec3::splat(1.0)).inside_out(), lambert(0.5), at(Vec3::ZERO))
        .light(light, 20.0, downwards(Vec3::Y * 0.9))
        .perspective(Vec3::new(0.0, 0.0, 0.9), Vec3::ZERO, 60.0)
        .0
}

/// Row M-07: for a light below 1 % of the hemisphere next-event estimation has the lower variance, and one indirect bounce takes exactly 4
/// rays: camera, shadow, bounce, shadow. With both strategies the last two come twice, once a branch.
#[test]
fn next_event_estimation_is_better_for_small_lights_and_takes_four_rays() {
    let scene = room(LightShape::Disk { radius: Meters(0.1) });
    let bsdf = render_at(&scene, &Settings { max_depth: 2, ..settings(Integrator::BsdfOnly, 1) }, 64);
    for strategy in [Strategy::Mis, Strategy::Lights] {
        let next_event = render_at(&scene, &Settings { max_depth: 2, strategy, ..settings(Integrator::Path, 1) }, 64);
        let (better, worse) = (mean_variance(&next_event), mean_variance(&bsdf));
        assert!(better < 0.1 * worse, "{strategy:?}: {better} and {worse}");
    }
    for (strategy, rays) in [(Strategy::Mis, 6), (Strategy::Lights, 4)] {
        let film = film_at(&room(LightShape::Point), &Settings { max_depth: 2, strategy, ..settings(Integrator::Path, 1) }, 16);
        let looking = 2 * u64::from(film.size().x * film.size().y);
        assert_eq!(film.rays(), looking + rays * film.samples(), "{strategy:?}");
    }
}

fn rmse(a: &Frame, b: &Frame) -> f64 {
    let squares = a.beauty().pixels().iter().zip(b.beauty().pixels()).map(|(a, b)| f64::from((a.0 - b.0).length_squared()));
    (squares.sum::<f64>() / a.beauty().pixels().len() as f64).sqrt()
}

/// Row M-12: from 1 to 512 independent samples the error against 1024 samples of another seed halves for four times the samples. The reference is
/// made of Sobol points, so that its own error, which the comparison adds, is small beside that of 512 independent samples. With Sobol points the
/// error falls at least as fast and is smaller.
#[test]
fn error_falls_with_the_square_root_of_samples() {
    let scene = room(LightShape::Rectangle { width: Meters(0.8), height: Meters(0.8) });
    let (tracer, settings) = (tracer(&scene), |seed| Settings { max_depth: 2, ..settings(Integrator::Path, seed) });
    let reference = render_at(&scene, &Settings { sampler: SamplerKind::Sobol, ..settings(99) }, 1024);
    let errors = |sampler| {
        let (settings, mut film) = (Settings { sampler, ..settings(7) }, None);
        [1, 2, 4, 8, 16, 32, 64, 128, 256, 512].map(|spp| {
            let longer = render(&tracer, &settings, Stop::at_spp(spp), film.take(), &uncontrolled).expect("a rendering");
            rmse(&film.insert(longer).develop(), &reference)
        })
    };
    let independent = errors(SamplerKind::Independent);
    for (few, many) in independent.iter().zip(&independent[2..]) {
        assert!((few / many / 2.0 - 1.0).abs() < 0.15, "{independent:?}");
    }
    let sobol = errors(SamplerKind::Sobol);
    assert!(sobol[6] < 0.5 * independent[6] && sobol[0] / sobol[6] > 14.0, "{sobol:?} and {independent:?}");
}

/// Row M-13: roulette with q = 0.5 has the mean of none, shorter paths, and more noise.
#[test]
fn russian_roulette_keeps_the_mean_and_shortens_paths() {
    let scene = cornell();
    let with = |russian_roulette, seed| {
        let settings = Settings { russian_roulette, max_depth: 12, ..settings(Integrator::Path, seed) };
        render_at(&scene, &settings, 200)
    };
    let off = with(RussianRoulette::Off, 1);
    for roulette in [RussianRoulette::Constant(0.5), RussianRoulette::Throughput] {
        let on = with(roulette, 2);
        assert_same_mean("roulette", &on, &off);
        assert!(on.rays < off.rays, "{roulette:?}: {} and {} rays", on.rays, off.rays);
    }
    let halved = with(RussianRoulette::Constant(0.5), 2);
    assert!(halved.rays < off.rays / 2 && mean_variance(&halved) > mean_variance(&off));
}

/// The 95 % interval that a frame states holds the truth about as often as it says, with Sobol points more often.
#[test]
fn confidence_intervals_hold_the_truth() {
    let scene = cornell();
    let settings = |sampler, seed| Settings { sampler, max_depth: 3, size: UVec2::splat(16), ..settings(Integrator::Path, seed) };
    let truth = render_at(&scene, &settings(SamplerKind::Sobol, 1000), 8192).mean_luminance.0;
    for (sampler, expected) in [(SamplerKind::Independent, 35..=40), (SamplerKind::Sobol, 38..=40)] {
        let hits = (0..40).filter(|&seed| {
            let (mean, half) = render_at(&scene, &settings(sampler, seed), 16).mean_luminance;
            (mean - truth).abs() < half
        });
        let hits = hits.count();
        assert!(expected.contains(&hits), "{sampler:?}: {hits} of 40");
    }
}

/// Mirrors see lights through BSDF sampling whatever the strategy.
#[test]
fn mirrors_show_lights() {
    let scene = Stage::default()
        .mesh(shapes::rectangle(4.0, 4.0), mirror(), at(Vec3::ZERO))
        .light(LightShape::Disk { radius: Meters(5.0) }, 2.0, looking(Vec3::Z * 3.0, Vec3::ZERO))
        .orthographic(Vec3::Z * 2.0, Vec3::ZERO, 1.0)
        .0;
    for strategy in [Strategy::Mis, Strategy::Lights] {
        let film = film_at(&scene, &Settings { strategy, max_depth: 1, ..sized(4, 4) }, 4);
        assert!((mean(&film.develop()) - 2.0).abs() < 1e-4, "{strategy:?}");
        assert_eq!(film.rays(), 2 * 4 * 4 + 2 * film.samples(), "two rays a pixel look for highlights");
    }
}

#[test]
fn adaptive_sampling_keeps_the_mean_and_reaches_a_noise_goal_with_fewer_samples() {
    let even = Settings { max_depth: 3, sampler: SamplerKind::Independent, ..sized(32, 32) };
    let adaptive = Settings { adaptive: true, seed: 1, aovs: vec![crate::Aov::Samples], ..even.clone() };
    let frame = render_at(&super::scenes::cornell(), &adaptive, 256);
    assert_same_mean("adaptive", &frame, &render_at(&super::scenes::cornell(), &even, 256));
    let counts = frame.image("samples").expect("asked for").pixels.to_color();
    let total: f64 = counts.pixels().iter().map(|n| f64::from(n[0])).sum();
    assert_eq!(total, frame.samples as f64);
    assert!((total / (32.0 * 32.0) / 256.0 - 1.0).abs() < 0.02, "{total}");
    let goal = |settings| render(&tracer(&super::scenes::cornell()), settings, Stop::at_noise(0.12), None, &uncontrolled).unwrap();
    let (even, adaptive) = (goal(&even), goal(&adaptive));
    assert!(adaptive.develop().relative_standard_error <= 0.12);
    assert!(adaptive.samples() * 2 < even.samples(), "{} samples instead of {}", adaptive.samples(), even.samples());
}

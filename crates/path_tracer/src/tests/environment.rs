//! What sampling an environment claims of whole renderings.

use super::scenes::{Stage, at, floor, lambert, render_at, sized, tracer};
use super::skies::sky;
use crate::{EnvironmentSampler, Filter, Frame, Integrator, Settings, Stop, Strategy, render, uncontrolled};
use glam::Vec3;
use kajo_sampling::SamplerKind;
use kajo_scene::{Environment, Material, Scene, shapes};
use kajo_units::LinearRgb;

fn metal(roughness: f32) -> Material {
    Material { metallic: 1.0, roughness, base_color: LinearRgb::new(0.9, 0.8, 0.7), ..Material::default() }
}

fn settings(seed: u64) -> Settings {
    Settings { seed, filter: Filter::Center, sampler: SamplerKind::Independent, ..sized(32, 32) }
}

/// A shiny sphere on a grey floor.
fn scene(environment: Environment) -> Scene {
    let stage = Stage::default()
        .mesh(floor(), lambert(0.6), at(Vec3::ZERO))
        .mesh(shapes::sphere(0.5, 24), metal(0.3), at(Vec3::new(0.0, 0.5, 0.0)))
        .perspective(Vec3::new(0.0, 1.2, 3.0), Vec3::new(0.0, 0.4, 0.0), 30.0);
    Scene { environment: Some(environment), ..stage.0 }
}

fn rendered(scene: &Scene, sampler: EnvironmentSampler, seed: u64) -> Frame {
    let tracer = tracer(scene).with_environment_sampler(sampler).expect("a sound environment");
    let settings = Settings { max_depth: 2, ..settings(seed) };
    render(&tracer, &settings, Stop::at_spp(256), None, &uncontrolled).expect("a rendering").develop()
}

/// Share of the pixels' channels whose difference is at most three of its standard deviations.
fn share_within_three_sigma(a: &Frame, b: &Frame) -> f64 {
    let (mut within, mut total) = (0u32, 0u32);
    for y in 0..a.size.y {
        for x in 0..a.size.x {
            for channel in 0..3 {
                let difference = (a.beauty().get(x, y)[channel] - b.beauty().get(x, y)[channel]).abs();
                let variance = a.beauty_variance().get(x, y)[channel] + b.beauty_variance().get(x, y)[channel];
                within += u32::from(difference <= 3.0 * variance.sqrt());
                total += 1;
            }
        }
    }
    f64::from(within) / f64::from(total)
}

/// Row GI-7: the law that blocks are drawn by is only near their light, and still nothing changes but noise.
#[test]
fn environment_samplers_have_one_mean_and_a_planted_fault_is_seen() {
    let environment = sky(256, 128);
    let cdf = rendered(&scene(environment.clone()), EnvironmentSampler::Cdf, 1);
    for (name, sampler) in [("kd", EnvironmentSampler::Kd), ("alias", EnvironmentSampler::Alias)] {
        let other = rendered(&scene(environment.clone()), sampler, 2);
        let share = share_within_three_sigma(&cdf, &other);
        assert!(share >= 0.99, "{name}: {share}");
    }
    let brighter = Environment { scale: LinearRgb::splat(1.15), ..environment };
    let share = share_within_three_sigma(&cdf, &rendered(&scene(brighter), EnvironmentSampler::Kd, 2));
    assert!(share < 0.95, "15 per cent more light are not seen: {share}");
}

/// Root mean square error of one ray a pixel: that of the pixels' means, which are unbiased, times the square root of the rays spent.
fn error_per_ray(scene: &Scene, settings: &Settings) -> f64 {
    let frame = render_at(scene, settings, 1024);
    let variance: f64 = frame.beauty_variance().pixels().iter().map(|v| f64::from(v.0.element_sum())).sum();
    (variance * frame.rays as f64).sqrt() / f64::from(frame.size.element_product())
}

/// Row GI-11: at equal numbers of rays the combination is never much worse than the better strategy and always better than the worse one, for
/// GGX widths α from 0.01 to 1 (rougher than a mirror, which no light sampling can find light in).
#[test]
fn combining_strategies_is_near_the_better_one_for_every_gloss() {
    let mut who_wins = [0; 2];
    for alpha in [0.01f32, 0.03, 0.1, 0.3, 1.0] {
        let stage = Stage::default().mesh(shapes::sphere(0.5, 48), metal(alpha.sqrt()), at(Vec3::ZERO)).orthographic(
            Vec3::new(0.0, 0.4, 2.0),
            Vec3::ZERO,
            0.6,
        );
        let scene = Scene { environment: Some(sky(128, 64)), ..stage.0 };
        let base = Settings { max_depth: 1, size: glam::UVec2::splat(16), ..settings(3) };
        let error = |integrator, strategy| error_per_ray(&scene, &Settings { integrator, strategy, ..base.clone() });
        let combined = error(Integrator::Path, Strategy::Mis);
        let (bsdf, lights) = (error(Integrator::BsdfOnly, Strategy::Mis), error(Integrator::Path, Strategy::Lights));
        let (better, worse) = (bsdf.min(lights), bsdf.max(lights));
        assert!(combined <= 1.5 * better && combined < worse, "α {alpha}: {combined}, BSDF {bsdf}, lights {lights}");
        who_wins[usize::from(lights < bsdf)] += 1;
    }
    assert!(who_wins.iter().all(|&wins| wins > 0), "one strategy is the better one everywhere: {who_wins:?}");
}

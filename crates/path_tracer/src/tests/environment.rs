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
    render(&tracer, &settings, Stop::at_spp(1024), None, &uncontrolled).expect("a rendering").develop()
}

/// Share of the pixels with noise whose luminances differ by no more than 99.73 % of differences do, which is three standard deviations of a normal one.
/// The deviations come from 8 blocks of samples each, so it is 3.64 of Student's t with 14 degrees of freedom, as for equal variances. The channels of a pixel follow the same
/// paths, so their deviations add up.
fn share_within_three_sigma(a: &Frame, b: &Frame) -> f64 {
    let (mut within, mut total) = (0u32, 0u32);
    let pixels = a.beauty().pixels().iter().zip(b.beauty().pixels());
    let variances = a.beauty_variance().pixels().iter().zip(b.beauty_variance().pixels());
    for ((a, b), (a_variance, b_variance)) in pixels.zip(variances) {
        let deviation = LinearRgb((a_variance.0 + b_variance.0).map(f32::sqrt)).luminance();
        if deviation > 0.0 {
            within += u32::from((a.luminance() - b.luminance()).abs() <= 3.64 * deviation);
            total += 1;
        }
    }
    assert!(total > 500, "{total} pixels are compared");
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

/// Row GI-9: numbers spread over strata for each pixel leave less noise in 64 renderings than independent ones.
#[test]
fn strata_lower_the_variance_of_renderings() {
    let tracer = tracer(&scene(sky(256, 128))).with_environment_sampler(EnvironmentSampler::Kd).expect("a sound environment");
    let variance = |sampler| {
        let takes: Vec<Frame> = (0..64)
            .map(|seed| {
                let settings = Settings { max_depth: 1, sampler, size: glam::UVec2::splat(16), ..settings(seed) };
                render(&tracer, &settings, Stop::at_spp(16), None, &uncontrolled).expect("a rendering").develop()
            })
            .collect();
        let n = takes.len() as f32;
        let of_pixel = |i: usize| {
            let values = takes.iter().map(|take| take.beauty().pixels()[i].luminance());
            let mean = values.clone().sum::<f32>() / n;
            values.map(|v| (v - mean).powi(2)).sum::<f32>() / (n - 1.0)
        };
        (0..16 * 16).map(of_pixel).sum::<f32>() / (16.0 * 16.0)
    };
    let (stratified, plain) = (variance(SamplerKind::Sobol), variance(SamplerKind::Independent));
    assert!(stratified < 0.8 * plain, "{stratified} and {plain}");
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

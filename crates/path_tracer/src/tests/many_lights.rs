//! What choosing among lights claims of whole renderings.

use super::compare::{assert_same_mean, largest_block_z};
use super::scenes::{Stage, at, downwards, floor, glowing, lambert, looking, mean, render_at, sized, tracer};
use super::skies::sky;
use crate::lights::{ChosenLight, SeenLight};
use crate::{Filter, Frame, Integrator, LightSampler, Settings, Stop, Strategy, Tracer, render, uncontrolled};
use glam::{Quat, Vec2, Vec3};
use kajo_sampling::light_tree::Receiver;
use kajo_sampling::statistics::Moments;
use kajo_sampling::warp::uniform_sphere;
use kajo_sampling::{Rng, SamplerKind, power_heuristic};
use kajo_scene::{LightShape, Material, Node, Scene, Transform, shapes};
use kajo_units::{Meters, Radians};
use std::f64::consts::PI;

fn builtin(reference: &str) -> Scene {
    kajo_scene::load(&format!("builtin:{reference}"), &Default::default()).expect("a built-in scene")
}

fn rendered(scene: &Scene, by: LightSampler, settings: &Settings, spp: u32) -> Frame {
    let film = render(&tracer(scene).with_light_sampler(by), settings, Stop::at_spp(spp), None, &uncontrolled).expect("a rendering");
    let frame = film.develop();
    assert_eq!(frame.invalid_samples, 0);
    frame
}

fn direct(seed: u64) -> Settings {
    Settings { seed, max_depth: 1, sampler: SamplerKind::Independent, filter: Filter::Center, ..sized(32, 32) }
}

/// Mean of the pixels' variances, of one sample.
fn variance(frame: &Frame) -> f64 {
    let pixels = frame.beauty_variance().pixels();
    pixels.iter().map(|v| f64::from(v.0.element_sum())).sum::<f64>() * f64::from(frame.spp) / pixels.len() as f64
}

/// Lights of every kind in one room: meshes that share triangles, one of them mirrored, one stretched, one that glows on both sides, a flat one mirrored; a
/// glass ball between them, which light reaches from all sides.
fn everything() -> Stage {
    let turn = Quat::from_rotation_x(1.0);
    let mirrored = Transform::Trs { translation: Vec3::new(-0.3, 1.3, -0.6), rotation: turn, scale: Vec3::new(-1.0, 1.0, 1.0) };
    let mut stage = Stage::default()
        .mesh(floor(), lambert(0.6), at(Vec3::ZERO))
        .mesh(shapes::sphere(0.25, 8), glowing(3.0, 0.2), at(Vec3::new(-1.2, 0.6, 0.0)))
        .mesh(shapes::rectangle(0.5, 0.3), Material { double_sided: true, ..glowing(5.0, 0.2) }, at(Vec3::new(1.0, 0.5, -0.3)))
        .mesh(
            shapes::sphere(0.4, 16),
            Material { transmission: 1.0, thickness: 1.0, roughness: 0.4, ..lambert(0.9) },
            at(Vec3::new(0.0, 0.4, 0.0)),
        )
        .mesh(shapes::rectangle(0.4, 0.3), glowing(4.0, 0.2), mirrored)
        .light(LightShape::Sphere { radius: Meters(0.1) }, 20.0, at(Vec3::new(0.3, 1.1, 0.6)))
        .light(LightShape::Disk { radius: Meters(0.2) }, 8.0, downwards(Vec3::new(-0.5, 1.5, 0.2)))
        .light(LightShape::Rectangle { width: Meters(0.3), height: Meters(0.2) }, 8.0, looking(Vec3::new(0.9, 0.9, 0.9), Vec3::ZERO))
        .light(LightShape::Directional { half_angle: Radians(0.3) }, 0.3, downwards(Vec3::Y))
        .perspective(Vec3::new(0.0, 1.2, 3.0), Vec3::new(0.0, 0.4, 0.0), 45.0);
    let glow = 1;
    for (scale, translation) in
        [(Vec3::new(-0.6, 0.6, 0.6), Vec3::new(0.5, 0.3, 0.9)), (Vec3::new(0.3, 1.2, 0.5), Vec3::new(-0.6, 0.5, -0.8))]
    {
        let transform = Transform::Trs { translation, rotation: Quat::from_rotation_x(0.7), scale };
        stage.0.nodes.push(Node { meshes: vec![glow], transform, ..Node::default() });
    }
    stage.0.environment = Some(sky(32, 16));
    stage.0.environment.as_mut().expect("just set").scale *= 0.2;
    stage
}

/// Row RM-35, in whole renderings: however lights are chosen the picture is that of paths that choose none, with and without the other strategy. Lights of
/// another brightness are seen. (What a tree leaves out is not: the other strategy finds it, see `no_light_above_a_receiver_is_left_out`.)
#[test]
fn ways_to_choose_lights_have_one_mean_and_a_planted_fault_is_seen() {
    let scene = everything().0;
    let settings = |seed| Settings { max_depth: 3, ..direct(seed) };
    let truth = render_at(&scene, &Settings { integrator: Integrator::BsdfOnly, ..settings(1) }, 800);
    for (name, by) in LightSampler::ALL {
        for (strategy, spp) in [(Strategy::Mis, 200), (Strategy::Lights, 400)] {
            assert_same_mean(name, &rendered(&scene, by, &Settings { strategy, ..settings(2) }, spp), &truth);
        }
    }
    let mut brighter = scene;
    brighter.lights[0].emission *= 1.3;
    let wrong = rendered(&brighter, LightSampler::Bvh, &settings(3), 400);
    assert!(largest_block_z(&wrong, &truth, 8) > 6.0);
}

/// The same with lights that only light sampling finds, which a tree knows by their cones.
#[test]
fn points_and_spots_have_one_mean() {
    let mut stage = everything();
    for i in 0..6u8 {
        let place = Vec3::new(0.5 * f32::from(i) - 1.3, 0.9, 0.3);
        stage = stage.light(LightShape::Spot { inner: Radians(0.2), outer: Radians(0.6) }, 0.6, looking(place, Vec3::new(0.3, 0.0, 0.0)));
        stage = stage.light(LightShape::Point, 0.05, at(place * Vec3::new(-1.0, 0.4, 2.0)));
    }
    let reference = rendered(&stage.0, LightSampler::Uniform, &direct(1), 2000);
    for (name, by) in LightSampler::ALL {
        assert_same_mean(name, &rendered(&stage.0, by, &direct(2), 300), &reference);
    }
}

/// Mean variance of a sample by each way to choose.
fn variances<const N: usize>(scene: &Scene, by: [LightSampler; N]) -> [f64; N] {
    by.map(|by| variance(&rendered(scene, by, &direct(1), 32)))
}

/// Row RM-35: 10 000 emissive triangles, equal samples.
#[test]
fn a_tree_of_ten_thousand_lights_has_less_than_a_quarter_of_the_variance_of_uniform_choice() {
    let [tree, uniform] = variances(&builtin("embers:10000"), [LightSampler::Bvh, LightSampler::Uniform]);
    assert!(tree < 0.1 * uniform, "{tree} and {uniform}");
}

/// Of 10 000 lamps uniform choice is not as bad, and of what the tree leaves much is gloss, which resampling knows.
#[test]
fn a_tree_of_ten_thousand_lamps_has_near_a_third_of_the_variance_and_resampling_near_half_of_that() {
    let by = [LightSampler::Bvh, LightSampler::Uniform, LightSampler::Ris { candidates: 4 }];
    let [tree, uniform, resampled] = variances(&builtin("many-lights:10000"), by);
    assert!(tree < 0.35 * uniform, "{tree} and {uniform}");
    assert!(resampled < 0.6 * tree, "{resampled} and {tree}");
}

/// A white floor under small lights of different brightness; every pixel sees it.
fn thousand_points() -> Scene {
    let mut rng = Rng::new(1);
    let mut stage = Stage::default().mesh(floor(), lambert(0.8), at(Vec3::ZERO)).orthographic(Vec3::Y * 9.0, Vec3::ZERO, 4.0);
    for _ in 0..1000 {
        let place = Vec3::new(rng.next_1d() * 8.0 - 4.0, 0.3 + rng.next_1d(), rng.next_1d() * 8.0 - 4.0);
        stage = stage.light(LightShape::Point, 0.01 + 0.1 * rng.next_1d().powi(4), at(place));
    }
    // Half of the floor in shadow of a board.
    stage.mesh(shapes::rectangle(1.0, 4.0), lambert(0.5), downwards(Vec3::new(-0.8, 0.25, 0.0))).0
}

/// Row M-11: 32 candidates of 1000 lights, of which one is kept: one shadow ray a sample, the mean that the sum over all lights has, and less error than
/// uniform choice at as many shadow rays.
#[test]
fn resampling_keeps_one_of_many_candidates_and_beats_uniform_choice() {
    let scene = thousand_points();
    let settings = |seed| Settings { strategy: Strategy::Lights, ..direct(seed) };
    let tracer = tracer(&scene).with_light_sampler(LightSampler::Ris { candidates: 32 });
    let film = render(&tracer, &settings(1), Stop::at_spp(64), None, &uncontrolled).expect("a rendering");
    assert_eq!(film.rays(), 2 * 32 * 32 + 2 * film.samples(), "one camera ray, one shadow ray, and as many once to look for highlights");
    let resampled = film.develop();
    // Every light for itself, summed.
    let mut sum = vec![Vec3::ZERO; 32 * 32];
    for light in 0..scene.lights.len() {
        let mut alone = scene.clone();
        alone.nodes.retain(|node| node.light.is_none_or(|index| index == light));
        let frame = rendered(&alone, LightSampler::Uniform, &settings(0), 1);
        sum.iter_mut().zip(frame.beauty().pixels()).for_each(|(sum, pixel)| *sum += pixel.0);
    }
    let exact: f64 = sum.iter().map(|s| f64::from(s.element_sum()) / 3.0).sum::<f64>() / sum.len() as f64;
    let error = (variance(&resampled) / 3.0 / 64.0 / sum.len() as f64).sqrt();
    let z = (mean(&resampled) - exact) / error;
    assert!(z.abs() < 3.0, "{} for {exact}: {z} standard errors", mean(&resampled));
    for block in 0..16 {
        let (bx, by) = (8 * (block % 4), 8 * (block / 4));
        let pixels = (0..64).map(|i| (bx + i % 8, by + i / 8));
        let (mut difference, mut variance) = (0.0, 0.0);
        for (x, y) in pixels {
            difference += f64::from(resampled.beauty().get(x, y)[0] - sum[(y * 32 + x) as usize].x);
            variance += f64::from(resampled.beauty_variance().get(x, y)[0]);
        }
        assert!(difference.abs() < 4.0 * variance.sqrt(), "block {block}: {difference} with deviation {}", variance.sqrt());
    }
    let uniform = rendered(&scene, LightSampler::Uniform, &settings(2), 64);
    assert!(variance(&resampled) < 0.25 * variance(&uniform), "{} and {}", variance(&resampled), variance(&uniform));
}

/// Row RM-32: the irradiance under a rectangle of emissive triangles is, within three standard errors of 10⁵ estimates of one sample each, the closed form of
/// `direct_light`'s `corner`; a scene whose light is 3 % stronger is not.
#[test]
fn one_sample_estimates_have_the_mean_of_the_closed_form_and_a_planted_fault_is_seen() {
    let lamp = |radiance| {
        let place = Transform::Trs {
            translation: Vec3::new(0.0, 1.0, 0.0),
            rotation: Quat::from_rotation_x(std::f32::consts::FRAC_PI_2),
            scale: Vec3::ONE,
        };
        Stage::default()
            .mesh(floor(), lambert(1.0), at(Vec3::ZERO))
            .mesh(shapes::rectangle(2.0, 2.0), glowing(radiance, 0.0), place)
            .orthographic(0.5 * Vec3::Y, Vec3::ZERO, 1e-3)
            .0
    };
    // Four corners of side 1 at distance 1: E = 4 · ½ · 2/√2 atan(1/√2).
    let exact = 4.0 / 2f64.sqrt() * (1.0 / 2f64.sqrt()).atan() / PI;
    let settings = |strategy| Settings { strategy, size: glam::UVec2::splat(100), ..direct(5) };
    let estimates = |radiance, strategy| {
        let frame = rendered(&lamp(radiance), LightSampler::Bvh, &settings(strategy), 10);
        assert_eq!(frame.samples, 100_000);
        let error = (variance(&frame) / 3.0 / frame.samples as f64).sqrt();
        (mean(&frame) - exact) / error
    };
    for strategy in [Strategy::Mis, Strategy::Lights] {
        let z = estimates(1.0, strategy);
        assert!(z.abs() < 3.0, "{strategy:?}: {z} standard errors from {exact}");
        assert!(estimates(1.03, strategy) > 5.0);
    }
}

/// A place in the room, above which half of the directions lie, or all.
fn some_receiver(rng: &mut Rng, faces: bool) -> Receiver {
    let point = Vec3::new(rng.next_1d() * 4.0 - 2.0, rng.next_1d() * 2.0, rng.next_1d() * 4.0 - 2.0);
    Receiver { point, normal: faces.then(|| uniform_sphere(rng.next_2d())) }
}

/// Density that a ray is given which meets a light where it was chosen. `None` where rounding takes the point to the other side of a rim.
fn density_of(tracer: &Tracer, receiver: &Receiver, chosen: &ChosenLight) -> Option<f32> {
    let (world, lights, sample) = (&tracer.world, &tracer.lights, &chosen.sample);
    let mut met = None;
    let mut see = |seen: SeenLight| {
        if seen.light == chosen.light {
            met = Some(seen.pdf);
        }
    };
    let point = receiver.point;
    match chosen.primitive {
        Some(primitive) => met = Some(lights.pdf_of_surface(world, receiver, primitive, (point, sample.wi, sample.distance))),
        None if sample.distance.is_finite() => lights.along(Some(receiver), point, sample.wi, f32::INFINITY, |_, seen| see(seen)),
        None => lights.beyond(world, Some(receiver), sample.wi, see),
    }
    met
}

/// Rows RM-32 and RM-35: for points of every light, the density that a met light is given is that with which it is sampled, so that the weights of both
/// strategies sum to 1 (4.20).
#[test]
fn densities_of_both_sides_agree_so_weights_sum_to_one() {
    let mut scene = everything().0;
    // Less of sun and sky, so that every light has its share of the choices.
    scene.lights[3].emission *= 1e-5;
    scene.environment.as_mut().expect("a sky").scale *= 1e-5;
    for (name, by) in LightSampler::ALL {
        let tracer = tracer(&scene).with_light_sampler(by);
        let mut rng = Rng::new(3);
        let (mut off, mut equal) = (Moments::default(), 0);
        let mut compared = vec![0; tracer.light_names().len()];
        for i in 0..30_000 {
            let receiver = some_receiver(&mut rng, i % 2 == 0);
            let Some(chosen) = tracer.lights.sample(&tracer.world, &receiver, rng.next_1d(), rng.next_2d()) else { continue };
            let Some(met) = density_of(&tracer, &receiver, &chosen) else { continue };
            let other = rng.next_1d() * 2.0 * chosen.sample.pdf;
            let sum = power_heuristic(chosen.sample.pdf, other) + power_heuristic(other, met);
            off.add(f64::from((sum - 1.0).abs()));
            equal += u32::from((sum - 1.0).abs() < 1e-6);
            compared[chosen.light as usize] += 1;
        }
        let share = f64::from(equal) / off.count() as f64;
        assert!(off.count() > 8000 && share > 0.98, "{name}: {share} of {}", off.count());
        assert!(off.mean() < 1e-4, "{name}: {}", off.mean());
        // Four analytic lights, five instances, the sky.
        assert!(compared.len() == 10 && compared.iter().all(|&n| n > 100), "{name}: {compared:?}");
    }
}

/// Row RM-35: whatever another way to choose finds, the tree finds, too. (No picture would tell: what light sampling leaves out, rays find.)
#[test]
fn no_light_above_a_receiver_is_left_out() {
    let scene = everything().0;
    let (uniform, tree) = (tracer(&scene).with_light_sampler(LightSampler::Uniform), tracer(&scene));
    let mut rng = Rng::new(4);
    let mut compared = vec![0; uniform.light_names().len()];
    for i in 0..20_000 {
        let receiver = some_receiver(&mut rng, i % 2 == 0);
        let Some(chosen) = uniform.lights.sample(&uniform.world, &receiver, rng.next_1d(), rng.next_2d()) else { continue };
        let above = receiver.normal.is_none_or(|normal| normal.dot(chosen.sample.wi) > 0.0);
        if above
            && !chosen.value.is_black()
            && let Some(density) = density_of(&tree, &receiver, &chosen)
        {
            assert!(density > 0.0, "{} from {receiver:?}: {:?}", uniform.light_names()[chosen.light as usize], chosen.sample);
            compared[chosen.light as usize] += 1;
        }
    }
    assert!(compared.iter().all(|&n| n > 20), "{compared:?}");
}

/// Where there is nothing to choose, the choice costs no random decision: the picture is the same bit for bit, however lights are chosen.
#[test]
fn a_single_light_is_the_same_picture_for_every_choice() {
    let scene = builtin("cornell");
    let picture = |by| rendered(&scene, by, &Settings { max_depth: 4, ..direct(1) }, 2).beauty().pixels().to_vec();
    let tree = picture(LightSampler::Bvh);
    assert_eq!(tree, picture(LightSampler::Power));
    assert_eq!(tree, picture(LightSampler::Uniform));
    assert_ne!(tree, picture(LightSampler::Ris { candidates: 4 }));
}

/// Samplers with the tree share it when one takes the place of the other.
#[test]
fn a_sampler_leaves_nothing_to_the_next() {
    let scene = everything().0;
    let ris = LightSampler::Ris { candidates: 4 };
    let picture = |by: &[LightSampler]| {
        let tracer = by.iter().fold(tracer(&scene), |tracer, &by| tracer.with_light_sampler(by));
        let film = render(&tracer, &direct(1), Stop::at_spp(1), None, &uncontrolled).expect("a rendering");
        film.develop().beauty().pixels().to_vec()
    };
    let (bvh, resampled) = (picture(&[]), picture(&[ris]));
    assert_ne!(bvh, resampled);
    assert_eq!(picture(&[LightSampler::Uniform, ris]), resampled);
    assert_eq!(picture(&[ris, LightSampler::Bvh]), bvh);
    assert_eq!(picture(&[ris, LightSampler::Power, LightSampler::Bvh]), bvh);
}

#[test]
fn every_light_of_a_scene_can_be_chosen() {
    let scene = builtin("embers:300");
    let tracer = tracer(&scene);
    let (world, lights) = (&tracer.world, &tracer.lights);
    let receiver = Receiver { point: Vec3::new(0.5, 5.0, 0.5), normal: None };
    let mut rng = Rng::new(9);
    let mut seen = vec![0; world.instances.len()];
    for _ in 0..4000 {
        let chosen = lights.sample(world, &receiver, rng.next_1d(), Vec2::new(rng.next_1d(), rng.next_1d()));
        if let Some(primitive) = chosen.and_then(|chosen| chosen.primitive) {
            seen[primitive.instance as usize] += 1;
        }
    }
    assert_eq!(seen.iter().filter(|&&count| count > 0).count(), 25, "whirls of which some ember was found");
}

/// What the choice knows nothing of, the sky's image and suns among lamps, is looked for twice at the first surface.
#[test]
fn the_first_surface_has_two_candidates_for_the_sky_and_for_suns_among_lamps() {
    let sun = |stage: Stage| stage.light(LightShape::Directional { half_angle: Radians(0.0) }, 1.0, downwards(Vec3::ZERO));
    let lamp = |stage: Stage| stage.light(LightShape::Point, 1.0, at(Vec3::Y));
    let floor = || Stage::default().mesh(floor(), lambert(0.5), at(Vec3::ZERO));
    let under_sky = Scene { environment: Some(sky(8, 4)), ..floor().0 };
    for (name, scene, first) in
        [("sky", under_sky, 2), ("sun and lamp", lamp(sun(floor())).0, 2), ("sun", sun(floor()).0, 1), ("lamps", lamp(lamp(floor())).0, 1)]
    {
        let tracer = tracer(&scene);
        assert_eq!([0, 1, 2].map(|bounces| tracer.lights.candidates(bounces)), [first, 1, 1], "{name}");
        for (sampler, all) in [(LightSampler::Power, 1), (LightSampler::Ris { candidates: 3 }, 3)] {
            let tracer = self::tracer(&scene).with_light_sampler(sampler);
            assert_eq!([0, 1].map(|bounces| tracer.lights.candidates(bounces)), [all; 2], "{name}, {sampler:?}");
        }
    }
}

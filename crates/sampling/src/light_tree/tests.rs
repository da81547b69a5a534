//! What the tree claims of its choices, on emitters with known sums.

use super::*;
use crate::Rng;
use crate::statistics::{Moments, chi_square_p_value};
use crate::warp::uniform_sphere;
use glam::{Affine3A, Quat, Vec3};
use std::f32::consts::TAU;
use std::sync::Arc;
use std::time::Duration;

/// Small triangles all over a room of side 10 m around the origin, turned at random, of very different power.
fn triangles(count: usize, seed: u64) -> Vec<[Vec3; 3]> {
    let mut rng = Rng::new(seed);
    (0..count)
        .map(|_| {
            let center = (Vec3::new(rng.next_1d(), rng.next_1d(), rng.next_1d()) - 0.5) * 10.0;
            let size = 0.02 * (1.0 + 4.0 * rng.next_1d());
            [(); 3].map(|()| center + size * uniform_sphere(rng.next_2d()))
        })
        .collect()
}

fn emitters_of(triangles: &[[Vec3; 3]]) -> Vec<EmitterBounds> {
    let bounds = |(i, &t): (usize, &[Vec3; 3])| EmitterBounds::triangle(t, 1.0 + (i % 7) as f32, i % 5 == 0);
    triangles.iter().enumerate().map(bounds).collect()
}

fn emitters(count: usize, seed: u64) -> Vec<EmitterBounds> {
    emitters_of(&triangles(count, seed))
}

/// Irradiance of an emitter as a small plane at its middle: what the sums of these tests are over.
fn irradiance(emitter: &EmitterBounds, receiver: &Receiver) -> f64 {
    let to = emitter.center() - receiver.point;
    let (d2, wi) = (to.length_squared(), to.normalize_or(Vec3::Z));
    let cos = if emitter.cos_normals < 0.0 { 1.0 } else { -emitter.axis.dot(wi) };
    let cos = if emitter.two_sided { cos.abs() } else { cos.max(0.0) };
    let cos_i = receiver.normal.map_or(1.0, |n| n.dot(wi).max(0.0));
    f64::from(emitter.intensity * cos * cos_i / d2)
}

fn receivers(count: usize, seed: u64) -> Vec<Receiver> {
    let mut rng = Rng::new(seed);
    (0..count)
        .map(|i| Receiver {
            point: (Vec3::new(rng.next_1d(), rng.next_1d(), rng.next_1d()) - 0.5) * 9.0,
            normal: (i % 3 > 0).then(|| uniform_sphere(rng.next_2d())),
        })
        .collect()
}

/// Row RM-35: probabilities of all emitters sum to 1, and none that contributes has none.
#[test]
fn probabilities_sum_to_one_and_never_leave_out_a_light_that_contributes() {
    for count in [1, 2, 7, 8, 9, 100, 3000] {
        let emitters = emitters(count, count as u64);
        let tree = LightTree::new(emitters.clone());
        tree.validate().unwrap();
        for receiver in receivers(60, 5) {
            let pmfs: Vec<f64> = (0..count).map(|i| f64::from(tree.pmf(&receiver, i))).collect();
            let sum: f64 = pmfs.iter().sum();
            let lit = emitters.iter().any(|e| irradiance(e, &receiver) > 0.0);
            assert!((sum - 1.0).abs() < 1e-4 || (sum == 0.0 && !lit), "{count} emitters: {sum} for {receiver:?}");
            for (emitter, pmf) in emitters.iter().zip(pmfs) {
                assert!(pmf > 0.0 || irradiance(emitter, &receiver) == 0.0, "{emitter:?} lights {receiver:?} and is never chosen");
            }
        }
    }
}

#[test]
fn emitters_are_chosen_with_their_probability_and_a_planted_fault_is_seen() {
    let tree = LightTree::new(emitters(300, 1));
    let mut rng = Rng::new(2);
    for receiver in receivers(6, 7) {
        let mut counts = vec![0.0; 300];
        let n = 60_000;
        let mut rests = vec![0.0; 10];
        for _ in 0..n {
            let Some(choice) = tree.sample(&receiver, rng.next_f64()) else { continue };
            assert!((choice.pmf / tree.pmf(&receiver, choice.index) - 1.0).abs() < 1e-5);
            counts[choice.index] += 1.0;
            rests[(choice.rest * 10.0) as usize] += 1.0;
        }
        let expected: Vec<f64> = (0..300).map(|i| f64::from(tree.pmf(&receiver, i)) * f64::from(n)).collect();
        assert!(chi_square_p_value(&counts, &expected, 0) > 1e-3);
        assert!(chi_square_p_value(&rests, &[f64::from(n) / 10.0; 10], 0) > 1e-3, "{rests:?}");
        let mut wrong = expected.clone();
        let likeliest = (0..300).max_by(|&a, &b| expected[a].total_cmp(&expected[b])).unwrap();
        wrong[likeliest] *= 0.8;
        wrong[(likeliest + 1) % 300] += 0.2 * expected[likeliest];
        assert!(chi_square_p_value(&counts, &wrong, 0) < 1e-6);
    }
}

/// Row RM-35: with 10 000 emitters the estimate by the tree is unbiased within 3 standard errors and has at most a quarter of the variance of
/// uniform choice, at every receiver.
#[test]
fn variance_is_below_a_quarter_of_that_of_uniform_choice() {
    let emitters = emitters(10_000, 3);
    let tree = LightTree::new(emitters.clone());
    let mut rng = Rng::new(4);
    let mut worst = 0.0f64;
    for receiver in receivers(24, 11) {
        let exact: f64 = emitters.iter().map(|e| irradiance(e, &receiver)).sum();
        let by_tree: Moments = (0..30_000)
            .map(|_| {
                let choice = tree.sample(&receiver, rng.next_f64());
                choice.map_or(0.0, |c| irradiance(&emitters[c.index], &receiver) / f64::from(c.pmf))
            })
            .collect();
        // Exactly: the mean of squares over all emitters, less the square of the sum.
        let n = emitters.len() as f64;
        let uniform = emitters.iter().map(|e| n * irradiance(e, &receiver).powi(2)).sum::<f64>() - exact * exact;
        let z = (by_tree.mean() - exact) / by_tree.standard_error();
        assert!(z.abs() < 3.0, "{} for {exact}: {z} standard errors", by_tree.mean());
        worst = worst.max(by_tree.variance() / uniform);
    }
    assert!(worst < 0.25, "variance over that of uniform choice: {worst}");
}

/// Row RM-36.
#[test]
fn splitting_goes_from_one_light_to_all_and_stays_unbiased() {
    let emitters = emitters(2000, 8);
    let tree = LightTree::new(emitters.clone());
    let mut rng = Rng::new(6);
    // By setting, over all receivers: relative deviations from the sum, and their variances.
    let mut deviations = [(0.0, 0.0); 9];
    for receiver in receivers(12, 13) {
        let exact: f64 = emitters.iter().map(|e| irradiance(e, &receiver)).sum();
        let mut last = 0.0;
        for (threshold, deviation) in [0.0, 0.3, 0.5, 0.6, 0.7, 0.8, 0.9, 0.97, 1.0].into_iter().zip(&mut deviations) {
            let threshold = SplitThreshold::new(threshold);
            let mut most = 0;
            let rounds = if threshold == SplitThreshold::ALWAYS { 2 } else { 300 };
            let estimates: Moments = (0..rounds)
                .map(|_| {
                    let (mut sum, mut own) = (0.0, 0);
                    tree.sample_split(
                        &receiver,
                        threshold,
                        || rng.next_f64(),
                        |index, pmf| {
                            sum += irradiance(&emitters[index], &receiver) / f64::from(pmf);
                            own += 1;
                        },
                    );
                    most = most.max(own);
                    sum
                })
                .collect();
            // Expected visits of emitters that contribute, exactly; clusters without any may be found dark when they are split.
            let contributing: Vec<usize> = (0..emitters.len()).filter(|&i| irradiance(&emitters[i], &receiver) > 0.0).collect();
            let cost: f64 = contributing.iter().map(|&i| f64::from(tree.pmf_split(&receiver, threshold, i))).sum();
            assert!(cost >= last * (1.0 - 1e-4), "{threshold:?}: {cost} visits after {last}");
            last = cost;
            if threshold == SplitThreshold::NEVER {
                assert!(most <= 1 && cost > 0.0);
            }
            if threshold == SplitThreshold::ALWAYS {
                assert!((estimates.mean() / exact - 1.0).abs() < 1e-4, "{} and {exact}", estimates.mean());
                assert_eq!(cost, contributing.len() as f64);
            } else {
                deviation.0 += estimates.mean() / exact - 1.0;
                deviation.1 += (estimates.standard_error() / exact).powi(2);
            }
        }
        assert!(last > 100.0);
    }
    let z = deviations.map(|(deviation, variance): (f64, f64)| deviation / variance.max(1e-12).sqrt());
    assert!(z.iter().all(|z| z.abs() < 3.0), "standard errors from the sum, by setting: {z:?}");
}

/// Row RM-36: where nothing can be ruled out, splitting always visits every light once.
#[test]
fn splitting_always_visits_all_points() {
    let mut rng = Rng::new(1);
    let points: Vec<_> = (0..777).map(|_| EmitterBounds::point(uniform_sphere(rng.next_2d()), 1.0 + rng.next_1d())).collect();
    let tree = LightTree::new(points);
    let mut visits = vec![0; 777];
    let receiver = Receiver { point: Vec3::new(0.1, 0.2, 0.3), normal: None };
    tree.sample_split(
        &receiver,
        SplitThreshold::ALWAYS,
        || unreachable!("nothing is left together"),
        |index, pmf| {
            visits[index] += 1;
            assert_eq!(pmf, 1.0);
        },
    );
    assert!(visits.iter().all(|&v| v == 1));
}

#[test]
fn the_probability_of_a_visit_is_its_frequency() {
    let mut rng = Rng::new(22);
    // A single emitter, too, which turns its back on some of the receivers.
    for (count, threshold) in [1, 200].into_iter().flat_map(|count| [0.0, 0.6, 0.85, 1.0].map(|t| (count, SplitThreshold::new(t)))) {
        let tree = LightTree::new(emitters(count, 21));
        for receiver in receivers(if count == 1 { 20 } else { 3 }, 23) {
            let mut counts = vec![0.0; count];
            let n = 4000;
            for _ in 0..n {
                tree.sample_split(
                    &receiver,
                    threshold,
                    || rng.next_f64(),
                    |index, pmf| {
                        counts[index] += 1.0;
                        assert!((pmf / tree.pmf_split(&receiver, threshold, index) - 1.0).abs() < 1e-5);
                    },
                );
            }
            for (index, count) in counts.into_iter().enumerate() {
                let expected = f64::from(n) * f64::from(tree.pmf_split(&receiver, threshold, index));
                assert!((count - expected).abs() <= 5.0 * expected.sqrt() + 1.0, "{count} visits, {expected} expected");
            }
        }
    }
}

/// Row RM-37: bounds enclose all emitters after any movement, and the probabilities still sum to 1.
#[test]
fn refitted_bounds_enclose_all_emitters_and_a_planted_fault_is_seen() {
    let before = triangles(1000, 31);
    let mut tree = LightTree::new(emitters_of(&before));
    let turn = |k: f32| Quat::from_rotation_y(k);
    let after: Vec<[Vec3; 3]> =
        before.iter().enumerate().map(|(i, t)| t.map(|p| turn(i as f32) * p + Vec3::Y * (i as f32 * TAU).sin())).collect();
    let moved = emitters_of(&after);
    // Only half of the movements made known: the tree must not pass.
    let mut half = tree.clone();
    half.emitters.copy_from_slice(&moved);
    assert!(half.validate().is_err());
    tree.refit(&moved);
    tree.validate().unwrap();
    for receiver in receivers(20, 32) {
        let sum: f64 = (0..1000).map(|i| f64::from(tree.pmf(&receiver, i))).sum();
        assert!((sum - 1.0).abs() < 1e-4, "{sum}");
    }
    let fresh = LightTree::new(moved.clone());
    assert!(fresh.cost() < tree.cost(), "a new tree is better: {} and {}", fresh.cost(), tree.cost());
    // One emitter: the nodes above it and no others.
    let mut one = fresh.clone();
    let touched = one.update(17, emitters_of(&before)[17]);
    one.validate().unwrap();
    assert!((1..=12).contains(&touched), "{touched} nodes");
    let mut all = moved;
    all[17] = emitters_of(&before)[17];
    let mut refitted = fresh;
    refitted.refit(&all);
    assert_eq!(one.clusters, refitted.clusters);
}

/// A hundred meshes of a hundred triangles each, on a circle.
fn meshes() -> (Vec<Arc<LightTree>>, TwoLevelTree) {
    let trees: Vec<_> = (0..100).map(|i| Arc::new(LightTree::new(emitters(100, 1000 + i)))).collect();
    let entries =
        trees.iter().enumerate().map(|(i, tree)| Entry::Object { tree: tree.clone(), world_from_object: place(i, 0.0) }).collect();
    (trees, TwoLevelTree::new(entries))
}

fn place(index: usize, lift: f32) -> Affine3A {
    let angle = index as f32 * TAU / 100.0;
    let scale = Vec3::splat(0.2) * if index.is_multiple_of(3) { Vec3::new(1.0, 1.0, -1.0) } else { Vec3::ONE };
    Affine3A::from_scale_rotation_translation(scale, Quat::from_rotation_x(angle), Vec3::new(9.0 * angle.cos(), lift, 9.0 * angle.sin()))
}

/// Row RM-37: a mesh that moves changes the nodes of the upper tree above it; one that deforms also its own tree. No other tree is touched.
#[test]
fn moving_one_of_a_hundred_meshes_touches_only_its_tree_and_the_top() {
    let (trees, mut scene) = meshes();
    let untouched = |scene: &TwoLevelTree, changed: usize| {
        (0..100).filter(|&i| i != changed).all(|i| match scene.entry(i) {
            Entry::Object { tree, world_from_object } => Arc::ptr_eq(tree, &trees[i]) && *world_from_object == place(i, 0.0),
            Entry::Single(_) => false,
        })
    };
    let touched = scene.replace(42, Entry::Object { tree: trees[42].clone(), world_from_object: place(42, 3.0) });
    assert!(touched <= 5, "{touched} nodes of the upper tree");
    assert!(untouched(&scene, 42));
    scene.top().validate().unwrap();
    // Deformed: its own triangles move, in its own tree.
    let mut deformed = LightTree::clone(&trees[42]);
    assert_eq!(deformed.refit(&emitters(100, 77)), deformed.nodes.len());
    scene.replace(42, Entry::Object { tree: Arc::new(deformed), world_from_object: place(42, 3.0) });
    assert!(untouched(&scene, 42));
    scene.top().validate().unwrap();
    for receiver in receivers(10, 1) {
        let sum: f64 = (0..100).flat_map(|i| (0..100).map(move |k| (i, k))).map(|(i, k)| f64::from(scene.pmf(&receiver, i, k))).sum();
        assert!((sum - 1.0).abs() < 1e-4, "{sum}");
    }
}

/// Two levels choose as one tree over all emitters in the world would: the mean is the same, the variance near.
#[test]
fn two_levels_are_unbiased_and_nearly_as_good_as_one() {
    let (trees, scene) = meshes();
    let in_world: Vec<EmitterBounds> =
        trees.iter().enumerate().flat_map(|(i, tree)| tree.emitters().iter().map(move |e| e.transformed(&place(i, 0.0)))).collect();
    let flat = LightTree::new(in_world.clone());
    let mut rng = Rng::new(3);
    let mut ratio = 0.0;
    let receivers = receivers(20, 41);
    for receiver in &receivers {
        let exact: f64 = in_world.iter().map(|e| irradiance(e, receiver)).sum();
        let value = |index: usize, pmf: f32| irradiance(&in_world[index], receiver) / f64::from(pmf);
        let two: Moments =
            (0..2000).map(|_| scene.sample(receiver, rng.next_f64()).map_or(0.0, |c| value(c.entry * 100 + c.emitter, c.pmf))).collect();
        let one: Moments = (0..2000).map(|_| flat.sample(receiver, rng.next_f64()).map_or(0.0, |c| value(c.index, c.pmf))).collect();
        let z = (two.mean() - exact) / two.standard_error();
        assert!(z.abs() < 3.0, "{} for {exact}: {z} standard errors", two.mean());
        ratio += (two.variance() / one.variance()).ln() / receivers.len() as f64;
        let chosen = scene.sample(receiver, rng.next_f64()).unwrap();
        assert!((scene.pmf(receiver, chosen.entry, chosen.emitter) / chosen.pmf - 1.0).abs() < 1e-5);
    }
    assert!(ratio.exp() < 2.0, "{}", ratio.exp());
}

/// Row RM-37: while a tree is built on another thread the refitted one answers; the new one takes over with the movements made meanwhile.
#[test]
fn a_tree_rebuilt_in_the_background_takes_over_with_later_movements() {
    let before = triangles(20_000, 51);
    let at = |time: f32| -> Vec<EmitterBounds> {
        let moved = |(i, t): (usize, &[Vec3; 3])| t.map(|p| Quat::from_rotation_y(time * (1.0 + (i % 11) as f32)) * p);
        emitters_of(&before.iter().enumerate().map(moved).collect::<Vec<_>>())
    };
    let mut tree = LightTree::new(at(0.0));
    tree.refit(&at(0.5));
    let rebuild = tree.rebuild();
    // It serves, and follows the emitters, while the other thread builds.
    let receiver = receivers(1, 5)[0];
    let mut served = 0;
    while !rebuild.is_ready() || served == 0 {
        tree.refit(&at(0.51));
        tree.validate().unwrap();
        assert!(tree.sample(&receiver, 0.3).is_some());
        served += 1;
        std::thread::sleep(Duration::from_millis(1));
    }
    let refitted = tree.cost();
    tree.swap(rebuild);
    tree.validate().unwrap();
    assert_eq!(tree.emitters(), at(0.51));
    assert!(tree.cost() < 0.7 * refitted, "{} after {refitted}", tree.cost());
}

#[test]
fn extreme_emitters_are_kept_apart_or_left_out() {
    assert!(LightTree::new(Vec::new()).sample(&receivers(1, 1)[0], 0.5).is_none());
    let point = |x: f32, intensity: f32| EmitterBounds::point(Vec3::new(x, 0.0, 0.0), intensity);
    // Coinciding, dark, infinite, without a place, very near each other and very far.
    let mut emitters: Vec<_> = (0..50).map(|_| point(1.0, 1.0)).collect();
    emitters.extend((0..100).map(|i| point(2f32.powi(-i), 1e-3)));
    emitters.extend([
        point(2.0, 0.0),
        point(f32::NAN, 1.0),
        point(3.0, f32::INFINITY),
        point(3.0, f32::NAN),
        point(1e18, 1e30),
        point(4.0, -2.0),
    ]);
    let tree = LightTree::new(emitters);
    let at_first = Receiver { point: Vec3::X, normal: None };
    let sum: f64 = (0..tree.len()).map(|i| f64::from(tree.pmf(&at_first, i))).sum();
    assert!((sum - 1.0).abs() < 1e-4, "{sum}");
    for dark in [150, 151, 152, 153, 155] {
        assert_eq!(tree.pmf(&at_first, dark), 0.0);
    }
    for u in [0.0, 0.3, 1.0 - f64::EPSILON / 2.0] {
        assert!(tree.sample(&at_first, u).is_some_and(|choice| choice.pmf > 0.0));
    }
}

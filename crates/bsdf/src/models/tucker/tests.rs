use super::*;
use crate::models::factored::testing::{SMALL, assert_sampled, random};
use crate::models::testing::{assert_finite, extreme_pair};
use crate::models::{Reflectance, V3, find};
use std::f64::consts::{FRAC_1_PI, FRAC_PI_2};

/// Of numbers of both signs, the more negative the lower `low`.
fn factors(grid: Grid, rank: usize, low: f32) -> Factors {
    let (nodes, ranks) = (nodes(grid), ranks(grid, rank));
    let pass = |seed: u64| Pass {
        functions: std::array::from_fn(|mode| random(nodes[mode] * ranks[mode], low, 10 * seed + mode as u64)),
        core: random(ranks.iter().product(), low, 10 * seed + 9),
    };
    Factors { grid, diffuse: random(grid.channels, 0.1, 5), rank, passes: (0..2).map(pass).collect() }
}

/// Every index of the core by hand, at nodes.
#[test]
fn the_value_is_the_core_times_the_functions() {
    let grid = SMALL[1];
    let factors = factors(grid, 2, -0.3);
    let (theta_o, phi_o, k, j) = (2, 4, 3, 5);
    let wo = DVec3::from(V3::from_angles(FRAC_PI_2 * 0.995 * 0.5, 240_f64.to_radians()));
    // Anisotropic: φ_h from the tangent.
    let h = DVec3::from(V3::from_angles((3.0_f64 / 8.0).powi(2) * FRAC_PI_2, 225_f64.to_radians()));
    let wi = 2.0 * h.dot(wo) * h - wo;
    let expected = |factors: &Factors, channel: usize| {
        let at = [channel, theta_o, phi_o, k, j];
        let mut q = 0.0;
        for pass in &factors.passes {
            for (i, g) in pass.core.iter().enumerate() {
                let term = [i / 16, i / 8 % 2, i / 4 % 2, i / 2 % 2, i % 2];
                let value = |mode: usize| f64::from(pass.functions[mode][term[mode] * nodes(grid)[mode] + at[mode]]);
                q += f64::from(*g) * (0..MODES).map(value).product::<f64>();
            }
        }
        (f64::from(factors.diffuse[channel]) * FRAC_1_PI + q / (4.0 * h.dot(wo) * wi.z)).max(0.0)
    };
    let value = factors.clone().into_model().value(wi, wo);
    for channel in 0..3 {
        assert!((value[channel] - expected(&factors, channel)).abs() < 1e-6 * value[channel], "{value} {}", expected(&factors, channel));
    }
    let mut fault = factors;
    fault.passes[1].core.swap(3, 5);
    assert!((value.x - expected(&fault, 0)).abs() > 1e-6 * value.x, "planted fault");
}

#[test]
fn samples_follow_density_and_value_whatever_the_signs() {
    for (grid, low) in SMALL.into_iter().zip([0.0, -0.7]) {
        assert_sampled(&factors(grid, 2, low).into_model());
    }
}

#[test]
fn a_file_that_is_written_and_read_is_the_same() {
    for grid in SMALL {
        for rank in [1, 3] {
            let factors = factors(grid, rank, -1.0);
            let bytes = factors.to_bytes();
            assert_eq!(Factors::from_bytes(&bytes).unwrap(), factors);
            assert!(bytes.len() < 4 * factors.numbers() + 200 && bytes.len() > 4 * factors.numbers());
        }
    }
}

#[test]
fn absurd_numbers_stay_finite() {
    let mut absurd = factors(SMALL[0], 2, -0.7);
    for pass in &mut absurd.passes {
        pass.functions.iter_mut().chain([&mut pass.core]).flatten().for_each(|v| *v *= 1e30);
    }
    let model = Factors::from_bytes(&absurd.to_bytes()).unwrap().into_model();
    let mut rng = kajo_sampling::Rng::new(4);
    for k in 0..5_000 {
        let (wi, wo) = extreme_pair(&mut rng, k);
        assert_finite(&model, wi, wo);
    }
}

/// A cosine lobe of negative weight would have no density.
#[test]
fn a_negative_diffuse_part_is_refused() {
    let mut negative = factors(SMALL[0], 2, -0.7);
    negative.diffuse[0] = -0.1;
    assert!(Factors::from_bytes(&negative.to_bytes()).unwrap_err().contains("none may be negative"));
}

/// 800 kB that would become 24 GB of weights.
#[test]
fn few_numbers_that_announce_many_weights_are_refused() {
    let grid = Grid { theta_o: 4000, phi_o: 4000, ..SMALL[1] };
    assert!(check_size(SMALL[1], 8, 100).is_ok());
    let error = Factors::from_bytes(&factors(grid, 8, 0.0).to_bytes()).unwrap_err();
    assert!(error.starts_with("2 passes of rank 8 are 128 terms for 16000000 viewers"), "{error}");
}

#[test]
fn a_model_is_made_from_a_file() {
    let entry = find("tucker").unwrap();
    let problem = |pairs: &[(&str, &str)]| entry.from_pairs(pairs, Form::Corrected).err().map(|e| e.to_string()).unwrap_or_default();
    assert!(problem(&[]).contains("`file` is not given"));
    let path = std::env::temp_dir().join(format!("kajo-tucker-{}", std::process::id()));
    let file = path.to_str().unwrap();
    let factors = factors(SMALL[0], 2, -0.2);
    std::fs::write(file, factors.to_bytes()).unwrap();
    let made = entry.from_pairs(&[("file", file)], Form::Corrected);
    std::fs::write(file, &factors.to_bytes()[..300]).unwrap();
    let cut = problem(&[("file", file)]);
    std::fs::remove_file(&path).unwrap();
    let (wi, wo) = (DVec3::from(V3::from_angles(0.4, 1.0)), DVec3::from(V3::from_angles(1.0, 3.0)));
    assert_eq!(made.unwrap().value(wi, wo), factors.into_model().value(wi, wo));
    assert!(cut.starts_with(&format!("`{file}`: has ")) && cut.contains("bytes of numbers"), "{cut}");
}

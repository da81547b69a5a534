use super::*;
use crate::models::factored::testing::{SMALL, assert_sampled, random};
use crate::models::{Reflectance, V3, find};
use std::f64::consts::{FRAC_1_PI, FRAC_PI_2};

fn factors(grid: Grid) -> Factors {
    let (outer, inner) = (3, 2);
    Factors {
        grid,
        diffuse: random(grid.channels, 0.0, 1),
        outer,
        inner,
        views: random(outer * grid.viewers() * grid.channels, 0.0, 2),
        inclinations: random(outer * inner * grid.theta_h, 0.0, 3),
        azimuths: random(outer * inner * grid.phi_h, 0.0, 4),
    }
}

/// One term, by hand: k_d/π + F u v/(4 (h·o) cos θ_i).
#[test]
fn the_value_is_the_product_of_the_factors() {
    let grid = SMALL[0];
    let mut one = Factors { outer: 1, inner: 1, ..factors(grid) };
    one.views.truncate(grid.viewers());
    one.inclinations.truncate(grid.theta_h);
    one.azimuths.truncate(grid.phi_h);
    // The third node of θ_o, θ_h = (3/8)² 90°, φ_h − φ_o = 225°: fifth node.
    let (viewer, k, j) = (2, 3, 5);
    let theta_o = FRAC_PI_2 * 0.995 * viewer as f64 / 4.0;
    let expected = |factors: &Factors, cos_beta: f64, cos_i: f64| {
        let q = f64::from(factors.views[viewer]) * f64::from(factors.inclinations[k]) * f64::from(factors.azimuths[j]);
        f64::from(factors.diffuse[0]) * FRAC_1_PI + q / (4.0 * cos_beta * cos_i)
    };
    for turn in [0.0, 2.0] {
        let wo = DVec3::from(V3::from_angles(theta_o, turn));
        let h = DVec3::from(V3::from_angles((3.0_f64 / 8.0).powi(2) * FRAC_PI_2, turn + 225_f64.to_radians()));
        let wi = 2.0 * h.dot(wo) * h - wo;
        let value = one.clone().into_model().value(wi, wo).x;
        assert!((value - expected(&one, h.dot(wo), wi.z)).abs() < 1e-6 * value, "{value}");
        let mut fault = one.clone();
        fault.azimuths[j] *= 1.001;
        assert!((value - expected(&fault, h.dot(wo), wi.z)).abs() > 1e-6 * value, "planted fault");
    }
}

#[test]
fn samples_follow_density_and_value() {
    for grid in SMALL {
        assert_sampled(&factors(grid).into_model());
    }
}

#[test]
fn black_factors_reflect_nothing() {
    let mut black = factors(SMALL[0]);
    black.views.fill(0.0);
    black.diffuse.fill(0.0);
    let model = black.into_model();
    let wo = DVec3::new(0.6, 0.0, 0.8);
    assert_eq!(model.value(DVec3::Z, wo), DVec3::ZERO);
    assert!(model.pdf(DVec3::Z, wo) > 0.0 && model.sample(wo, [0.5; 3]).is_some());
}

#[test]
fn a_file_that_is_written_and_read_is_the_same() {
    for grid in SMALL {
        let factors = factors(grid);
        let bytes = factors.to_bytes();
        assert_eq!(Factors::from_bytes(&bytes).unwrap(), factors);
        assert!(bytes.len() < 4 * factors.numbers() + 200);
        let mut negative = factors;
        negative.azimuths[3] = -1.0;
        assert!(Factors::from_bytes(&negative.to_bytes()).unwrap_err().contains("none may be negative"));
    }
}

#[test]
fn a_model_is_made_from_a_file() {
    let entry = find("nmf").unwrap();
    let problem = |pairs: &[(&str, &str)]| entry.from_pairs(pairs, Form::Corrected).err().map(|e| e.to_string()).unwrap_or_default();
    assert!(problem(&[]).contains("`file` is not given"));
    assert!(problem(&[("file", "/nowhere/at/all")]).starts_with("`/nowhere/at/all`: cannot be read"));
    let path = std::env::temp_dir().join(format!("kajo-nmf-{}", std::process::id()));
    let file = path.to_str().unwrap();
    let factors = factors(SMALL[1]);
    std::fs::write(file, factors.to_bytes()).unwrap();
    let made = entry.from_pairs(&[("path", file)], Form::Corrected);
    let other = find("tucker").unwrap().from_pairs(&[("file", file)], Form::Corrected).err().map(|e| e.to_string()).unwrap_or_default();
    std::fs::remove_file(&path).unwrap();
    let (wi, wo) = (DVec3::from(V3::from_angles(0.4, 1.0)), DVec3::from(V3::from_angles(1.0, 3.0)));
    assert_eq!(made.unwrap().value(wi, wo), factors.into_model().value(wi, wo));
    assert!(other.contains("begins with \"kajo-nmf 1\", not with \"kajo-tucker 1\""), "{other}");
}

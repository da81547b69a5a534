use crate::models::testing::*;
use crate::models::{Form, Hemisphere, V3};
use std::f64::consts::{FRAC_1_PI, PI};

/// The paper's equations by angles, apart from the model's code.
fn by_angles([theta_i, phi_i, theta_r, phi_r]: [f64; 4], rho: f64, sigma: f64, full: bool) -> f64 {
    let [ti, tr, dphi, s] = [theta_i, theta_r, phi_r - phi_i, sigma].map(f64::to_radians);
    let (alpha, beta, s2, cos) = (ti.max(tr), ti.min(tr), s * s, dphi.cos());
    let a = 1.0 - 0.5 * s2 / (s2 + 0.33);
    let b = 0.45 * s2 / (s2 + 0.09);
    if !full {
        return rho * FRAC_1_PI * (a + b * cos.max(0.0) * alpha.sin() * beta.tan());
    }
    let c2 = if cos >= 0.0 { b * alpha.sin() } else { b * (alpha.sin() - (2.0 * beta / PI).powi(3)) };
    let c3 = 0.125 * s2 / (s2 + 0.09) * (4.0 * alpha * beta / (PI * PI)).powi(2);
    let first = rho * FRAC_1_PI * (a + cos * c2 * beta.tan() + (1.0 - cos.abs()) * c3 * ((alpha + beta) / 2.0).tan());
    first + 0.17 * rho * rho * FRAC_1_PI * s2 / (s2 + 0.13) * (1.0 - cos * (2.0 * beta / PI).powi(2))
}

#[test]
fn both_forms_are_the_papers_equations() {
    for (terms, full) in [("qualitative", false), ("full", true)] {
        for sigma in [10.0, 35.0] {
            let golden = SETS.map(|(_, angles)| by_angles(angles, 0.7, sigma, full));
            assert_golden("oren-nayar", &[("kd", "0.7"), ("sigma", &sigma.to_string()), ("terms", terms)], Form::Corrected, golden, 1e-9);
        }
    }
}

#[test]
fn a_smooth_surface_is_lambertian() {
    for terms in ["qualitative", "full"] {
        let smooth = model("oren-nayar", &[("kd", "0.8"), ("sigma", "0"), ("terms", terms)], Form::Corrected);
        for (_, angles) in SETS {
            let (wi, wo) = directions(angles);
            assert!((smooth.value(wi, wo).x - 0.8 * FRAC_1_PI).abs() < 1e-15);
        }
    }
}

/// Back towards the light a rough surface is brighter than in the forward direction; Lambert is not.
#[test]
fn rough_surfaces_reflect_back() {
    for terms in ["qualitative", "full"] {
        let rough = model("oren-nayar", &[("kd", "0.8"), ("sigma", "30"), ("terms", terms)], Form::Corrected);
        let at = |angles| {
            let (wi, wo) = directions(angles);
            rough.value(wi, wo).x
        };
        assert!(at([60.0, 0.0, 60.0, 0.0]) > 1.5 * at([60.0, 0.0, 60.0, 180.0]), "{terms}");
    }
}

/// Row BR-5.
#[test]
fn oren_nayar_is_reciprocal_and_sampled_without_bias() {
    for terms in ["qualitative", "full"] {
        let pairs = [("kd", "0.8"), ("sigma", "30"), ("terms", terms)];
        let rough = model("oren-nayar", &pairs, Form::Corrected);
        assert!(asymmetry(|a, b| rough.value(a, b).x, 20_000) < 1e-9);
        assert_sampled_albedo("oren-nayar", &pairs, 20_000);
    }
}

/// Row BR-6: what doc.md says of energy. Towards grazing the qualitative form tends to ρ (A + B/2).
#[test]
fn energy_is_kept_up_to_the_excess_that_the_document_states() {
    let nodes = Hemisphere::new(200, 128);
    let worst = |terms: &str, kd: &str| {
        let mut worst: f64 = 0.0;
        for sigma in ["5", "12", "18", "40", "90"] {
            let rough = model("oren-nayar", &[("kd", kd), ("sigma", sigma), ("terms", terms)], Form::Corrected);
            for theta in [0.0_f64, 60.0, 85.0, 89.9] {
                worst = worst.max(nodes.albedo(&*rough, V3::from_angles(theta.to_radians(), 0.0).into()).x);
            }
        }
        worst
    };
    let found = worst("qualitative", "1");
    assert!(found > 1.01 && found < 1.0152, "{found}");
    let found = worst("full", "1");
    assert!(found > 1.04 && found < 1.051, "{found}");
    assert!(worst("full", "0.95") < 1.0);
}

/// Row BR-41.
#[test]
fn oren_nayar_is_robust() {
    assert_robust("oren-nayar", &[&[("sigma", "0")], &[("sigma", "90")], &[("sigma", "40"), ("terms", "full")]]);
}

//! Rows L-04 to L-06: albedo, reciprocity and energy of the models that every text begins with.

use super::testing::{albedo, asymmetry, model};
use super::{Form, Hemisphere, Reflectance};
use glam::DVec3;
use std::sync::Arc;

fn of(id: &str, pairs: &[(&str, &str)]) -> Arc<dyn Reflectance> {
    model(id, pairs, Form::Corrected)
}

/// Row L-04.
#[test]
fn lambert_albedo_is_rho() {
    for rho in ["0", "0.18", "0.5", "1"] {
        let found = albedo(&*of("lambert", &[("kd", rho)]), 40.0, 0.0);
        assert!((found - rho.parse::<f64>().unwrap()).abs() < 1e-9, "{rho}: {found}");
    }
}

/// Row L-05.
#[test]
fn lambert_blinn_phong_and_ggx_are_reciprocal() {
    let worst = |id: &str, pairs: &[(&str, &str)]| {
        let model = of(id, pairs);
        asymmetry(|a, b| model.value(a, b).x, 10_000)
    };
    assert_eq!(worst("lambert", &[("kd", "0.7")]), 0.0);
    assert!(worst("blinn-phong", &[("kd", "0"), ("ks", "1"), ("n", "50")]) < 1e-5);
    for alpha in ["0.1", "0.5", "1"] {
        let found = worst("ggx", &[("alpha", alpha), ("f0", "0.04")]);
        assert!(found < 1e-5, "alpha {alpha}: {found}");
    }
    let phong = of("phong-bsf", &[("kd", "0"), ("ks", "1"), ("n", "5")]);
    let fault = asymmetry(|a, b| phong.f_cos(a, b).x / a.z.max(1e-3), 10_000);
    assert!(fault > 0.5, "planted fault, Phong over the cosine of the light: {fault}");
}

/// Row L-06.
#[test]
fn energy_is_conserved_but_not_by_unnormalised_phong() {
    let bright = [
        of("lambert", &[("kd", "1")]),
        of("phong", &[("kd", "0"), ("ks", "1"), ("n", "20")]),
        of("blinn-phong", &[("kd", "0"), ("ks", "1"), ("n", "20")]),
        of("ggx", &[("alpha", "0.1"), ("f0", "1")]),
        of("ggx", &[("alpha", "0.5"), ("f0", "1")]),
        of("ggx", &[("alpha", "1"), ("f0", "1")]),
    ];
    for (index, model) in bright.iter().enumerate() {
        for degrees in [0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0, 85.0] {
            let found = albedo(&**model, degrees, 0.0);
            assert!(found <= 1.0 + 1e-3, "model {index}, {degrees}°: {found}");
        }
    }
    // cosⁿα as a BRDF reflects 2π/(n + 2) at normal incidence.
    let highlight = of("phong-bsf", &[("kd", "0"), ("ks", "1"), ("n", "2")]);
    let unnormalised: f64 = Hemisphere::fine().integrate(|wi| highlight.value(wi, DVec3::Z).x * wi.z);
    assert!((unnormalised - 1.571).abs() < 1e-3, "n = 2: {unnormalised}");
}

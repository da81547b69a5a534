use crate::models::testing::*;
use crate::models::{Form, Lobe, V3};

const SET: [(&str, &str); 4] = [("rs", "0.4"), ("rd", "0.4"), ("nx", "10"), ("ny", "100")];

/// Row BR-26.
#[test]
fn ashikhmin_shirley_equals_its_golden_values() {
    let golden = [0.799_754_437_5, 0.062_927_717_12, 0.044_923_678_17, 0.078_097_900_58, 5.408_332_457];
    assert_golden("ashikhmin-shirley", &SET, Form::Corrected, golden, 1e-9);
}

/// Row BR-26.
#[test]
fn ashikhmin_shirley_reflects_what_the_furnace_table_says() {
    for (rs, rd, nx, ny, table) in [
        ("1", "0", "10", "10", [0.696, 0.688, 0.613, 0.559, 0.520]),
        ("1", "0", "100", "100", [0.961, 0.934, 0.846, 0.725, 0.583]),
        ("0.05", "1", "100", "100", [0.968, 0.941, 0.794, 0.641, 0.475]),
        ("0.4", "0.4", "10", "100", [0.5616, 0.5427, 0.4571, 0.3896, 0.3393]),
    ] {
        let model = model("ashikhmin-shirley", &[("rs", rs), ("rd", rd), ("nx", nx), ("ny", ny)], Form::Corrected);
        // The table has three digits, or four.
        let tolerance = 2e-4 + if rs == "0.4" { 5e-5 } else { 5e-4 };
        for (theta, expected) in [0.0, 30.0, 60.0, 75.0, 85.0].into_iter().zip(table) {
            let quadrature = albedo(&*model, theta, 0.0);
            assert!((quadrature - expected).abs() < tolerance, "{rs}/{rd}, n {nx}/{ny}, {theta}°: {quadrature}, table {expected}");
        }
    }
}

/// Row BR-26: without a specular layer only its Fresnel growth is left beside f_d, so f_d is what f(R_d = 1) − f(R_d = 0) is.
#[test]
fn the_diffuse_part_is_exactly_nothing_without_reflectance_and_else_as_tabled() {
    let make = |rd| model("ashikhmin-shirley", &[("rs", "0"), ("rd", rd), ("n", "100")], Form::Corrected);
    let (with, without) = (make("1"), make("0"));
    let (wi, wo) = directions(SETS[2].1);
    let h = (wi + wo).normalize();
    let specular = 101.0 / (8.0 * std::f64::consts::PI) * h.z.powi(100) / (h.dot(wo) * wi.z.max(wo.z)) * (1.0 - h.dot(wo)).powi(5);
    assert!((without.value(wi, wo).x / specular - 1.0).abs() < 1e-12, "nothing but the highlight");
    let glancing = model("ashikhmin-shirley", &[("rs", "0"), ("rd", "0"), ("n", "1e6")], Form::Corrected);
    assert_eq!(glancing.value(wi, wo).x, 0.0);
    for (theta, expected) in [(0.0, 0.9687), (30.0, 0.9414), (60.0, 0.7627), (75.0, 0.4999), (85.0, 0.1997)] {
        let diffuse = albedo(&*with, theta, 0.0) - albedo(&*without, theta, 0.0);
        assert!((diffuse - expected).abs() < 2e-4, "{theta}°: {diffuse}");
    }
}

/// Row BR-26.
#[test]
fn the_half_vector_density_integrates_to_one_at_normal_incidence() {
    let lobe = Lobe::HalfPower { nx: 10.0, ny: 100.0 };
    let (whole, _) = masses(|wi| lobe.pdf(wi, V3::new(0.0, 0.0, 1.0)));
    assert!((whole - 1.0).abs() < 1e-6, "{whole}");
}

/// Row BR-26.
#[test]
fn ashikhmin_shirleys_samples_give_its_albedo_and_follow_its_density() {
    let model = model("ashikhmin-shirley", &SET, Form::Corrected);
    for (theta, phi) in [(0.0, 0.0), (45.0, 20.0), (75.0, 90.0)] {
        let quadrature = albedo(&*model, theta, phi);
        let (mean, error) = sampled_albedo(&*model, theta, phi, 300_000);
        assert!((mean - quadrature).abs() < 3.0 * error, "{theta}°: sampled {mean} ± {error}, quadrature {quadrature}");
    }
    assert_samples_follow(&*model, 45.0, 20.0);
    assert_samples_follow(&*model, 75.0, 90.0);
}

#[test]
fn ashikhmin_shirley_is_reciprocal_and_conserves_energy_with_its_narrowest_lobe() {
    let model = |n| model("ashikhmin-shirley", &[("rs", "0.9"), ("rd", "1"), ("n", n)], Form::Corrected);
    assert!(asymmetry(|a, b| model("100").value(a, b).x, 20_000) < 1e-11);
    for theta in [0.0, 60.0, 85.0] {
        let (mean, error) = sampled_albedo(&*model("10000"), theta, 0.0, 50_000);
        assert!(mean < 1.0 + 3.0 * error && mean > 0.7, "{theta}°: {mean} ± {error}");
    }
}

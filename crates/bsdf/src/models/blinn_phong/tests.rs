use crate::models::testing::*;
use crate::models::{Form, find};

const SET: [(&str, &str); 3] = [("kd", "0.4"), ("ks", "0.4"), ("n", "50")];

/// Row BR-11.
#[test]
fn blinn_phong_equals_its_golden_values() {
    let bsf = [0.676_986_140_1, 0.200_405_161_7, 0.393_925_317_9, 0.257_115_044_0, 0.536_808_057_3];
    assert_golden("blinn-phong-bsf", &SET, Form::Corrected, bsf, 1e-9);
    let printed = [2.863_189_609, 0.130_677_095_6, 0.127_342_299_6, 0.127_323_955_3, 3.437_746_771];
    assert_golden("blinn-phong", &SET, Form::Printed, printed, 1e-9);
    let corrected = [0.866_007_680_9, 0.128_229_302_6, 0.127_328_907_7, 0.127_323_954_7, 1.021_138_114];
    assert_golden("blinn-phong", &SET, Form::Corrected, corrected, 1e-9);
}

/// Row BR-11.
#[test]
fn the_corrected_highlight_reflects_ks_at_normal_incidence_and_the_printed_one_up_to_four_times_that() {
    for n in [1.0_f64, 5.0, 10.0, 50.0, 200.0] {
        let pairs = [("kd", "0"), ("ks", "1"), ("n", &*n.to_string())];
        let corrected = furnace(&*model("blinn-phong", &pairs, Form::Corrected), 0.0);
        assert!((corrected - 1.0).abs() < 1e-6, "{n}: {corrected}");
        let expected = 4.0 * (n + (-0.5 * n).exp2()) / (n + 4.0);
        let printed = furnace(&*model("blinn-phong", &pairs, Form::Printed), 0.0);
        assert!((printed - expected).abs() < 1e-6, "{n}: {printed} for {expected}");
    }
}

/// Row BR-11.
#[test]
fn the_corrected_highlight_darkens_towards_grazing_angles() {
    let blinn = model("blinn-phong", &[("kd", "0"), ("ks", "1"), ("n", "50")], Form::Corrected);
    for (theta, expected) in [(0.0, 1.0), (30.0, 0.760), (60.0, 0.281), (75.0, 0.105), (85.0, 0.039)] {
        let found = furnace(&*blinn, theta);
        assert!((found - expected).abs() < 6e-4, "{theta}°: {found}");
    }
}

/// Row BR-5.
#[test]
fn the_brdf_is_reciprocal_and_keeps_to_its_limit() {
    for form in [Form::Corrected, Form::Printed] {
        let blinn = model("blinn-phong", &SET, form);
        assert!(asymmetry(|a, b| blinn.value(a, b).x, 20_000) < 1e-12);
    }
    let bsf = model("blinn-phong-bsf", &SET, Form::Corrected);
    assert!(asymmetry(|a, b| bsf.f_cos(a, b).x / a.z, 20_000) > 0.5);
    assert!(find("blinn-phong").unwrap().from_pairs(&[("kd", "0.7"), ("ks", "0.4")], Form::Corrected).is_err());
}

#[test]
fn every_highlight_is_sampled_without_bias() {
    assert_sampled_albedo("blinn-phong", &SET, 50_000);
    for highlight in ["phong", "trowbridge-reitz", "table", "gaussian", "polynomial", "schlick"] {
        let pairs = [("kd", "0.1"), ("ks", "0.8"), ("n", "50"), ("highlight", highlight)];
        assert_sampled_albedo("blinn-phong-bsf", &pairs, 50_000);
        assert_sampled_albedo("phong-bsf", &pairs, 50_000);
    }
    assert_sampled_albedo("schlick-phong-bsf", &[("kd", "0.1"), ("ks", "0.8")], 50_000);
}

/// Row BR-41.
#[test]
fn blinn_phong_is_robust() {
    assert_robust("blinn-phong", &[&[("n", "0")], &[("n", "10000")], &[("kd", "0"), ("n", "50")]]);
    let sets: Vec<_> = ["phong", "trowbridge-reitz", "table", "gaussian", "polynomial", "schlick"]
        .into_iter()
        .flat_map(|highlight| ["0", "1", "10000"].map(|n| [("kd", "0"), ("n", n), ("highlight", highlight)]))
        .collect();
    let sets: Vec<&[(&str, &str)]> = sets.iter().map(|set| &set[..]).collect();
    assert_robust("blinn-phong-bsf", &sets);
    assert_robust("phong-bsf", &sets);
}

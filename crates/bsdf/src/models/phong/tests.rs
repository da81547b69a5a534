use crate::models::testing::*;
use crate::models::{Form, find};

const SET: [(&str, &str); 3] = [("kd", "0.4"), ("ks", "0.4"), ("n", "50")];

/// Row BR-10.
#[test]
fn phong_equals_its_golden_values() {
    let bsf = [0.532_461_560_4, 0.200_000_187_6, 0.393_923_101_2, 0.257_115_043_9, 0.536_808_057_3];
    assert_golden("phong-bsf", &SET, Form::Corrected, bsf, 1e-9);
    let brdf = [1.667_095_944, 0.127_325_507_3, 0.127_323_954_5, 0.127_323_954_5, 3.437_746_771];
    assert_golden("phong", &SET, Form::Corrected, brdf, 1e-9);
}

/// Row BR-10.
#[test]
fn phong_reflects_ks_at_normal_incidence_and_darkens() {
    let phong = model("phong", &[("kd", "0"), ("ks", "1"), ("n", "50")], Form::Corrected);
    for (theta, expected) in [(0.0, 1.0), (30.0, 0.8660), (60.0, 0.5), (75.0, 0.2605), (85.0, 0.1101)] {
        let quadrature = albedo(&*phong, theta, 0.0);
        assert!((quadrature - expected).abs() < 2e-4, "{theta}°: {quadrature}");
        let (mean, error) = sampled_albedo(&*phong, theta, 0.0, 100_000);
        assert!((mean - quadrature).abs() < 4.0 * error + 1e-6, "{theta}°: sampled {mean} ± {error}, quadrature {quadrature}");
    }
}

/// Row BR-10.
#[test]
fn more_light_than_arrives_is_refused() {
    let error = find("phong").unwrap().from_pairs(&[("kd", "0.6"), ("ks", "0.6")], Form::Corrected).err().unwrap().to_string();
    assert!(error.contains("kd + ks is 1.2"), "{error}");
    assert!(find("phong-bsf").unwrap().from_pairs(&[("kd", "0.6"), ("ks", "0.6")], Form::Corrected).is_ok());
}

/// Row BR-5.
#[test]
fn the_brdf_is_reciprocal_and_the_shading_function_is_not() {
    let brdf = model("phong", &SET, Form::Corrected);
    assert!(asymmetry(|a, b| brdf.value(a, b).x, 20_000) < 1e-9);
    let bsf = model("phong-bsf", &[("kd", "0.4"), ("ks", "0.4"), ("n", "5")], Form::Corrected);
    assert!(asymmetry(|a, b| bsf.f_cos(a, b).x / a.z, 20_000) > 0.5);
}

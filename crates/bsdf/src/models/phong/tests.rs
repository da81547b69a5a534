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
    let schlick = [0.572_229_103_1, 0.222_323_438_6, 0.396_641_132_2, 0.257_115_043_9, 0.536_808_057_3];
    assert_golden("schlick-phong-bsf", &SET, Form::Corrected, schlick, 1e-9);
    let chosen = [&SET[..], &[("highlight", "schlick")]].concat();
    assert_golden("phong-bsf", &chosen, Form::Corrected, schlick, 1e-9);
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

/// Row BR-12: by name, and the printed forms of two of them.
#[test]
fn highlights_are_exchanged_by_name() {
    let (wi, wo) = directions(SETS[0].1);
    let cos_alpha = (2.0 * wi.z * wo.z - wi.dot(wo)).min(1.0);
    let at = |highlight: &str, form: Form| {
        model("phong-bsf", &[("kd", "0"), ("ks", "1"), ("n", "50"), ("c", "0.5"), ("highlight", highlight)], form).value(wi, wo).x
    };
    let power = cos_alpha.powi(50);
    for (highlight, tolerance) in [("phong", 1e-12), ("table", 1e-3), ("polynomial", 2e-4)] {
        assert!((at(highlight, Form::Corrected) - power).abs() < tolerance, "{highlight}");
    }
    let width = cos_alpha * cos_alpha * (0.25 - 1.0) + 1.0;
    assert!((at("trowbridge-reitz", Form::Corrected) - (0.25 / width).powi(2)).abs() < 1e-12);
    assert!((at("trowbridge-reitz", Form::Printed) - (0.125 / width).powi(2)).abs() < 1e-12);
    let exponent = (cos_alpha.acos() * 0.5).powi(2);
    assert!((at("gaussian", Form::Corrected) - (-exponent).exp()).abs() < 1e-12);
    assert!((at("gaussian", Form::Printed) - exponent.exp()).abs() < 1e-12);
    let broad = [("highlight", "trowbridge-reitz"), ("c", "1.5")];
    let error = find("phong-bsf").unwrap().from_pairs(&broad, Form::Corrected).err().unwrap().to_string();
    assert!(error.contains("c is 1.5"), "{error}");
}

/// Row BR-10: the shading function exceeds 1 where its parameters are bright, at the mirror direction of a light at the zenith.
#[test]
fn the_shading_function_exceeds_one() {
    let bright = model("phong-bsf", &[("kd", "0.6"), ("ks", "0.6"), ("n", "5")], Form::Corrected);
    assert!((bright.value(glam::DVec3::Z, glam::DVec3::Z).x - 1.2).abs() < 1e-12);
}

/// Row BR-41.
#[test]
fn phong_is_robust() {
    assert_robust("phong", &[&[("n", "0"), ("kd", "0")], &[("n", "10000")], &[("kd", "0"), ("n", "50")]]);
    assert_robust("schlick-phong-bsf", &[&[("n", "1"), ("kd", "0")], &[("n", "10000"), ("kd", "0")]]);
}

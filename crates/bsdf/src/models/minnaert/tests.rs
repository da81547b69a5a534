use crate::models::Form;
use crate::models::testing::*;

/// Row BR-27.
#[test]
fn minnaert_equals_its_golden_values() {
    let golden = [0.161_214_135_6, 0.103_770_140_5, 0.082_527_232_74, 0.115_730_650_9, 0.047_843_865_26];
    assert_golden("minnaert", &[("kd", "0.5"), ("n", "0.7")], Form::Corrected, golden, 1e-9);
}

/// Row BR-27: reciprocal, albedo k_d cosⁿθ, Lambert for n = 0.
#[test]
fn minnaert_reflects_kd_times_a_power_of_the_cosine() {
    let pairs = [("kd", "0.5"), ("n", "0.7")];
    let minnaert = model("minnaert", &pairs, Form::Corrected);
    assert!(asymmetry(|a, b| minnaert.value(a, b).x, 20_000) < 1e-12);
    for theta in [0.0_f64, 30.0, 60.0, 85.0] {
        let expected = 0.5 * theta.to_radians().cos().powf(0.7);
        assert!((furnace(&*minnaert, theta) - expected).abs() < 1e-9, "{theta}°");
    }
    assert_sampled_albedo("minnaert", &pairs, 20_000);
    let (wi, wo) = directions(SETS[1].1);
    let flat = model("minnaert", &[("kd", "0.8"), ("n", "0")], Form::Corrected);
    assert_eq!(flat.value(wi, wo), model("lambert", &[("kd", "0.8")], Form::Corrected).value(wi, wo));
}

/// Row BR-40: with the x components the value at normal incidence is 0, which no diffuse surface is.
#[test]
fn the_printed_form_is_no_diffuse_lobe() {
    let printed = model("minnaert", &[("kd", "0.5"), ("n", "0.7")], Form::Printed);
    assert_eq!(printed.value(glam::DVec3::Z, glam::DVec3::Z).x, 0.0);
    let (wi, wo) = directions(SETS[3].1);
    let expected = 0.5 * 2.7 / std::f64::consts::TAU * (wi.x * wo.x).powf(0.7);
    assert!((printed.value(wi, wo).x - expected).abs() < 1e-12);
    let (mean, error) = sampled_albedo(&*printed, 50.0, 0.0, 50_000);
    let quadrature = albedo(&*printed, 50.0, 0.0);
    assert!((mean - quadrature).abs() < 4.0 * error + 1e-5, "sampled {mean} ± {error}, quadrature {quadrature}");
}

/// Row BR-41.
#[test]
fn minnaert_is_robust() {
    assert_robust("minnaert", &[&[("n", "0")], &[("n", "0.7")], &[("n", "10000")]]);
}

use crate::models::testing::*;
use crate::models::{Form, find};
use kajo_params::ParamType;

const PERFECT: [(&str, &str); 4] = [("kd", "0"), ("ks", "1"), ("m", "0.2"), ("fresnel", "none")];

#[test]
fn with_beckmanns_facets_it_is_cook_torrance() {
    let shared = [("kd", "0.4"), ("ks", "0.4"), ("m", "0.2"), ("eta", "1.5"), ("distribution", "beckmann")];
    let golden = [0.170_632_818_3, 0.127_395_859_2, 0.127_323_986_8, 0.127_323_954_5, 1.290_889_605];
    assert_golden("torrance-sparrow", &shared, Form::Corrected, golden, 1e-9);
}

/// Row BR-6.
#[test]
fn gaussian_facets_keep_energy() {
    let model = model("torrance-sparrow", &PERFECT, Form::Corrected);
    for theta in [0.0, 60.0, 85.0] {
        let quadrature = albedo(&*model, theta, 0.0);
        assert!(theta > 0.0 || (quadrature - 1.0).abs() < 1e-3, "c normalises the Gaussian: {quadrature}");
        assert!(quadrature <= 1.0 + 2e-4 && quadrature > 0.9, "{theta}°: {quadrature}");
        let (mean, error) = sampled_albedo(&*model, theta, 0.0, 20_000);
        assert!((mean - quadrature).abs() < 4.0 * error + 1e-6, "{theta}°: sampled {mean} ± {error}, quadrature {quadrature}");
    }
}

/// The two discoveries of the paper.
#[test]
fn reflectance_grows_and_the_peak_leaves_the_mirror_direction() {
    let model = model("torrance-sparrow", &[("kd", "0"), ("ks", "1"), ("m", "0.2"), ("eta", "1.5")], Form::Corrected);
    let value = |theta_i: f64, theta_r: f64| {
        let (wi, wo) = directions([theta_i, 0.0, theta_r, 180.0]);
        model.value(wi, wo).x
    };
    assert!(value(45.0, 50.0) > value(45.0, 45.0));
    assert!(value(75.0, 75.0) > 5.0 * value(30.0, 30.0));
}

#[test]
fn every_combination_of_parts_is_reciprocal_and_finite() {
    let mut rng = kajo_sampling::Rng::new(5);
    let params = find("torrance-sparrow").unwrap().params;
    let names = |name| match params.iter().find(|spec| spec.name == name).unwrap().kind {
        kajo_params::ParamKind::Choice { names } => names,
        other => panic!("{other:?}"),
    };
    assert_eq!(names("masking"), crate::models::blocks::masking::Masking::TYPE.choices());
    for distribution in names("distribution") {
        for masking in names("masking") {
            for m in ["0.001", "0.2", "1.5"] {
                let model = model("torrance-sparrow", &[("m", m), ("distribution", distribution), ("masking", masking)], Form::Corrected);
                let worst = asymmetry(|a, b| model.value(a, b).x, 300);
                assert!(worst < 1e-7, "{distribution}, {masking}, {m}: {worst}");
                for k in 0..200 {
                    let (wi, wo) = extreme_pair(&mut rng, k);
                    assert_finite(&*model, wi, wo);
                }
            }
        }
    }
}

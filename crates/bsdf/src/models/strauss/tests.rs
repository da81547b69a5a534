use super::*;
use crate::models::testing::*;

const SET: Params = Params { c: [0.7; 3], s: 0.5, e: 0.5, t: 0.0, eta: 1.5 };

fn parts(form: Form) -> [[f64; 2]; 5] {
    let formula = Strauss::formula::<f64>(&SET, form);
    SETS.map(|(_, angles)| {
        let (wi, wo) = directions(angles);
        let g = Geometry::new(wi.into(), wo.into());
        [formula.diffuse(&g).x, formula.specular(&g).x]
    })
}

const DIFFUSE: [f64; 5] = [0.397_830_419_9, 0.229_687_5, 0.452_396_061_5, 0.295_280_558_2, 0.157_115_503_3];
const SPECULAR: [f64; 5] = [0.099_213_862_58, 0.020_671_695_28, 2.929_003_433e-5, 0.0, 0.130_283_680_1];

/// Row BR-21.
#[test]
fn strauss_equals_its_golden_values() {
    for ((found, diffuse), specular) in parts(Form::Corrected).into_iter().zip(DIFFUSE).zip(SPECULAR) {
        assert!((found[0] / diffuse - 1.0).abs() < 1e-9, "{found:?} {diffuse}");
        assert!((found[1] - specular).abs() <= 1e-9 * specular, "{found:?} {specular}");
    }
    let pairs = [("c", "0.7"), ("s", "0.5"), ("e", "0.5"), ("t", "0")];
    assert_golden("strauss", &pairs, Form::Corrected, std::array::from_fn(|k| DIFFUSE[k] + SPECULAR[k]), 1e-9);
}

/// Row BR-21.
#[test]
fn fresnel_and_attenuation_are_tabulated() {
    let x = [0.0, 0.25, 0.5, 0.75, 0.9, 1.0];
    let f = [0.0, 0.007_633_002, 0.026_283_106, 0.094_794_882, 0.289_362_837, 1.0];
    let g = [1.0, 0.999_924_892, 0.999_713_534, 0.998_618_604, 0.991_832_766, 0.0];
    for k in 0..6 {
        assert!((fresnel(x[k]) - f[k]).abs() < 1e-8, "F({}) = {}", x[k], fresnel(x[k]));
        assert!((attenuation(x[k]) - g[k]).abs() < 1e-8, "G({}) = {}", x[k], attenuation(x[k]));
        assert!((fresnel(x[k] + 1e-4) - f[k]).abs() > 1e-8, "planted fault");
    }
}

/// Row BR-21: the exponents and diffuse shares of figure 4.1, the highlight colours of figure 4.2.
#[test]
fn smoothness_and_metalness_do_what_the_figures_say() {
    let found: Vec<_> = [0.1, 0.3, 0.5, 0.7, 0.9].map(|s| Strauss::formula::<f64>(&Params { s, e: 0.0, ..SET }, Form::Corrected)).to_vec();
    for (formula, (h, rho_d)) in found.iter().zip([(3.333_333, 0.999), (4.285_714, 0.973), (6.0, 0.875), (10.0, 0.657), (30.0, 0.271)]) {
        assert!((formula.h - h).abs() < 1e-6 && (formula.diffuse - rho_d).abs() < 1e-9, "{formula:?}");
    }
    for (e, normal, grazing) in
        [(0.1, 0.97, 0.98383), (0.3, 0.91, 0.95149), (0.5, 0.85, 0.91916), (0.7, 0.79, 0.88682), (0.9, 0.73, 0.85448)]
    {
        let tint = |degrees: f64| 1.0 + e * (1.0 - fresnel(degrees / 90.0)) * (0.7 - 1.0);
        assert!((tint(0.0) - normal).abs() < 1e-12 && (tint(85.0) - grazing).abs() < 1e-5, "{e}");
        // The model's highlight at normal incidence has that colour.
        let formula = Strauss::formula::<f64>(&Params { e, ..SET }, Form::Corrected);
        let up = V3::new(0.0, 0.0, 1.0);
        assert!((formula.specular(&Geometry::new(up, up)).x - normal * 0.125).abs() < 1e-12, "{e}");
    }
}

/// Row BR-21.
#[test]
fn highlights_are_never_negative_and_extremes_are_finite() {
    for c in ["0", "0.5", "1"] {
        for e in ["0", "0.5", "1"] {
            for s in ["0", "0.5", "1"] {
                let strauss = model("strauss", &[("c", c), ("e", e), ("s", s)], Form::Corrected);
                let fault = fault(&*strauss, 20_000);
                assert!(fault.is_none(), "C {c}, e {e}, s {s}: {fault:?}");
            }
        }
    }
    let mirror = Strauss::formula::<f64>(&Params { s: 1.0, ..SET }, Form::Corrected);
    assert!((mirror.h - 30_000.0).abs() < 1e-6 && mirror.diffuse == 0.0);
    // As printed, black metal has a negative highlight at grazing angles.
    let printed = model("strauss", &[("c", "0"), ("e", "1"), ("s", "0.9")], Form::Printed);
    let (wi, wo) = directions(SETS[4].1);
    assert!(printed.value(wi, wo).x < 0.0);
    assert!(fault(&*printed, 20_000).is_some(), "and the check above notices it");
}

/// Row BR-40: the diffuse part is flat, the highlight of set A 2.7 times too strong (in strength; its colour differs too).
#[test]
fn the_printed_form_is_flat_and_too_strong() {
    let (printed, corrected) = (parts(Form::Printed), parts(Form::Corrected));
    assert!(printed.iter().all(|part| (part[0] - 0.656_25).abs() < 1e-12));
    let ratio = printed[0][1] / corrected[0][1];
    assert!(ratio > 2.6 && ratio < 2.8, "{ratio}");
}

/// Rows BR-5, BR-7: not reciprocal, and S exceeds 1 for bright smooth surfaces.
#[test]
fn strauss_is_no_brdf() {
    let strauss = model("strauss", &[("c", "0.7"), ("s", "0.5"), ("e", "0.5")], Form::Corrected);
    assert!(asymmetry(|a, b| strauss.value(a, b).x / a.z, 20_000) > 0.5);
    let bright = model("strauss", &[("c", "1"), ("s", "0.9"), ("e", "0.5")], Form::Corrected);
    let most = (0..900).map(|k| {
        let (wi, wo) = directions([f64::from(k) * 0.1, 0.0, f64::from(k) * 0.1, 180.0]);
        bright.value(wi, wo).x
    });
    let most = most.fold(0.0, f64::max);
    assert!((most - 1.0197).abs() < 1e-4, "{most}");
}

#[test]
fn strauss_is_sampled_without_bias() {
    for pairs in [[("c", "0.7"), ("s", "0.5"), ("e", "0.5")], [("c", "0.2"), ("s", "0.9"), ("e", "1")]] {
        assert_sampled_albedo("strauss", &pairs, 50_000);
    }
}

/// Row BR-41.
#[test]
fn strauss_is_robust() {
    assert_robust("strauss", &[&[], &[("s", "1")], &[("s", "0"), ("c", "0")]]);
}

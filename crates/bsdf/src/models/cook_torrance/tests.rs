use crate::models::blocks::distribution::Distribution;
use crate::models::blocks::fresnel::{Fresnel, FresnelForm, normal_reflectance};
use crate::models::blocks::masking::Masking;
use crate::models::blocks::metals::Metal;
use crate::models::testing::*;
use crate::models::{Form, Reflectance, V3, find};
use glam::DVec3;
use kajo_params::ParamType;

const PLASTIC: [(&str, &str); 4] = [("kd", "0.8"), ("ks", "0.2"), ("m", "0.15"), ("eta", "1.49")];
const COPPER: [(&str, &str); 5] = [("kd", "0"), ("ks", "0.8"), ("m", "0.25"), ("eta", "1.0"), ("kappa", "2.39")];
const GREY: [(&str, &str); 4] = [("kd", "0.4"), ("ks", "0.4"), ("m", "0.2"), ("eta", "1.5")];
const PERFECT: [(&str, &str); 4] = [("kd", "0"), ("ks", "1"), ("m", "0.2"), ("fresnel", "none")];

/// Row BR-17.
#[test]
fn cook_torrance_equals_its_golden_values() {
    let rows = [
        (&PLASTIC[..], Form::Printed, [0.383_284_844_7, 0.254_648_426_3, 0.254_647_908_9, 0.254_647_908_9, 4.346_080_261]),
        (&PLASTIC, Form::Corrected, [0.286_807_142_9, 0.254_648_038_3, 0.254_647_908_9, 0.254_647_908_9, 1.277_505_997]),
        (&COPPER, Form::Printed, [3.244_630_067, 0.073_185_705_21, 5.976_456_975e-4, 3.794_983_943e-9, 21.785_645_87]),
        (&COPPER, Form::Corrected, [0.811_157_516_8, 0.018_296_426_3, 1.494_114_244e-4, 9.487_459_857e-10, 5.446_411_467]),
        (&GREY, Form::Printed, [0.300_559_409_6, 0.127_611_573_3, 0.127_324_083_8, 0.127_323_954_5, 4.781_586_558]),
        (&GREY, Form::Corrected, [0.170_632_818_3, 0.127_395_859_2, 0.127_323_986_8, 0.127_323_954_5, 1.290_889_605]),
    ];
    for (pairs, form, golden) in rows {
        assert_golden("cook-torrance", pairs, form, golden, 1e-9);
    }
}

/// Rows BR-6, BR-17: the corrected factor keeps energy, the printed one reflects four times what arrives.
#[test]
fn perfect_facets_reflect_what_arrives_and_four_times_that_as_printed() {
    let corrected = model("cook-torrance", &PERFECT, Form::Corrected);
    let printed = model("cook-torrance", &PERFECT, Form::Printed);
    for (theta, expected) in [(0.0, 1.0), (30.0, 0.9989), (60.0, 0.9656), (75.0, 0.9275), (85.0, 0.9598)] {
        let quadrature = albedo(&*corrected, theta, 0.0);
        assert!((quadrature - expected).abs() < 2e-4, "{theta}°: {quadrature}");
        let (wi, wo) = directions([theta, 0.0, theta * 0.8, 180.0]);
        assert!((printed.value(wi, wo).x / corrected.value(wi, wo).x - 4.0).abs() < 1e-12);
        let (mean, error) = sampled_albedo(&*corrected, theta, 0.0, 20_000);
        assert!((mean - quadrature).abs() < 4.0 * error + 1e-6, "{theta}°: sampled {mean} ± {error}, quadrature {quadrature}");
    }
    let four = albedo(&*printed, 0.0, 0.0);
    assert!((four - 4.0).abs() < 1e-3, "the furnace must report the print: {four}");
}

/// The angle of the largest value in the plane of incidence, degrees.
fn peak(model: &dyn Reflectance, theta_i: f64) -> f64 {
    let value = |k: u32| {
        let (wi, wo) = directions([theta_i, 0.0, f64::from(k) / 100.0, 180.0]);
        model.value(wi, wo).x
    };
    f64::from((0..9000).max_by(|a, b| value(*a).total_cmp(&value(*b))).unwrap()) / 100.0
}

/// Row BR-17.
#[test]
fn the_highlight_leaves_the_mirror_direction() {
    let specular = |m| model("cook-torrance", &[("kd", "0"), ("ks", "1"), ("m", m), ("eta", "1.5")], Form::Corrected);
    let smooth = specular("0.1");
    for (theta_i, expected) in [(30.0, 30.89), (45.0, 47.09), (60.0, 64.43), (75.0, 85.0)] {
        assert!((peak(&*smooth, theta_i) - expected).abs() < 0.05, "m = 0.1, {theta_i}°: {}", peak(&*smooth, theta_i));
    }
    let rough = specular("0.2");
    for (theta_i, expected) in [(30.0, 34.39), (45.0, 57.73), (60.0, 80.0)] {
        assert!((peak(&*rough, theta_i) - expected).abs() < 0.05, "m = 0.2, {theta_i}°: {}", peak(&*rough, theta_i));
    }
}

/// Row BR-19.
#[test]
fn equal_slopes_are_the_isotropic_model_and_swapped_ones_a_quarter_turn() {
    for distribution in ["gaussian", "beckmann", "schlick", "trowbridge-reitz", "blinn"] {
        for masking in ["v-groove", "smith", "smith-printed", "schlick"] {
            let parts = [("distribution", distribution), ("masking", masking)];
            let make = |slopes: &[(&'static str, &'static str)]| model("cook-torrance", &[&parts[..], slopes].concat(), Form::Corrected);
            let (one, two) = (make(&[("m", "0.25")]), make(&[("mx", "0.25"), ("my", "0.25")]));
            let (wide, turned) = (make(&[("mx", "0.1"), ("my", "0.4")]), make(&[("mx", "0.4"), ("my", "0.1")]));
            let mut rng = kajo_sampling::Rng::new(19);
            for _ in 0..200 {
                let [a, b, c] = [85.0, 85.0, 360.0].map(|scale| f64::from(rng.next_1d()) * scale);
                let (wi, wo) = directions([a, 10.0, b, c]);
                let rotated = directions([a, 73.0, b, c + 63.0]);
                assert!((one.value(wi, wo).x / two.value(wi, wo).x - 1.0).abs() < 1e-12);
                assert!((one.value(wi, wo).x / one.value(rotated.0, rotated.1).x - 1.0).abs() < 1e-12, "isotropic");
                let quarter = |w: DVec3| DVec3::new(-w.y, w.x, w.z);
                assert!((wide.value(wi, wo).x / turned.value(quarter(wi), quarter(wo)).x - 1.0).abs() < 1e-9);
            }
            let (wi, wo) = directions([30.0, 0.0, 50.0, 180.0]);
            assert!((wide.value(wi, wo).x / turned.value(wi, wo).x - 1.0).abs() > 1e-3, "elliptic: the direction matters");
        }
    }
}

/// Row BR-5, for every combination of parts.
#[test]
fn every_combination_of_parts_is_reciprocal() {
    let names = |ty: kajo_params::ScalarType| ty.choices();
    for distribution in names(Distribution::TYPE) {
        for masking in names(Masking::TYPE) {
            for fresnel in names(FresnelForm::TYPE) {
                let parts = [("mx", "0.3"), ("my", "0.15"), ("distribution", *distribution), ("masking", masking), ("fresnel", fresnel)];
                let model = model("cook-torrance", &parts, Form::Corrected);
                let worst = asymmetry(|a, b| model.value(a, b).x, 300);
                assert!(worst < 1e-9, "{distribution}, {masking}, {fresnel}: {worst}");
            }
        }
    }
    let grey = model("cook-torrance", &GREY, Form::Corrected);
    assert!(asymmetry(|a, b| grey.value(a, b).x, 20_000) < 1e-9);
    assert!(asymmetry(|a, b| grey.value(a, b).x * (1.0 + 1e-5 * a.z), 20_000) > 1e-6, "planted fault");
}

#[test]
fn sampled_albedo_is_the_integral_for_every_distribution() {
    for distribution in Distribution::TYPE.choices() {
        let parts = [("kd", "0.2"), ("ks", "0.8"), ("mx", "0.3"), ("my", "0.15"), ("w2", "0.4"), ("m2", "0.6"), ("metal", "gold")];
        let model = model("cook-torrance", &[&parts[..], &[("distribution", distribution)]].concat(), Form::Corrected);
        let quadrature = albedo(&*model, 60.0, 40.0);
        let (mean, error) = sampled_albedo(&*model, 60.0, 40.0, 20_000);
        assert!(
            (mean - quadrature).abs() < 4.0 * error && error < 0.01,
            "{distribution}: sampled {mean} ± {error}, quadrature {quadrature}"
        );
    }
}

/// Row BR-33: the highlight of copper turns to the colour of the light. Mean index as in the thesis; with the mean of the measured constants F̄ dips below f̄
/// before it rises, and the colour first stays.
#[test]
fn the_colour_of_copper_goes_to_that_of_the_light_at_grazing_angles() {
    let colour = Metal::Copper.rgb().unwrap().f;
    let copper = Fresnel::<f64>::new(FresnelForm::Interpolated, Metal::None, [1.0; 3], [2.39; 3], colour);
    let measured = Fresnel::<f64>::new(FresnelForm::Interpolated, Metal::Copper, [1.5; 3], [0.0; 3], [0.04; 3]);
    let distance = |copper: &Fresnel<f64>, degrees: f64| {
        let f = copper.at(degrees.to_radians().cos()).to_array();
        let sum: f64 = f.iter().sum();
        f.iter().map(|channel| (channel / sum - 1.0 / 3.0).powi(2)).sum::<f64>().sqrt()
    };
    assert!(distance(&copper, 0.0) > 0.05, "copper is red");
    for half_degree in 120..180 {
        let beta = f64::from(half_degree) / 2.0;
        let (now, next) = (distance(&copper, beta), distance(&copper, beta + 0.5));
        assert!(next < now, "{beta}°: {now} then {next}");
        assert!(distance(&measured, beta + 0.5) <= distance(&measured, beta) + 1e-15, "measured, {beta}°");
    }
    assert!(distance(&copper, 90.0) < 1e-12 && distance(&measured, 90.0) < 1e-12);
    // The same through the model.
    let f0 = colour.map(|f| f.to_string()).join(",");
    let pairs = [("kd", "0"), ("ks", "1"), ("eta", "1"), ("kappa", "2.39"), ("f0", &f0), ("fresnel", "interpolated")];
    let model = model("cook-torrance", &pairs, Form::Corrected);
    let redness = |degrees| {
        let (wi, wo) = directions([degrees, 0.0, degrees, 180.0]);
        let f = model.value(wi, wo);
        f.x / f.z
    };
    assert!(redness(60.0) > redness(75.0) && redness(75.0) > redness(88.0) && redness(88.0) > 1.0);
}

#[test]
fn a_metal_replaces_index_and_reflectance() {
    let gold = Metal::Gold.rgb().unwrap();
    let row = |values: [f64; 3]| values.map(|v| v.to_string()).join(",");
    let by_name = model("cook-torrance", &[("metal", "gold")], Form::Corrected);
    let by_number = model("cook-torrance", &[("eta", &row(gold.eta)), ("kappa", &row(gold.kappa))], Form::Corrected);
    let (wi, wo) = directions(SETS[0].1);
    assert!((by_name.value(wi, wo) - by_number.value(wi, wo)).length() < 1e-12);
    assert!(by_name.value(wi, wo).x > by_name.value(wi, wo).z, "gold is yellow");
    assert!((normal_reflectance(gold.eta[0], gold.kappa[0]) - gold.f[0]).abs() < 1e-15);
}

#[test]
fn more_light_than_arrives_is_refused() {
    let error = find("cook-torrance").unwrap().from_pairs(&[("kd", "0.6"), ("ks", "0.6")], Form::Corrected).err().unwrap().to_string();
    assert!(error.contains("kd + ks is 1.2"), "{error}");
}

/// Row BR-41: all parts, extreme slopes and directions.
#[test]
fn every_combination_of_parts_is_finite_and_not_negative() {
    let mut rng = kajo_sampling::Rng::new(41);
    for distribution in Distribution::TYPE.choices() {
        for masking in Masking::TYPE.choices() {
            for (mx, my) in [("0.001", "0.001"), ("0.001", "10"), ("0.3", "0.3"), ("10", "10")] {
                let parts = [("mx", mx), ("my", my), ("distribution", *distribution), ("masking", masking), ("metal", "silver")];
                let model = model("cook-torrance", &parts, Form::Corrected);
                for k in 0..200 {
                    let (wi, wo) = extreme_pair(&mut rng, k);
                    assert_finite(&*model, wi, wo);
                }
            }
        }
    }
    let name = |form: FresnelForm| form.to_value().to_string();
    for fresnel in [FresnelForm::Exact, FresnelForm::Schlick, FresnelForm::Interpolated, FresnelForm::Inverted].map(name) {
        for (eta, kappa, f0) in [("0.001", "0", "0"), ("1", "0", "1"), ("100", "1e6", "0.5")] {
            let model = model("cook-torrance", &[("fresnel", &fresnel), ("eta", eta), ("kappa", kappa), ("f0", f0)], Form::Corrected);
            for k in 0..200 {
                let (wi, wo) = extreme_pair(&mut rng, k);
                assert_finite(&*model, wi, wo);
            }
        }
    }
    let grazing: DVec3 = V3::from_angles(89.999_f64.to_radians(), 0.3).into();
    let model = model("cook-torrance", &GREY, Form::Corrected);
    assert_eq!(model.value(-grazing, DVec3::Z), DVec3::ZERO, "below the horizon");
}

use crate::models::Form;
use crate::models::testing::*;

const BASES: [&[(&str, &str)]; 5] = [
    &[("base_color", "1")],
    &[("base_color", "1"), ("metalness", "1"), ("roughness", "0.8")],
    &[("base_color", "1"), ("metalness", "0.4"), ("roughness", "0.3"), ("ior", "1.8")],
    &[("base_color", "1"), ("metalness", "1"), ("roughness", "0.3"), ("anisotropy", "0.7")],
    &[("base_color", "1"), ("film", "1"), ("film_thickness", "500")],
];

const LAYERED: [&[(&str, &str)]; 3] = [
    &[("clearcoat", "1"), ("clearcoat_roughness", "0.3"), ("base_color", "1")],
    &[("sheen", "1"), ("sheen_roughness", "0.4"), ("base_color", "1")],
    &[("sheen", "0.5"), ("clearcoat", "0.5"), ("base_color", "1"), ("metalness", "1"), ("roughness", "0.2")],
];

#[test]
fn a_white_base_reflects_everything_and_nothing_reflects_more() {
    for (whole, pairs) in BASES.map(|pairs| (true, pairs)).into_iter().chain(LAYERED.map(|pairs| (false, pairs))) {
        let principled = model("principled", pairs, Form::Corrected);
        // A film takes its strongest colour from what lies below in every colour, so that the rest keeps its hue.
        let film = pairs.iter().any(|(name, _)| *name == "film");
        for (theta, phi) in [(0.0, 0.0), (60.0, 20.0), (80.0, 70.0)] {
            let (mean, error) = sampled_albedo(&*principled, theta, phi, 40_000);
            assert!(mean < 1.005 + 4.0 * error, "{pairs:?}, {theta}°: {mean} ± {error}");
            let least = if whole && !film { 0.985 } else { 0.6 };
            assert!(mean > least - 4.0 * error, "{pairs:?}, {theta}°: {mean} ± {error}");
        }
    }
}

/// Energy as a renderer sees it: f cos over the hemisphere, against the samples.
#[test]
fn principled_samples_give_its_albedo_and_follow_its_density() {
    for pairs in [BASES[2], LAYERED[2]] {
        let principled = model("principled", pairs, Form::Corrected);
        let quadrature = albedo(&*principled, 50.0, 20.0);
        let (mean, error) = sampled_albedo(&*principled, 50.0, 20.0, 100_000);
        assert!((mean - quadrature).abs() < 4.0 * error + 2e-4, "{pairs:?}: sampled {mean} ± {error}, quadrature {quadrature}");
        assert_samples_follow(&*principled, 50.0, 20.0);
    }
}

/// The base to rounding; what coat and sheen leave is what doc.md states.
#[test]
fn the_base_is_reciprocal_and_the_layers_are_as_far_as_stated() {
    let worst = |pairs| {
        let principled = model("principled", pairs, Form::Corrected);
        asymmetry(|a, b| principled.value(a, b).x, 20_000)
    };
    for pairs in BASES {
        assert!(worst(pairs) < 2e-4, "{pairs:?}: {}", worst(pairs));
    }
    let stated = [0.42, 0.81, 0.61];
    for (pairs, stated) in LAYERED.into_iter().zip(stated) {
        assert!((worst(pairs) - stated).abs() < 0.05, "{:?}", LAYERED.map(worst));
    }
}

#[test]
fn both_spellings_and_both_ends_of_the_roughness_are_accepted() {
    let (wi, wo) = directions(SETS[0].1);
    let value = |pairs: &[(&str, &str)]| model("principled", pairs, Form::Corrected).value(wi, wo);
    assert_eq!(value(&[("metallic", "1"), ("coat", "1")]), value(&[("metalness", "1"), ("clearcoat", "1")]));
    assert_ne!(value(&[("metallic", "1")]), value(&[("metallic", "0")]), "planted fault");
    let (wi, wo) = directions(SETS[4].1);
    let mirror = model("principled", &[("roughness", "0"), ("metalness", "1")], Form::Corrected);
    assert!(mirror.value(wi, wo).x > 1e4 && mirror.value(wi, wo).is_finite());
}

use super::*;
use kajo_bsdf::models::{Form, find};
use std::sync::Arc;

fn model(id: &str) -> Arc<dyn Reflectance> {
    find(id).unwrap().from_pairs(&[], Form::Corrected).unwrap()
}

fn costs(ids: &[&str]) -> Costs {
    let models: Vec<_> = ids.iter().map(|id| model(id)).collect();
    let subjects: Vec<_> = ids.iter().zip(&models).map(|(id, model)| Subject { id, model: &**model, is_default: true }).collect();
    bench(&subjects, 1, |_| true).unwrap()
}

/// Row BR-34, without a clock: the order that the survey found, in operations weighted alike for all; times stand in docs/performance.md.
#[test]
fn operations_are_in_the_order_that_the_survey_measured() {
    let cost = |id: &str| {
        let (wi, wo) = (V3::from_angles(0.5, 0.3).into(), V3::from_angles(0.8, 2.5).into());
        weight(&model(id).operations(wi, wo).unwrap())
    };
    let not_dearer = |a: &str, b: &str| cost(a) <= cost(b);
    for (a, b) in [
        ("lambert-bsf", "schlick-phong-bsf"),
        ("schlick-phong-bsf", "blinn-phong-bsf"),
        ("blinn-phong-bsf", "phong-bsf"),
        ("schlick-cook-torrance", "cook-torrance"),
    ] {
        assert!(not_dearer(a, b), "{a} {} is dearer than {b} {}", cost(a), cost(b));
    }
    assert!(!not_dearer("cook-torrance", "schlick-phong-bsf"), "planted fault");
}

/// Row BR-34: calls are counted, inputs differ, checksums are those of the models, by single calls, by many and by hand.
#[test]
fn every_way_of_calling_a_model_has_one_checksum() {
    let inputs = Inputs::new();
    let measured = costs(&["lambert", "ggx", "cook-torrance"]);
    assert!(measured.calls >= inputs.pairs() as u64 && measured.rounds >= 1);
    for cost in &measured.models {
        let model = model(&cost.id);
        let mut expected = 0.0;
        for block in 0..inputs.pairs() / BLOCK {
            let (wi, wo) = inputs.block(block as u64);
            expected += wi.iter().zip(wo).map(|(wi, wo)| model.value(wi.as_dvec3(), wo.as_dvec3()).element_sum()).sum::<f64>();
        }
        expected /= inputs.pairs() as f64;
        let same = |sum: f64| (sum / expected - 1.0).abs() < 1e-5;
        let hand = cost.by_hand.map_or(expected, |(_, sum)| sum);
        assert!(cost.checksums.into_iter().chain([hand]).all(same), "{}: {:?}, {hand}, not {expected}", cost.id, cost.checksums);
        assert!(!same(expected * 1.0001), "planted fault");
        assert!(cost.raw.single > 0.0 && cost.raw.many > 0.0);
        assert_eq!(cost.by_hand.is_some(), cost.id != "cook-torrance" && measured.instructions != Instructions::Scalar, "{}", cost.id);
    }
}

#[test]
fn inputs_are_all_different() {
    let inputs = Inputs::new();
    let mut seen = std::collections::BTreeSet::new();
    for block in 0..inputs.pairs() / BLOCK {
        let (wi, wo) = inputs.block(block as u64);
        seen.extend(
            wi.iter()
                .zip(wo)
                .map(|(wi, wo)| wi.to_array().map(f32::to_bits).into_iter().chain(wo.to_array().map(f32::to_bits)).collect::<Vec<_>>()),
        );
    }
    assert_eq!(seen.len(), inputs.pairs());
}

/// Row BR-36, without a clock: what the approximation saves, in operations; measured ratios stand in docs/performance.md.
#[test]
fn schlicks_approximation_saves_operations_and_less_than_is_claimed() {
    let [exact, schlick] = fresnel::operations().map(|operations| f64::from(weight(&operations)));
    let ratio = exact / schlick;
    assert!(ratio > 4.0 && ratio < CLAIMED_RATIO, "{exact} to {schlick}");
    let cost = costs(&[]).fresnel;
    assert!(cost.ratios().single.is_finite() && cost.ratios().many.is_finite(), "{cost:?}");
}

#[test]
fn a_run_can_be_stopped() {
    let lambert = model("lambert");
    assert!(bench(&[Subject { id: "lambert", model: &*lambert, is_default: true }], 1, |_| false).is_none());
}

#[test]
fn the_survey_timed_ten_models_and_left_out_two() {
    assert_eq!(surveyed("ward").and_then(Survey::ratio).map(|ratio| (ratio * 100.0).round()), Some(468.0));
    assert_eq!(surveyed("htsg"), Some(Survey::NotMeasured));
    assert_eq!(surveyed("ggx"), None);
}

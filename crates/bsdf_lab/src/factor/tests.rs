use super::*;
use crate::checks::{from_degrees, sampling_test, test_against};
use kajo_bsdf::models::{Form, Reflectance, find};
use std::sync::Arc;

type Source = (&'static str, &'static [(&'static str, &'static str)]);

const GGX: Source = ("ggx", &[("alpha_x", "0.2"), ("alpha_y", "0.2"), ("f0", "0.9")]);
const WARD: Source = ("ward", &[("kd", "0.3"), ("ks", "0.4"), ("m", "0.2")]);
const METAL: Source = ("cook-torrance", &[("kd", "0"), ("ks", "1"), ("m", "0.3"), ("metal", "gold")]);
const BRUSHED: Source = ("ward", &[("kd", "0.1"), ("ks", "0.5"), ("mx", "0.15"), ("my", "0.4")]);

const NMF: NmfOptions = NmfOptions { outer: 4, inner: 2, sweeps: 100 };
const TUCKER: TuckerOptions = TuckerOptions { rank: 2, passes: 4 };

/// Not larger than [`NMF`], of one colour or three.
const SMALL_TUCKER: TuckerOptions = TuckerOptions { rank: 2, passes: 3 };

fn model((id, pairs): Source) -> Arc<dyn Reflectance> {
    find(id).unwrap().from_pairs(pairs, Form::Corrected).unwrap()
}

fn table(source: Source) -> Table {
    Table::of_model(&*model(source)).unwrap()
}

/// Both factorisations as models, with the steps that led there.
fn both(table: &Table, (n, t): (NmfOptions, TuckerOptions)) -> [(&'static str, Box<dyn Reflectance>, Vec<Step>); 2] {
    let mut steps = [Vec::new(), Vec::new()];
    let [a, b] = &mut steps;
    let keep = |steps: &mut Vec<Step>, step: &Step| {
        steps.push(*step);
        true
    };
    let nmf = nmf(table, n, |step| keep(a, step));
    let tucker = tucker(table, t, |step| keep(b, step));
    assert_eq!([nmf.numbers(), tucker.numbers()], [a.last().unwrap().numbers, b.last().unwrap().numbers]);
    let [a, b] = steps;
    [("nmf", Box::new(nmf.into_model()), a), ("tucker", Box::new(tucker.into_model()), b)]
}
/// The largest quotient of an error and the one before it.
fn worst_step(errors: impl Iterator<Item = f64>) -> f64 {
    let errors: Vec<f64> = errors.collect();
    assert!(errors.len() > 2, "{errors:?}");
    errors.windows(2).fold(0.0, |worst, pair| f64::max(worst, pair[1] / pair[0]))
}

/// Row GI-42: what each method makes small falls with every term and every pass, and the error of f cos θ_i with it.
#[test]
fn reconstruction_error_falls_each_pass() {
    for (source, [by_nmf, by_tucker]) in [(GGX, [0.045, 0.03]), (WARD, [0.015, 0.005]), (METAL, [0.09, 0.06]), (BRUSHED, [0.1, 0.05])] {
        let table = table(source);
        assert_eq!(table.grid.is_isotropic(), source != BRUSHED, "{source:?}");
        assert_eq!(table.grid.channels == 3, source == METAL, "{source:?}");
        for ((name, _, steps), limit) in both(&table, (NMF, TUCKER)).into_iter().zip([by_nmf, by_tucker]) {
            let residual = worst_step(steps.iter().map(|step| step.errors.residual));
            assert!(residual < 0.9, "{source:?} {name}: a step leaves {residual} of the residual, {steps:?}");
            let cos = worst_step(steps.iter().map(|step| step.errors.cos_rms));
            assert!(cos < 1.0, "{source:?} {name}: {steps:?}");
            assert!(worst_step(steps.iter().rev().map(|step| step.errors.residual)) > 1.0, "planted fault");
            let last = steps.last().unwrap();
            assert!(last.errors.cos_rms < limit && 40 * last.numbers < table.grid.numbers(), "{source:?} {name}: {last:?}");
        }
    }
}

/// The tests of the file's errors are of the table; here directions are between the nodes.
#[test]
fn factors_are_near_the_model_between_nodes_too() {
    let source = model(WARD);
    for (name, factored, steps) in both(&table(WARD), (NMF, TUCKER)) {
        let error = |other: &dyn Reflectance| {
            let mut rng = kajo_sampling::Rng::new(3);
            let (mut squares, mut all) = (0.0, 0.0);
            for _ in 0..20_000 {
                let [wi, wo] = std::array::from_fn(|_| crate::checks::random_direction(&mut rng));
                let f = source.f_cos(wi, wo).x;
                squares += (other.f_cos(wi, wo).x - f).powi(2) * wo.z;
                all += f * f * wo.z;
            }
            (squares / all).sqrt()
        };
        let between = error(&*factored);
        let at_nodes = steps.last().unwrap().errors.cos_rms;
        assert!(between < 2.0 * at_nodes + 0.005, "{name}: {between} between nodes, {at_nodes} at them");
        assert!(error(&*model(("ward", &[("kd", "0.3"), ("ks", "0.4"), ("m", "0.22")]))) > 0.05, "planted fault");
    }
}

/// Row GI-42: samples follow their density, and value over density finds the albedo of quadrature.
#[test]
fn samples_of_factored_models_follow_density_and_value() {
    for (source, theta) in [(GGX, 70.0), (METAL, 0.0), (BRUSHED, 50.0)] {
        let table = table(source);
        let wo = from_degrees(theta, 35.0);
        let exact = crate::albedo(&*model(source), wo, 1e-4);
        let [nmf, tucker] = both(&table, (NMF, TUCKER));
        for (name, factored, _) in [&nmf, &tucker] {
            let test = sampling_test(&**factored, wo, 20_000, 8);
            assert!(test.holds(1e-6), "{source:?} {name}: {test:?}");
            let found = crate::albedo(&**factored, wo, 1e-4);
            assert!((found - exact).abs().max_element() < 0.02, "{source:?} {name}: albedo {found}, of the model {exact}");
        }
        // Two densities that are both near f cos θ_i, one of them the wrong one.
        if source == BRUSHED {
            let fault = test_against(&*nmf.1, |wi| tucker.1.pdf(wi, wo), wo, 20_000, 8);
            assert!(fault.p_value < 1e-6, "planted fault: {fault:?}");
        }
    }
}

#[test]
fn answers_are_finite_numbers() {
    for source in [METAL, BRUSHED] {
        for (name, factored, _) in both(&table(source), (NmfOptions { sweeps: 10, ..NMF }, TUCKER)) {
            let found = crate::checks::robustness(&*factored, 20_000, 9);
            assert!(found.holds(), "{source:?} {name}: {found:?}");
        }
    }
}

/// What the documents say: in equal memory the tensor is nearer to f cos θ_i, and the factors without signs make samples of steadier weights.
#[test]
fn tensors_keep_more_and_factors_without_signs_sample_better() {
    for source in [GGX, WARD, METAL] {
        let [nmf, tucker] = both(&table(source), (NMF, SMALL_TUCKER));
        let last = |steps: &[Step]| *steps.last().unwrap();
        let (n, t) = (last(&nmf.2), last(&tucker.2));
        assert!(t.numbers <= n.numbers, "{} {}", n.numbers, t.numbers);
        assert!(t.errors.cos_rms < n.errors.cos_rms, "{source:?}: {n:?} {t:?}");
        let wo = from_degrees(60.0, 0.0);
        let [n, t] = [&nmf.1, &tucker.1].map(|m| {
            let sampled = crate::sampled_albedo(&**m, wo, 20_000, 4);
            sampled.standard_error.x * 20_000_f64.sqrt() / sampled.mean.x
        });
        assert!(n < 0.2 && t > 2.0 * n && t < 0.7, "{source:?}: relative deviation of weights {n} {t}");
    }
}

#[test]
fn a_constant_is_kept_apart_and_needs_no_terms() {
    let lambert = table(("lambert", &[("kd", "0.2,0.5,0.8")]));
    assert!(lambert.diffuse.iter().zip([0.2, 0.5, 0.8]).all(|(found, kd)| (found - kd).abs() < 1e-12), "{:?}", lambert.diffuse);
    let shading = table(("lambert-bsf", &[("kd", "0.5")]));
    assert!(shading.diffuse.len() == 1 && (shading.diffuse[0] - 0.5).abs() < 1e-12, "{:?}", shading.diffuse);
    let source = model(("lambert", &[("kd", "0.2,0.5,0.8")]));
    let (wi, wo) = (from_degrees(33.0, 4.0), from_degrees(70.0, 99.0));
    for (name, factored, steps) in both(&lambert, (NmfOptions { sweeps: 2, ..NMF }, TuckerOptions { rank: 1, passes: 3 })) {
        assert!((factored.value(wi, wo) - source.value(wi, wo)).abs().max_element() < 1e-6, "{name}: {}", factored.value(wi, wo));
        assert!((factored.pdf(wi, wo) - source.pdf(wi, wo)).abs() < 1e-6, "{name}");
        assert!(steps.iter().all(|step| step.errors.cos_rms < 1e-6 && step.errors.residual.is_finite()), "{name}: {steps:?}");
    }
}

#[test]
fn work_ends_when_it_is_told_to() {
    let table = table(WARD);
    assert_eq!(nmf(&table, NMF, |step| step.count < 2).outer, 2);
    assert_eq!(tucker(&table, TUCKER, |step| step.count < 3).passes.len(), 3);
}

#[test]
fn models_that_no_table_can_hold_are_refused() {
    let refused = |source: Source| Table::of_model(&*model(source)).unwrap_err().to_string();
    assert!(refused(("lambert", &[("kd", "0")])).starts_with("the model is black"));
    let smooth = refused(("htsg", &[("sigma0", "0.01")]));
    assert!(smooth.contains("is a perfect mirror"), "{smooth}");
}

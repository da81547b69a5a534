//! What every model has to keep, whatever its equation; one test over the registry for each.

use super::testing::{albedo, asymmetry, masses, model};
use super::*;
use glam::DVec3;
use kajo_params::{ParamKind, ParamValues};
use kajo_sampling::Rng;
use std::f64::consts::{FRAC_PI_2, TAU};
use std::sync::Arc;

/// Values at the ends of the ranges as often as between them; `None` where they do not go together.
pub(super) fn random_model(entry: &ModelEntry, rng: &mut Rng) -> Option<Arc<dyn Reflectance>> {
    let mut values = ParamValues::defaults(entry.params);
    for spec in entry.params {
        let mut number = |min: f64, max: f64| {
            let u = f64::from(rng.next_1d());
            match f64::from(rng.next_1d()) {
                end if end < 0.2 => min,
                end if end < 0.4 => max,
                // Ranges of several decades are searched in each.
                middle if middle < 0.7 && min > 0.0 => min * (max / min).powf(u),
                _ => min + u * (max - min),
            }
        };
        let text = match spec.kind {
            ParamKind::Float { min, max } => number(min, max).to_string(),
            ParamKind::Color { min, max } => format!("{},{},{}", number(min, max), number(min, max), number(min, max)),
            ParamKind::UInt { min, max } => (number(min.into(), max.into()) as u32).to_string(),
            ParamKind::Int { min, max } => (number(min.into(), max.into()) as i32).to_string(),
            ParamKind::Bool => (number(0.0, 1.0) < 0.5).to_string(),
            ParamKind::Choice { names } => names[(number(0.0, 1.0) * names.len() as f64).min(names.len() as f64 - 1.0) as usize].to_owned(),
            // Cosine lobes: with coefficients up to 1 every exponent is allowed, with others hardly any.
            ParamKind::Rows { max, .. } => {
                let mut lobe = || format!("{},{},{},{}", number(-1.0, 1.0), number(-1.0, 1.0), number(-1.0, 1.0), number(0.0, max));
                format!("{};{}", lobe(), lobe())
            }
            ParamKind::Path => continue,
        };
        values.set(spec.name, &text).unwrap_or_else(|error| panic!("{}: {error}", entry.id));
    }
    (entry.make)(&values, Form::Corrected).ok()
}

/// A direction above the surface: any, or one of the awkward ones.
fn awkward(rng: &mut Rng, other: Option<DVec3>) -> DVec3 {
    let theta = match (rng.next_1d() * 6.0) as u32 {
        0 => 0.0,
        1 => 89.999_f64.to_radians(),
        2 if other.is_some() => return other.unwrap_or(DVec3::Z),
        3 if other.is_some() => return other.map_or(DVec3::Z, |o| DVec3::new(-o.x, -o.y, o.z)),
        _ => f64::from(rng.next_1d()) * FRAC_PI_2,
    };
    V3::from_angles(theta, f64::from(rng.next_1d()) * TAU).into()
}

/// What is wrong with the values at one pair of directions, if anything.
fn complaint(model: &dyn Reflectance, wi: DVec3, wo: DVec3) -> Option<String> {
    let (double, single) = (model.value(wi, wo), model.value_f32(wi.as_vec3(), wo.as_vec3()));
    let sound = |f: DVec3| f.is_finite() && f.min_element() >= 0.0;
    if !sound(double) || !sound(single.as_dvec3()) {
        return Some(format!("f = {double}, in f32 {single}"));
    }
    let below = [model.value(-wi, wo), model.value(wi, -wo), model.value(-wi, -wo)];
    if below.iter().any(|f| *f != DVec3::ZERO) {
        return Some(format!("below the surface {below:?}"));
    }
    let (double, single) = (model.pdf(wi, wo), f64::from(model.pdf_f32(wi.as_vec3(), wo.as_vec3())));
    (!(double.is_finite() && double >= 0.0 && single.is_finite() && single >= 0.0)).then(|| format!("density {double}, in f32 {single}"))
}

/// Row BR-41: a million inputs, of parameters and directions at the ends of their ranges and between.
#[test]
fn every_model_is_finite_and_not_negative_for_a_million_inputs() {
    let analytic: Vec<_> = all().filter(|entry| entry.wesl.is_some()).collect();
    let each = 1_000_000 / analytic.len() + 1;
    let materials = 100;
    for entry in analytic {
        let mut rng = Rng::new(41);
        let (mut made, mut tried) = (0, 0);
        while made < materials {
            tried += 1;
            assert!(tried < 100 * materials, "{}: only {made} of {tried} materials can be made", entry.id);
            let Some(model) = random_model(entry, &mut rng) else { continue };
            made += 1;
            for _ in 0..each / materials + 1 {
                let wo = awkward(&mut rng, None);
                let wi = awkward(&mut rng, Some(wo));
                if let Some(complaint) = complaint(&*model, wi, wo) {
                    panic!("{}, material {made}, {wi} {wo}: {complaint}", entry.id);
                }
                let u = [rng.next_1d(), rng.next_1d(), rng.next_1d()];
                if let Some(wi) = model.sample_f32(wo.as_vec3(), u) {
                    assert!(wi.z > 0.0 && (wi.length() - 1.0).abs() < 1e-3, "{}, material {made}, {wo} {u:?}: {wi}", entry.id);
                }
            }
        }
    }
}

#[test]
fn unsound_values_are_complained_about() {
    #[derive(kajo_params::Params, Clone, Copy, Debug)]
    struct Params {
        /// What the value is.
        #[param(default = 1.0, range = -1e300..=1e300)]
        value: f64,
    }
    #[derive(Clone, Copy)]
    struct Constant<T>(T);
    impl<T: Real> Evaluate<T> for Constant<T> {
        fn value(&self, _g: &Geometry<T>) -> Rgb<T> {
            Rgb::splat(self.0)
        }
    }
    struct Fault;
    impl Model for Fault {
        type Params = Params;
        type Formula<T: Real> = Constant<T>;
        const KIND: Kind = Kind::Brdf;
        fn formula<T: Real>(params: &Params, _form: Form) -> Constant<T> {
            Constant(T::of(params.value))
        }
        fn lobes<T: Scalar>(_formula: &Constant<T>, _wo: V3<T>) -> Mixture<T> {
            Mixture::new(&[])
        }
        fn constants(_formula: &Constant<f32>) -> Vec<f32> {
            Vec::new()
        }
    }
    let complaint = |value: &str| {
        let model = make::<Fault>(&ParamValues::from_pairs(Params::SPEC, &[("value", value)]).unwrap(), Form::Corrected).unwrap();
        complaint(&*model, DVec3::Z, DVec3::Z)
    };
    assert!(complaint("1").is_none() && complaint("-1").is_some() && complaint("1e300").is_some(), "infinite in f32");
}

/// The models of section 2.3 of the survey of global illumination, with parameters that they keep energy with.
const SURVEYED: &[(&str, &[(&str, &str)])] = &[
    ("lambert", &[("kd", "0.8")]),
    ("oren-nayar", &[("sigma", "30")]),
    ("phong", &[("kd", "0.3"), ("ks", "0.7"), ("n", "20")]),
    ("blinn-phong", &[("kd", "0.3"), ("ks", "0.7"), ("n", "20")]),
    ("ashikhmin-shirley", &[("rs", "0.4"), ("rd", "0.6"), ("nx", "10"), ("ny", "60")]),
    ("lafortune", &[("kd", "0.2"), ("lobe", "-1,-1,0.8,20"), ("lobe", "-1,-0.6,0.9,20")]),
    ("torrance-sparrow", &[]),
    ("cook-torrance", &[("kd", "0.2"), ("ks", "0.8"), ("m", "0.3"), ("eta", "0.2"), ("kappa", "3")]),
    ("ward", &[("kd", "0.3"), ("ks", "0.7"), ("m", "0.2")]),
    ("ward", &[("kd", "0.3"), ("ks", "0.7"), ("mx", "0.15"), ("my", "0.4")]),
];

/// Row GI-41.
#[test]
fn the_surveyed_models_are_plausible_and_sampled_from_a_density() {
    for (id, pairs) in SURVEYED {
        let model = model(id, pairs, Form::Corrected);
        let unequal = asymmetry(|a, b| model.value(a, b).x, 20_000);
        assert!(unequal < 1e-5, "{id}: f(i, o) and f(o, i) differ by {unequal}");
        for theta in [0.0, 45.0, 80.0] {
            let reflected = albedo(&*model, theta, 15.0);
            assert!(reflected <= 1.0 + 2e-4, "{id}, {theta}°: reflects {reflected}");
            let wo = DVec3::from(V3::from_angles(f64::to_radians(theta), f64::to_radians(15.0)));
            let (_, above) = masses(|wi| model.pdf(wi.into(), wo));
            let lost = lost_share(&*model, wo);
            assert!((above + lost - 1.0).abs() < 5e-3, "{id}, {theta}°: density {above}, samples of weight 0 {lost}");
            assert!((1.03 * above + lost - 1.0).abs() > 5e-3, "{id}, {theta}°: planted fault");
        }
    }
}

/// Share of samples of weight 0, which density below the surface stands for.
fn lost_share(model: &dyn Reflectance, wo: DVec3) -> f64 {
    let n = 100;
    let middle = |k: u32| (f64::from(k % n) + 0.5) / f64::from(n);
    // One point of the lattice for each cell of (u, v), with the choice of the lobe spread by a golden ratio.
    let lost = (0..n * n)
        .filter(|&k| model.sample(wo, [(f64::from(k) * 0.618_033_988_749_895).fract(), middle(k), middle(k / n)]).is_none())
        .count();
    lost as f64 / f64::from(n * n)
}

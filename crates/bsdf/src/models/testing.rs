//! What the tests of every model use: the geometry sets of the specification, golden values, and checks with their planted faults.

use super::*;
use glam::DVec3;
use std::sync::Arc;

/// Geometry sets (θ_i, φ_i, θ_r, φ_r) in degrees, appendix C.
pub const SETS: [(char, [f64; 4]); 5] = [
    ('A', [30.0, 0.0, 40.0, 180.0]),
    ('B', [60.0, 20.0, 45.0, 150.0]),
    ('C', [10.0, 0.0, 75.0, 90.0]),
    ('D', [50.0, 0.0, 50.0, 0.0]),
    ('E', [70.0, 0.0, 70.0, 180.0]),
];

/// wi and wo of a set.
pub fn directions([theta_i, phi_i, theta_r, phi_r]: [f64; 4]) -> (DVec3, DVec3) {
    let direction = |theta: f64, phi: f64| V3::from_angles(theta.to_radians(), phi.to_radians()).into();
    (direction(theta_i, phi_i), direction(theta_r, phi_r))
}

/// The model with parameters.
pub fn model(id: &str, pairs: &[(&str, &str)], form: Form) -> Arc<dyn Reflectance> {
    find(id).unwrap_or_else(|| panic!("no model {id}")).from_pairs(pairs, form).unwrap()
}

/// The largest relative deviation from golden values at the sets A to E; f32 against f64 is looked at on the way.
pub fn golden_error(model: &dyn Reflectance, golden: [f64; 5]) -> f64 {
    SETS.iter().zip(golden).fold(0.0, |worst, ((name, angles), expected)| {
        let (wi, wo) = directions(*angles);
        let value = model.value(wi, wo).x;
        let single = f64::from(model.value_f32(wi.as_vec3(), wo.as_vec3()).x);
        assert!((single - value).abs() <= 2e-4 * value.abs() + 1e-6, "{name}: f32 gives {single}, f64 {value}");
        worst.max((value - expected).abs() / expected.abs().max(1e-12))
    })
}

/// Asserts golden values to a relative tolerance, and that a value off by ten tolerances would be noticed.
#[track_caller]
pub fn assert_golden(id: &str, pairs: &[(&str, &str)], form: Form, golden: [f64; 5], tolerance: f64) {
    let model = model(id, pairs, form);
    let error = golden_error(&*model, golden);
    assert!(error < tolerance, "{id} {pairs:?}: {error:e} from the golden values");
    let fault = golden.map(|value| value * (1.0 + 10.0 * tolerance) + 1e-9 * tolerance);
    assert!(golden_error(&*model, fault) > tolerance, "{id}: planted fault");
}

/// Directional albedo ∫ f cos θ dω, or ∫ S dω, seen from θ_r (and azimuth φ_r), degrees.
pub fn albedo(model: &dyn Reflectance, theta_r: f64, phi_r: f64) -> f64 {
    let wo = DVec3::from(V3::from_angles(theta_r.to_radians(), phi_r.to_radians()));
    Hemisphere::fine().integrate(|wi| model.f_cos(wi, wo).x)
}

/// The share of uniform light that leaves towards θ_r degrees, shading functions by their π.
pub fn furnace(model: &dyn Reflectance, theta_r: f64) -> f64 {
    Hemisphere::fine().albedo(model, V3::from_angles(theta_r.to_radians(), 0.0).into()).x
}

/// Row BR-41: asserts that values are finite and ≥ 0 in both precisions, 0 below the horizon, and that densities reach every value, for a million pairs
/// of directions in all, among them θ = 0, 89.999°, equal directions and half vectors along the normal.
#[track_caller]
pub fn assert_robust(id: &str, sets: &[&[(&str, &str)]]) {
    for pairs in sets {
        let model = model(id, pairs, Form::Corrected);
        if let Some(fault) = fault(&*model, 1_000_000 / sets.len()) {
            panic!("{id} {pairs:?}: {fault}");
        }
    }
}

/// What is wrong with a model at some pair of directions, if anything.
pub fn fault(model: &dyn Reflectance, pairs: usize) -> Option<String> {
    let mut rng = kajo_sampling::Rng::new(41);
    let low = 89.999_f64.to_radians();
    for k in 0..pairs {
        let mut next = |special: bool| -> DVec3 {
            let phi = std::f64::consts::TAU * rng.next_f64();
            let theta = match rng.below(4) {
                _ if !special => rng.next_f64().acos(),
                0 => 0.0,
                1 => low,
                _ => rng.next_f64().acos(),
            };
            V3::from_angles(theta, phi).into()
        };
        let wo = next(k % 2 == 0);
        let wi = match k % 8 {
            0 => wo,
            2 => DVec3::new(-wo.x, -wo.y, wo.z),
            4 => -next(true),
            _ => next(k % 2 == 0),
        };
        let value = model.value(wi, wo);
        let single = model.value_f32(wi.as_vec3(), wo.as_vec3());
        if !(value.is_finite() && single.is_finite() && value.min_element() >= 0.0 && single.min_element() >= 0.0) {
            return Some(format!("{value} and {single} at {wi} {wo}"));
        }
        if wi.z < 0.0 && (value != DVec3::ZERO || single != glam::Vec3::ZERO) {
            return Some(format!("{value} below the horizon at {wi} {wo}"));
        }
        let (pdf, pdf_single) = (model.pdf(wi, wo), model.pdf_f32(wi.as_vec3(), wo.as_vec3()));
        if !(pdf.is_finite() && pdf_single.is_finite() && pdf >= 0.0 && pdf_single >= 0.0) {
            return Some(format!("density {pdf} and {pdf_single} at {wi} {wo}"));
        }
        if value.max_element() > 1e-30 && wi.z > 0.0 && pdf == 0.0 {
            return Some(format!("{value} is never sampled at {wi} {wo}"));
        }
        let u = std::array::from_fn(|_| rng.next_f64());
        let unsound = |wi: &DVec3| !wi.is_finite() || (wi.length() - 1.0).abs() > 1e-6 || wi.z <= 0.0;
        if let Some(wi) = model.sample(wo, u).filter(unsound) {
            return Some(format!("sample {wi} from {wo}"));
        }
    }
    None
}

/// Asserts that the model's own samples find the albedo of the quadrature within four standard errors, at 0, 30, 60 and 85 degrees, and that these
/// are small enough to notice an eighth of it.
#[track_caller]
pub fn assert_sampled_albedo(id: &str, pairs: &[(&str, &str)], samples: u32) {
    let model = model(id, pairs, Form::Corrected);
    // Samples of weight 0 (below the horizon) so rare that none came up change the mean and not the error.
    let rare = 8.0 / f64::from(samples);
    for theta in [0.0, 30.0, 60.0, 85.0] {
        let quadrature = albedo(&*model, theta, 20.0);
        let (mean, error) = sampled_albedo(&*model, theta, 20.0, samples);
        assert!(
            (mean - quadrature).abs() < 4.0 * error + rare * quadrature,
            "{id} {pairs:?} {theta}°: sampled {mean} ± {error}, quadrature {quadrature}"
        );
        assert!(error < 0.03 * (quadrature + 0.01), "{id} {pairs:?} {theta}°: ± {error} of {quadrature}");
    }
}

/// Largest relative asymmetry of f over pseudo-random pairs of directions.
pub fn asymmetry(f: impl Fn(DVec3, DVec3) -> f64, pairs: usize) -> f64 {
    let mut rng = kajo_sampling::Rng::new(77);
    let mut next = || kajo_sampling::warp::uniform_hemisphere(rng.next_2d()).as_dvec3().normalize();
    (0..pairs).fold(0.0, |worst, _| {
        let (a, b) = (next(), next());
        let (ab, ba) = (f(a, b), f(b, a));
        f64::max(worst, (ab - ba).abs() / ab.abs().max(ba.abs()).max(1e-12))
    })
}

/// E[f cos/pdf] by the model's own sampler and its standard error, seen from θ_r degrees.
pub fn sampled_albedo(model: &dyn Reflectance, theta_r: f64, phi_r: f64, samples: u32) -> (f64, f64) {
    let wo = DVec3::from(V3::from_angles(theta_r.to_radians(), phi_r.to_radians()));
    let mut rng = kajo_sampling::Rng::new(u64::from(samples));
    let (mut sum, mut squares) = (0.0, 0.0);
    for _ in 0..samples {
        let u = std::array::from_fn(|_| f64::from(rng.next_1d()));
        if let Some(wi) = model.sample(wo, u) {
            let weight = model.f_cos(wi, wo).x / model.pdf(wi, wo);
            sum += weight;
            squares += weight * weight;
        }
    }
    let n = f64::from(samples);
    let mean = sum / n;
    (mean, ((squares / n - mean * mean).max(0.0) / n).sqrt())
}

/// ∫ p dω over the sphere and over its upper half: midpoints in θ and φ.
pub fn masses(pdf: impl Fn(V3<f64>) -> f64) -> (f64, f64) {
    let (nt, np) = (2400, 600);
    let (mut whole, mut above) = (0.0, 0.0);
    for i in 0..nt {
        let theta = (f64::from(i) + 0.5) / f64::from(nt) * std::f64::consts::PI;
        let row: f64 = (0..np).map(|j| pdf(V3::from_angles(theta, (f64::from(j) + 0.5) / f64::from(np) * std::f64::consts::TAU))).sum();
        let mass = row * theta.sin() * 2.0 * std::f64::consts::PI * std::f64::consts::PI / (f64::from(nt) * f64::from(np));
        whole += mass;
        above += if 2 * i < nt { mass } else { 0.0 };
    }
    (whole, above)
}

/// p-value of χ²: do samples seen from θ_r, φ_r (degrees) follow `pdf`? Samples of weight 0 are a cell of their own.
pub fn chi_square(model: &dyn Reflectance, pdf: impl Fn(DVec3, DVec3) -> f64, theta_r: f64, phi_r: f64) -> f64 {
    chi_square_by(24, model, pdf, theta_r, phi_r)
}

/// [`chi_square`] with the density integrated by `fine` × `fine` nodes in each cell: many for densities with steps.
pub fn chi_square_by(fine: usize, model: &dyn Reflectance, pdf: impl Fn(DVec3, DVec3) -> f64, theta_r: f64, phi_r: f64) -> f64 {
    use std::f64::consts::{FRAC_PI_2, TAU};
    let (rows, columns, samples) = (12, 24, 200_000_u32);
    let wo = DVec3::from(V3::from_angles(theta_r.to_radians(), phi_r.to_radians()));
    let mut expected = vec![0.0; rows * columns + 1];
    for i in 0..rows * fine {
        let theta = (i as f64 + 0.5) / (rows * fine) as f64 * FRAC_PI_2;
        for j in 0..columns * fine {
            let phi = (j as f64 + 0.5) / (columns * fine) as f64 * TAU;
            let mass = pdf(DVec3::from(V3::from_angles(theta, phi)), wo) * theta.sin() * FRAC_PI_2 * TAU;
            expected[i / fine * columns + j / fine] += f64::from(samples) * mass / (rows * columns * fine * fine) as f64;
        }
    }
    let above: f64 = expected.iter().sum();
    expected[rows * columns] = (f64::from(samples) - above).max(0.0);
    let mut observed = vec![0.0; rows * columns + 1];
    let mut rng = kajo_sampling::Rng::new(91);
    for _ in 0..samples {
        let u = std::array::from_fn(|_| f64::from(rng.next_1d()));
        let cell = model.sample(wo, u).map_or(rows * columns, |wi| {
            let row = ((wi.z.acos() / FRAC_PI_2 * rows as f64) as usize).min(rows - 1);
            row * columns + (((wi.y.atan2(wi.x) / TAU).rem_euclid(1.0) * columns as f64) as usize).min(columns - 1)
        });
        observed[cell] += 1.0;
    }
    // Next to no lost mass is known to the accuracy of the quadrature only.
    let lost = [expected[rows * columns], observed[rows * columns]];
    if lost.iter().all(|count| *count < 2e-4 * f64::from(samples)) {
        expected[rows * columns] = observed[rows * columns];
    }
    kajo_sampling::statistics::chi_square_p_value(&observed, &expected, 0)
}

/// Asserts that samples follow the model's density, and that one off by 5 % between two halves of the azimuth would be noticed.
#[track_caller]
pub fn assert_samples_follow(model: &dyn Reflectance, theta_r: f64, phi_r: f64) {
    let p = chi_square(model, |wi, wo| model.pdf(wi, wo), theta_r, phi_r);
    assert!(p > 0.001, "seen from {theta_r}°, {phi_r}°: p = {p}");
    let fault = chi_square(model, |wi, wo| model.pdf(wi, wo) * if wi.y > 0.0 { 1.05 } else { 0.95 }, theta_r, phi_r);
    assert!(fault < 0.001, "planted fault: p = {fault}");
}

/// Pseudo-random directions, among them grazing ones, the retro-reflection Θ_i = Θ_r, and mirror pairs with Θ_h = N.
pub fn extreme_pair(rng: &mut kajo_sampling::Rng, k: u32) -> (DVec3, DVec3) {
    let mut direction = |kind: u32| {
        let theta = match kind {
            0 => 0.0,
            1 => 89.999,
            2 => f64::from(rng.next_1d()) * 1e-3,
            3 => 90.0 - f64::from(rng.next_1d()) * 0.1,
            _ => f64::from(rng.next_1d()) * 90.0,
        };
        directions([theta, f64::from(rng.next_1d()) * 360.0, 0.0, 0.0]).0
    };
    let wi = direction(k % 7);
    match k / 7 % 9 {
        0 => (wi, wi),
        1 => (wi, DVec3::new(-wi.x, -wi.y, wi.z)),
        kind => (wi, direction(kind - 2)),
    }
}

/// Asserts that value, density and samples are finite and not negative, in both precisions.
#[track_caller]
pub fn assert_finite(model: &dyn Reflectance, wi: DVec3, wo: DVec3) {
    let good = |v: DVec3| v.is_finite() && v.min_element() >= 0.0;
    assert!(good(model.value(wi, wo)), "{} at {wi} {wo}", model.value(wi, wo));
    let (wi32, wo32) = (wi.as_vec3(), wo.as_vec3());
    let single = model.value_f32(wi32, wo32);
    assert!(good(single.as_dvec3()), "f32: {single} at {wi} {wo}");
    for pdf in [model.pdf(wi, wo), f64::from(model.pdf_f32(wi32, wo32))] {
        assert!(pdf.is_finite() && pdf >= 0.0, "density {pdf} at {wi} {wo}");
    }
    let u = [wi.x.abs(), wi.y.abs(), wi.z.abs()].map(|v| v.min(0.999_999));
    let sample = model.sample(wo, u).unwrap_or(DVec3::Z);
    let sample32 = model.sample_f32(wo32, u.map(|v| v as f32)).map_or(DVec3::Z, |s| s.as_dvec3());
    assert!((sample.length() - 1.0).abs() < 1e-6 && (sample32.length() - 1.0).abs() < 1e-4, "samples {sample} {sample32} at {wo}");
}

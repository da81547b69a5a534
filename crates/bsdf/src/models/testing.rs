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

/// Directional albedo ∫ f cos θ dω seen from θ_r (and azimuth φ_r), degrees: midpoints in θ and φ.
pub fn albedo(model: &dyn Reflectance, theta_r: f64, phi_r: f64) -> f64 {
    use std::f64::consts::{FRAC_PI_2, PI, TAU};
    let (nz, np) = (900, 1440);
    let wo = DVec3::from(V3::from_angles(theta_r.to_radians(), phi_r.to_radians()));
    let azimuths: Vec<_> = (0..np).map(|j| ((f64::from(j) + 0.5) / f64::from(np) * TAU).sin_cos()).collect();
    let mut sum = 0.0;
    for i in 0..nz {
        let (sin, cos) = ((f64::from(i) + 0.5) / f64::from(nz) * FRAC_PI_2).sin_cos();
        let row: f64 = azimuths.iter().map(|(s, c)| model.f_cos(DVec3::new(c * sin, s * sin, cos), wo).x).sum();
        sum += row * sin;
    }
    sum * PI * PI / f64::from(nz * np)
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
    (mean, ((squares / n - mean * mean) / n).sqrt())
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
    use std::f64::consts::{FRAC_PI_2, TAU};
    let (rows, columns, fine, samples) = (12, 24, 24, 200_000_u32);
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

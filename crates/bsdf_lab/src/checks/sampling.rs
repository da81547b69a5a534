//! Do samples follow their density, and do value and density give the albedo?
//!
//! A χ² test compares samples with the density and says nothing of the weights; the mean weight f cos/pdf compared with quadrature says the rest.

use crate::albedo::{albedo, next, sampled_albedo};
use crate::quadrature::{Cell, angles, integrate};
use glam::DVec3;
use kajo_bsdf::models::Reflectance;
use kajo_sampling::Rng;
use kajo_sampling::statistics::chi_square_p_value;
use std::f64::consts::{FRAC_PI_2, TAU};

const ROWS: usize = 12;
const COLUMNS: usize = 24;

/// Both answers for one direction of the viewer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SamplingTest {
    /// Probability of samples this far from the density, if they follow it.
    pub p_value: f64,
    /// ∫ pdf over the hemisphere; the rest of the samples are lost below the horizon.
    pub mass: f64,
    /// Deviation of the sampled albedo from quadrature in standard errors.
    pub z: f64,
    /// The largest weight f cos/pdf.
    pub largest_weight: f64,
}

impl SamplingTest {
    /// Passes at significance `alpha` (corrected for the number of tests by the caller).
    pub fn holds(&self, alpha: f64) -> bool {
        // The two-sided normal quantile of alpha is about √(−2 ln alpha) or less.
        self.p_value > alpha && self.z.abs() < (-2.0 * alpha.ln()).sqrt() && self.mass <= 1.0 + 1e-3
    }
}

/// Tests `samples` samples seen from `wo`.
pub fn sampling_test(model: &dyn Reflectance, wo: DVec3, samples: u32, seed: u64) -> SamplingTest {
    test_against(model, |wi| model.pdf(wi, wo), wo, samples, seed)
}

/// [`sampling_test`] with a density of its own, for planted faults.
pub(crate) fn test_against(model: &dyn Reflectance, pdf: impl Fn(DVec3) -> f64, wo: DVec3, samples: u32, seed: u64) -> SamplingTest {
    let mut rng = Rng::new(seed);
    let mut observed = vec![0.0; ROWS * COLUMNS + 1];
    let mut peaks = Vec::new();
    for _ in 0..samples {
        let cell = model.sample(wo, next(&mut rng)).map_or(ROWS * COLUMNS, |wi| {
            if peaks.len() < 64 {
                peaks.push(wi);
            }
            let (theta, phi) = angles(wi);
            let row = (theta / FRAC_PI_2 * ROWS as f64).min(ROWS as f64 - 1.0) as usize;
            let column = (phi / TAU * COLUMNS as f64).min(COLUMNS as f64 - 1.0) as usize;
            row * COLUMNS + column
        });
        observed[cell] += 1.0;
    }
    // A tenth of a sample in each cell, below what χ² can see.
    let tolerance = 0.1 / f64::from(samples);
    let mut expected: Vec<f64> = (0..ROWS * COLUMNS)
        .map(|i| {
            let part = |k: usize, count: usize, whole: f64| [whole * k as f64 / count as f64, whole * (k + 1) as f64 / count as f64];
            let cell = Cell { theta: part(i / COLUMNS, ROWS, FRAC_PI_2), phi: part(i % COLUMNS, COLUMNS, TAU) };
            integrate(cell, &peaks, tolerance, |wi| DVec3::new(pdf(wi), 0.0, 0.0)).x * f64::from(samples)
        })
        .collect();
    let mass = expected.iter().sum::<f64>() / f64::from(samples);
    expected.push(f64::from(samples) * (1.0 - mass).max(0.0));
    // The lost mass is known to the accuracy of the quadrature only.
    if expected[ROWS * COLUMNS] < 1e-4 * f64::from(samples) {
        expected[ROWS * COLUMNS] = observed[ROWS * COLUMNS];
    }
    let sampled = sampled_albedo(model, wo, samples, seed + 1);
    let exact = albedo(model, wo, 1e-6);
    // Rounding and quadrature, where sampling is perfect and the standard error nothing; and one sample, for what is so rare that it never came up.
    let error = sampled.standard_error.max_element() + sampled.largest_weight / f64::from(samples) + 1e-6;
    SamplingTest {
        p_value: chi_square_p_value(&observed, &expected, 0),
        mass,
        z: (sampled.mean - exact).abs().max_element() / error,
        largest_weight: sampled.largest_weight,
    }
}

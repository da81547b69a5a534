//! The table of a measured isotropic BRDF: 90 × 90 × 180 bins over (θ_h, θ_d, φ_d), those of θ_h the finer the nearer to the normal.
//!
//! ```text
//! bin of θ_h  ⌊90 √(θ_h/(π/2))⌋        of θ_d  ⌊90 θ_d/(π/2)⌋        of φ_d  ⌊180 φ_d/π⌋
//! ```

use super::coordinates::HalfDifference;
use crate::models::{Kind, Reflectance};
use glam::DVec3;
use kajo_params::ParamChoice;
use std::f64::consts::{FRAC_PI_2, PI};

/// Bins of θ_h, θ_d and φ_d.
pub const BINS: [usize; 3] = [90, 90, 180];

/// How values between the centres of bins are found.
#[derive(ParamChoice, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interpolation {
    /// The value of the bin, as in the code published with the data.
    Nearest,
    /// Between the centres of the eight bins around, without those that were not measured.
    Linear,
}

/// f in 1/sr of each bin; negative where nothing was measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    bins: Vec<[f32; 3]>,
}

/// Marks a bin without a measurement.
pub(super) const MISSING: [f32; 3] = [-1.0; 3];

impl Table {
    /// Of 90 · 90 · 180 bins.
    pub(super) fn of_bins(bins: Vec<[f32; 3]>) -> Self {
        assert_eq!(bins.len(), BINS.iter().product::<usize>(), "bins of a table");
        Self { bins }
    }

    /// The bins, φ_d fastest, then θ_d.
    pub(super) fn bins(&self) -> &[[f32; 3]] {
        &self.bins
    }

    /// Measures a model at the centre of each bin; bins with a direction below the surface have no measurement. Of an anisotropic model the table keeps
    /// what half vectors along the tangent's azimuth reflect, of one that is not reciprocal the value for φ_d in [0, π).
    pub fn of_model(model: &dyn Reflectance) -> Self {
        let value = |index: usize| {
            let (wi, wo) = centre(index).directions();
            if wi.z <= 0.0 || wo.z <= 0.0 {
                return MISSING;
            }
            let f = match model.kind() {
                Kind::Brdf => model.value(wi, wo),
                Kind::Bsf => model.value(wi, wo) / (PI * wi.z),
            };
            f.as_vec3().to_array()
        };
        Self { bins: (0..BINS.iter().product()).map(value).collect() }
    }

    /// f in 1/sr for directions above the surface; 0 where nothing was measured.
    pub fn value(&self, wi: DVec3, wo: DVec3, interpolation: Interpolation) -> DVec3 {
        let angles = HalfDifference::new(wi, wo);
        let [theta_h, theta_d, phi_d] = BINS.map(|count| count as f64);
        let at = [theta_h * (angles.theta_h / FRAC_PI_2).sqrt(), theta_d * angles.theta_d / FRAC_PI_2, phi_d * angles.phi_d / PI];
        match interpolation {
            Interpolation::Nearest => self.measured(at.map(|x| x as usize)).unwrap_or(DVec3::ZERO),
            Interpolation::Linear => self.between_centres(at.map(|x| x - 0.5)),
        }
    }

    fn between_centres(&self, at: [f64; 3]) -> DVec3 {
        let low = at.map(f64::floor);
        let share = [at[0] - low[0], at[1] - low[1], at[2] - low[2]];
        let (mut sum, mut weights) = (DVec3::ZERO, 0.0);
        for corner in 0..8_usize {
            let upper = [corner & 1, corner >> 1 & 1, corner >> 2];
            let weight: f64 = (0..3).map(|axis| if upper[axis] == 1 { share[axis] } else { 1.0 - share[axis] }).product();
            let index = |axis: usize| (low[axis] as isize + upper[axis] as isize).max(0) as usize;
            // φ_d goes on at its other end.
            let around = (low[2] as isize + upper[2] as isize).rem_euclid(BINS[2] as isize) as usize;
            if let Some(value) = self.measured([index(0), index(1), around]) {
                sum += weight * value;
                weights += weight;
            }
        }
        // Below, the only measured neighbours are as good as out of reach.
        if weights > 1e-9 { sum / weights } else { DVec3::ZERO }
    }

    fn measured(&self, bin: [usize; 3]) -> Option<DVec3> {
        let [h, d, p] = std::array::from_fn(|axis| bin[axis].min(BINS[axis] - 1));
        let value = self.bins[(h * BINS[1] + d) * BINS[2] + p];
        value.iter().all(|v| *v >= 0.0).then(|| DVec3::from_array(value.map(f64::from)))
    }
}

/// The angles at the centre of a bin.
pub(super) fn centre(index: usize) -> HalfDifference {
    let share = |i: usize, axis: usize| (i as f64 + 0.5) / BINS[axis] as f64;
    HalfDifference {
        theta_h: share(index / (BINS[1] * BINS[2]), 0).powi(2) * FRAC_PI_2,
        theta_d: share(index / BINS[2] % BINS[1], 1) * FRAC_PI_2,
        phi_d: share(index % BINS[2], 2) * PI,
    }
}

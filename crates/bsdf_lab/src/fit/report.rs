//! How far a model is from its target.

use super::samples::reflected;
use super::{Metric, Samples};
use glam::DVec3;
use kajo_bsdf::models::Reflectance;

/// Errors at one inclination of the light.
#[derive(Clone, Copy, Debug)]
pub struct AngleError {
    /// Degrees.
    pub theta_i: f64,
    /// Root mean square of (f − g) cos θ_i cos θ_r, 1/sr.
    pub rms: f64,
    /// Over the root mean square of g cos θ_i cos θ_r at this inclination.
    pub relative_rms: f64,
    /// How many.
    pub samples: usize,
}

/// Errors of a model.
#[derive(Clone, Debug)]
pub struct Report {
    /// Root mean square of (f − g) cos θ_i cos θ_r over that of g cos θ_i cos θ_r.
    pub relative_rms: f64,
    /// Root mean square of the logarithmic residual of [`Metric::Log`].
    pub log_rms: f64,
    /// By inclination of the light, ascending.
    pub by_theta_i: Vec<AngleError>,
}

impl Report {
    /// Of `model` against `target`.
    pub fn of(model: &dyn Reflectance, target: &Samples) -> Self {
        let floor = super::solve::floor(target);
        let mut by_theta_i: Vec<(AngleError, f64)> = Vec::new();
        let (mut wrong, mut right, mut log) = (0.0, 0.0, 0.0);
        let squares = |v: DVec3| v.length_squared() / 3.0;
        for sample in target.as_slice() {
            let f = reflected(model, sample.wi, sample.wo);
            let (error, size) = (squares(Metric::Cos.residual(sample, f, floor)), squares(sample.f * sample.weight()));
            (wrong, right) = (wrong + error, right + size);
            log += squares(Metric::Log.residual(sample, f, floor));
            let found = by_theta_i.iter().position(|(angle, _)| angle.theta_i == sample.theta_i);
            let index = found.unwrap_or_else(|| {
                by_theta_i.push((AngleError { theta_i: sample.theta_i, rms: 0.0, relative_rms: 0.0, samples: 0 }, 0.0));
                by_theta_i.len() - 1
            });
            let (angle, sum) = &mut by_theta_i[index];
            angle.rms += error;
            angle.samples += 1;
            *sum += size;
        }
        by_theta_i.sort_by(|(a, _), (b, _)| a.theta_i.total_cmp(&b.theta_i));
        let finished = by_theta_i.into_iter().map(|(angle, size)| AngleError {
            rms: (angle.rms / angle.samples as f64).sqrt(),
            relative_rms: (angle.rms / size.max(f64::MIN_POSITIVE)).sqrt(),
            ..angle
        });
        Self {
            relative_rms: (wrong / right.max(f64::MIN_POSITIVE)).sqrt(),
            log_rms: (log / target.as_slice().len().max(1) as f64).sqrt(),
            by_theta_i: finished.collect(),
        }
    }
}

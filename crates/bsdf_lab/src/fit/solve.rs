//! Levenberg and Marquardt's method from many starts.

use super::samples::reflected;
use super::unknown::{Unknown, unknowns};
use super::{FitError, Metric, Report, Samples};
use kajo_bsdf::models::{Form, ModelEntry, Reflectance};
use kajo_params::{ParamValues, Rows, Value};
use kajo_sampling::Rng;
use rayon::prelude::*;
use rmpfit::{MPConfig, MPError, MPFitter, MPPar, MPResult, MPSide, MPStatus};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Step of the numerical Jacobian, in [0, 1] of a range: central differences are then good to 1e-9 or so.
const STEP: f64 = 1e-6;

/// How to fit.
#[derive(Clone, Debug)]
pub struct Options {
    /// What is made small.
    pub metric: Metric,
    /// Parameters to change; none for every number.
    pub free: Vec<String>,
    /// C_x = C_y in lobes.
    pub isotropic: bool,
    /// How many starts: the values given, and random ones.
    pub starts: usize,
    /// Of the random starts.
    pub seed: u64,
    /// Which form of the equation is fitted.
    pub form: Form,
}

impl Default for Options {
    fn default() -> Self {
        Self { metric: Metric::Cos, free: Vec::new(), isotropic: false, starts: 16, seed: 0, form: Form::Corrected }
    }
}

/// Follows a fit, and may end it: what the starts that are done have found is then the result.
pub trait Watch: Sync {
    /// Some starts are done.
    fn done(&self, _starts: usize) {}
    /// Whether to go on; asked often.
    fn goes_on(&self) -> bool {
        true
    }
}

/// Nobody watches.
impl Watch for () {}

/// One number found.
#[derive(Clone, Debug)]
pub struct Estimate {
    /// `m`, `kd.r`, `lobe[1].cz`.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// Standard error, from the residuals' scatter; `None` where the target does not determine the number or it lies at the end of its range.
    pub standard_error: Option<f64>,
}

/// A model that was fitted.
#[derive(Clone)]
pub struct Fit {
    /// Every parameter.
    pub values: ParamValues,
    /// The model.
    pub model: Arc<dyn Reflectance>,
    /// What was changed.
    pub estimates: Vec<Estimate>,
    /// Numbers that change nothing beside the others' values, such as the width of a lobe that is switched off; they stay.
    pub idle: Vec<String>,
    /// How far the model is from the target.
    pub report: Report,
    /// Starts that were tried to the end: fewer than asked for where the watch ended the fit.
    pub tried: usize,
    /// Starts that came to the best sum of squares, within a thousandth.
    pub agreeing: usize,
    /// Evaluations of the model's whole table, by all starts.
    pub evaluations: usize,
}

/// Fits `entry` to `target`, beginning at `start`, whose other values stay.
///
/// # Errors
/// [`FitError`].
pub fn fit(
    entry: &'static ModelEntry,
    start: &ParamValues,
    target: &Samples,
    options: &Options,
    watch: &dyn Watch,
) -> Result<Fit, FitError> {
    let grey = target.is_grey();
    let mut unknowns = unknowns(entry, start, &options.free, grey, options.isotropic)?;
    let values: Vec<Value> = start.iter().map(|(_, value)| value).collect();
    let count = target.as_slice().len() * if grey { 1 } else { 3 };
    if count < unknowns.len() {
        return Err(FitError::TooFew { values: count, unknowns: unknowns.len() });
    }
    if target.rms() == 0.0 {
        return Err(FitError::Black);
    }
    (entry.make)(start, options.form)?;
    let busy = Problem::new(entry, values.clone(), &unknowns, target, options, watch).busy();
    let mut idle = Vec::new();
    for index in (0..unknowns.len()).rev().filter(|&index| !busy[index]) {
        idle.insert(0, unknowns.remove(index).name);
    }
    if unknowns.is_empty() {
        return Err(FitError::NotFree { name: idle.join(","), reason: "it changes nothing beside the other values".into() });
    }
    let starts = options.starts.max(1);
    let tried = AtomicUsize::new(0);
    let end_of_start = || watch.done(1 + tried.fetch_add(1, Ordering::Relaxed));
    let found: Vec<Try> = (0..starts)
        .into_par_iter()
        .filter_map(|index| {
            if !watch.goes_on() {
                return None;
            }
            let mut problem = Problem::new(entry, values.clone(), &unknowns, target, options, watch);
            let mut u = problem.start(index, options.seed)?;
            let status = problem.mpfit(&mut u);
            // A start that was broken off is none.
            if !watch.goes_on() {
                return None;
            }
            end_of_start();
            let status = status.ok().filter(|status| status.best_norm.is_finite())?;
            let values = problem.near(&u)?.0;
            Some(Try { u, values, status, evaluations: problem.evaluations })
        })
        .collect();
    let evaluations = found.iter().map(|attempt| attempt.evaluations).sum();
    let Some(Try { u, values, status, .. }) = found.iter().min_by(|a, b| a.status.best_norm.total_cmp(&b.status.best_norm)) else {
        return Err(if watch.goes_on() { FitError::NoneConverged { starts } } else { FitError::Interrupted });
    };
    // Sums of squares of rounding errors are all alike.
    let alike = status.best_norm * 1.001 + 1e-16 * status.orig_norm;
    let model = (entry.make)(values, options.form)?;
    let plain: Vec<Value> = values.iter().map(|(_, value)| value).collect();
    let scatter = (status.best_norm / (count - unknowns.len()).max(1) as f64).sqrt();
    let estimates = unknowns.iter().zip(u).zip(&status.xerror).map(|((unknown, &u), &error)| {
        let (low, high) = around(u);
        let slope = (unknown.value(high) - unknown.value(low)) / (high - low);
        // An error as large as the range is none.
        let standard_error = Some(error * scatter).filter(|error| *error > 0.0 && *error < 1.0).map(|error| error * slope);
        Estimate { name: unknown.name.clone(), value: unknown.read(&plain), standard_error }
    });
    Ok(Fit {
        estimates: estimates.collect(),
        idle,
        report: Report::of(&*model, target),
        tried: tried.into_inner(),
        agreeing: found.iter().filter(|attempt| attempt.status.best_norm <= alike).count(),
        evaluations,
        model,
        values: values.clone(),
    })
}

/// Where a start led.
struct Try {
    u: Vec<f64>,
    values: ParamValues,
    status: MPStatus,
    evaluations: usize,
}

/// e of [`Metric::Log`].
pub(super) fn floor(target: &Samples) -> f64 {
    (1e-3 * target.rms()).max(f64::MIN_POSITIVE)
}

/// Two places about u within [0, 1].
fn around(u: f64) -> (f64, f64) {
    ((u - STEP).max(0.0), (u + STEP).min(1.0))
}

/// The least-squares problem over the unknowns' positions.
struct Problem<'a> {
    entry: &'static ModelEntry,
    values: Vec<Value>,
    unknowns: &'a [Unknown],
    target: &'a Samples,
    options: &'a Options,
    watch: &'a dyn Watch,
    channels: usize,
    floor: f64,
    limits: Vec<MPPar>,
    config: MPConfig,
    evaluations: usize,
    /// Where the solver started: the model takes it.
    centre: Vec<f64>,
}

impl<'a> Problem<'a> {
    fn new(
        entry: &'static ModelEntry,
        values: Vec<Value>,
        unknowns: &'a [Unknown],
        target: &'a Samples,
        options: &'a Options,
        watch: &'a dyn Watch,
    ) -> Self {
        let limit = || MPPar { limited_low: true, limited_up: true, limit_low: 0.0, limit_up: 1.0, side: MPSide::User, ..MPPar::default() };
        Self {
            entry,
            values,
            unknowns,
            target,
            options,
            watch,
            channels: if target.is_grey() { 1 } else { 3 },
            floor: floor(target),
            limits: unknowns.iter().map(|_| limit()).collect(),
            config: MPConfig { ftol: 1e-14, xtol: 1e-12, gtol: 1e-14, max_iter: 300, ..MPConfig::default() },
            evaluations: 0,
            centre: Vec::new(),
        }
    }

    /// Every parameter with the unknowns at `u`.
    fn at(&self, u: &[f64]) -> ParamValues {
        let mut values = self.values.clone();
        for (unknown, &u) in self.unknowns.iter().zip(u) {
            unknown.write(&mut values, unknown.value(u));
        }
        ParamValues::new(self.entry.params, values)
    }

    /// The model at `u`; where it refuses parameters that do not go together, such as k_d + k_s > 1, at the last place that it takes on the way
    /// there from the start. So residuals are continuous and an optimum on such a limit can be reached.
    fn near(&self, u: &[f64]) -> Option<(ParamValues, Arc<dyn Reflectance>)> {
        let take = |u: &[f64]| {
            let values = self.at(u);
            (self.entry.make)(&values, self.options.form).ok().map(|model| (values, model))
        };
        take(u).or_else(|| {
            let on_the_way = |t: f64| -> Vec<f64> { self.centre.iter().zip(u).map(|(c, u)| c + (u - c) * t).collect() };
            let (mut taken, mut low, mut high) = (take(&self.centre)?, 0.0, 1.0);
            for _ in 0..40 {
                let middle = 0.5 * (low + high);
                match take(&on_the_way(middle)) {
                    Some(found) => (taken, low) = (found, middle),
                    None => high = middle,
                }
            }
            Some(taken)
        })
    }

    /// The first start is what the caller gave; random ones are drawn until the model takes one.
    fn start(&mut self, index: usize, seed: u64) -> Option<Vec<f64>> {
        let mut rng = Rng::new(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15).wrapping_add(index as u64));
        let mut random = || {
            let back: [bool; Rows::MOST] = std::array::from_fn(|_| rng.next_f64() < 0.125);
            self.unknowns.iter().map(|unknown| unknown.start(&mut rng, &back)).collect::<Vec<f64>>()
        };
        let given = || self.unknowns.iter().map(|unknown| unknown.position(unknown.read(&self.values))).collect();
        self.centre = (0..100)
            .map(|_| if index == 0 { given() } else { random() })
            .find(|u| (self.entry.make)(&self.at(u), self.options.form).is_ok())?;
        Some(self.centre.clone())
    }

    /// Which unknowns change a residual, at the caller's start or at a random one.
    fn busy(&mut self) -> Vec<bool> {
        let mut busy = vec![false; self.unknowns.len()];
        let (mut here, mut there) = (vec![0.0; self.number_of_points()], vec![0.0; self.number_of_points()]);
        for index in 0..4 {
            let Some(mut u) = self.start(index, self.options.seed) else { continue };
            if self.residuals(&u, &mut here).is_none() {
                continue;
            }
            for (index, busy) in busy.iter_mut().enumerate() {
                let place = u[index];
                // To both sides: one of them may be out of range or refused.
                for moved in [place * 0.9, place + 0.1 * (1.0 - place)] {
                    u[index] = moved;
                    *busy |= self.residuals(&u, &mut there).is_some() && here != there;
                }
                u[index] = place;
            }
        }
        busy
    }

    /// Residuals at `u`; `None` where one is not finite.
    fn residuals(&mut self, u: &[f64], out: &mut [f64]) -> Option<()> {
        self.evaluations += 1;
        let (_, model) = self.near(u)?;
        for (sample, out) in self.target.as_slice().iter().zip(out.chunks_exact_mut(self.channels)) {
            let residual = self.options.metric.residual(sample, reflected(&*model, sample.wi, sample.wo), self.floor);
            out.copy_from_slice(&residual.to_array()[..self.channels]);
        }
        out.iter().all(|r| r.is_finite()).then_some(())
    }
}

impl MPFitter for Problem<'_> {
    /// A step to where nothing is finite is worse than any other, so that a shorter one is tried.
    fn eval(&mut self, u: &[f64], deviates: &mut [f64]) -> MPResult<()> {
        if !self.watch.goes_on() {
            return Err(MPError::Eval);
        }
        if self.residuals(u, deviates).is_none() {
            deviates.fill(1e6 * self.target.rms().max(1.0));
        }
        Ok(())
    }

    fn number_of_points(&self) -> usize {
        self.target.as_slice().len() * self.channels
    }

    fn config(&self) -> &MPConfig {
        &self.config
    }

    fn parameters(&self) -> &[MPPar] {
        &self.limits
    }

    /// Central differences; to one side at the end of a range and where the other side is not finite.
    fn jacobian(&mut self, u: &[f64], deviates: &mut [f64], derivs: &mut [Option<Vec<f64>>]) -> MPResult<()> {
        self.residuals(u, deviates).ok_or(MPError::Eval)?;
        let (mut low, mut high) = (deviates.to_vec(), deviates.to_vec());
        for (index, column) in derivs.iter_mut().enumerate() {
            let Some(column) = column else { continue };
            if !self.watch.goes_on() {
                return Err(MPError::Eval);
            }
            let (mut below, mut above) = around(u[index]);
            let mut moved = u.to_vec();
            moved[index] = below;
            if self.residuals(&moved, &mut low).is_none() {
                (below, low) = (u[index], deviates.to_vec());
            }
            moved[index] = above;
            if self.residuals(&moved, &mut high).is_none() {
                (above, high) = (u[index], deviates.to_vec());
            }
            let step = above - below;
            if step == 0.0 {
                column.fill(0.0);
                continue;
            }
            for ((slot, low), high) in column.iter_mut().zip(&low).zip(&high) {
                *slot = (high - low) / step;
            }
        }
        Ok(())
    }
}

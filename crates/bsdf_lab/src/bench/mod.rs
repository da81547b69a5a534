//! What a call of a model costs: nanoseconds one by one and many at once, beside what its source measured and beside loops written by hand.
//!
//! Everything is measured in rounds that take turns, and the least of them counts: what other programs do at the same time makes rounds longer, never
//! shorter. Directions go round a set of 65 536 pairs, so that nothing is known at compile time, and every value enters a checksum.

mod by_hand;
mod fresnel;
mod inputs;
mod survey;

pub use by_hand::{DEFAULTS, Materials, by_hand};
pub use fresnel::{CLAIMED_RATIO, FresnelCost};
pub use inputs::{BLOCK, Inputs};
pub use survey::{Survey, surveyed, weight};

use glam::Vec3;
use kajo_bsdf::models::{Instructions, Operations, Reflectance, V3};
use std::hint::black_box;
use std::time::Instant;

/// A model to be timed.
#[derive(Clone, Copy)]
pub struct Subject<'a> {
    /// Its id.
    pub id: &'a str,
    /// With its parameters.
    pub model: &'a dyn Reflectance,
    /// Its parameters are the defaults, so that a loop by hand does the same.
    pub is_default: bool,
}

/// What calls cost, ns each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nanoseconds {
    /// By [`Reflectance::value_f32`], through the table of methods as a renderer calls it.
    pub single: f64,
    /// By [`Reflectance::values_f32`], 1024 pairs a call.
    pub many: f64,
}

/// The cost of a model.
#[derive(Clone, Debug)]
pub struct ModelCost {
    /// The model's id.
    pub id: String,
    /// As measured.
    pub raw: Nanoseconds,
    /// The mean over all calls of the values' three channels added up: by single calls and by many at once.
    pub checksums: [f64; 2],
    /// Of one call, the half vector given; `None` for models of other code than formulas.
    pub operations: Option<Operations>,
    /// The loop written by hand: ns a call, and its checksum.
    pub by_hand: Option<(f64, f64)>,
}

/// All costs of a run.
#[derive(Clone, Debug)]
pub struct Costs {
    /// Calls of each kind for each model: those asked for, rounded up to whole sets of inputs.
    pub calls: u64,
    /// Rounds that these are spread over.
    pub rounds: u32,
    /// What many calls use.
    pub instructions: Instructions,
    /// The loops without the model.
    pub empty: Nanoseconds,
    /// In the order asked for.
    pub models: Vec<ModelCost>,
    /// Fresnel's equations against Schlick's approximation.
    pub fresnel: FresnelCost,
}

impl Costs {
    /// Costs without the loop.
    pub fn net(&self, raw: Nanoseconds) -> Nanoseconds {
        Nanoseconds { single: raw.single - self.empty.single, many: raw.many - self.empty.many }
    }
}

/// Times models by at least `calls` calls of each kind. `progress` is told the share that is done, and stops the run by `false`: then the result is `None`.
pub fn bench(subjects: &[Subject<'_>], calls: u64, mut progress: impl FnMut(f64) -> bool) -> Option<Costs> {
    let inputs = Inputs::new();
    let set = inputs.pairs() as u64;
    let rounds = (calls / (4 * set)).clamp(1, 16) as u32;
    let blocks_a_round = calls.div_ceil(set * u64::from(rounds)) * (set / BLOCK as u64);
    let instructions = Instructions::detect();
    let probes = fresnel::probes();
    let probe_subjects = probes.iter().map(|(id, model)| Subject { id, model: &**model, is_default: true });
    let all: Vec<Subject<'_>> = subjects.iter().copied().chain(probe_subjects).collect();

    let mut loops: Vec<TimedLoop> = all.iter().map(|subject| TimedLoop::new(subject, instructions)).collect();
    let mut empty = Nanoseconds { single: f64::INFINITY, many: f64::INFINITY };
    for round in 0..rounds {
        empty.single = empty.single.min(time_single(&inputs, blocks_a_round, |wi, _| wi).0);
        empty.many = empty.many.min(time_many(&inputs, blocks_a_round, |_, _, _| ()));
        for (k, timed) in loops.iter_mut().enumerate() {
            timed.round(&inputs, blocks_a_round);
            if !progress((f64::from(round) + (k + 1) as f64 / all.len() as f64) / f64::from(rounds)) {
                return None;
            }
        }
    }
    let mut costs: Vec<ModelCost> = loops.into_iter().map(|timed| timed.finish(&inputs)).collect();
    let fresnel = FresnelCost::of(&costs.split_off(subjects.len()));
    let calls = u64::from(rounds) * blocks_a_round * BLOCK as u64;
    Some(Costs { calls, rounds, instructions, empty, models: costs, fresnel })
}

/// Values of many pairs.
type Many<'a> = &'a dyn Fn(&[Vec3], &[Vec3], &mut [Vec3]);

/// A model between its rounds.
struct TimedLoop<'a> {
    subject: &'a Subject<'a>,
    by_hand: Option<by_hand::Loop>,
    raw: Nanoseconds,
    hand: f64,
    sum: f64,
    calls: f64,
}

impl<'a> TimedLoop<'a> {
    fn new(subject: &'a Subject<'a>, instructions: Instructions) -> Self {
        let by_hand = if subject.is_default { by_hand(instructions, subject.id) } else { None };
        let raw = Nanoseconds { single: f64::INFINITY, many: f64::INFINITY };
        Self { subject, by_hand, raw, hand: f64::INFINITY, sum: 0.0, calls: 0.0 }
    }

    fn round(&mut self, inputs: &Inputs, blocks: u64) {
        let model = self.subject.model;
        let (single, sum) = time_single(inputs, blocks, |wi, wo| model.value_f32(wi, wo));
        self.raw.single = self.raw.single.min(single);
        self.sum += sum;
        self.calls += (blocks * BLOCK as u64) as f64;
        self.raw.many = self.raw.many.min(time_many(inputs, blocks, |wi, wo, out| model.values_f32(wi, wo, out)));
        if let Some(by_hand) = self.by_hand {
            let material = black_box(DEFAULTS);
            self.hand = self.hand.min(time_many(inputs, blocks, |wi, wo, out| by_hand(&material, wi, wo, out)));
        }
    }

    fn finish(self, inputs: &Inputs) -> ModelCost {
        let model = self.subject.model;
        let mean = |many: Many<'_>| {
            let mut out = [Vec3::ZERO; BLOCK];
            let blocks = inputs.pairs() / BLOCK;
            let sum: f64 = (0..blocks)
                .map(|block| {
                    let (wi, wo) = inputs.block(block as u64);
                    many(wi, wo, &mut out);
                    out.iter().map(|f| f64::from(f.x) + f64::from(f.y) + f64::from(f.z)).sum::<f64>()
                })
                .sum();
            sum / inputs.pairs() as f64
        };
        let (wi, wo) = (V3::from_angles(0.5, 0.3).into(), V3::from_angles(0.8, 2.5).into());
        ModelCost {
            id: self.subject.id.to_owned(),
            raw: self.raw,
            checksums: [self.sum / self.calls, mean(&|wi, wo, out| model.values_f32(wi, wo, out))],
            operations: model.operations(wi, wo),
            by_hand: self.by_hand.map(|by_hand| (self.hand, mean(&|wi, wo, out| by_hand(&DEFAULTS, wi, wo, out)))),
        }
    }
}

/// ns a call, and the sum of all values' channels.
fn time_single(inputs: &Inputs, blocks: u64, value: impl Fn(Vec3, Vec3) -> Vec3) -> (f64, f64) {
    let mut total = 0.0;
    let start = Instant::now();
    for block in 0..blocks {
        let (wi, wo) = inputs.block(block);
        let mut sum = Vec3::ZERO;
        for (wi, wo) in wi.iter().zip(wo) {
            sum += value(*black_box(wi), *black_box(wo));
        }
        total += f64::from(sum.x) + f64::from(sum.y) + f64::from(sum.z);
    }
    (nanoseconds(start, blocks), black_box(total))
}

/// ns a pair.
fn time_many(inputs: &Inputs, blocks: u64, values: impl Fn(&[Vec3], &[Vec3], &mut [Vec3])) -> f64 {
    let mut out = [Vec3::ZERO; BLOCK];
    let start = Instant::now();
    for block in 0..blocks {
        let (wi, wo) = inputs.block(block);
        values(black_box(wi), black_box(wo), black_box(&mut out));
    }
    nanoseconds(start, blocks)
}

fn nanoseconds(start: Instant, blocks: u64) -> f64 {
    start.elapsed().as_secs_f64() * 1e9 / (blocks * BLOCK as u64) as f64
}

#[cfg(test)]
mod tests;

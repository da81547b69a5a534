//! `kajo compare`: error and cost of techniques, as a report.

use crate::arguments::{Common, Compare};
use crate::failure::{Failure, Outcome};
use crate::output;
use crate::{progress, view};
use indicatif::ProgressBar;
use kajo_lab::report::Report;
use kajo_lab::{CompareOptions, LabError, Progress, ReferenceStop, compare};

/// Runs the comparison and says what to use.
pub fn run(common: &Common, arguments: &Compare) -> Outcome {
    let options = options(arguments);
    let watched = Watched::new(progress::bar(common.quiet, "comparing"));
    let result = compare(&options, &watched);
    watched.finish();
    let report = result.map_err(|error| match error {
        LabError::Technique(_) | LabError::Nothing { .. } => Failure::usage(error),
        LabError::Scene(error) => view::failure(error),
        other => other.into(),
    })?;
    if common.json {
        output::json(&report)?;
    } else if !common.quiet {
        tell(&options, &report)?;
    }
    report.nothing_compared().map_or(Ok(()), |reason| Err(LabError::NotMeasured { reason }.into()))
}

fn options(arguments: &Compare) -> CompareOptions {
    let defaults = CompareOptions::default();
    CompareOptions {
        scenes: arguments.scenes.clone(),
        output: arguments.output.clone(),
        roles: arguments.role.clone(),
        techniques: arguments.technique.clone(),
        size: arguments.size.map(|size| size.0),
        reference: match (arguments.reference_spp, arguments.reference_noise) {
            (Some(spp), _) => ReferenceStop::Spp(spp),
            (None, Some(noise)) => ReferenceStop::Noise(noise as f32),
            (None, None) => defaults.reference,
        },
        frames: arguments.frames,
        repeat: arguments.repeat,
        temporal: arguments.temporal,
        budget_ms: arguments.budget_ms,
        camera: arguments.view.camera.clone(),
        look: view::look(&arguments.view),
        environment: arguments.view.env.clone(),
        time: arguments.view.frame,
        animation: arguments.view.animation.clone(),
        ambient_distance: arguments.view.ambient_distance.map(|distance| distance as f32),
        ray_culling: arguments.view.ray_culling,
        seed: arguments.seed,
        threads: arguments.threads.map(usize::from),
    }
}

/// The advice on stdout, what was skipped on stderr.
fn tell(options: &CompareOptions, report: &Report) -> Outcome {
    for run in report.runs.iter().filter(|run| !run.is_ok()) {
        eprintln!("note: {}, {}: {}", run.scene, run.label(), run.status);
    }
    for warning in &report.warnings {
        eprintln!("note: {warning}");
    }
    let decisions = report.decisions.iter().map(|decision| format!("{}, {}: {}\n", decision.scene, decision.role, decision.sentence));
    output::text(&format!("{}{}\n", decisions.collect::<String>(), options.output.join("index.html").display()))
}

/// Shows progress of the lab on a bar and stops it at an interrupt.
pub struct Watched {
    bar: ProgressBar,
}

impl Watched {
    /// On this bar.
    pub fn new(bar: ProgressBar) -> Self {
        Self { bar }
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

impl Progress for Watched {
    fn at(&self, what: &str, fraction: f64) {
        self.bar.set_position((fraction * 1000.0) as u64);
        if self.bar.message() != what {
            self.bar.set_message(what.to_owned());
        }
    }

    fn interrupted(&self) -> bool {
        progress::interrupted()
    }
}

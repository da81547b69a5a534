//! `kajo bsdf`: one file a subcommand.

mod albedo;
mod bench;
mod check;
mod claims;
mod errata;
mod eval;
mod factor;
mod fit;
mod gallery;
mod list;
mod plot;
mod sample_test;
mod table;

use crate::arguments::Common;
use crate::arguments::bsdf::{Bsdf, Form, ModelChoice, Models, Table};
use crate::failure::{Failure, Outcome};
use glam::DVec3;
use kajo_bsdf::models::{ModelEntry, ModelError, Reflectance, V3, all, find};
use kajo_names::UnknownName;
use kajo_params::ParamValues;
use std::sync::Arc;

/// Carries out the subcommand.
pub fn run(common: &Common, command: &Bsdf) -> Outcome {
    match command {
        Bsdf::List { id, markdown } => list::run(common, id.as_deref(), *markdown),
        Bsdf::Eval(arguments) => eval::run(common, arguments),
        Bsdf::Albedo(arguments) => albedo::run(common, arguments),
        Bsdf::Check(arguments) => check::run(common, arguments),
        Bsdf::Table(Table { errata: true, .. }) => errata::run(common),
        Bsdf::Table(Table { claims: true, .. }) => claims::run(common),
        Bsdf::Table(Table { form, .. }) => table::run(common, (*form).into()),
        Bsdf::Plot(arguments) => plot::run(common, arguments),
        Bsdf::SampleTest(arguments) => sample_test::run(common, arguments),
        Bsdf::Bench(arguments) => bench::run(common, arguments),
        Bsdf::Fit(arguments) => fit::run(common, arguments),
        Bsdf::Factor(arguments) => factor::run(common, arguments),
    }
}

/// A model that the user chose, ready to evaluate.
struct Chosen {
    entry: &'static ModelEntry,
    values: ParamValues,
    model: Arc<dyn Reflectance>,
}

fn choose(choice: &ModelChoice) -> Outcome<Chosen> {
    prepare(entry(&choice.model)?, &choice.params, choice.form)
}

/// The model asked for, or every model that needs no file.
fn choose_all(models: &Models) -> Outcome<Vec<Chosen>> {
    match &models.model {
        Some(id) => Ok(vec![prepare(entry(id)?, &models.params, models.form)?]),
        None => all().filter(|entry| entry.wesl.is_some()).map(|entry| prepare(entry, &[], models.form)).collect(),
    }
}

fn prepare(entry: &'static ModelEntry, params: &[(String, String)], form: Form) -> Outcome<Chosen> {
    let pairs: Vec<(&str, &str)> = params.iter().map(|(name, value)| (name.as_str(), value.as_str())).collect();
    let usage = |error: ModelError| Failure::usage(format!("model `{}`: {error}", entry.id));
    let values = entry.values(&pairs).map_err(|error| usage(error.into()))?;
    let model = (entry.make)(&values, form.into()).map_err(|error| match error {
        ModelError::File { .. } => Failure::Run(error.into()),
        other => usage(other),
    })?;
    Ok(Chosen { entry, values, model })
}

fn entry(id: &str) -> Outcome<&'static ModelEntry> {
    find(id).ok_or_else(|| {
        let ids: Vec<&str> = all().map(|entry| entry.id).collect();
        Failure::Usage(UnknownName::new("model", id, &ids).into())
    })
}

fn direction(theta: f64, phi: f64) -> DVec3 {
    V3::from_angles(theta.to_radians(), phi.to_radians()).into()
}

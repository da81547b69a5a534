//! `kajo bsdf fit`: the parameters with which a model comes nearest to another one, or to a table.

use super::{choose, entry, prepare};
use crate::arguments::Common;
use crate::arguments::bsdf::{Fit, Form, Metric};
use crate::failure::{Failure, Outcome};
use crate::{output, progress};
use indicatif::ProgressBar;
use kajo_bsdf::models::lafortune::phong_row;
use kajo_bsdf_lab::fit::{self, FitError, Grid, Options, Samples};
use kajo_params::{ParamKind, ParamValues};
use serde_json::{Value, json};

/// Prints the parameters with their standard errors, how far the model is from the target by inclination of the light, and writes the material.
pub fn run(common: &Common, arguments: &Fit) -> Outcome {
    let mut choice = arguments.model.clone();
    let model = entry(&choice.model)?;
    if let Some(count) = arguments.lobes {
        let Some(rows) = model.params.iter().find(|spec| matches!(spec.kind, ParamKind::Rows { .. })) else {
            return Err(Failure::usage(format!("model `{}` has no lobes; leave out --lobes, or take lafortune", model.id)));
        };
        // Exponents 4, 16, 64 …: widths that halve.
        let lobes = (1..=count).map(|k| phong_row(4.0_f64.powi(k as i32)).map(|v| v.to_string()).join(","));
        choice.params.push((rows.name.into(), lobes.collect::<Vec<_>>().join(";")));
    }
    let chosen = choose(&choice)?;
    let (name, target) = target(arguments)?;
    let options = Options {
        metric: match arguments.metric {
            Metric::Cos => fit::Metric::Cos,
            Metric::Log => fit::Metric::Log,
        },
        free: arguments.free.clone(),
        isotropic: arguments.isotropic,
        starts: arguments.starts as usize,
        seed: arguments.seed,
        form: choice.form.into(),
    };
    let bar = progress::bar(common.quiet, "fit");
    bar.set_length(options.starts as u64);
    let found = fit::fit(model, &chosen.values, &target, &options, &OnTerminal(&bar)).map_err(|error| match error {
        FitError::NotFree { .. } => Failure::usage(error),
        other => Failure::Run(other.into()),
    })?;
    bar.finish_and_clear();
    if let Some(path) = &arguments.output {
        kajo_image::write_atomic(path, material(model.id, &found.values, choice.form)?.as_bytes())?;
    }
    let report = &found.report;
    if common.json {
        return output::json(&json!({
            "model": model.id,
            "target": name,
            "samples": target.as_slice().len(),
            "metric": options.metric.name(),
            "params": found.values.to_json(),
            "free": found.estimates.iter().map(|e| json!({ "name": e.name, "value": e.value, "standard_error": e.standard_error }))
                .collect::<Vec<_>>(),
            "idle": found.idle,
            "relative_rms": report.relative_rms,
            "log_rms": report.log_rms,
            "by_theta_i": report.by_theta_i.iter().map(|a| json!({ "theta_i": a.theta_i, "rms": a.rms, "relative_rms": a.relative_rms,
                "samples": a.samples })).collect::<Vec<_>>(),
            "starts": found.tried,
            "agreeing_starts": found.agreeing,
            "evaluations": found.evaluations,
        }));
    }
    let estimates: Vec<Vec<String>> = found
        .estimates
        .iter()
        .map(|e| {
            let error = e.standard_error.map_or("not determined, or at the end of its range".into(), |error| format!("{error:.2e}"));
            vec![e.name.clone(), e.value.to_string(), error]
        })
        .collect();
    let angles: Vec<Vec<String>> = report
        .by_theta_i
        .iter()
        .map(|a| vec![a.theta_i.to_string(), format!("{:.3e}", a.rms), format!("{:.4}", a.relative_rms), a.samples.to_string()])
        .collect();
    let idle = if found.idle.is_empty() { String::new() } else { format!("without effect, unchanged: {}\n", found.idle.join(", ")) };
    output::text(&format!(
        "{}: {}\nfitted to {name}, {} samples; {} of {} starts agree\n\n{}{idle}\n{}\nrelative rms {:.4}, rms of the logarithm {:.4}\n",
        model.id,
        found.values,
        target.as_slice().len(),
        found.agreeing,
        found.tried,
        output::table(&["free", "value", "standard error"], &estimates),
        output::table(&["θi, deg", "rms of error·cos θi·cos θr, 1/sr", "relative", "samples"], &angles),
        report.relative_rms,
        report.log_rms
    ))
}

/// Shows the starts that are done; Ctrl-C ends the fit with the best of them.
struct OnTerminal<'a>(&'a ProgressBar);

impl fit::Watch for OnTerminal<'_> {
    fn done(&self, starts: usize) {
        self.0.set_position(starts as u64);
    }
    fn goes_on(&self) -> bool {
        !progress::interrupted()
    }
}

/// What to fit to, and its name.
fn target(arguments: &Fit) -> Outcome<(String, Samples)> {
    let (name, samples) = match (&arguments.to, &arguments.table) {
        (Some(id), _) => {
            let chosen = prepare(entry(id)?, &arguments.to_params, Form::Corrected)?;
            (format!("{id}: {}", chosen.values), Samples::of_model(&*chosen.model, &Grid::default()))
        }
        (None, Some(path)) => {
            let failed = |problem: String| Failure::run(format!("cannot use {}: {problem}", path.display()));
            let text = std::fs::read_to_string(path).map_err(|error| failed(error.to_string()))?;
            (path.display().to_string(), Samples::from_csv(&text).map_err(|error| failed(error.to_string()))?)
        }
        (None, None) => return Err(Failure::usage("there is nothing to fit to; give --to ID or --table FILE.csv")),
    };
    Ok((name, if arguments.noise > 0.0 { samples.with_noise(arguments.noise, arguments.seed) } else { samples }))
}

/// A `[[material]]` of a `.kajo.toml`.
fn material(id: &str, values: &ParamValues, form: Form) -> Outcome<String> {
    let mut params = values.to_json();
    params.retain(|_, value| value.as_str() != Some("") && value.as_array().is_none_or(|items| !items.is_empty()));
    let mut table = json!({ "name": format!("fitted-{id}"), "model": id, "params": Value::Object(params) });
    if matches!(form, Form::Printed) {
        table["form"] = "printed".into();
    }
    Ok(toml::to_string(&json!({ "material": [table] }))?)
}

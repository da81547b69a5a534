//! `kajo bsdf factor`: a model as a sum of products of functions of one angle.

use super::choose;
use crate::arguments::Common;
use crate::arguments::bsdf::{Factor, Method};
use crate::failure::{Failure, Outcome};
use crate::{output, progress};
use kajo_bsdf::models::tucker::check_size;
use kajo_bsdf_lab::factor::{NmfOptions, Step, Table, TuckerOptions, nmf, tucker};
use serde_json::json;

/// Bytes of a number, in the table and in the file.
const NUMBER: usize = size_of::<f32>();
/// The largest rank of a pass: its core has the fifth power of it.
const MOST_RANK: u32 = 16;

/// Prints what is missing after each term or pass and what is saved, and writes the factors.
pub fn run(common: &Common, arguments: &Factor) -> Outcome {
    refuse_what_the_method_lacks(arguments)?;
    let chosen = choose(&arguments.model)?;
    let table =
        Table::of_model(&*chosen.model).map_err(|error| Failure::run(format!("cannot factor model `{}`: {error}", chosen.entry.id)))?;
    let bar = progress::bar(common.quiet, "factor");
    let mut steps: Vec<Step> = Vec::new();
    let on_step = |step: &Step| {
        steps.push(*step);
        bar.set_position(step.count as u64);
        bar.set_message(format!("error {:.4}", step.errors.cos_rms));
        !progress::interrupted()
    };
    let (bytes, method) = match arguments.method {
        Method::Nmf => {
            let (outer, inner) = (arguments.terms.unwrap_or(4) as usize, arguments.inner.unwrap_or(2) as usize);
            let options = NmfOptions { outer, inner, sweeps: arguments.sweeps.unwrap_or(100) as usize };
            bar.set_length(outer as u64);
            (nmf(&table, options, on_step).to_bytes(), "nmf")
        }
        Method::Tucker => {
            let options = TuckerOptions { rank: arguments.terms.unwrap_or(2) as usize, passes: arguments.passes.unwrap_or(4) as usize };
            check_size(table.grid, options.rank, options.passes).map_err(Failure::usage)?;
            bar.set_length(options.passes as u64);
            (tucker(&table, options, on_step).to_bytes(), "tucker")
        }
    };
    bar.finish_and_clear();
    kajo_image::write_atomic(&arguments.output, &bytes)?;
    report(common, arguments, &table, &steps, method, &format!("{}: {}", chosen.entry.id, chosen.values))
}

fn refuse_what_the_method_lacks(arguments: &Factor) -> Outcome {
    let given = match arguments.method {
        Method::Nmf => [("--passes", arguments.passes.is_some()), ("", false)],
        Method::Tucker => [("--inner", arguments.inner.is_some()), ("--sweeps", arguments.sweeps.is_some())],
    };
    if let Some((name, _)) = given.iter().find(|(_, given)| *given) {
        let (method, has) = match arguments.method {
            Method::Nmf => ("nmf", "--terms, --inner and --sweeps"),
            Method::Tucker => ("tucker", "--terms and --passes"),
        };
        return Err(Failure::usage(format!("method {method} has no {name}; it has {has}")));
    }
    match arguments.terms {
        Some(terms) if arguments.method == Method::Tucker && terms > MOST_RANK => {
            Err(Failure::usage(format!("--terms is {terms}; a pass of tucker has at most {MOST_RANK}, more is for --passes")))
        }
        _ => Ok(()),
    }
}

fn report(common: &Common, arguments: &Factor, table: &Table, steps: &[Step], method: &str, source: &str) -> Outcome {
    let grid = table.grid;
    let table_bytes = grid.numbers() * NUMBER;
    let kept = steps.last().map_or(0, |step| step.numbers * NUMBER);
    let ratio = table_bytes as f64 / kept as f64;
    if common.json {
        return output::json(&json!({
            "source": source,
            "method": method,
            "file": arguments.output,
            "isotropic": grid.is_isotropic(),
            "nodes": { "theta_h": grid.theta_h, "phi_h": grid.phi_h, "theta_o": grid.theta_o, "phi_o": grid.phi_o, "channels": grid.channels },
            "diffuse": table.diffuse,
            "steps": steps.iter().map(|s| json!({ "count": s.count, "bytes": s.numbers * NUMBER, "residual": s.errors.residual,
                "cos_rms": s.errors.cos_rms, "relative_rms": s.errors.relative_rms })).collect::<Vec<_>>(),
            "table_bytes": table_bytes,
            "factor_bytes": kept,
            "ratio": ratio,
        }));
    }
    let rows: Vec<Vec<String>> = steps
        .iter()
        .map(|s| {
            vec![
                s.count.to_string(),
                output::bytes((s.numbers * NUMBER) as u64),
                format!("{:.5}", s.errors.residual),
                format!("{:.4}", s.errors.cos_rms),
                format!("{:.4}", s.errors.relative_rms),
            ]
        })
        .collect();
    let count = if method == "nmf" { "terms" } else { "passes" };
    let diffuse: Vec<String> = table.diffuse.iter().map(|v| format!("{v:.4}")).collect();
    let turns = if grid.is_isotropic() { "isotropic" } else { "anisotropic" };
    output::text(&format!(
        "{source}\n{turns}, kd {} kept apart; the rest by {method}\n\n{}\n{} instead of {}, {ratio:.0} times less; written to {}\n",
        diffuse.join("  "),
        output::table(&[count, "size", "residual", "rms of f cos θi", "rms relative"], &rows),
        output::bytes(kept as u64),
        output::bytes(table_bytes as u64),
        arguments.output.display()
    ))
}

//! `kajo bsdf check`: reciprocity, energy, finite numbers.

use super::choose_all;
use crate::arguments::Common;
use crate::arguments::bsdf::Check;
use crate::failure::Outcome;
use crate::output;
use kajo_bsdf_lab::checks::{furnace, reciprocity, robustness};
use serde_json::json;

/// Prints what holds. Models that claim nothing, such as shading functions, may fail: the result is a finding and no error.
pub fn run(common: &Common, arguments: &Check) -> Outcome {
    let chosen = choose_all(&arguments.models)?;
    let measured: Vec<_> = chosen
        .iter()
        .map(|c| {
            let model = &*c.model;
            (c, reciprocity(model, arguments.pairs, arguments.seed), furnace(model), robustness(model, arguments.pairs, arguments.seed))
        })
        .collect();
    if common.json {
        let rows: Vec<_> = measured
            .iter()
            .map(|(c, reciprocity, furnace, robustness)| {
                json!({
                    "model": c.entry.id,
                    "params": c.values.to_json(),
                    "reciprocity": { "holds": reciprocity.holds(), "worst_asymmetry": reciprocity.worst, "pairs": reciprocity.pairs,
                        "wi": reciprocity.pair[0].to_array(), "wo": reciprocity.pair[1].to_array() },
                    "energy": { "holds": furnace.holds(), "worst_albedo": furnace.worst().2, "theta_r": furnace.worst().0, "phi_r": furnace.worst().1 },
                    "finite": { "holds": robustness.holds(), "inputs": robustness.inputs, "faults": robustness.faults, "first": robustness.first },
                })
            })
            .collect();
        return output::json(&rows);
    }
    let word = |holds: bool| if holds { "yes" } else { "no" };
    let rows: Vec<Vec<String>> = measured
        .iter()
        .map(|(c, reciprocity, furnace, robustness)| {
            let (theta, _, albedo) = furnace.worst();
            vec![
                c.entry.id.into(),
                format!("{} (asymmetry {:.1e})", word(reciprocity.holds()), reciprocity.worst),
                format!("{} (albedo {albedo:.4} at {theta}°)", word(furnace.holds())),
                robustness.first.clone().unwrap_or_else(|| format!("yes ({} inputs)", robustness.inputs)),
            ]
        })
        .collect();
    output::text(&output::table(&["model", "reciprocal", "energy conserving", "finite and not negative"], &rows))
}

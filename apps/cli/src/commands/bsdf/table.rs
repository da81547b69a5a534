//! `kajo bsdf table`: what the literature claims of the models, beside what is measured.

use crate::arguments::Common;
use crate::failure::Outcome;
use crate::output;
use kajo_bsdf::models::{Form, Parameters};
use kajo_bsdf_lab::{TableRow, probe, survey_table};
use serde_json::{Value, json};

/// Prints the table.
pub fn run(common: &Common, form: Form) -> Outcome {
    let table = survey_table(form);
    if common.json {
        return output::json(&table.iter().map(as_json).collect::<Vec<_>>());
    }
    let word = |holds: bool| if holds { "yes" } else { "no" };
    let pair = |claim: bool, measured: bool, how: String| format!("{} / {} ({how})", word(claim), word(measured));
    let rows: Vec<Vec<String>> = table
        .iter()
        .map(|row| {
            let (theta, _, albedo) = row.furnace.worst();
            let shift = row.peak_shift.map_or("no peak".to_owned(), |degrees| format!("{degrees:+.1}° at 60°"));
            vec![
                row.entry.id.into(),
                parameters(row).into(),
                pair(
                    row.claims.plausible,
                    row.plausible(),
                    format!("asymmetry {:.0e}, albedo {albedo:.3} at {theta}°", row.reciprocity.worst),
                ),
                pair(row.claims.anisotropic, row.anisotropic(), format!("{:.0e}", row.turning)),
                pair(row.claims.off_specular, row.off_specular(), shift),
            ]
        })
        .collect();
    let head = ["model", "parameters", "plausible: claimed / measured", "anisotropic", "off-specular peak"];
    output::text(&output::table(&head, &rows))
}

fn parameters(row: &TableRow) -> &'static str {
    match row.claims.parameters {
        Parameters::Empirical => "empirical",
        Parameters::Physical => "physical",
    }
}

fn as_json(row: &TableRow) -> Value {
    json!({
        "model": row.entry.id,
        "measured_at": probe(row.entry.id).iter().map(|(name, value)| format!("{name}={value}")).collect::<Vec<_>>(),
        "parameters": parameters(row),
        "claimed": { "plausible": row.claims.plausible, "anisotropic": row.claims.anisotropic, "off_specular": row.claims.off_specular },
        "measured": { "plausible": row.plausible(), "anisotropic": row.anisotropic(), "off_specular": row.off_specular() },
        "worst_asymmetry": row.reciprocity.worst,
        "worst_albedo": row.furnace.worst().2,
        "change_on_turning": row.turning,
        "peak_shift_deg": row.peak_shift,
    })
}

//! `kajo bsdf sample-test`: samples against density, and value over density against quadrature.

use super::{choose_all, direction};
use crate::arguments::Common;
use crate::arguments::bsdf::SampleTest;
use crate::failure::{Failure, Outcome};
use crate::output;
use kajo_bsdf_lab::checks::{SamplingTest, sampling_test};
use serde_json::json;

/// Chance that a right sampler fails anywhere in one run of this command.
const SIGNIFICANCE: f64 = 1e-3;

/// Prints every test; one that fails is a failure of the command.
pub fn run(common: &Common, arguments: &SampleTest) -> Outcome {
    let chosen = choose_all(&arguments.models)?;
    let mut tests: Vec<(&str, f64, SamplingTest)> = Vec::new();
    for c in &chosen {
        for &theta in &arguments.theta_r {
            let wo = direction(theta, arguments.phi_r);
            tests.push((c.entry.id, theta, sampling_test(&*c.model, wo, arguments.samples, arguments.seed)));
        }
    }
    let alpha = SIGNIFICANCE / tests.len() as f64;
    if common.json {
        let rows: Vec<_> = tests
            .iter()
            .map(|(id, theta, t)| {
                json!({ "model": id, "theta_r": theta, "holds": t.holds(alpha), "chi_square_p": t.p_value, "pdf_mass": t.mass,
                    "albedo_z": t.z, "largest_weight": t.largest_weight })
            })
            .collect();
        output::json(&rows)?;
    } else {
        let rows: Vec<Vec<String>> = tests
            .iter()
            .map(|(id, theta, t)| {
                let holds = if t.holds(alpha) { "yes" } else { "NO" };
                vec![
                    (*id).into(),
                    theta.to_string(),
                    holds.into(),
                    format!("{:.3}", t.p_value),
                    format!("{:.4}", t.mass),
                    format!("{:.2}", t.z),
                    format!("{:.3}", t.largest_weight),
                ]
            })
            .collect();
        output::text(&output::table(
            &["model", "θr, deg", "holds", "χ² p", "pdf above horizon", "albedo, σ off", "largest weight"],
            &rows,
        ))?;
    }
    match tests.iter().filter(|(_, _, t)| !t.holds(alpha)).count() {
        0 => Ok(()),
        failed => Err(Failure::run(format!("{failed} of {} sampling tests fail at significance {alpha:.1e}", tests.len()))),
    }
}

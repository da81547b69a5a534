//! `kajo bsdf albedo`: how much of the light a model reflects.

use super::{choose, direction};
use crate::arguments::Common;
use crate::arguments::bsdf::Albedo;
use crate::failure::Outcome;
use crate::output;
use kajo_bsdf_lab::{albedo, sampled_albedo};
use serde_json::json;

/// Quadrature is good to about this.
const TOLERANCE: f64 = 1e-7;

/// Prints the albedo for each direction of the viewer.
pub fn run(common: &Common, arguments: &Albedo) -> Outcome {
    let chosen = choose(&arguments.model)?;
    let measured: Vec<_> = arguments
        .theta_r
        .iter()
        .map(|&theta| {
            let wo = direction(theta, arguments.phi_r);
            (theta, albedo(&*chosen.model, wo, TOLERANCE), sampled_albedo(&*chosen.model, wo, arguments.samples, 1))
        })
        .collect();
    if common.json {
        let rows: Vec<_> = measured
            .iter()
            .map(|(theta, exact, sampled)| {
                json!({
                    "theta_r": theta,
                    "albedo": exact.to_array(),
                    "sampled": sampled.mean.to_array(),
                    "standard_error": sampled.standard_error.to_array(),
                    "largest_weight": sampled.largest_weight,
                })
            })
            .collect();
        return output::json(
            &json!({ "model": chosen.entry.id, "params": chosen.values.to_json(), "phi_r": arguments.phi_r, "albedos": rows }),
        );
    }
    let rows: Vec<Vec<String>> = measured
        .iter()
        .map(|(theta, exact, sampled)| {
            let colour = |c: glam::DVec3| format!("{:.6} {:.6} {:.6}", c.x, c.y, c.z);
            vec![theta.to_string(), colour(*exact), colour(sampled.mean), format!("{:.6}", sampled.standard_error.max_element())]
        })
        .collect();
    output::text(&output::table(&["θr, deg", "albedo", "sampled", "standard error"], &rows))
}

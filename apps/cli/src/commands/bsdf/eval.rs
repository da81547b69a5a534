//! `kajo bsdf eval`: the value of a model for one pair of directions.

use super::{choose, direction};
use crate::arguments::Common;
use crate::arguments::bsdf::Eval;
use crate::failure::Outcome;
use crate::output;
use kajo_bsdf::models::Kind;
use serde_json::json;

/// Prints f, f cos θ_i, the shading function and the density of the model's own sampler.
///
/// Of a model that is a shading function, `f_cos` is S and `f` is S/cos θ_i. `bsf` is S: π f cos θ_i of a BRDF, so that Lambert is k_d cos θ_i.
pub fn run(common: &Common, arguments: &Eval) -> Outcome {
    let chosen = choose(&arguments.model)?;
    let model = &chosen.model;
    let wi = direction(arguments.theta_i, arguments.phi_i);
    let wo = direction(arguments.theta_r, arguments.phi_r);
    let f_cos = model.f_cos(wi, wo);
    let (f, bsf) = match model.kind() {
        Kind::Brdf => (model.value(wi, wo), f_cos * std::f64::consts::PI),
        Kind::Bsf => (if wi.z > 0.0 { f_cos / wi.z } else { f_cos }, f_cos),
    };
    let pdf = model.pdf(wi, wo);
    if common.json {
        return output::json(&json!({
            "model": chosen.entry.id,
            "kind": match model.kind() { Kind::Brdf => "brdf", Kind::Bsf => "bsf" },
            "params": chosen.values.to_json(),
            "f": f.to_array(),
            "f_cos": f_cos.to_array(),
            "bsf": bsf.to_array(),
            "pdf": pdf,
            "mirror": model.mirror(wo).to_array(),
            "ambient": model.ambient().to_array(),
        }));
    }
    let colour = |c: glam::DVec3| format!("{}  {}  {}", c.x, c.y, c.z);
    let rows = [
        ("f", colour(f), "1/sr"),
        ("f cos θi", colour(f_cos), "1/sr"),
        ("shading function", colour(bsf), ""),
        ("pdf", pdf.to_string(), "1/sr"),
    ];
    let rows: Vec<Vec<String>> = rows.into_iter().map(|(name, value, unit)| vec![name.into(), value, unit.into()]).collect();
    output::text(&format!("{}: {}\n{}", chosen.entry.id, chosen.values, output::table(&["", "red  green  blue", "unit"], &rows)))
}

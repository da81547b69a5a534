//! `kajo bsdf table --claims`: what is claimed of single models, with the numbers that decide it.

use super::errata::number;
use crate::arguments::Common;
use crate::failure::Outcome;
use crate::output;
use kajo_bsdf_lab::{Claim, claims};
use serde_json::{Value, json};

/// Prints the ledger.
pub fn run(common: &Common) -> Outcome {
    let claims = claims();
    if common.json {
        return output::json(&claims.iter().map(as_json).collect::<Vec<_>>());
    }
    let mut rows = Vec::new();
    for claim in &claims {
        let holds = if claim.holds { "yes" } else { "no" };
        rows.push(vec![claim.claim.into(), holds.into(), String::new(), claim.remark.to_owned()]);
        rows.extend(claim.measured.iter().map(|m| vec![format!("    {}", m.what), String::new(), number(m.value), String::new()]));
    }
    output::text(&output::table(&["claim", "holds", "measured", "remark"], &rows))
}

fn as_json(claim: &Claim) -> Value {
    json!({
        "claim": claim.claim,
        "holds": claim.holds,
        "remark": claim.remark,
        "measured": claim.measured.iter().map(|m| json!({ "what": m.what, "value": m.value })).collect::<Vec<_>>(),
    })
}

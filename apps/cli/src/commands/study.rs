//! `kajo study`: questions that one comparison does not answer.

use super::compare::Watched;
use crate::arguments::{Common, StudyCommand};
use crate::failure::{Failure, Outcome};
use crate::{output, progress};
use kajo_lab::study::{ALL, Findings, find, run_study};
use serde_json::json;
use std::path::Path;

/// Lists the studies, or runs the one that is named.
pub fn run(common: &Common, arguments: &StudyCommand) -> Outcome {
    let (Some(name), Some(folder)) = (&arguments.name, &arguments.output) else { return list(common) };
    let study = find(name).map_err(Failure::usage)?;
    let watched = Watched::new(progress::bar(common.quiet, study.id));
    let findings = run_study(study, folder, arguments.quick, &watched);
    watched.finish();
    let findings = findings?;
    if common.json {
        return output::json(&json!({ "study": study.id, "claims": findings.claims, "tables": findings.tables }));
    }
    if common.quiet { Ok(()) } else { tell(&findings, folder) }
}

fn list(common: &Common) -> Outcome {
    if common.json {
        return output::json(
            &ALL.iter().map(|study| json!({ "id": study.id, "title": study.title, "doc": study.doc })).collect::<Vec<_>>(),
        );
    }
    let rows: Vec<Vec<String>> = ALL.iter().map(|study| vec![study.id.into(), study.title.into()]).collect();
    output::text(&output::table(&["study", "question"], &rows))
}

fn tell(findings: &Findings, folder: &Path) -> Outcome {
    let line = |claim: &kajo_lab::study::Claim| {
        format!("{}: {} ({})\n", if claim.holds { "holds" } else { "does not hold" }, claim.text, claim.measured)
    };
    let claims: String = findings.claims.iter().map(line).collect();
    output::text(&format!("{claims}{}\n", folder.join("index.html").display()))
}

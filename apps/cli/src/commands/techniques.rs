//! `kajo techniques`: the registry as a list, or one technique with its documentation and parameters.

use crate::arguments::Common;
use crate::failure::{Failure, Outcome};
use crate::output;
use kajo_params::{ParamKind, ParamSpec};
use kajo_techniques::{Technique, all, find};
use serde_json::{Value, json};

/// Prints the list, or the technique called `id`.
pub fn run(common: &Common, id: Option<&str>, markdown: bool) -> Outcome {
    if markdown {
        return output::text(&as_markdown());
    }
    let Some(id) = id else {
        if common.json {
            return output::json(&all().map(as_json).collect::<Vec<_>>());
        }
        let rows: Vec<Vec<String>> = all().map(|t| vec![t.id.into(), t.role.id().into(), t.title.into()]).collect();
        return output::text(&output::table(&["technique", "role", "what"], &rows));
    };
    let technique = find(id).map_err(|error| Failure::Usage(error.into()))?;
    if common.json {
        return output::json(&as_json(technique));
    }
    let rows: Vec<Vec<String>> = technique
        .params
        .iter()
        .map(|p| {
            vec![p.name.into(), p.default.to_string(), range(p), p.unit.into(), p.doc.split_whitespace().collect::<Vec<_>>().join(" ")]
        })
        .collect();
    let params = match rows.is_empty() {
        true => "No parameters.\n".into(),
        false => output::table(&["parameter", "default", "range", "unit", "what"], &rows),
    };
    let cites = if technique.cites.is_empty() { String::new() } else { format!("Sources: {}\n", technique.cites.join(", ")) };
    let head = format!(
        "{}: {}\nRole {}: {}, {}\n",
        technique.id,
        technique.title,
        technique.role,
        technique.role.estimates(),
        technique.role.unit()
    );
    output::text(&format!("{head}\n{}\n\n{cites}{params}", technique.doc.trim()))
}

/// The table of the README.
pub fn as_markdown() -> String {
    let row = |t: &Technique| {
        let names: Vec<String> = t.params.iter().map(|p| format!("`{}`", p.name)).collect();
        format!("| `{}` | {} | {} | {} |\n", t.id, t.title, t.role, names.join(", "))
    };
    "| technique | what | role | parameters |\n| --- | --- | --- | --- |\n".to_string() + &all().map(row).collect::<String>()
}

fn as_json(technique: &Technique) -> Value {
    let param =
        |p: &ParamSpec| json!({ "name": p.name, "doc": p.doc, "default": p.default.to_string(), "range": range(p), "unit": p.unit });
    json!({
        "id": technique.id,
        "title": technique.title,
        "role": technique.role.id(),
        "estimates": technique.role.estimates(),
        "unit": technique.role.unit(),
        "judged_by": technique.role.judged_by(),
        "cites": technique.cites,
        "doc": technique.doc,
        "params": technique.params.iter().map(param).collect::<Vec<_>>(),
    })
}

fn range(param: &ParamSpec) -> String {
    match param.kind {
        ParamKind::Float { min, max } => format!("{min} … {max}"),
        ParamKind::UInt { min, max } => format!("{min} … {max}"),
        ParamKind::Int { min, max } => format!("{min} … {max}"),
        ParamKind::Bool => "true, false".into(),
        ParamKind::Choice { names } => names.join(", "),
        ParamKind::Color { .. } | ParamKind::Rows { .. } | ParamKind::Path => param.expected(),
    }
}

#[cfg(test)]
mod tests {
    use super::as_markdown;

    #[test]
    fn the_readme_shows_the_registry() {
        let readme = include_str!("../../../../README.md");
        let (_, rest) = readme.split_once("<!-- begin: kajo techniques --markdown -->\n").expect("the table's begin");
        let (table, _) = rest.split_once("<!-- end -->").expect("the table's end");
        assert_eq!(table, as_markdown(), "put the output of `kajo techniques --markdown` into README.md");
    }
}

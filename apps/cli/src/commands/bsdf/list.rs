//! `kajo bsdf list`: the models with their parameters.

use super::entry;
use crate::arguments::Common;
use crate::failure::Outcome;
use crate::output;
use kajo_bsdf::models::{Kind, ModelEntry, all};
use kajo_params::ParamKind;
use serde_json::{Value, json};

/// Prints the list, or one model with its documentation.
pub fn run(common: &Common, id: Option<&str>, markdown: bool) -> Outcome {
    if markdown {
        return output::text(&as_markdown());
    }
    let Some(id) = id else {
        if common.json {
            return output::json(&all().map(as_json).collect::<Vec<_>>());
        }
        let rows: Vec<Vec<String>> = all()
            .map(|model| {
                let params: Vec<&str> = model.params.iter().map(|p| p.name).collect();
                vec![model.id.into(), model.title.into(), params.join(" ")]
            })
            .collect();
        return output::text(&output::table(&["model", "what", "parameters"], &rows));
    };
    let model = entry(id)?;
    if common.json {
        return output::json(&as_json(model));
    }
    let rows: Vec<Vec<String>> =
        model.params.iter().map(|p| vec![p.name.into(), p.default.to_string(), p.expected(), p.doc.into()]).collect();
    let table =
        if rows.is_empty() { "No parameters.\n".into() } else { output::table(&["parameter", "default", "allowed", "what"], &rows) };
    output::text(&format!("{}: {}\n\n{}\n\nSources: {}\n{table}", model.id, model.title, model.doc.trim(), model.cites.join(", ")))
}

/// The table of the README.
fn as_markdown() -> String {
    let row = |model: &ModelEntry| {
        let names: Vec<String> = model.params.iter().map(|p| format!("`{}`", p.name)).collect();
        format!("| `{}` | {} | {} |\n", model.id, model.title, names.join(", "))
    };
    "| model | what | parameters |\n| --- | --- | --- |\n".to_string() + &all().map(row).collect::<String>()
}

fn as_json(model: &ModelEntry) -> Value {
    let params: Vec<Value> = model
        .params
        .iter()
        .map(|p| {
            let (kind, range) = match p.kind {
                ParamKind::Float { min, max } => ("number", json!([min, max])),
                ParamKind::UInt { min, max } => ("integer", json!([min, max])),
                ParamKind::Int { min, max } => ("integer", json!([min, max])),
                ParamKind::Bool => ("boolean", json!([false, true])),
                ParamKind::Choice { names } => ("choice", json!(names)),
                ParamKind::Color { min, max } => ("color", json!([min, max])),
                ParamKind::Rows { min, max } => ("rows of four numbers", json!([min, max])),
                ParamKind::Path => ("file", Value::Null),
            };
            json!({ "name": p.name, "doc": p.doc, "type": kind, "default": p.default.to_string(), "range": range, "unit": p.unit })
        })
        .collect();
    let aliases: serde_json::Map<_, _> = model.aliases.iter().map(|(name, targets)| ((*name).to_owned(), json!(targets))).collect();
    json!({
        "id": model.id,
        "title": model.title,
        "kind": match model.kind { Kind::Brdf => "brdf", Kind::Bsf => "bsf" },
        "printed_form": model.has_printed_form,
        "cites": model.cites,
        "params": params,
        "aliases": aliases,
    })
}

#[cfg(test)]
mod tests {
    use super::as_markdown;

    #[test]
    fn the_readme_shows_the_models() {
        let readme = include_str!("../../../../../README.md");
        assert!(readme.contains(&as_markdown()), "put the output of `kajo bsdf list --markdown` into README.md");
    }
}

//! `model`, `params` and `form` of a `[[material]]`: a reflectance model of the library.

use super::format::{FormName, MaterialTable};
use super::source::Table;
use crate::{ReflectanceModel, SceneError};
use kajo_bsdf::models::{Form, ModelEntry, all, find};
use kajo_names::UnknownName;
use kajo_params::ParamKind;
use std::path::PathBuf;
use toml::Value;

/// The model that the table names; `locate` finds a file that a parameter names.
pub fn read(
    table: &Table,
    values: &MaterialTable,
    locate: &dyn Fn(&str) -> Result<PathBuf, SceneError>,
) -> Result<Option<ReflectanceModel>, SceneError> {
    let Some(id) = &values.model else { return Ok(None) };
    let Some(entry) = find(id) else {
        let ids: Vec<&str> = all().map(|model| model.id).collect();
        return Err(table.error(UnknownName::new("model", id, &ids).to_string()));
    };
    let mut pairs = Vec::new();
    for (name, value) in values.params.iter().flatten() {
        let text = match value {
            Value::String(file) if is_path(entry, name) => locate(file)?.to_string_lossy().into_owned(),
            Value::String(text) => text.clone(),
            other => text(other).ok_or_else(|| {
                table.error(format!("`params.{name}` is {other}; give a number, a colour [r, g, b], a list of rows or a name"))
            })?,
        };
        pairs.push((name.as_str(), text));
    }
    let pairs: Vec<(&str, &str)> = pairs.iter().map(|(name, value)| (*name, value.as_str())).collect();
    let form = match values.form {
        Some(FormName::Printed) => Form::Printed,
        Some(FormName::Corrected) | None => Form::Corrected,
    };
    ReflectanceModel::new(entry, &pairs, form).map(Some).map_err(|error| table.error(format!("model \"{id}\": {error}")))
}

fn is_path(entry: &ModelEntry, name: &str) -> bool {
    entry.params.iter().any(|param| param.name == name && param.kind == ParamKind::Path)
}

/// A value as the command line writes it: numbers by commas, rows by semicolons.
fn text(value: &Value) -> Option<String> {
    match value {
        Value::Integer(number) => Some(number.to_string()),
        Value::Float(number) => Some(number.to_string()),
        Value::Boolean(on) => Some(on.to_string()),
        Value::Array(items) => {
            let separator = if items.iter().any(Value::is_array) { ";" } else { "," };
            Some(items.iter().map(text).collect::<Option<Vec<_>>>()?.join(separator))
        }
        _ => None,
    }
}

//! Values of parameters without their types: what code that iterates over techniques handles.

use crate::{ParamError, ParamSpec, Value};
use kajo_names::UnknownName;
use std::fmt;

/// One checked value for each parameter of a `SPEC`.
#[derive(Clone, Debug, PartialEq)]
pub struct ParamValues {
    specs: &'static [ParamSpec],
    values: Vec<Value>,
}

impl ParamValues {
    /// The default of every parameter.
    pub fn defaults(specs: &'static [ParamSpec]) -> Self {
        Self { specs, values: specs.iter().map(|spec| spec.default).collect() }
    }

    /// Takes values in the order of `specs`.
    ///
    /// # Panics
    /// When their numbers differ.
    pub fn new(specs: &'static [ParamSpec], values: Vec<Value>) -> Self {
        assert_eq!(specs.len(), values.len(), "one value a parameter");
        Self { specs, values }
    }

    /// The defaults, changed by `name = value` pairs. Rows may be given together, or one by one under the same name.
    ///
    /// # Errors
    /// Unknown or repeated names, values of the wrong type or out of range.
    pub fn from_pairs(specs: &'static [ParamSpec], pairs: &[(&str, &str)]) -> Result<Self, ParamError> {
        let mut out = Self::defaults(specs);
        let mut given = vec![false; specs.len()];
        for (name, text) in pairs {
            let before = out.get(name);
            let index = out.set(name, text)?;
            if std::mem::replace(&mut given[index], true) {
                let repeated = ParamError::Repeated { name: specs[index].name };
                let (Some(Value::Rows(mut rows)), Value::Rows(more)) = (before, out.values[index]) else { return Err(repeated) };
                if !more.as_slice().iter().all(|&row| rows.push(row)) {
                    return Err(ParamError::OutOfRange {
                        name: specs[index].name,
                        got: text.to_string(),
                        expected: specs[index].expected(),
                    });
                }
                out.values[index] = Value::Rows(rows);
            }
        }
        Ok(out)
    }

    /// Changes one value; returns its place in the list.
    ///
    /// # Errors
    /// An unknown name, a value of the wrong type or out of range.
    pub fn set(&mut self, name: &str, text: &str) -> Result<usize, ParamError> {
        let index = self.specs.iter().position(|spec| spec.name == name).ok_or_else(|| self.unknown(name))?;
        self.values[index] = self.specs[index].parse(text)?;
        Ok(index)
    }

    /// The value called `name`.
    pub fn get(&self, name: &str) -> Option<Value> {
        self.iter().find(|(spec, _)| spec.name == name).map(|(_, value)| value)
    }

    /// The parameters with their values, in order.
    pub fn iter(&self) -> impl Iterator<Item = (&'static ParamSpec, Value)> + '_ {
        self.specs.iter().zip(self.values.iter().copied())
    }

    /// The values alone; for the derive.
    ///
    /// # Panics
    /// When they belong to other parameters than `specs`.
    pub fn values_of(&self, specs: &[ParamSpec]) -> &[Value] {
        assert_eq!(self.specs, specs, "values of another technique");
        &self.values
    }

    /// Every parameter as text, in order; [`ParamValues::from_pairs`] reads it back exactly.
    pub fn to_pairs(&self) -> Vec<(&'static str, String)> {
        self.iter().map(|(spec, value)| (spec.name, value.to_string())).collect()
    }

    /// Every parameter, for reports: numbers as numbers, choices by name.
    pub fn to_json(&self) -> serde_json::Map<String, serde_json::Value> {
        let json = |value: Value| match value {
            Value::Float(value) => value.into(),
            Value::UInt(value) => value.into(),
            Value::Int(value) => value.into(),
            Value::Bool(value) => value.into(),
            Value::Choice { name, .. } => name.into(),
            Value::Color(color) => color.to_vec().into(),
            Value::Rows(rows) => rows.as_slice().iter().map(|row| row.to_vec()).collect::<Vec<_>>().into(),
            Value::Path(path) => path.into(),
        };
        self.iter().map(|(spec, value)| (spec.name.to_owned(), json(value))).collect()
    }

    fn unknown(&self, name: &str) -> ParamError {
        UnknownName::new("parameter", name, &self.specs.iter().map(|spec| spec.name).collect::<Vec<_>>()).into()
    }
}

/// `a=1,b=true`: the text after the colon of `--technique`.
impl fmt::Display for ParamValues {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, (spec, value)) in self.iter().enumerate() {
            write!(f, "{}{}={value}", if i > 0 { "," } else { "" }, spec.name)?;
        }
        Ok(())
    }
}

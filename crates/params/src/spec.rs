//! What a parameter is: name, description, type, default, range and unit.

use crate::{ParamError, ScalarType, Value};
use std::fmt;

/// One parameter, as data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParamSpec {
    /// The name users write.
    pub name: &'static str,
    /// What it does, from the field's doc comment.
    pub doc: &'static str,
    /// Type and range.
    pub kind: ParamKind,
    /// The value it has when none is given.
    pub default: Value,
    /// Symbol of the unit; empty for a pure number.
    pub unit: &'static str,
}

/// Type and range of a parameter; both ends of a range are allowed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs, reason = "min and max say it")]
pub enum ParamKind {
    /// A real number.
    Float { min: f32, max: f32 },
    /// A count.
    UInt { min: u32, max: u32 },
    /// A whole number.
    Int { min: i32, max: i32 },
    /// On or off.
    Bool,
    /// One of these names.
    Choice { names: &'static [&'static str] },
}

impl ParamSpec {
    /// For the derive: everything is checked here, at compile time.
    ///
    /// # Panics
    /// When a number has no range or a range of nothing, a range stands where none belongs, or the default is outside the range.
    pub const fn new(
        name: &'static str,
        doc: &'static str,
        ty: ScalarType,
        default: f64,
        range: Option<(f64, f64)>,
        unit: &'static str,
    ) -> Self {
        let (min, max) = match (range, ty) {
            (Some(range), ScalarType::Float | ScalarType::UInt | ScalarType::Int) => range,
            (None, ScalarType::Bool) => (0.0, 1.0),
            (None, ScalarType::Choice(names)) => (0.0, names.len() as f64 - 1.0),
            (None, _) => panic!("a number needs a range"),
            (Some(_), _) => panic!("a range is for numbers"),
        };
        assert!(min.is_finite() && max.is_finite() && min <= max, "a range runs from a finite minimum to a finite maximum");
        assert!(default >= min && default <= max, "the default lies in the range");
        let (kind, default) = match ty {
            ScalarType::Float => (ParamKind::Float { min: min as f32, max: max as f32 }, Value::Float(default as f32)),
            ScalarType::UInt => (ParamKind::UInt { min: min as u32, max: max as u32 }, Value::UInt(default as u32)),
            ScalarType::Int => (ParamKind::Int { min: min as i32, max: max as i32 }, Value::Int(default as i32)),
            ScalarType::Bool => (ParamKind::Bool, Value::Bool(default == 1.0)),
            ScalarType::Choice(names) => {
                (ParamKind::Choice { names }, Value::Choice { index: default as usize, name: names[default as usize] })
            }
        };
        Self { name, doc, kind, default, unit }
    }

    /// Reads a value of this parameter.
    ///
    /// # Errors
    /// [`ParamError::Malformed`] for text of the wrong type, NaN and infinities included; [`ParamError::OutOfRange`].
    pub fn parse(&self, text: &str) -> Result<Value, ParamError> {
        let text = text.trim();
        let malformed = || ParamError::Malformed { name: self.name, got: text.to_owned(), expected: self.expected() };
        let (value, inside) = match self.kind {
            ParamKind::Float { min, max } => {
                let value: f32 = text.parse().ok().filter(|value: &f32| value.is_finite()).ok_or_else(malformed)?;
                (Value::Float(value), (min..=max).contains(&value))
            }
            ParamKind::UInt { min, max } => {
                // Read as i64, so that −1 is reported as out of range and not as no number.
                let value: i64 = text.parse().map_err(|_| malformed())?;
                (Value::UInt(value as u32), (i64::from(min)..=i64::from(max)).contains(&value))
            }
            ParamKind::Int { min, max } => {
                let value: i64 = text.parse().map_err(|_| malformed())?;
                (Value::Int(value as i32), (i64::from(min)..=i64::from(max)).contains(&value))
            }
            ParamKind::Bool => match text {
                "true" | "on" | "1" => (Value::Bool(true), true),
                "false" | "off" | "0" => (Value::Bool(false), true),
                _ => return Err(malformed()),
            },
            ParamKind::Choice { names } => {
                let index = names.iter().position(|&name| name == text).ok_or_else(malformed)?;
                (Value::Choice { index, name: names[index] }, true)
            }
        };
        if inside { Ok(value) } else { Err(ParamError::OutOfRange { name: self.name, got: text.to_owned(), expected: self.expected() }) }
    }

    /// What is allowed, as messages and documents say it: `from 0 to 2 m`, `true or false`, `one of box, tent`.
    pub fn expected(&self) -> String {
        let range = |min: &dyn fmt::Display, max: &dyn fmt::Display| {
            let unit = if self.unit.is_empty() { String::new() } else { format!(" {}", self.unit) };
            format!("from {min} to {max}{unit}")
        };
        match self.kind {
            ParamKind::Float { min, max } => range(&min, &max),
            ParamKind::UInt { min, max } => format!("a whole number {}", range(&min, &max)),
            ParamKind::Int { min, max } => format!("a whole number {}", range(&min, &max)),
            ParamKind::Bool => "true or false".to_owned(),
            ParamKind::Choice { names } => format!("one of {}", names.join(", ")),
        }
    }
}

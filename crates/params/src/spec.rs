//! What a parameter is: name, description, type, default, range and unit.

use crate::{ParamError, Rows, ScalarType, Value};
use std::collections::HashSet;
use std::fmt;
use std::sync::Mutex;

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
    Float { min: f64, max: f64 },
    /// A count.
    UInt { min: u32, max: u32 },
    /// A whole number.
    Int { min: i32, max: i32 },
    /// On or off.
    Bool,
    /// One of these names.
    Choice { names: &'static [&'static str] },
    /// Linear RGB; the range is each channel's.
    Color { min: f64, max: f64 },
    /// Up to [`Rows::MOST`] rows of four numbers; the range is each number's.
    Rows { min: f64, max: f64 },
    /// The path of a file.
    Path,
}

impl ParamSpec {
    /// For the derive: everything is checked here, at compile time. The default of a colour is a grey; rows and paths have none.
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
            (Some(range), ScalarType::Float | ScalarType::UInt | ScalarType::Int | ScalarType::Color | ScalarType::Rows) => range,
            (None, ScalarType::Bool | ScalarType::Path) => (0.0, 1.0),
            (None, ScalarType::Choice(names)) => (0.0, names.len() as f64 - 1.0),
            (None, _) => panic!("a number needs a range"),
            (Some(_), _) => panic!("a range is for numbers"),
        };
        assert!(min.is_finite() && max.is_finite() && min <= max, "a range runs from a finite minimum to a finite maximum");
        assert!(default >= min && default <= max, "the default lies in the range");
        let (kind, default) = match ty {
            ScalarType::Float => (ParamKind::Float { min, max }, Value::Float(default)),
            ScalarType::UInt => (ParamKind::UInt { min: min as u32, max: max as u32 }, Value::UInt(default as u32)),
            ScalarType::Int => (ParamKind::Int { min: min as i32, max: max as i32 }, Value::Int(default as i32)),
            ScalarType::Bool => (ParamKind::Bool, Value::Bool(default == 1.0)),
            ScalarType::Choice(names) => {
                (ParamKind::Choice { names }, Value::Choice { index: default as usize, name: names[default as usize] })
            }
            ScalarType::Color => (ParamKind::Color { min, max }, Value::Color([default; 3])),
            ScalarType::Rows => (ParamKind::Rows { min, max }, Value::Rows(Rows::NONE)),
            ScalarType::Path => (ParamKind::Path, Value::Path("")),
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
                let [value] = numbers(text).ok_or_else(malformed)?;
                (Value::Float(value), (min..=max).contains(&value))
            }
            ParamKind::Color { min, max } => {
                let color = numbers(text).or_else(|| numbers(text).map(|[grey]| [grey; 3])).ok_or_else(malformed)?;
                (Value::Color(color), color.iter().all(|value| (min..=max).contains(value)))
            }
            ParamKind::Rows { min, max } => {
                let mut rows = Rows::NONE;
                for row in text.split(';') {
                    if !rows.push(numbers(row).ok_or_else(malformed)?) {
                        return Err(malformed());
                    }
                }
                (Value::Rows(rows), rows.as_slice().iter().flatten().all(|value| (min..=max).contains(value)))
            }
            ParamKind::Path => (Value::Path(intern(text)), true),
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
            ParamKind::Color { min, max } => format!("one number or r,g,b, each {}", range(&min, &max)),
            ParamKind::Rows { min, max } => format!("four numbers a,b,c,d, each {}, at most {} times", range(&min, &max), Rows::MOST),
            ParamKind::Path => "the path of a file".to_owned(),
        }
    }
}

/// Exactly `N` finite numbers with commas between them.
fn numbers<const N: usize>(text: &str) -> Option<[f64; N]> {
    let values: Vec<f64> = text.split(',').map(|word| word.trim().parse().ok().filter(|v: &f64| v.is_finite())).collect::<Option<_>>()?;
    values.try_into().ok()
}

/// One copy of each text, for the life of the program.
fn intern(text: &str) -> &'static str {
    static TEXTS: Mutex<Option<HashSet<&'static str>>> = Mutex::new(None);
    let mut texts = TEXTS.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    let texts = texts.get_or_insert_default();
    if let Some(known) = texts.get(text) {
        return known;
    }
    let leaked: &'static str = Box::leak(text.into());
    texts.insert(leaked);
    leaked
}

//! The text of a file, for messages that name their line, and checks of single values.

use crate::SceneError;
use kajo_names::nearest;
use std::ops::{Range, RangeInclusive};

/// A file's name and text.
#[derive(Clone, Copy)]
pub struct Source<'a> {
    pub file: &'a str,
    pub text: &'a str,
}

/// A table of the file, for messages about its values.
#[derive(Clone)]
pub struct Table<'a> {
    source: Source<'a>,
    /// `light "key"`
    pub what: String,
    span: Range<usize>,
}

impl<'a> Source<'a> {
    /// An error at a byte of the text.
    pub fn error(&self, at: usize, problem: impl Into<String>) -> SceneError {
        let before = &self.text.as_bytes()[..at.min(self.text.len())];
        let line_start = before.iter().rposition(|&byte| byte == b'\n').map_or(0, |newline| newline + 1);
        SceneError::Syntax {
            file: self.file.into(),
            line: 1 + before.iter().filter(|&&byte| byte == b'\n').count(),
            column: 1 + String::from_utf8_lossy(&before[line_start..]).chars().count(),
            problem: problem.into(),
        }
    }

    /// What the TOML reader found; an unknown key or value gets the nearest known one.
    pub fn refused(&self, error: &toml::de::Error) -> SceneError {
        let message = error.message();
        let problem = suggestion(message).map_or_else(|| message.to_owned(), |name| format!("{message}; did you mean `{name}`?"));
        self.error(error.span().map_or(0, |span| span.start), problem)
    }

    /// A table that stands at `span`.
    pub fn table(&self, kind: &str, name: Option<&str>, span: Range<usize>) -> Table<'a> {
        let what = name.map_or_else(|| kind.to_owned(), |name| format!("{kind} \"{name}\""));
        Table { source: *self, what, span }
    }
}

/// The nearest of the names that serde lists after "unknown field `x`, expected one of `a`, `b`".
fn suggestion(message: &str) -> Option<&str> {
    let (unknown, known) = message.split_once(", expected ")?;
    if !unknown.starts_with("unknown ") {
        return None;
    }
    let quoted = |text| str::split(text, '`').skip(1).step_by(2);
    nearest(quoted(unknown).next()?, quoted(known))
}

impl Table<'_> {
    /// An error about this table.
    pub fn error(&self, problem: impl Into<String>) -> SceneError {
        self.source.error(self.span.start, format!("{}: {}", self.what, problem.into()))
    }

    /// The number, if it is finite and in the range.
    pub fn number(&self, key: &str, value: f32, range: RangeInclusive<f32>) -> Result<f32, SceneError> {
        if value.is_finite() && range.contains(&value) {
            return Ok(value);
        }
        let limits = match (*range.start(), *range.end()) {
            (low, f32::MAX) if low == f32::MIN => "a finite number".to_owned(),
            (0.0, f32::MAX) => "a finite number of 0 or more".to_owned(),
            (low, f32::MAX) if low == f32::MIN_POSITIVE => "a finite number above 0".to_owned(),
            (low, f32::MAX) => format!("a finite number of {low} or more"),
            (low, high) if low == f32::MIN_POSITIVE => format!("a number above 0, up to {high}"),
            (low, high) => format!("a number from {low} to {high}"),
        };
        Err(self.error(format!("`{key}` is {value}; give {limits}")))
    }

    /// Several numbers, each in the range.
    pub fn numbers<const N: usize>(&self, key: &str, values: [f32; N], range: RangeInclusive<f32>) -> Result<[f32; N], SceneError> {
        for value in values {
            self.number(key, value, range.clone())?;
        }
        Ok(values)
    }

    /// The only one of several keys that say the same thing in different ways; `None` where none is given.
    pub fn one_of<T: Copy>(&self, keys: &[(&'static str, Option<T>)]) -> Result<Option<(&'static str, T)>, SceneError> {
        let mut given = keys.iter().filter_map(|(key, value)| value.map(|value| (*key, value)));
        let first = given.next();
        match (first, given.next()) {
            (Some((a, _)), Some((b, _))) => Err(self.error(format!("`{a}` and `{b}` exclude each other; keep one"))),
            _ => Ok(first),
        }
    }
}

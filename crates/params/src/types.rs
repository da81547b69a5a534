//! The types a parameter may have.

use crate::{ParamError, ParamSpec, ParamValues};
use std::fmt;

/// A value of a parameter.
#[allow(clippy::large_enum_variant, reason = "few values exist at a time, and they stay Copy")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// A real number, finite.
    Float(f64),
    /// A count.
    UInt(u32),
    /// A whole number.
    Int(i32),
    /// On or off.
    Bool(bool),
    /// One of the names of [`ScalarType::Choice`].
    Choice {
        /// Rank of the name.
        index: usize,
        /// The name.
        name: &'static str,
    },
    /// A linear RGB colour.
    Color([f64; 3]),
    /// Rows of four numbers.
    Rows(Rows),
    /// A file's path, empty if none is given. Paths are few and live as long as the program.
    Path(&'static str),
}

/// A short list of rows of four numbers, such as the lobes (c_x, c_y, c_z, n) of Lafortune's model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rows {
    rows: [[f64; 4]; Self::MOST],
    count: usize,
}

impl Rows {
    /// As many rows as one list holds.
    pub const MOST: usize = 8;

    /// The empty list.
    pub const NONE: Self = Self { rows: [[0.0; 4]; Self::MOST], count: 0 };

    /// The rows given, in order.
    pub fn as_slice(&self) -> &[[f64; 4]] {
        &self.rows[..self.count]
    }

    /// Adds a row; `false` when the list is full.
    #[must_use]
    pub fn push(&mut self, row: [f64; 4]) -> bool {
        let fits = self.count < Self::MOST;
        if fits {
            self.rows[self.count] = row;
            self.count += 1;
        }
        fits
    }
}

impl FromIterator<[f64; 4]> for Rows {
    /// # Panics
    /// When there are more than [`Rows::MOST`].
    fn from_iter<I: IntoIterator<Item = [f64; 4]>>(rows: I) -> Self {
        rows.into_iter().fold(Self::NONE, |mut list, row| {
            assert!(list.push(row), "at most {} rows", Self::MOST);
            list
        })
    }
}

/// The type of a parameter, without its range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ScalarType {
    /// `f64`, `f32` and its unit newtypes.
    Float,
    /// `u32`.
    UInt,
    /// `i32`.
    Int,
    /// `bool`.
    Bool,
    /// An enum; the names of its variants.
    Choice(&'static [&'static str]),
    /// `[f64; 3]`: linear RGB, written as one number or as `r,g,b`.
    Color,
    /// [`Rows`], written `a,b,c,d` and repeated.
    Rows,
    /// `&'static str`, the path of a file.
    Path,
}

impl ScalarType {
    /// The names of a choice; empty for other types.
    pub const fn choices(self) -> &'static [&'static str] {
        match self {
            Self::Choice(names) => names,
            _ => &[],
        }
    }
}

impl Value {
    /// The value as a number: booleans are 0 and 1, a choice is its rank. For sliders and `override` constants.
    ///
    /// # Panics
    /// For colours, rows and paths.
    pub fn as_f64(self) -> f64 {
        match self {
            Self::Float(value) => value,
            Self::UInt(value) => f64::from(value),
            Self::Int(value) => f64::from(value),
            Self::Bool(value) => f64::from(u8::from(value)),
            Self::Choice { index, .. } => index as f64,
            other => panic!("{other:?} is not one number"),
        }
    }

    /// The rank of a choice.
    ///
    /// # Panics
    /// For every other kind of value.
    pub fn choice(self) -> usize {
        match self {
            Self::Choice { index, .. } => index,
            other => panic!("{other:?} is not a choice"),
        }
    }
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Float(value) => write!(f, "{value}"),
            Self::UInt(value) => write!(f, "{value}"),
            Self::Int(value) => write!(f, "{value}"),
            Self::Bool(value) => write!(f, "{value}"),
            Self::Choice { name, .. } => f.write_str(name),
            Self::Color([r, g, b]) if r == g && g == b => write!(f, "{r}"),
            Self::Color([r, g, b]) => write!(f, "{r},{g},{b}"),
            Self::Rows(rows) => {
                for (i, [a, b, c, d]) in rows.as_slice().iter().enumerate() {
                    write!(f, "{}{a},{b},{c},{d}", if i > 0 { ";" } else { "" })?;
                }
                Ok(())
            }
            Self::Path(path) => f.write_str(path),
        }
    }
}

/// A Rust type that a field of a parameter struct may have.
pub trait ParamType: Sized {
    /// Its kind.
    const TYPE: ScalarType;

    /// From a value of that kind.
    ///
    /// # Panics
    /// When the value is of another kind: `SPEC` and field disagree, which the derive rules out.
    fn from_value(value: Value) -> Self;

    /// Back to a value.
    fn to_value(self) -> Value;
}

macro_rules! scalar {
    ($($ty:ty: $variant:ident),*) => {$(
        impl ParamType for $ty {
            const TYPE: ScalarType = ScalarType::$variant;

            fn from_value(value: Value) -> Self {
                match value {
                    Value::$variant(value) => value,
                    other => panic!("{other:?} is not a {}", stringify!($ty)),
                }
            }

            fn to_value(self) -> Value {
                Value::$variant(self)
            }
        }
    )*};
}
scalar!(f64: Float, u32: UInt, i32: Int, bool: Bool, [f64; 3]: Color, Rows: Rows, &'static str: Path);

impl ParamType for f32 {
    const TYPE: ScalarType = ScalarType::Float;

    fn from_value(value: Value) -> Self {
        f64::from_value(value) as f32
    }

    fn to_value(self) -> Value {
        // Through the shortest decimal text: 0.1_f32 is 0.1 for a reader, not 0.10000000149.
        Value::Float(self.to_string().parse().expect("a number reads back"))
    }
}

macro_rules! quantity {
    ($($ty:ident),*) => {$(
        impl ParamType for kajo_units::$ty {
            const TYPE: ScalarType = ScalarType::Float;

            fn from_value(value: Value) -> Self {
                Self(f32::from_value(value))
            }

            fn to_value(self) -> Value {
                self.0.to_value()
            }
        }
    )*};
}
quantity!(Meters, Radians, Seconds, Kelvin, Ev100, Nits, Lux, Radiance, Irradiance, PerceptualRoughness, Alpha);

/// A struct of parameters; `#[derive(Params)]` implements it.
pub trait ParamSet: Default {
    /// The parameters in field order.
    const SPEC: &'static [ParamSpec];

    /// From checked values.
    ///
    /// # Panics
    /// When the values belong to another `SPEC`.
    fn from_values(values: &ParamValues) -> Self;

    /// The values, without their types.
    fn to_values(&self) -> ParamValues;

    /// Every parameter as text, in field order.
    fn to_pairs(&self) -> Vec<(&'static str, String)> {
        self.to_values().to_pairs()
    }

    /// Reads `name = value` pairs; what is not given keeps its default.
    ///
    /// # Errors
    /// Unknown or repeated names, values of the wrong type or out of range.
    fn from_pairs(pairs: &[(&str, &str)]) -> Result<Self, ParamError> {
        Ok(Self::from_values(&ParamValues::from_pairs(Self::SPEC, pairs)?))
    }
}

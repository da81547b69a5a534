//! What a figure must show, as a number: measured beside expected.

use serde::Serialize;

/// One measurement.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Check {
    /// What was measured, with its unit.
    pub what: String,
    /// What it should be.
    pub expected: Expected,
    /// What it is.
    pub measured: f64,
    /// Does it hold?
    pub holds: bool,
}

/// Where a measurement should lie.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Expected {
    /// At most `within` away from `value`.
    Near {
        /// The value.
        value: f64,
        /// The tolerance, absolute.
        within: f64,
    },
    /// Not below.
    AtLeast(f64),
    /// Not above.
    AtMost(f64),
}

impl Expected {
    fn admits(self, measured: f64) -> bool {
        match self {
            Self::Near { value, within } => (measured - value).abs() <= within,
            Self::AtLeast(least) => measured >= least,
            Self::AtMost(most) => measured <= most,
        }
    }
}

impl Check {
    /// Judges a measurement. NaN never holds.
    pub fn new(what: impl Into<String>, measured: f64, expected: Expected) -> Self {
        Self { what: what.into(), expected, measured, holds: expected.admits(measured) }
    }

    /// `value` ± `within`.
    pub fn near(what: impl Into<String>, measured: f64, value: f64, within: f64) -> Self {
        Self::new(what, measured, Expected::Near { value, within })
    }

    /// `least` or more.
    pub fn at_least(what: impl Into<String>, measured: f64, least: f64) -> Self {
        Self::new(what, measured, Expected::AtLeast(least))
    }

    /// `most` or less.
    pub fn at_most(what: impl Into<String>, measured: f64, most: f64) -> Self {
        Self::new(what, measured, Expected::AtMost(most))
    }
}

/// The largest of some measurements; NaN if one of them is NaN or if there is none, so that nothing holds that was not measured.
pub(crate) fn largest(measurements: impl IntoIterator<Item = f64>) -> f64 {
    measurements.into_iter().reduce(|a, b| if a.is_nan() || a > b { a } else { b }).unwrap_or(f64::NAN)
}

/// The smallest, likewise.
pub(crate) fn smallest(measurements: impl IntoIterator<Item = f64>) -> f64 {
    -largest(measurements.into_iter().map(|measurement| -measurement))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn measurements_outside_their_bounds_do_not_hold() {
        assert!(Check::near("a", 1.01, 1.0, 0.02).holds && !Check::near("a", 1.03, 1.0, 0.02).holds);
        assert!(Check::at_least("a", 1.0, 1.0).holds && !Check::at_least("a", 0.9, 1.0).holds);
        assert!(Check::at_most("a", 1.0, 1.0).holds && !Check::at_most("a", 1.1, 1.0).holds);
        assert!(!Check::near("a", f64::NAN, 1.0, 1.0).holds && !Check::at_most("a", f64::NAN, 1.0).holds);
    }

    #[test]
    fn nothing_holds_that_was_not_measured() {
        assert_eq!((largest([1.0, 3.0, 2.0]), smallest([2.0, 1.0, 3.0])), (3.0, 1.0));
        for place in 0..3 {
            let mut numbers = [1.0, 3.0, 2.0];
            numbers[place] = f64::NAN;
            assert!(largest(numbers).is_nan() && smallest(numbers).is_nan());
        }
        assert!(largest([]).is_nan() && smallest([]).is_nan());
    }
}

//! What can be wrong with a parameter that a user gave.

use kajo_names::UnknownName;

/// A parameter that cannot be used. Messages say what to write instead.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ParamError {
    /// No parameter has this name.
    #[error(transparent)]
    Unknown(#[from] UnknownName),
    /// The same name twice.
    #[error("parameter `{name}` is given twice; give it once")]
    Repeated {
        /// The name.
        name: &'static str,
    },
    /// Text that is no value of the parameter's type; also NaN and infinities.
    #[error("parameter `{name}` is `{got}`; it must be {expected}")]
    Malformed {
        /// The name.
        name: &'static str,
        /// The text given.
        got: String,
        /// What is allowed, range included.
        expected: String,
    },
    /// A number outside its range.
    #[error("parameter `{name}` is {got}; it must be {expected}")]
    OutOfRange {
        /// The name.
        name: &'static str,
        /// The number given.
        got: String,
        /// The range with its unit.
        expected: String,
    },
}

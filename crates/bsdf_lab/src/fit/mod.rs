//! Fits a model's numbers to another model or to measured values: nonlinear least squares by Levenberg and Marquardt from many starts.
//!
//! The unknowns are the model's parameters, each mapped to [0, 1] such that its default lies in the middle, so that a roughness and an exponent of
//! up to a million are searched alike and no step leaves a range. So \[Lafortune97] fit their lobes, also to other models, as \[Falski04] reports.

mod metric;
mod report;
mod samples;
mod solve;
#[cfg(test)]
mod tests;
mod unknown;

pub use metric::Metric;
pub use report::{AngleError, Report};
pub use samples::{Grid, Sample, Samples};
pub use solve::{Estimate, Fit, Options, Watch, fit};

/// A fit that cannot be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FitError {
    /// A table that cannot be read.
    #[error("line {line} of the table: {problem}")]
    #[allow(missing_docs, reason = "the names say it")]
    Table { line: usize, problem: String },
    /// Too few values.
    #[error("{values} values cannot determine {unknowns} unknowns; give more samples or free fewer parameters")]
    #[allow(missing_docs, reason = "the names say it")]
    TooFew { values: usize, unknowns: usize },
    /// Nothing to fit to.
    #[error("the target is 0 for every pair of directions; give one that reflects")]
    Black,
    /// A name that is no free parameter.
    #[error("`{name}` cannot be fitted; {reason}")]
    #[allow(missing_docs, reason = "the names say it")]
    NotFree { name: String, reason: String },
    /// Starting values that the model refuses.
    #[error(transparent)]
    Model(#[from] kajo_bsdf::models::ModelError),
    /// No start led anywhere.
    #[error("none of {starts} starts led to finite values; give starting values nearer to the target")]
    #[allow(missing_docs, reason = "the names say it")]
    NoneConverged { starts: usize },
    /// Ended from outside.
    #[error("ended before the first start was done; fewer free parameters (--free) end sooner")]
    Interrupted,
}

//! Experiments over the registry of techniques: error and cost of each against the path-traced reference, and the report.

mod error;
mod evaluate;
mod host;
pub mod html;
mod judge;
mod options;
mod progress;
mod reference;
pub mod report;
mod staging;

pub use error::LabError;
pub use options::{CompareOptions, ReferenceStop};
pub use progress::{Progress, Unwatched};
pub use staging::Staging;

//! Experiments over the registry of techniques: error and cost of each against the path-traced reference, and the report.
//!
//! [`compare`] is the whole experiment: for each scene one rendering of the path tracer gives a [judge](judge::Judge) for each role; each
//! technique gives images for several seeds and the cost of a frame; [`report`] turns them into advice, [`html`] into a page.

mod error;
mod evaluate;
mod experiment;
pub mod failures;
mod host;
pub mod html;
pub mod judge;
mod look;
mod measure;
pub mod model_cost;
mod options;
mod plan;
mod progress;
mod progressive;
mod reference;
pub mod render_cost;
pub mod report;
mod settled;
mod staging;
pub mod study;
mod subject;
mod temporal;

pub use error::LabError;
pub use experiment::compare;
pub use look::Look;
pub use measure::take;
pub use options::{CompareOptions, ReferenceStop, quoted};
pub use progress::{Progress, Unwatched};
pub use progressive::{depth_of, is_judged_progressively, progressive_judge, progressive_picture, spread_of};
pub use reference::{Pictured, ReferencePlan, judged_lights, judged_roles};
pub use staging::Staging;
pub use subject::ambient_distance;

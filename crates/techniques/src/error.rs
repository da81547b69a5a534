//! What can go wrong with a technique.

use kajo_names::UnknownName;
use kajo_params::ParamError;

/// Errors of techniques and their registry.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// No role or technique has this name.
    #[error(transparent)]
    UnknownName(#[from] UnknownName),
    /// The technique cannot run on this device.
    #[error("{technique} is skipped: needs {needs}, which this adapter does not have")]
    Needs {
        /// Id of the technique.
        technique: &'static str,
        /// What is missing.
        needs: String,
    },
    /// A parameter cannot be used.
    #[error("{technique}: {source}")]
    Param {
        /// Id of the technique.
        technique: &'static str,
        /// What is wrong.
        source: ParamError,
    },
    /// The graph or the device refuses.
    #[error(transparent)]
    Graph(#[from] kajo_render_graph::Error),
}

//! What can go wrong with a technique.

use kajo_params::ParamError;

/// Errors of techniques and their registry.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// No role has this name.
    #[error("no role is called \"{got}\"; there are: {known}")]
    UnknownRole {
        /// The name given.
        got: String,
        /// Every role.
        known: String,
    },
    /// No technique has this id.
    #[error("no technique is called \"{got}\"{}; there are: {known}", nearest.map_or_else(String::new, |id| format!(", did you mean {id}?")))]
    UnknownTechnique {
        /// The id given.
        got: String,
        /// The nearest id there is.
        nearest: Option<&'static str>,
        /// Every technique.
        known: String,
    },
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

//! What stops a comparison.

use std::io;
use std::path::PathBuf;

/// Why there is no report. A technique that cannot run does not stop one: it is listed as skipped.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LabError {
    /// The report's folder cannot be made or written to.
    #[error("cannot write the report to {}: {reason}; choose another folder with -o", folder.display())]
    Folder {
        /// The folder.
        folder: PathBuf,
        /// The system's reason.
        reason: io::Error,
    },
    /// The folder's name belongs to a file.
    #[error("cannot write the report to {}: it is a file; choose another folder with -o", folder.display())]
    NotAFolder {
        /// The name.
        folder: PathBuf,
    },
    /// Nothing is left to compare.
    #[error("nothing to compare: {reason}")]
    Nothing {
        /// Why, and what to do.
        reason: String,
    },
    /// What was asked for is right and cannot be measured here.
    #[error("nothing was compared: {reason}")]
    NotMeasured {
        /// Why.
        reason: String,
    },
    /// Interrupted before the first result.
    #[error("interrupted before the first result; nothing was written")]
    Interrupted,
    /// A scene that cannot be loaded.
    #[error(transparent)]
    Scene(#[from] kajo_scene::SceneError),
    /// A role, a technique or a parameter that does not exist.
    #[error(transparent)]
    Technique(#[from] kajo_techniques::Error),
    /// No adapter, or one that fails.
    #[error(transparent)]
    Device(#[from] kajo_render_graph::Error),
    /// A reference that cannot be rendered.
    #[error(transparent)]
    Tracer(#[from] kajo_path_tracer::PathTracerError),
    /// An image that cannot be written.
    #[error(transparent)]
    Image(#[from] kajo_image::ImageError),
    /// Images that cannot be compared.
    #[error("{what}: {source}")]
    Metrics {
        /// Scene, role and technique.
        what: String,
        /// Why.
        source: kajo_image_metrics::MetricsError,
    },
}

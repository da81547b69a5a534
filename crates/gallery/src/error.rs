//! What stops a gallery.

use std::io;

/// Why there is no gallery.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GalleryError {
    /// A file of the gallery cannot be written.
    #[error("cannot write `{name}` of the gallery: {reason}; choose another folder with -o")]
    Write {
        /// The file.
        name: String,
        /// The system's reason.
        reason: io::Error,
    },
    /// Interrupted: a gallery is whole or not there.
    #[error("interrupted before the gallery was complete; nothing was written")]
    Interrupted,
    /// A picture that cannot be rendered.
    #[error(transparent)]
    Tracer(#[from] kajo_path_tracer::PathTracerError),
    /// An image that cannot be written.
    #[error(transparent)]
    Image(#[from] kajo_image::ImageError),
}

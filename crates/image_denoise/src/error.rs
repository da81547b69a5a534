//! What cannot be denoised.

use glam::UVec2;

/// Why nothing was denoised.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DenoiseError {
    /// No pixels.
    #[error("the image to denoise has no pixels; give one that has")]
    Empty,
    /// Images that do not belong together.
    #[error("the image `{what}` has {}x{} px and the picture {}x{}; they must be of one rendering", got.x, got.y, expected.x, expected.y)]
    Size {
        /// The image.
        what: &'static str,
        /// Its size.
        got: UVec2,
        /// That of the picture.
        expected: UVec2,
    },
    /// NaN, infinite or negative where that means nothing.
    #[error("the image `{what}` holds a number that is not finite, or a negative variance; render it anew")]
    NotFinite {
        /// The image.
        what: &'static str,
    },
}

//! Why there is no window.

/// Errors of the viewer. What goes wrong once the window stands is said in it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The system has no place for windows.
    #[error("no window can be opened: {reason}; `kajo render` and `kajo compare` need none")]
    NoWindow {
        /// What the system says.
        reason: String,
    },
    /// No adapter can paint the window.
    #[error("no graphics adapter can paint a window: {reason}; run `cargo xtask setup` to install a software Vulkan driver")]
    NoAdapter {
        /// What the drivers say.
        reason: String,
    },
    /// The device that paints the window is gone.
    #[error("the graphics device that paints the window was lost: {reason}; start the viewer again")]
    PaintingLost {
        /// What the driver says.
        reason: String,
    },
    /// A script cannot be read or does not succeed.
    #[error("{file}: line {line}: {reason}")]
    Script {
        /// The script.
        file: String,
        /// Counted from 1.
        line: usize,
        /// What is wrong.
        reason: String,
    },
    /// What the command line asks to see cannot be shown.
    #[error("{reason}")]
    Asked {
        /// Why.
        reason: String,
    },
    /// A file cannot be read.
    #[error("cannot read {file}: {reason}")]
    Read {
        /// The file.
        file: String,
        /// Why.
        reason: std::io::Error,
    },
    /// A picture cannot be written.
    #[error(transparent)]
    Image(#[from] kajo_image::ImageError),
}

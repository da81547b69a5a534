//! What can go wrong with image files.

use glam::UVec2;
use std::io;
use std::path::{Path, PathBuf};

/// An image file that could not be read or written: what, got, limit, what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ImageError {
    /// The input does not exist or cannot be opened.
    #[error("cannot read {}: {reason}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        reason: io::Error,
    },
    /// The output's directory does not exist.
    #[error("cannot write {}: the directory {} does not exist; create it first", path.display(), directory.display())]
    NoDirectory {
        /// The file.
        path: PathBuf,
        /// Its directory.
        directory: PathBuf,
    },
    /// The output's place is not writable.
    #[error("cannot write {}: permission denied; choose another place or change its permissions", path.display())]
    NotWritable {
        /// The file.
        path: PathBuf,
    },
    /// No space is left.
    #[error("cannot write {}: the disk is full; the file of {bytes} bytes was not written", path.display())]
    DiskFull {
        /// The file.
        path: PathBuf,
        /// Size of the whole file.
        bytes: usize,
    },
    /// Another failure of the file system.
    #[error("cannot write {}: {reason}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        reason: io::Error,
    },
    /// The bytes are not a valid file of their format.
    #[error("{} is not a readable {format} image: {reason}", path.display())]
    Malformed {
        /// The file.
        path: PathBuf,
        /// EXR, PNG, …
        format: &'static str,
        /// The decoder's reason.
        reason: String,
    },
    /// A file without a byte.
    #[error("{} is empty", path.display())]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// The format is unknown.
    #[error("{} has an unknown image format; known for {}", path.display(), if *writing { "writing: exr, hdr, png" } else { "reading: exr, hdr, png, jpg, webp" })]
    UnknownFormat {
        /// The file.
        path: PathBuf,
        /// Whether it was to be written.
        writing: bool,
    },
    /// An empty image, or one larger than memory is given for.
    #[error("an image of {}x{} px is outside the limits: 1x1 to {max_side} px a side and {max_pixels} px in all; choose another size", size.x, size.y)]
    Size {
        /// What was asked.
        size: UVec2,
        /// See [`MAX_SIDE`](crate::MAX_SIDE).
        max_side: u32,
        /// See [`MAX_PIXELS`](crate::MAX_PIXELS).
        max_pixels: u64,
    },
    /// A file that declares a picture larger than memory is given for, or an empty one.
    #[error("{} declares {}x{} px, which is outside the limits: 1x1 to {max_side} px a side and {max_pixels} px in all; scale it down", path.display(), size.x, size.y)]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// What it declares.
        size: UVec2,
        /// See [`MAX_SIDE`](crate::MAX_SIDE).
        max_side: u32,
        /// [`MAX_PIXELS`](crate::MAX_PIXELS), or what the caller allows.
        max_pixels: u64,
    },
    /// An OpenEXR file whose parts and channels together are more than memory is given for.
    #[error("{} declares {values} values in the channels of all its parts; the limit is {max_values}; scale it down or keep fewer channels", path.display())]
    TooManyValues {
        /// The file.
        path: PathBuf,
        /// Pixels × channels, summed over the parts.
        values: u64,
        /// The most that is read.
        max_values: u64,
    },
    /// A channel whose length is not `size.x × size.y`.
    #[error("channel {channel} has {got} values, but the file's size asks for {expected}")]
    ChannelLength {
        /// Full name.
        channel: String,
        /// Its length.
        got: usize,
        /// `size.x × size.y`.
        expected: usize,
    },
    /// Two channels have one name.
    #[error("channel {channel} appears twice; give each layer its own name")]
    DuplicateChannel {
        /// Full name.
        channel: String,
    },
    /// A colour was asked of a file that has none.
    #[error("{} has no colour image: expected channels R, G, B or Y, found {}", path.display(), found.join(", "))]
    NoColor {
        /// The file.
        path: PathBuf,
        /// All channels.
        found: Vec<String>,
    },
    /// Radiance HDR and PNG have no code for these values.
    #[error("cannot store {count} pixels that are NaN or infinite in {}: {format} has no code for them; write an .exr, or find their cause", path.display())]
    NotFinite {
        /// The file.
        path: PathBuf,
        /// HDR or PNG.
        format: &'static str,
        /// Number of pixels.
        count: usize,
    },
}

impl ImageError {
    /// Sorts a failure to write `bytes` bytes into the kinds a user can act on.
    pub(crate) fn from_write(path: &Path, bytes: usize, reason: io::Error) -> Self {
        let path = path.to_path_buf();
        match reason.kind() {
            io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => Self::NotWritable { path },
            io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => Self::DiskFull { path, bytes },
            _ => Self::Write { path, reason },
        }
    }
}

//! The image container, and its files: OpenEXR with named layers, Radiance HDR, PNG. Files are written atomically.
//!
//! Pixels in memory are linear light ([`LinearRgb`](kajo_units::LinearRgb)) or display-referred ([`Srgb8`](kajo_units::Srgb8)); a file's
//! encoding ends at this crate's border. [`read_image`] takes any file to linear light; [`ExrFile`] keeps every layer.

mod atomic;
mod buffer;
mod error;
mod exposure;
mod exr_file;
mod format;
mod hdr;
mod limits;
mod png_file;
mod read;
mod read_file;
pub mod tone_map;

pub use atomic::write_atomic;
pub use buffer::Image;
pub use error::ImageError;
pub use exposure::auto_exposure;
pub use exr_file::{ExrFile, Layer, Precision};
pub use format::{Written, write_image};
pub use hdr::write_hdr;
pub use limits::{MAX_PIXELS, MAX_SIDE, check_size, jpeg_is_cut_short};
pub use png_file::{encode_png, write_png};
pub use read::{decode_image, decode_image_within, read_image};
pub use read_file::read_file;
pub use tone_map::{ToneMap, tone_map};

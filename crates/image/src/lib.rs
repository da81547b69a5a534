//! The image container, and its files: OpenEXR with named layers, Radiance HDR, PNG. Files are written atomically.

mod buffer;

pub use buffer::Image;

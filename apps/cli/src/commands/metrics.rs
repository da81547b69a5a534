//! `kajo metrics`: how an image differs from a reference.

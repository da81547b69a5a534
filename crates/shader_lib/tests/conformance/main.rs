//! GPU against CPU: every shader function that has a Rust twin runs over its domain on an adapter (a software one is enough) and is
//! compared with the twin.

mod bsdf;
mod color;
mod compare;
mod gpu;
mod lights;
mod material;
mod points;

//! Reflectance models: every lobe with `f_cos`, `sample`, `pdf` and `albedo`, and the layered glTF material built from them.
//!
//! Directions are in the local shading frame (z is the normal), `wo` points to the viewer and `wi` to the light; see
//! `docs/conventions.md`.

mod material;

pub use material::MaterialParams;

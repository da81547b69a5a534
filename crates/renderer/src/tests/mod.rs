//! Whole frames, against the path tracer and against closed forms.

mod display;
mod emissive;
mod gbuffer;
mod lighting;
mod models;
mod scenes;
mod shadows;
mod textures;
mod tracing;

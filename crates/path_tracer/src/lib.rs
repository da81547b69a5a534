//! The path tracer on the CPU: the judge of every real-time technique.
//!
//! A [`Tracer`] holds a scene at one time; [`render`] gathers samples on a [`Film`], which develops into a [`Frame`]: the picture, one
//! image per role and light-path expression, and their variance. Everything is deterministic: the samples of a pixel come from
//! (seed, pixel, sample) and are added in order, so threads, passes and interruptions leave no trace.
//!
//! # What is simulated
//! Full unidirectional light transport on surfaces: all analytic lights, emissive meshes, environments; the layered material with
//! reflection and transmission; absorption inside of volumes. Depth d counts surface bounces: 0 is emission, 1 direct light.
//!
//! # What is not
//! Participating media, subsurface scattering, wavelengths (dispersion bends the three channels); shadow rays do not refract (caustics are found by BSDF sampling
//! alone); analytic lights neither block nor scatter light; nothing is clamped.

mod adaptive;
mod aov;
mod blocks;
mod camera;
mod checkpoint;
mod error;
mod extra;
mod film;
mod filter;
mod fingerprint;
mod frame;
mod geometry;
mod integrator;
mod lights;
mod pixels;
mod points;
mod ray_start;
mod record;
mod render;
mod settings;
mod surface;
mod tracer;
mod world;

pub use aov::Aov;
pub use error::PathTracerError;
pub use film::Film;
pub use filter::Filter;
pub use frame::{Frame, FrameImage, Pixels};
pub use render::{Control, Progress, render, uncontrolled};
pub use settings::{CameraChoice, EnvironmentSampler, Integrator, LightSampler, RussianRoulette, Settings, Stop, Strategy};
pub use tracer::Tracer;
#[cfg(test)]
mod tests;

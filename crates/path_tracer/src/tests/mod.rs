//! What the whole tracer claims, checked against closed forms and against itself.

mod aovs;
mod compare;
mod culling;
mod determinism;
mod direct_light;
mod dispersion;
mod environment;
mod estimators;
mod furnace;
mod leaks;
mod many_lights;
mod models;
mod rays;
pub(crate) mod scenes;
pub(crate) mod skies;
mod visibility;

//! What the whole tracer claims, checked against closed forms and against itself.

mod compare;
mod direct_light;
mod estimators;
mod furnace;
mod scenes;

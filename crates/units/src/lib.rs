//! Newtypes for every physical quantity, and the only home of conversion factors.
//!
//! A quantity that crosses a public boundary has a type; inside a kernel a bare `f32` is fine. Nothing here allocates,
//! and every type is `#[repr(transparent)]`, so that slices of them can be given to a GPU as they are.

mod color;
mod photometry;
mod roughness;
mod scalar;

pub use color::{LinearRgb, Srgb8, linear_from_srgb, srgb_from_linear};
pub use photometry::LuminousEfficacy;
pub use roughness::{Alpha, PerceptualRoughness};
pub use scalar::{
    Candela, Ev100, Irradiance, Kelvin, Lumens, Lux, Meters, Nits, Radiance, Radians, RadiantFlux, RadiantIntensity, Seconds,
};

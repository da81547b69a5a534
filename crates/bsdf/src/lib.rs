//! Reflectance models: every lobe with `f_cos`, `sample`, `pdf` and `albedo`, and the layered glTF material built from them.
//!
//! Directions are in the local shading frame (z is the normal), `wo` points to the viewer and `wi` to the light; see
//! `docs/conventions.md`.

mod any;
mod fresnel;
mod layered;
mod material;
mod microfacet;
pub mod models;
mod sheen;
pub mod tables;
mod thin_film;
mod vector;

pub use any::{AnyBsdf, AnyBsdfView, ModelView};
pub use fresnel::{
    f0_from_ior, fresnel_conductor, fresnel_dielectric, fresnel_schlick, fresnel_schlick_average, ior_from_f0, schlick_weight,
};
pub use layered::{Bsdf, BsdfSample, BsdfView, LambertView, Lobe, LobeValues};
pub use material::MaterialParams;
pub use microfacet::*;
pub use sheen::{SHEEN_MIN_ALPHA, sheen_albedo, sheen_d, sheen_lambda, sheen_visibility};
pub use thin_film::{film_sensitivity, fresnel_thin_film};
pub use vector::{critical_angle, reflect, refract};

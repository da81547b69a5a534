//! Techniques of the role specular indirect: what specular lobes reflect of surfaces, emissive meshes and the environment.
//!
//! Analytic lights are no part of it, their highlights are direct light. Emissive meshes are lights as well: where a technique mirrors them, see
//! [`Effect::mirrors_up_to`](crate::Effect::mirrors_up_to).

pub mod environment;
pub mod none;
pub mod planar;
pub mod ray_traced;
pub mod ssr_dda;
mod surfaces;

use crate::Technique;

/// In the order of every list.
pub const ALL: &[&Technique] =
    &[&none::TECHNIQUE, &environment::TECHNIQUE, &planar::TECHNIQUE, &ssr_dda::TECHNIQUE, &ray_traced::TECHNIQUE];

//! Techniques of the role direct visibility: which share of each light a point sees.

pub mod depth_map;
pub mod hard;
pub mod map;
pub mod multi_sample;
pub mod none;
pub mod ray_traced;
mod volume;
pub mod volume_zfail;
pub mod volume_zpass;

use crate::Technique;

/// In the order of every list.
pub const ALL: &[&Technique] = &[
    &none::TECHNIQUE,
    &map::TECHNIQUE,
    &volume_zpass::TECHNIQUE,
    &volume_zfail::TECHNIQUE,
    &multi_sample::TECHNIQUE,
    &ray_traced::TECHNIQUE,
];

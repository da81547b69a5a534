//! Techniques of the role direct visibility: which share of each light a point sees.

pub mod depth_map;
pub mod map;
pub mod none;
pub mod ray_traced;

use crate::Technique;

/// In the order of every list.
pub const ALL: &[&Technique] = &[&none::TECHNIQUE, &map::TECHNIQUE, &ray_traced::TECHNIQUE];

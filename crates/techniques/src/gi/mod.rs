//! Techniques of the role diffuse indirect: the irradiance of light that bounced before it arrives.
//!
//! What lights give straight is the role direct visibility, what the environment gives is weighted by the role ambient visibility: neither counts here.

pub mod none;

use crate::Technique;

/// In the order of every list.
pub const ALL: &[&Technique] = &[&none::TECHNIQUE];

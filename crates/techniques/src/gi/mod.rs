//! Techniques of the role diffuse indirect: the irradiance of light that bounced before it arrives.
//!
//! What lights give straight is the role direct visibility, what the environment gives is weighted by the role ambient visibility: neither counts here.

pub mod constant;
mod light_power;
pub mod none;
pub mod probes;
pub mod ray_traced;
mod sky;
pub mod vpl;

pub use light_power::light_powers;

use crate::Technique;
use kajo_render_graph::{Slot, slot};

/// In the order of every list.
pub const ALL: &[&Technique] = &[&none::TECHNIQUE, &constant::TECHNIQUE, &vpl::TECHNIQUE, &probes::TECHNIQUE, &ray_traced::TECHNIQUE];

/// Slots that the group reads.
const READS: &[Slot] = &[slot::DEPTH, slot::NORMAL];

//! Techniques of the role ambient visibility: which share of the hemisphere over a point is open.
//!
//! How far a surface blocks is an input of the role, [`FrameContext::ambient_distance`](crate::FrameContext::ambient_distance), so that every technique
//! and the reference integrate the same function.

pub mod gtao;
pub mod none;
pub mod ray_traced;
mod screen;
pub mod ssao;

use crate::{FrameContext, Technique};
use kajo_render_graph::{Slot, slot};

/// In the order of every list.
pub const ALL: &[&Technique] = &[&none::TECHNIQUE, &ssao::TECHNIQUE, &gtao::TECHNIQUE, &ray_traced::TECHNIQUE];

/// Slots that the group reads.
const READS: &[Slot] = &[slot::DEPTH, slot::NORMAL];

/// The ambient distance as shaders take it: they do not reckon with infinity. Twin of `shader_lib::math::FAR`.
fn reach(frame: &FrameContext) -> f32 {
    frame.ambient_distance.min(1e18)
}

//! Khronos PBR neutral.

use super::{Curve, READS, ToneMap};
use crate::{Needs, Role, Technique};

/// The technique.
pub const TECHNIQUE: Technique = Technique {
    id: "tone/pbr-neutral",
    role: Role::ToneMap,
    title: "Khronos PBR neutral",
    doc: include_str!("doc.md"),
    cites: &["KhronosNeutral"],
    reads: READS,
    needs: Needs::NONE,
    params: &[],
    make: |context, _| ToneMap::make(context, TECHNIQUE.id, Curve::PbrNeutral),
};

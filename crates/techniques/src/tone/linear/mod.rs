//! No curve.

use super::{Curve, READS, ToneMap};
use crate::{Needs, Role, Technique};

/// The technique.
pub const TECHNIQUE: Technique = Technique {
    id: "tone/linear",
    role: Role::ToneMap,
    title: "No curve",
    doc: include_str!("doc.md"),
    cites: &[],
    reads: READS,
    needs: Needs::NONE,
    params: &[],
    make: |context, _| ToneMap::make(context, TECHNIQUE.id, Curve::Linear),
};

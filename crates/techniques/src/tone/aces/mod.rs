//! ACES fit.

use super::{Curve, READS, ToneMap};
use crate::{Needs, Role, Technique};

/// The technique.
pub const TECHNIQUE: Technique = Technique {
    id: "tone/aces",
    role: Role::ToneMap,
    title: "ACES fit",
    doc: include_str!("doc.md"),
    cites: &["Hill16"],
    reads: READS,
    needs: Needs::NONE,
    params: &[],
    make: |context, _| ToneMap::make(context, TECHNIQUE.id, Curve::Aces),
};

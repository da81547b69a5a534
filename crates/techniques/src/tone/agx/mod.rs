//! AgX.

use super::{Curve, READS, ToneMap};
use crate::{Needs, Role, Technique};

/// The technique.
pub const TECHNIQUE: Technique = Technique {
    id: "tone/agx",
    role: Role::ToneMap,
    title: "AgX",
    doc: include_str!("doc.md"),
    cites: &["Sobotka22"],
    reads: READS,
    needs: Needs::NONE,
    params: &[],
    make: |context, _| ToneMap::make(context, TECHNIQUE.id, Curve::Agx),
};

//! Penumbra wedges: soft shadow volumes.

use super::volume::{Count, READS, ShadowVolumes};
use crate::{Needs, Role, Technique};
use kajo_params::Params;

/// The technique.
pub const TECHNIQUE: Technique = Technique {
    id: "shadow/wedges",
    role: Role::DirectVisibility,
    title: "Penumbra wedges",
    doc: include_str!("doc.md"),
    cites: &["Assarsson03", "Ericson05"],
    reads: READS,
    needs: Needs::NONE,
    params: Params::SPEC,
    make: |context, _| Ok(Box::new(ShadowVolumes::new(context, TECHNIQUE.id, Count::Behind, false)?.softened(context)?)),
};

/// Its parameters: none.
#[derive(Params, Clone, Copy, Debug)]
pub struct Params {}

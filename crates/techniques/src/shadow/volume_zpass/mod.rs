//! Shadow volumes by z-pass.

use super::volume::{Count, READS, ShadowVolumes};
use crate::{Needs, Role, Technique};
use kajo_params::Params;

/// The technique.
pub const TECHNIQUE: Technique = Technique {
    id: "shadow/volume-zpass",
    role: Role::DirectVisibility,
    title: "Shadow volumes, z-pass",
    doc: include_str!("doc.md"),
    cites: &["Crow77", "Heidmann91", "Kim08"],
    reads: READS,
    needs: Needs::NONE,
    params: Params::SPEC,
    make: |context, values| {
        let params = Params::from_values(values);
        Ok(Box::new(ShadowVolumes::new(context, TECHNIQUE.id, Count::Before, params.culling)?))
    },
};

/// Its parameters.
#[derive(Params, Clone, Copy, Debug)]
pub struct Params {
    /// Leaves out casters whose shadow lies beside the view, and counts nothing at pixels whose answer is known: no surface, or one turned away from the
    /// light. The image is the same.
    #[param(default = true)]
    pub culling: bool,
}

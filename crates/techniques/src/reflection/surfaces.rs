//! What passes of this role read of the surfaces that pixels show.

use kajo_render_graph::{Bindings, Error, PassContext, Slot, slot};

/// Slots that hold them.
pub(super) const READS: &[Slot] = &[slot::DEPTH, slot::NORMAL, slot::ALBEDO, slot::F0_ROUGHNESS, slot::LAYERS, slot::IDS];

/// The same and the picture without reflections.
pub(super) const READS_LIT: &[Slot] = &[slot::DEPTH, slot::NORMAL, slot::ALBEDO, slot::F0_ROUGHNESS, slot::LAYERS, slot::IDS, slot::LIT];

/// Their images by the names that shaders know them by: those of the slots.
pub(super) fn bind<'a>(pass: &PassContext) -> Result<Bindings<'a>, Error> {
    READS.iter().try_fold(Bindings::new(), |all, slot| Ok(all.with(slot.name, pass.view(*slot)?)))
}

//! The two inner loops, eight boxes and four triangles at a time, on each instruction set.

#[cfg(target_arch = "x86_64")]
mod avx2;
mod portable;

#[cfg(target_arch = "x86_64")]
pub(crate) use avx2::Avx2;
pub(crate) use portable::Portable;

use crate::{slab::SlabRay, triangle::Block, triangle::ShearedRay, wide::Node, wide::WIDTH};

/// Entry distances of the children of a node.
#[repr(C, align(32))]
pub(crate) struct Distances(pub [f32; WIDTH]);

/// Tests boxes and triangles side by side. Implementations may differ in rounding of box distances, within the margin of [`crate::slab`].
pub(crate) trait Lanes {
    /// Children whose box is met within `t_min ..= t_max`, one bit each, and where each is entered.
    fn boxes(ray: &SlabRay, node: &Node, t_max: f32) -> (u32, Distances);

    /// Lanes whose edge functions, in single precision, do not have two signs: one bit each. Exactly the same in every implementation.
    fn triangles(ray: &ShearedRay, block: &Block) -> u32;
}

/// Which instructions traversal uses. The hits are the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Backend {
    /// Plain Rust.
    Portable,
    /// AVX2 and FMA; x86-64 only.
    Avx2,
}

impl Backend {
    /// The fastest one that this processor runs.
    pub fn detect() -> Self {
        if Self::Avx2.is_supported() { Self::Avx2 } else { Self::Portable }
    }

    /// Whether this processor runs it.
    pub fn is_supported(self) -> bool {
        match self {
            Self::Portable => true,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma"),
            #[cfg(not(target_arch = "x86_64"))]
            Self::Avx2 => false,
        }
    }
}

//! What can go wrong between an image and its sampler.

/// Why an environment has no such sampler. Each message is one sentence: what, got, limit, what to do.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum EnvironmentError {
    /// A side of zero, one that no block can hold, or another number of pixels.
    #[error(
        "environment of {width}x{height} px with {pixels} values: each side must lie in 1 ..= {max} and every pixel have one; resize it"
    )]
    Size {
        /// Width, px.
        width: u32,
        /// Height, px.
        height: u32,
        /// Values given.
        pixels: usize,
        /// Largest side, px.
        max: u32,
    },
    /// Nothing to prefer.
    #[error("environment without light: no pixel is positive; leave it to uniform sampling")]
    Black,
    /// No block at all.
    #[error("{got} blocks: at least 1 is needed; give a larger number")]
    Blocks {
        /// Blocks asked for.
        got: usize,
    },
    /// More than the words of the packed tree can say.
    #[error(
        "packed tree of {blocks} blocks over {width}x{height} px exceeds {max_blocks} blocks or {max_side} px a side; use another lookup"
    )]
    PackedTree {
        /// Leaves of the tree.
        blocks: usize,
        /// Width, px.
        width: u32,
        /// Height, px.
        height: u32,
        /// Most leaves.
        max_blocks: usize,
        /// Largest side, px.
        max_side: u32,
    },
}

//! From boxes to a binary tree, in one of three ways.

mod bins;
mod morton;
mod options;
mod reinsertion;
mod spatial;
mod tree;

pub(crate) use tree::{BinaryNode, BinaryTree, Cost, Item};

pub use options::{BuildFlags, BuildOptions, BuildQuality, Sah};

use crate::stack::MAX_DEPTH;
use glam::Vec3;
use reinsertion::Effort;

/// Subtrees that are tried elsewhere, however many items there are: the time then no longer grows, and what is left to gain is small.
const MOST_SUBTREES: usize = 1 << 14;

impl BinaryTree {
    /// Builds as the options say; the result does not depend on the number of threads. `triangle` gives the corners of an item that may be cut.
    pub fn with_options(
        items: Vec<Item>,
        block: usize,
        options: &BuildOptions,
        triangle: impl Fn(u32) -> Option<[Vec3; 3]> + Sync,
    ) -> Self {
        let cost = Cost { sah: options.effective_sah(), block };
        let count = items.len();
        let tree = match options.quality {
            BuildQuality::Fast => morton::build(items, &cost),
            _ if options.may_cut() => spatial::build(items, &cost, &triangle),
            _ => Self::build(items, &cost),
        };
        let effort = match options.quality {
            BuildQuality::Fast => Effort { subtrees: (count / 64).min(MOST_SUBTREES), rounds: 2 },
            BuildQuality::Balanced => Effort { subtrees: (count / 256).min(MOST_SUBTREES), rounds: 2 },
            BuildQuality::High => Effort { subtrees: count.min(16 * MOST_SUBTREES), rounds: 3 },
        };
        tree.optimized(effort, MAX_DEPTH)
    }
}

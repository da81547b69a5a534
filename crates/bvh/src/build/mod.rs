//! From boxes to a binary tree, in one of three ways.

mod bins;
mod morton;
mod options;
mod spatial;
mod tree;

pub(crate) use tree::{BinaryNode, BinaryTree, Cost, Item};

pub use options::{BuildFlags, BuildOptions, BuildQuality, Sah};

use glam::Vec3;

impl BinaryTree {
    /// Builds as the options say; the result does not depend on the number of threads. `triangle` gives the corners of an item that may be cut.
    pub fn with_options(
        items: Vec<Item>,
        block: usize,
        options: &BuildOptions,
        triangle: impl Fn(u32) -> Option<[Vec3; 3]> + Sync,
    ) -> Self {
        let cost = Cost { sah: options.effective_sah(), block };
        match options.quality {
            BuildQuality::Fast => morton::build(items, &cost),
            _ if options.may_cut() => spatial::build(items, &cost, &triangle),
            _ => Self::build(items, &cost),
        }
    }
}

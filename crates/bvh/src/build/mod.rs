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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aabb::Aabb;

    fn depth(tree: &BinaryTree, node: usize) -> usize {
        match tree.nodes[node].leaf() {
            Some(_) => 1,
            None => 1 + tree.nodes[node].children().map(|child| depth(tree, child)).into_iter().max().unwrap_or(0),
        }
    }

    /// Boxes over all magnitudes of numbers, each twice as large and as far as the one before: the cheapest plane cuts off one or two of many.
    #[test]
    fn no_tree_is_deeper_than_the_stack_allows() {
        for copies in [1, 40] {
            let items: Vec<Item> = (0..180 * copies)
                .map(|i| {
                    let size = 2.0f32.powi((i / copies) as i32 - 122);
                    Item::new(&Aabb { min: Vec3::splat(size), max: Vec3::splat(1.5 * size) }, i)
                })
                .collect();
            for quality in BuildQuality::ALL {
                let sah = Sah { max_leaf_size: 1, bins: 2, ..Sah::default() };
                let tree = BinaryTree::with_options(items.clone(), 1, &BuildOptions { sah, ..BuildOptions::of(quality) }, |_| None);
                let depth = depth(&tree, 0);
                assert!((40..=MAX_DEPTH).contains(&depth) || quality == BuildQuality::Fast && depth <= MAX_DEPTH, "{quality:?}: {depth}");
            }
        }
    }
}

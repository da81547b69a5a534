//! The fast build: items in the order of a space-filling curve, divided where the curve leaves a cell, \[Lauterbach09].

use super::{
    bins::Bins,
    tree::{self, BinaryNode, BinaryTree, Bounds, Cost, Item, PARALLEL_ITEMS, Task},
};
use glam::Vec4;
use rayon::prelude::*;

/// Bits of a cell on each axis. Three of them and the [`NUMBER_BITS`] fill a word, so that one sort of words orders the items.
const CELL_BITS: u32 = 12;

/// Bits of an item's place.
const NUMBER_BITS: u32 = 28;

/// Builds over items; the result does not depend on the number of threads. Items that fall into one cell, of the 2³⁶ in the box of all, are divided by
/// the surface area heuristic: details in a large scene keep their tree.
pub fn build(items: Vec<Item>, cost: &Cost) -> BinaryTree {
    if items.is_empty() {
        return BinaryTree { nodes: Vec::new(), order: Vec::new() };
    }
    let bounds = items.par_chunks(PARALLEL_ITEMS).map(Bounds::of).reduce(|| Bounds::EMPTY, |a, b| a.union(&b));
    let mut words = cells(&items, &bounds);
    words.par_sort_unstable();
    let mut items: Vec<Item> = words.par_iter().with_min_len(1024).map(|word| items[(word & ((1 << NUMBER_BITS) - 1)) as usize]).collect();
    let mut nodes = vec![BinaryNode::UNUSED; 2 * items.len() - 1];
    subtree(Task { items: &mut items, nodes: &mut nodes, first_item: 0, first_node: 0, depth: 0 }, &words, cost);
    BinaryTree { nodes, order: items.par_iter().with_min_len(1024).map(Item::number).collect() }
}

/// For each item its cell on the curve, and its place in the list.
fn cells(items: &[Item], bounds: &Bounds) -> Vec<u64> {
    let extent = bounds.center_max - bounds.center_min;
    let scale = Vec4::select(extent.cmpgt(Vec4::ZERO), Vec4::splat(((1 << CELL_BITS) - 1) as f32) / extent, Vec4::ZERO);
    let scale = Vec4::select(scale.cmplt(Vec4::INFINITY), scale, Vec4::ZERO);
    let cell = |(place, item): (usize, &Item)| {
        let at = (item.center2() - bounds.center_min) * scale;
        (spread(at.x) << 2 | spread(at.y) << 1 | spread(at.z)) << NUMBER_BITS | place as u64
    };
    items.par_iter().enumerate().with_min_len(1024).map(cell).collect()
}

/// The bits of a number below 2¹², each third bit.
fn spread(x: f32) -> u64 {
    let mut x = u64::from(x as u32);
    x = (x | x << 16) & 0x0000_0000_ff00_00ff;
    x = (x | x << 8) & 0x00f0_0f00_f00f;
    x = (x | x << 4) & 0x0c30_c30c_30c3;
    (x | x << 2) & 0x2492_4924_9249
}

/// Builds a subtree over items in the order of the curve; returns the bounds and, for a leaf, its tests.
fn subtree(task: Task, words: &[u64], cost: &Cost) -> (Bounds, Option<f32>) {
    let Task { items, nodes, first_item, first_node, depth } = task;
    let count = items.len();
    if count <= cost.block.min(cost.sah.max_leaf_size) || count == 1 {
        let bounds = Bounds::of(items);
        nodes[0] = BinaryNode::of_leaf(&bounds, first_item, count);
        return (bounds, Some(cost.blocks(count)));
    }
    let (first, last) = (words[0] >> NUMBER_BITS, words[count - 1] >> NUMBER_BITS);
    if first == last {
        let bounds = Bounds::of(items);
        tree::build(Task { items, nodes, first_item, first_node, depth }, bounds, cost, &mut Bins::new());
        let is_leaf = nodes[0].leaf().is_some();
        return (bounds, is_leaf.then(|| cost.blocks(count)));
    }
    let highest = 63 - (first ^ last).leading_zeros();
    let middle = words.partition_point(|word| word >> NUMBER_BITS >> highest & 1 == 0);

    let (node, rest) = nodes.split_first_mut().expect("a place for every node");
    let (left_items, right_items) = items.split_at_mut(middle);
    let (left_nodes, right_nodes) = rest.split_at_mut(2 * middle - 1);
    let (left_first, right_first) = (first_node + 1, first_node + 2 * middle);
    let left = Task { items: left_items, nodes: left_nodes, first_item, first_node: left_first, depth: depth + 1 };
    let right = Task { items: right_items, nodes: right_nodes, first_item: first_item + middle, first_node: right_first, depth: depth + 1 };
    let (left, right) = if count >= PARALLEL_ITEMS {
        rayon::join(|| subtree(left, &words[..middle], cost), || subtree(right, &words[middle..], cost))
    } else {
        (subtree(left, &words[..middle], cost), subtree(right, &words[middle..], cost))
    };
    let bounds = left.0.union(&right.0);
    // Two leaves that cost no less than one are one.
    if let (Some(left_tests), Some(right_tests)) = (left.1, right.1)
        && count <= cost.sah.max_leaf_size
        && bounds.half_area() * (cost.blocks(count) - cost.sah.node_cost)
            <= left.0.half_area() * left_tests + right.0.half_area() * right_tests
    {
        *node = BinaryNode::of_leaf(&bounds, first_item, count);
        return (bounds, Some(cost.blocks(count)));
    }
    *node = BinaryNode::of_children(&bounds, left_first, right_first);
    (bounds, None)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spread_bits_stand_two_apart() {
        for bit in 0..CELL_BITS {
            assert_eq!(spread((1u32 << bit) as f32), 1 << (3 * bit));
        }
        assert_eq!(spread(4095.9), 0x2492_4924_9249 & ((1 << 36) - 1));
    }
}

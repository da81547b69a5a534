//! The binary tree and its recursive build by binned surface area heuristic.

use super::{Sah, bins::Bins};
use crate::{aabb::Aabb, stack::MAX_DEPTH};
use glam::{Vec3, Vec4, Vec4Swizzles};
use std::ops::Range;

/// Set in a number's bits, so that as a float it is neither tiny (slow arithmetic) nor NaN.
const NORMAL: u32 = 0x4000_0000;

/// A primitive to build over: its box and its number, below 2²⁸.
#[derive(Clone, Copy, Debug)]
pub struct Item {
    /// Least corner; the last lane holds the number's bits and [`NORMAL`].
    min: Vec4,
    /// Greatest corner.
    max: Vec4,
}

impl Item {
    pub fn new(bounds: &Aabb, number: u32) -> Self {
        Self { min: bounds.min.extend(f32::from_bits(number | NORMAL)), max: bounds.max.extend(0.0) }
    }

    pub fn number(&self) -> u32 {
        self.min.w.to_bits() & !NORMAL
    }

    pub fn bounds(&self) -> Aabb {
        Aabb { min: self.min.xyz(), max: self.max.xyz() }
    }

    /// Twice the centre of the box; the last lane means nothing.
    #[inline(always)]
    pub fn center2(&self) -> Vec4 {
        self.min + self.max
    }

    #[inline(always)]
    pub fn min(&self) -> Vec4 {
        self.min
    }

    #[inline(always)]
    pub fn max(&self) -> Vec4 {
        self.max
    }
}

/// A node of 32 bytes: two fill a cache line.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct BinaryNode {
    min: Vec3,
    /// The left child, or the first item of a leaf.
    left_or_first: u32,
    max: Vec3,
    /// The right child, or the number of items of a leaf and [`LEAF`].
    right_or_count: u32,
}

/// Tells leaves; node indices stay below.
const LEAF: u32 = 1 << 31;

impl BinaryNode {
    pub const UNUSED: Self = Self { min: Vec3::ZERO, left_or_first: 0, max: Vec3::ZERO, right_or_count: 0 };

    /// A leaf with `count` items from `first`.
    pub fn of_leaf(bounds: &Bounds, first: usize, count: usize) -> Self {
        Self { min: bounds.min.xyz(), left_or_first: first as u32, max: bounds.max.xyz(), right_or_count: count as u32 | LEAF }
    }

    /// An inner node.
    pub fn of_children(bounds: &Bounds, left: usize, right: usize) -> Self {
        Self { min: bounds.min.xyz(), left_or_first: left as u32, max: bounds.max.xyz(), right_or_count: right as u32 }
    }

    /// An inner node with the given box.
    pub fn of_boxes(bounds: Aabb, left: u32, right: u32) -> Self {
        Self { min: bounds.min, left_or_first: left, max: bounds.max, right_or_count: right }
    }

    pub fn bounds(&self) -> Aabb {
        Aabb { min: self.min, max: self.max }
    }

    /// The range of the tree's order that a leaf holds.
    pub fn leaf(&self) -> Option<Range<usize>> {
        let first = self.left_or_first as usize;
        (self.right_or_count & LEAF != 0).then(|| first..first + (self.right_or_count & !LEAF) as usize)
    }

    /// Indices of both children of an inner node.
    pub fn children(&self) -> [usize; 2] {
        [self.left_or_first as usize, self.right_or_count as usize]
    }
}

/// A binary tree; node 0 is the top. Subtrees of known size have reserved places, so nodes in between may be unused.
#[derive(Clone, Debug)]
pub struct BinaryTree {
    pub nodes: Vec<BinaryNode>,
    /// Numbers of the items, leaf after leaf.
    pub order: Vec<u32>,
}

/// What the cost model needs to know.
#[derive(Clone, Copy, Debug)]
pub struct Cost {
    pub sah: Sah,
    /// Items that are tested together.
    pub block: usize,
}

impl Cost {
    /// Tests that `count` items cost.
    pub fn blocks(&self, count: usize) -> f32 {
        count.div_ceil(self.block) as f32
    }
}

/// Below this many items a subtree is built by one thread.
pub const PARALLEL_ITEMS: usize = 4096;

/// From this depth on, halves of equal count bound the depth.
pub const BALANCE_DEPTH: usize = MAX_DEPTH - 32;

impl BinaryTree {
    /// Builds over items; the result does not depend on the number of threads.
    pub fn build(mut items: Vec<Item>, cost: &Cost) -> Self {
        if items.is_empty() {
            return Self { nodes: Vec::new(), order: Vec::new() };
        }
        let mut nodes = vec![BinaryNode::UNUSED; 2 * items.len() - 1];
        let bounds = Bounds::of(&items);
        build(Task { items: &mut items, nodes: &mut nodes, first_item: 0, first_node: 0, depth: 0 }, bounds, cost, &mut Bins::new());
        Self { nodes, order: items.iter().map(Item::number).collect() }
    }
}

/// Boxes around items and around twice their centres.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    pub min: Vec4,
    pub max: Vec4,
    pub center_min: Vec4,
    pub center_max: Vec4,
}

impl Bounds {
    pub const EMPTY: Self =
        Self { min: Vec4::INFINITY, max: Vec4::NEG_INFINITY, center_min: Vec4::INFINITY, center_max: Vec4::NEG_INFINITY };

    pub fn of(items: &[Item]) -> Self {
        let mut bounds = Self::EMPTY;
        for item in items {
            bounds.add(item);
        }
        bounds
    }

    #[inline(always)]
    pub fn add(&mut self, item: &Item) {
        let center = item.center2();
        self.min = self.min.min(item.min);
        self.max = self.max.max(item.max);
        self.center_min = self.center_min.min(center);
        self.center_max = self.center_max.max(center);
    }

    /// Boxes around both.
    pub fn union(&self, other: &Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
            center_min: self.center_min.min(other.center_min),
            center_max: self.center_max.max(other.center_max),
        }
    }

    pub fn half_area(&self) -> f32 {
        half_area(self.min, self.max)
    }
}

/// Half the surface of a box that is not empty.
#[inline(always)]
pub fn half_area(min: Vec4, max: Vec4) -> f32 {
    let d = max - min;
    d.x * d.y + d.y * d.z + d.z * d.x
}

/// A subtree to build: its items, the nodes reserved for it, and where both start in the whole.
pub struct Task<'a> {
    pub items: &'a mut [Item],
    pub nodes: &'a mut [BinaryNode],
    pub first_item: usize,
    pub first_node: usize,
    pub depth: usize,
}

/// Builds a subtree over items with the given bounds.
pub fn build(task: Task, bounds: Bounds, cost: &Cost, bins: &mut Bins) {
    let Task { items, nodes, first_item, first_node, depth } = task;
    let count = items.len();
    let (node, nodes) = nodes.split_first_mut().expect("a place for every node");
    let Some(Split { middle, left: left_bounds, right: right_bounds }) = split(items, &bounds, depth, cost, bins) else {
        *node = BinaryNode::of_leaf(&bounds, first_item, count);
        return;
    };
    let (left_first, right_first) = (first_node + 1, first_node + 2 * middle);
    *node = BinaryNode::of_children(&bounds, left_first, right_first);
    let (left, right) = items.split_at_mut(middle);
    let (left_nodes, right_nodes) = nodes.split_at_mut(2 * middle - 1);
    let left = Task { items: left, nodes: left_nodes, first_item, first_node: left_first, depth: depth + 1 };
    let right = Task { items: right, nodes: right_nodes, first_item: first_item + middle, first_node: right_first, depth: depth + 1 };
    if count >= PARALLEL_ITEMS {
        rayon::join(|| build(left, left_bounds, cost, bins), || build(right, right_bounds, cost, &mut Bins::new()));
    } else {
        build(left, left_bounds, cost, bins);
        build(right, right_bounds, cost, bins);
    }
}

/// Where a list of items was divided, and the bounds of both parts.
pub struct Split {
    pub middle: usize,
    pub left: Bounds,
    pub right: Bounds,
}

/// Reorders items so that the first part goes left; `None` makes a leaf.
fn split(items: &mut [Item], bounds: &Bounds, depth: usize, cost: &Cost, bins: &mut Bins) -> Option<Split> {
    let count = items.len();
    if count == 1 {
        return None;
    }
    let must_split = count > cost.sah.max_leaf_size;
    if depth >= BALANCE_DEPTH {
        return must_split.then(|| halve(items, bounds));
    }
    bins.fill(items, bounds, cost.sah.bins);
    let area = bounds.half_area();
    let leaf_cost = area * cost.blocks(count);
    match bins.best_plane(cost) {
        Some(plane) if must_split || area * cost.sah.node_cost + plane.cost < leaf_cost => Some(bins.partition(items, &plane)),
        _ => must_split.then(|| halve(items, bounds)),
    }
}

/// Splits at the median of the longest axis of the centres; equal centres by number.
pub fn halve(items: &mut [Item], bounds: &Bounds) -> Split {
    let extent = (bounds.center_max - bounds.center_min).xyz();
    let axis = extent.max_position();
    let middle = items.len() / 2;
    items.select_nth_unstable_by(middle, |a, b| a.center2()[axis].total_cmp(&b.center2()[axis]).then(a.number().cmp(&b.number())));
    let (left, right) = items.split_at(middle);
    Split { middle, left: Bounds::of(left), right: Bounds::of(right) }
}

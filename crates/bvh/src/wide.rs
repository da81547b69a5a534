//! Nodes with eight children, and how a binary tree becomes them.

use crate::{
    aabb::Aabb,
    build::{BinaryNode, BinaryTree},
};

/// Children of a node.
pub const WIDTH: usize = 8;

/// Greatest number of blocks in a leaf.
pub const MAX_LEAF_BLOCKS: usize = 8;

/// Reference to a child: a node, or a run of up to eight items (triangle blocks or instances).
///
/// Bit 31 tells a leaf; a leaf holds the number of items less one in bits 28–30 and the first item in bits 0–27.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(transparent)]
pub struct Child(u32);

impl Child {
    /// No child.
    pub const NONE: Self = Self(u32::MAX);
    /// Nodes and items that can be addressed.
    pub const MAX_INDEX: usize = (1 << 28) - 1;

    pub fn node(index: usize) -> Self {
        Self(index as u32)
    }

    pub fn leaf(first: usize, count: usize) -> Self {
        assert!((1..=MAX_LEAF_BLOCKS).contains(&count) && first < Self::MAX_INDEX, "leaf of {count} items at {first}");
        Self(1 << 31 | (count as u32 - 1) << 28 | first as u32)
    }

    #[inline(always)]
    pub fn is_leaf(self) -> bool {
        self.0 >> 31 != 0
    }

    #[inline(always)]
    pub fn index(self) -> usize {
        self.0 as usize
    }

    /// The first item of a leaf, and a leaf of the others.
    #[inline(always)]
    pub fn split_first(self) -> (usize, Option<Self>) {
        let more = self.0 >> 28 & 7 != 0;
        // One less of the count, one more of the first item.
        ((self.0 & 0x0fff_ffff) as usize, more.then_some(Self(self.0.wrapping_sub((1 << 28) - 1))))
    }

    /// The items of a leaf.
    #[inline(always)]
    pub fn items(self) -> std::ops::Range<usize> {
        let first = (self.0 & 0x0fff_ffff) as usize;
        first..first + (self.0 >> 28 & 7) as usize + 1
    }
}

/// Eight boxes, side by side for SIMD.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct Node {
    /// `[min x, max x, min y, max y, min z, max z][child]`, m; +∞ … −∞ for no child.
    pub planes: [[f32; WIDTH]; 6],
    /// What is in each box.
    pub children: [Child; WIDTH],
    /// For each octant of directions (bit 0 set for −x, 1 for −y, 2 for −z), the children from the farthest to the nearest, three bits each from
    /// the lowest on. Of the boxes as they were built: an update keeps it, which costs time and no hit.
    pub orders: [u32; 8],
}

impl Node {
    const EMPTY: Self = Self {
        planes: [
            [f32::INFINITY; WIDTH],
            [f32::NEG_INFINITY; WIDTH],
            [f32::INFINITY; WIDTH],
            [f32::NEG_INFINITY; WIDTH],
            [f32::INFINITY; WIDTH],
            [f32::NEG_INFINITY; WIDTH],
        ],
        children: [Child::NONE; WIDTH],
        orders: [0; 8],
    };

    /// Puts a child into a slot.
    pub fn set(&mut self, slot: usize, bounds: &Aabb, child: Child) {
        for axis in 0..3 {
            self.planes[2 * axis][slot] = bounds.min[axis];
            self.planes[2 * axis + 1][slot] = bounds.max[axis];
        }
        self.children[slot] = child;
    }

    /// Orders the children for rays of each octant, by their centres along its diagonal.
    fn put_in_order(&mut self) {
        for octant in 0..4 {
            let mut along = [f32::NEG_INFINITY; WIDTH];
            for (slot, along) in along.iter_mut().enumerate().filter(|(slot, _)| self.children[*slot] != Child::NONE) {
                let center2 = |axis: usize| self.planes[2 * axis][slot] + self.planes[2 * axis + 1][slot];
                let signed = |axis: usize| if octant >> axis & 1 == 0 { center2(axis) } else { -center2(axis) };
                *along = signed(0) + signed(1) + signed(2);
            }
            for slot in 0..WIDTH {
                let is_farther = |other: usize| along[other] > along[slot] || (along[other] == along[slot] && other < slot);
                let rank = (0..WIDTH).map(|other| u32::from(is_farther(other))).sum::<u32>();
                self.orders[octant] |= (slot as u32) << (3 * rank);
                // The opposite octant sees them the other way round.
                self.orders[7 - octant] |= (slot as u32) << (3 * (7 - rank));
            }
        }
    }

    /// Box of a child.
    pub fn bounds(&self, slot: usize) -> Aabb {
        let p = |plane: usize| self.planes[plane][slot];
        Aabb { min: glam::Vec3::new(p(0), p(2), p(4)), max: glam::Vec3::new(p(1), p(3), p(5)) }
    }

    /// Box around all children.
    pub fn all_bounds(&self) -> Aabb {
        self.used().fold(Aabb::EMPTY, |all, (bounds, _)| all.union(bounds))
    }

    /// Boxes and children in use.
    pub fn used(&self) -> impl Iterator<Item = (Aabb, Child)> + '_ {
        (0..WIDTH).filter(|&i| self.children[i] != Child::NONE).map(|i| (self.bounds(i), self.children[i]))
    }
}

/// A tree of wide nodes over numbered items.
#[derive(Clone, Debug)]
pub struct WideTree {
    /// Parents before children.
    pub nodes: Vec<Node>,
    /// The top: a node, a leaf, or nothing.
    pub root: Child,
    /// Box around everything.
    pub bounds: Aabb,
}

impl WideTree {
    /// Collapses a binary tree: the child with the largest surface is replaced by its two children until there are eight.
    ///
    /// `leaf` stores the primitives of a leaf (a range of the tree's order) and returns the reference to them.
    pub fn collapse(tree: &BinaryTree, mut leaf: impl FnMut(std::ops::Range<usize>) -> Child) -> Self {
        if tree.nodes.is_empty() {
            return Self { nodes: Vec::new(), root: Child::NONE, bounds: Aabb::EMPTY };
        }
        let top = &tree.nodes[0];
        if let Some(range) = top.leaf() {
            return Self { nodes: Vec::new(), root: leaf(range), bounds: top.bounds() };
        }
        let mut nodes = vec![Node::EMPTY];
        let mut waiting = vec![(0usize, 0usize)];
        while let Some((binary, wide)) = waiting.pop() {
            for (slot, &child) in Opened::of(tree, &tree.nodes[binary]).children().iter().enumerate() {
                let node = &tree.nodes[child];
                let reference = match node.leaf() {
                    Some(range) => leaf(range),
                    None => {
                        nodes.push(Node::EMPTY);
                        waiting.push((child, nodes.len() - 1));
                        Child::node(nodes.len() - 1)
                    }
                };
                nodes[wide].set(slot, &node.bounds(), reference);
            }
            nodes[wide].put_in_order();
        }
        Self { nodes, root: Child::node(0), bounds: top.bounds() }
    }

    /// Bytes held, with those set aside.
    pub fn memory(&self) -> usize {
        self.nodes.capacity() * std::mem::size_of::<Node>()
    }

    /// Bytes of the nodes alone.
    pub fn compacted_memory(&self) -> usize {
        std::mem::size_of_val(&self.nodes[..])
    }
}

/// The descendants, at most eight, that replace the two children of a node.
struct Opened {
    children: [usize; WIDTH],
    /// Surface of each, m²; −1 for a leaf, which cannot be opened.
    areas: [f32; WIDTH],
    count: usize,
}

impl Opened {
    fn of(tree: &BinaryTree, parent: &BinaryNode) -> Self {
        let mut opened = Self { children: [0; WIDTH], areas: [-1.0; WIDTH], count: 2 };
        let [left, right] = parent.children();
        opened.place(tree, 0, left);
        opened.place(tree, 1, right);
        while opened.count < WIDTH {
            let widest = (1..opened.count).fold(0, |widest, i| if opened.areas[i] > opened.areas[widest] { i } else { widest });
            if opened.areas[widest] < 0.0 {
                break;
            }
            let [left, right] = tree.nodes[opened.children[widest]].children();
            opened.place(tree, widest, left);
            opened.place(tree, opened.count, right);
            opened.count += 1;
        }
        opened
    }

    fn place(&mut self, tree: &BinaryTree, slot: usize, child: usize) {
        let node = &tree.nodes[child];
        self.children[slot] = child;
        self.areas[slot] = if node.leaf().is_none() { node.bounds().half_area() } else { -1.0 };
    }

    fn children(&self) -> &[usize] {
        &self.children[..self.count]
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A node around the given boxes.
    pub(crate) fn node_of(boxes: &[Aabb]) -> Node {
        let mut node = Node::EMPTY;
        for (slot, bounds) in boxes.iter().enumerate() {
            node.set(slot, bounds, Child::leaf(slot, 1));
        }
        node.put_in_order();
        node
    }

    #[test]
    fn references_keep_what_they_refer_to() {
        for first in [0, 1, 12345, Child::MAX_INDEX - 1] {
            for count in 1..=MAX_LEAF_BLOCKS {
                let leaf = Child::leaf(first, count);
                assert!(leaf.is_leaf() && leaf.items() == (first..first + count));
                let rest = (count > 1 && first + 1 < Child::MAX_INDEX).then(|| Child::leaf(first + 1, count - 1));
                assert!(first + 1 == Child::MAX_INDEX || leaf.split_first() == (first, rest));
            }
            assert!(!Child::node(first).is_leaf() && Child::node(first).index() == first);
        }
        assert!(Child::leaf(Child::MAX_INDEX - 1, MAX_LEAF_BLOCKS) != Child::NONE);
    }
}

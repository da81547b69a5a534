//! Improving a finished tree: subtrees move to where they make the boxes smaller, \[Meister18].
//!
//! Taking a subtree out shrinks the boxes above it, putting it in elsewhere grows those above that place. For each of the largest subtrees a search up and
//! down the tree, with a bound on what is still to gain, finds the best place. The top levels matter most: some hundred moves there bring most of
//! what all moves would. One after the other, so the result does not depend on threads.

use super::tree::{BinaryNode, BinaryTree};
use crate::aabb::Aabb;
use std::{cmp::Ordering, collections::BinaryHeap};

/// How much is tried.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Subtrees of a round.
    pub subtrees: usize,
    /// Rounds over the largest subtrees.
    pub rounds: usize,
}

/// Steps of a search, at most.
const STEPS: usize = 2048;

impl BinaryTree {
    /// Lowers the sum of the surfaces of the inner nodes. Where that would make the tree deeper than `max_depth`, it stays as it was.
    pub fn optimized(self, effort: Effort, max_depth: usize) -> Self {
        if effort.subtrees == 0 || self.nodes.len() < 7 {
            return self;
        }
        let parents = vec![0; self.nodes.len()];
        let mut optimizer = Optimizer { tree: self, parents, waiting: Vec::new(), moves: Vec::new() };
        for _ in 0..effort.rounds {
            optimizer.round(effort.subtrees);
        }
        if optimizer.is_deeper_than(max_depth) {
            optimizer.undo();
        }
        optimizer.tree
    }
}

struct Optimizer {
    tree: BinaryTree,
    /// The parent of each node that was reached so far; the top is its own.
    parents: Vec<u32>,
    /// What a search still has to look at: what would be gained above, and the node.
    waiting: Vec<(f32, u32)>,
    /// Subtrees that moved, and beside what they were.
    moves: Vec<(u32, u32)>,
}

/// A node by its surface; of equals the first is greatest.
struct BySurface(f32, u32);

impl Ord for BySurface {
    fn cmp(&self, other: &Self) -> Ordering {
        self.0.total_cmp(&other.0).then(other.1.cmp(&self.1))
    }
}

impl PartialOrd for BySurface {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for BySurface {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for BySurface {}

impl Optimizer {
    fn bounds(&self, node: u32) -> Aabb {
        self.tree.nodes[node as usize].bounds()
    }

    fn area(&self, node: u32) -> f32 {
        self.bounds(node).half_area()
    }

    fn parent(&self, node: u32) -> u32 {
        self.parents[node as usize]
    }

    fn sibling(&self, node: u32) -> u32 {
        let [left, right] = self.tree.nodes[self.parent(node) as usize].children();
        (if left == node as usize { right } else { left }) as u32
    }

    fn is_leaf(&self, node: u32) -> bool {
        self.tree.nodes[node as usize].leaf().is_some()
    }

    /// Both children of an inner node, which learn their parent.
    fn enter(&mut self, node: u32) -> [u32; 2] {
        self.tree.nodes[node as usize].children().map(|child| {
            self.parents[child] = node;
            child as u32
        })
    }

    /// Moves each of the largest subtrees to its best place. A child is not larger than its parent, so they are found from the top.
    fn round(&mut self, subtrees: usize) {
        let mut largest = Vec::with_capacity(subtrees);
        let mut open = BinaryHeap::from([BySurface(self.area(0), 0)]);
        while let Some(BySurface(_, node)) = open.pop()
            && largest.len() < subtrees
        {
            if !self.is_leaf(node) {
                for child in self.enter(node) {
                    open.push(BySurface(self.area(child), child));
                }
            }
            largest.push(node);
        }
        for node in largest {
            // The top has no place, and its children stay, so that it keeps its index.
            if node != 0
                && self.parent(node) != 0
                && let Some(place) = self.best_place(node)
            {
                self.moves.push((node, self.sibling(node)));
                self.reinsert(node, place);
            }
        }
    }

    /// The node beside which a subtree would make the sum of surfaces least; `None` where it is already. \[Meister18] algorithm 1.
    fn best_place(&mut self, node: u32) -> Option<u32> {
        let parent = self.parent(node);
        let (bounds, area) = (self.bounds(node), self.area(node));
        let (mut best, mut place) = (0.0, None);
        // Without the subtree its parent is not needed, and what lies above shrinks.
        let mut gained = self.area(parent);
        let mut rest = self.bounds(self.sibling(node));
        let (mut pivot, mut aside) = (parent, self.sibling(node));
        let mut steps = 0;
        loop {
            self.waiting.push((gained, aside));
            while let Some((gain, candidate)) = self.waiting.pop() {
                // Whatever the place, a box of at least the subtree's size is added.
                if gain - area <= best || steps >= STEPS {
                    continue;
                }
                steps += 1;
                let merged = self.bounds(candidate).union(bounds).half_area();
                let left = gain - merged;
                if left > best {
                    (best, place) = (left, Some(candidate));
                }
                if !self.is_leaf(candidate) {
                    let below = left + self.area(candidate);
                    let children = self.enter(candidate);
                    self.waiting.extend(children.map(|child| (below, child)));
                }
            }
            if pivot == 0 {
                break;
            }
            aside = self.sibling(pivot);
            if pivot != parent {
                gained += self.area(pivot) - rest.half_area();
            }
            rest = rest.union(self.bounds(aside));
            pivot = self.parent(pivot);
        }
        // A relative gain within rounding is none.
        place.filter(|&place| place != self.sibling(node) && best > 1e-6 * self.area(parent))
    }

    /// Takes a subtree out and puts it beside `place`, under the node that was its parent.
    fn reinsert(&mut self, node: u32, place: u32) {
        let (parent, sibling) = (self.parent(node), self.sibling(node));
        let above = self.parent(parent);
        self.replace_child(above, parent, sibling);
        self.refit_from(above);
        let above = self.parent(place);
        self.replace_child(above, place, parent);
        self.parents[place as usize] = parent;
        self.tree.nodes[parent as usize] = BinaryNode::of_boxes(self.bounds(place).union(self.bounds(node)), place, node);
        self.refit_from(above);
    }

    fn replace_child(&mut self, parent: u32, old: u32, new: u32) {
        let [left, right] = self.tree.nodes[parent as usize].children().map(|child| if child == old as usize { new } else { child as u32 });
        let bounds = self.bounds(left).union(self.bounds(right));
        self.tree.nodes[parent as usize] = BinaryNode::of_boxes(bounds, left, right);
        self.parents[new as usize] = parent;
    }

    /// Fits the boxes from a node to the top.
    fn refit_from(&mut self, mut node: u32) {
        loop {
            let [left, right] = self.tree.nodes[node as usize].children().map(|child| child as u32);
            let bounds = self.bounds(left).union(self.bounds(right));
            self.tree.nodes[node as usize] = BinaryNode::of_boxes(bounds, left, right);
            if node == 0 {
                break;
            }
            node = self.parent(node);
        }
    }

    fn is_deeper_than(&self, max_depth: usize) -> bool {
        let mut waiting = vec![(0, 1)];
        while let Some((node, depth)) = waiting.pop() {
            if depth > max_depth {
                return true;
            }
            let node = &self.tree.nodes[node];
            if node.leaf().is_none() {
                waiting.extend(node.children().map(|child| (child, depth + 1)));
            }
        }
        false
    }

    /// Takes all moves back.
    fn undo(&mut self) {
        while let Some((node, sibling)) = self.moves.pop() {
            self.reinsert(node, sibling);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::build::{Cost, Item, Sah};
    use glam::Vec3;

    /// Boxes in a clump and a few scattered ones, in an order that makes a bad tree.
    fn tree() -> BinaryTree {
        let items = (0..400u32).map(|i| {
            let h = |k: u32| ((i * k) % 97) as f32 / 97.0;
            let place = Vec3::new(h(31), h(57), h(83)) * if i % 5 == 0 { 20.0 } else { 1.0 };
            Item::new(&Aabb { min: place, max: place + Vec3::new(h(11) * 8.0, h(13), h(17) * 3.0) }, i)
        });
        BinaryTree::build(items.collect(), &Cost { sah: Sah { max_leaf_size: 1, ..Sah::default() }, block: 1 })
    }

    /// Sum of the surfaces of inner nodes, the depth, and the items in leaves, all boxes being checked.
    fn measured(tree: &BinaryTree) -> (f64, usize, Vec<u32>) {
        fn walk(tree: &BinaryTree, node: usize, out: &mut (f64, usize, Vec<u32>), depth: usize) {
            out.1 = out.1.max(depth);
            match tree.nodes[node].leaf() {
                Some(range) => out.2.extend(&tree.order[range]),
                None => {
                    let [left, right] = tree.nodes[node].children();
                    let bounds = tree.nodes[left].bounds().union(tree.nodes[right].bounds());
                    assert_eq!(bounds, tree.nodes[node].bounds());
                    out.0 += f64::from(bounds.half_area());
                    walk(tree, left, out, depth + 1);
                    walk(tree, right, out, depth + 1);
                }
            }
        }
        let mut out = (0.0, 0, Vec::new());
        walk(tree, 0, &mut out, 1);
        out.2.sort_unstable();
        out
    }

    #[test]
    fn surfaces_shrink_and_nothing_is_lost() {
        let (before, _, items) = measured(&tree());
        let mut last = before;
        for subtrees in [10, 100, 1_000] {
            let (after, _, kept) = measured(&tree().optimized(Effort { subtrees, rounds: 2 }, 80));
            assert!(after < last, "{subtrees}: {before} to {after}");
            assert_eq!(kept, items);
            last = after;
        }
        assert!(last < 0.95 * before, "{before} to {last}");
    }

    #[test]
    fn a_tree_that_would_be_too_deep_stays_as_it_was() {
        let (before, depth, items) = measured(&tree());
        let effort = Effort { subtrees: 1_000, rounds: 2 };
        let (_, deeper, _) = measured(&tree().optimized(effort, 80));
        assert!(deeper > depth, "{depth} {deeper}: the limit would test nothing");
        let (after, same_depth, kept) = measured(&tree().optimized(effort, deeper - 1));
        assert_eq!((same_depth, kept), (depth, items));
        assert!((after / before - 1.0).abs() < 1e-9, "{before} {after}");
    }
}

//! Moving a finished tree along with what is in it.

use crate::{
    aabb::Aabb,
    wide::{Child, WideTree},
};
use rayon::prelude::*;

/// What an update did to the expected work of a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UpdateReport {
    /// Cost by the surface area heuristic when the tree was built, in tests of a block.
    pub built_cost: f32,
    /// The same now.
    pub cost: f32,
}

impl UpdateReport {
    /// How many times the work it takes now; 1 for a tree without surface, ∞ for one that had none when it was built.
    pub fn degradation(&self) -> f32 {
        if self.cost == self.built_cost { 1.0 } else { self.cost / self.built_cost }
    }

    /// Whether a build would soon pay: rays take half as much work again.
    pub fn suggests_rebuild(&self) -> bool {
        self.degradation() > 1.5
    }
}

impl WideTree {
    /// Fits every box anew. `item` gives the box of an item of a leaf.
    pub fn refit(&mut self, item: impl Fn(usize) -> Aabb + Sync) {
        let leaf = |child: Child| child.items().fold(Aabb::EMPTY, |bounds, index| bounds.union(item(index)));
        if self.root == Child::NONE {
            return;
        }
        if self.root.is_leaf() {
            self.bounds = leaf(self.root);
            return;
        }
        self.nodes.par_iter_mut().with_min_len(256).for_each(|node| {
            for slot in 0..node.children.len() {
                let child = node.children[slot];
                if child != Child::NONE && child.is_leaf() {
                    node.set(slot, &leaf(child), child);
                }
            }
        });
        // Parents stand before their children.
        for index in (0..self.nodes.len()).rev() {
            for slot in 0..self.nodes[index].children.len() {
                let child = self.nodes[index].children[slot];
                if child != Child::NONE && !child.is_leaf() {
                    let bounds = self.nodes[child.index()].all_bounds();
                    self.nodes[index].set(slot, &bounds, child);
                }
            }
        }
        self.bounds = self.nodes[0].all_bounds();
    }
}

//! From boxes to a binary tree, by the surface area heuristic.

mod bins;
mod tree;

pub(crate) use tree::{BinaryNode, BinaryTree, Cost, Item};

/// How to weigh a split. The defaults suit the traversal of this crate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BuildOptions {
    /// Candidate planes an axis, plus one; 2 to 32.
    pub bins: usize,
    /// Greatest number of triangles in a leaf; 1 to 32.
    pub max_leaf_size: usize,
    /// Cost of visiting a node, in units of the cost of a triangle block.
    pub node_cost: f32,
}

impl Default for BuildOptions {
    fn default() -> Self {
        Self { bins: 16, max_leaf_size: 8, node_cost: 1.0 }
    }
}

//! Checks of a finished tree, and its expected cost.

use crate::{
    aabb::Aabb,
    blas::Blas,
    tlas::{Tlas, world_bounds},
    triangle::{Block, NO_PRIMITIVE},
    wide::{Child, WideTree},
};

/// What is wrong with a tree. A bug in the builder, or memory that was overwritten.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Fault {
    /// A reference to a node or item that is not there, or was visited before.
    #[error("node {node} refers to {what}, which does not exist or is reached twice")]
    Reference {
        /// Index of the node.
        node: usize,
        /// What it refers to.
        what: String,
    },
    /// A box that does not contain what is in it, or is not finite.
    #[error("the box {outer:?} of child {slot} of node {node} does not contain {inner:?}")]
    Box {
        /// Index of the node.
        node: usize,
        /// Which of its children.
        slot: usize,
        /// The box.
        outer: Aabb,
        /// What sticks out.
        inner: Aabb,
    },
    /// A primitive that is reached never or more than once.
    #[error("primitive {primitive} is reached {times} times instead of once")]
    Reached {
        /// Index of the primitive.
        primitive: usize,
        /// How often it is reached.
        times: usize,
    },
}

impl Blas {
    /// Checks that every triangle is reached exactly once and every box contains its children.
    ///
    /// # Errors
    /// The first fault found.
    pub fn validate(&self) -> Result<(), Fault> {
        let blocks = self.blocks();
        let mut reached = vec![0; self.triangle_count()];
        check_tree(self.tree(), blocks.len(), |block| {
            for &primitive in blocks[block].primitives.iter().filter(|&&p| p != NO_PRIMITIVE) {
                match reached.get_mut(primitive as usize) {
                    Some(times) => *times += 1,
                    None => return Err(Fault::Reached { primitive: primitive as usize, times: 1 }),
                }
            }
            Ok(block_bounds(&blocks[block]))
        })?;
        match reached.iter().position(|&times| times != 1) {
            Some(primitive) => Err(Fault::Reached { primitive, times: reached[primitive] }),
            None => Ok(()),
        }
    }

    /// Expected work of a ray that meets the box of the mesh, by the surface area heuristic.
    ///
    /// ```text
    /// cost = Σ_nodes A(node)/A(root) · node_cost + Σ_leaves A(leaf)/A(root) · blocks(leaf)
    /// ```
    ///
    /// \[MacDonald90] eq. 1, for nodes of eight children and blocks of four triangles. Unit: tests of a block. 0 when there is nothing.
    pub fn sah_cost(&self, node_cost: f32) -> f32 {
        let tree = self.tree();
        let whole = tree.bounds.half_area();
        if tree.root == Child::NONE || whole == 0.0 {
            return 0.0;
        }
        if tree.root.is_leaf() {
            return tree.root.items().len() as f32;
        }
        let below: f64 = tree
            .nodes
            .iter()
            .flat_map(|node| node.used())
            .map(|(bounds, child)| {
                let tests = if child.is_leaf() { child.items().len() as f32 } else { node_cost };
                f64::from(bounds.half_area() / whole * tests)
            })
            .sum();
        node_cost + below as f32
    }
}

impl Tlas {
    /// Checks the upper level like [`Blas::validate`], and every mesh.
    ///
    /// # Errors
    /// The first fault found.
    pub fn validate(&self) -> Result<(), Fault> {
        let placed = self.placed();
        let mut reached = vec![0; placed.len()];
        check_tree(self.tree(), placed.len(), |slot| {
            reached[slot] += 1;
            Ok(world_bounds(&self.blases()[placed[slot].blas as usize], &placed[slot].world_from_object))
        })?;
        if let Some(slot) = reached.iter().position(|&times| times != 1) {
            return Err(Fault::Reached { primitive: placed[slot].instance as usize, times: reached[slot] });
        }
        self.blases().iter().try_for_each(|blas| blas.validate())
    }
}

/// Box around the triangles of a block.
fn block_bounds(block: &Block) -> Aabb {
    let lanes = (0..block.primitives.len()).filter(|&lane| block.primitives[lane] != NO_PRIMITIVE);
    Aabb::of_points(lanes.flat_map(|lane| block.get(lane)))
}

/// Walks a whole tree. `item` counts an item and returns its box.
fn check_tree(tree: &WideTree, items: usize, mut item: impl FnMut(usize) -> Result<Aabb, Fault>) -> Result<(), Fault> {
    let mut leaf_bounds = |node: usize, child: Child| {
        child.items().try_fold(Aabb::EMPTY, |bounds, i| match i < items {
            true => Ok(bounds.union(item(i)?)),
            false => Err(Fault::Reference { node, what: format!("item {i}") }),
        })
    };
    if tree.root == Child::NONE {
        return Ok(());
    }
    if tree.root.is_leaf() {
        let inner = leaf_bounds(0, tree.root)?;
        return contained(0, 0, &tree.bounds, &inner);
    }
    let mut seen = vec![false; tree.nodes.len()];
    let mut waiting = vec![(tree.root, tree.bounds)];
    while let Some((child, outer)) = waiting.pop() {
        let index = child.index();
        if seen.get(index).copied() != Some(false) {
            return Err(Fault::Reference { node: index, what: format!("node {index}") });
        }
        seen[index] = true;
        for (slot, (bounds, child)) in tree.nodes[index].used().enumerate() {
            contained(index, slot, &outer, &bounds)?;
            if child.is_leaf() {
                contained(index, slot, &bounds, &leaf_bounds(index, child)?)?;
            } else {
                waiting.push((child, bounds));
            }
        }
    }
    Ok(())
}

fn contained(node: usize, slot: usize, outer: &Aabb, inner: &Aabb) -> Result<(), Fault> {
    let finite = outer.min.is_finite() && outer.max.is_finite();
    match finite && outer.contains(inner) {
        true => Ok(()),
        false => Err(Fault::Box { node, slot, outer: *outer, inner: *inner }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::BuildOptions;
    use glam::Vec3;

    fn strip(count: u32) -> Blas {
        let positions: Vec<Vec3> = (0..count + 2).map(|i| Vec3::new(i as f32, (i % 2) as f32, (i % 7) as f32)).collect();
        let indices: Vec<[u32; 3]> = (0..count).map(|i| [i, i + 1, i + 2]).collect();
        Blas::build(&positions, &indices, &BuildOptions::default()).unwrap()
    }

    #[test]
    fn built_trees_are_valid() {
        for count in [0, 1, 2, 4, 5, 8, 9, 64, 1000] {
            strip(count).validate().unwrap();
        }
    }

    #[test]
    fn planted_faults_are_found() {
        let good = strip(1000);
        let mut shrunk = good.clone();
        shrunk.tree_mut().nodes[3].planes[0][0] += 0.5;
        assert!(matches!(shrunk.validate(), Err(Fault::Box { .. })));

        let mut not_a_number = good.clone();
        not_a_number.tree_mut().nodes[0].planes[1][2] = f32::NAN;
        assert!(matches!(not_a_number.validate(), Err(Fault::Box { .. })));

        let mut doubled = good.clone();
        let other = doubled.blocks()[7];
        doubled.blocks_mut()[2] = other;
        assert!(doubled.validate().is_err());

        let mut circular = good.clone();
        let inner = circular.tree().nodes[0].children.iter().position(|c| !c.is_leaf()).unwrap();
        circular.tree_mut().nodes[0].children[inner] = Child::node(0);
        assert!(matches!(circular.validate(), Err(Fault::Box { .. } | Fault::Reference { .. })));

        let mut lost = good.clone();
        let node = lost.tree().nodes.iter().position(|n| n.children[0].is_leaf()).unwrap();
        lost.tree_mut().nodes[node].children[0] = Child::NONE;
        assert!(matches!(lost.validate(), Err(Fault::Reached { times: 0, .. })));
    }
}

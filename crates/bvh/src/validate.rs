//! Checks of a finished tree, and its expected cost.

use crate::{
    aabb::Aabb,
    blas::Blas,
    tlas::{Tlas, world_bounds},
    triangle::NO_PRIMITIVE,
    wide::{Child, WideTree},
};
use glam::Vec3;

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
    /// A triangle that was cut, of which a part is in no box.
    #[error("triangle {primitive} was cut, and no part of it covers {point:?}")]
    Uncovered {
        /// Index of the triangle.
        primitive: usize,
        /// A point of it.
        point: [f32; 3],
    },
}

impl Blas {
    /// Checks that every box contains its children, and that every triangle and shape is reached: once, or where triangles were cut, in parts that cover it.
    ///
    /// # Errors
    /// The first fault found.
    pub fn validate(&self) -> Result<(), Fault> {
        let blocks = self.blocks();
        let mut reached = vec![0; self.triangle_count() + self.shape_count()];
        let mut in_one_box = vec![false; self.triangle_count()];
        let mut parts = Vec::new();
        check_tree(self.tree(), blocks.len(), |index, outer| {
            let mut bounds = Aabb::EMPTY;
            let block = &blocks[index];
            for (lane, &primitive) in block.primitives.iter().enumerate().filter(|&(_, &p)| p != NO_PRIMITIVE) {
                match reached.get_mut(primitive as usize) {
                    Some(times) => *times += 1,
                    None => return Err(Fault::Reached { primitive: primitive as usize, times: 1 }),
                }
                let whole = match (primitive as usize).checked_sub(self.triangle_count()) {
                    None => Aabb::of_points(block.get(lane)),
                    Some(shape) => self.shapes().expect("counted above").bounds(shape),
                };
                if self.is_cut() && !outer.contains(&whole) {
                    parts.push(Part { primitive, corners: block.get(lane), bounds: *outer });
                } else {
                    bounds = bounds.union(whole);
                    if let Some(is) = in_one_box.get_mut(primitive as usize) {
                        *is = true;
                    }
                }
            }
            Ok(bounds)
        })?;
        parts.retain(|part| !in_one_box[part.primitive as usize]);
        check_parts(&mut parts)?;
        let may_repeat = |primitive: usize| self.is_cut() && primitive < self.triangle_count();
        match reached.iter().enumerate().position(|(primitive, &times)| times == 0 || (times > 1 && !may_repeat(primitive))) {
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
        sah_cost(self.tree(), node_cost)
    }
}

fn sah_cost(tree: &WideTree, node_cost: f32) -> f32 {
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

impl Tlas {
    /// Expected work of a ray that meets the box of the world, like [`Blas::sah_cost`]: nodes of the upper level, and instances entered at 1 each.
    pub fn sah_cost(&self, node_cost: f32) -> f32 {
        sah_cost(self.tree(), node_cost)
    }

    /// Checks the upper level like [`Blas::validate`], and every mesh.
    ///
    /// # Errors
    /// The first fault found.
    pub fn validate(&self) -> Result<(), Fault> {
        let placed = self.placed();
        let mut reached = vec![0; placed.len()];
        check_tree(self.tree(), placed.len(), |slot, _| {
            reached[slot] += 1;
            Ok(world_bounds(&self.blases()[placed[slot].blas as usize], &placed[slot].world_from_object))
        })?;
        if let Some(slot) = reached.iter().position(|&times| times != 1) {
            return Err(Fault::Reached { primitive: placed[slot].instance as usize, times: reached[slot] });
        }
        self.blases().iter().try_for_each(|blas| blas.validate())
    }
}

/// A triangle in a box that does not contain all of it.
struct Part {
    primitive: u32,
    corners: [Vec3; 3],
    bounds: Aabb,
}

/// Checks that the parts of each triangle cover it, at a grid of points of it.
fn check_parts(parts: &mut [Part]) -> Result<(), Fault> {
    parts.sort_by_key(|part| part.primitive);
    for parts in parts.chunk_by(|a, b| a.primitive == b.primitive) {
        let Part { primitive, corners: [a, b, c], .. } = parts[0];
        // The points are rounded.
        let slack = a.abs().max(b.abs()).max(c.abs()).max_element() * (1.0 / 1048576.0);
        let boxes: Vec<Aabb> = parts.iter().map(|part| part.bounds.expanded(slack)).collect();
        for i in 0..=GRID {
            for j in 0..=GRID - i {
                let (u, v) = (i as f32 / GRID as f32, j as f32 / GRID as f32);
                let point = a * (1.0 - u - v) + b * u + c * v;
                if !boxes.iter().any(|bounds| bounds.contains(&Aabb { min: point, max: point })) {
                    return Err(Fault::Uncovered { primitive: primitive as usize, point: point.to_array() });
                }
            }
        }
    }
    Ok(())
}

/// Steps along an edge of a triangle that is checked for gaps.
const GRID: usize = 16;

/// Walks a whole tree. `item` counts an item of a leaf with the given box and returns what the box must contain.
fn check_tree(tree: &WideTree, items: usize, mut item: impl FnMut(usize, &Aabb) -> Result<Aabb, Fault>) -> Result<(), Fault> {
    let mut leaf_bounds = |node: usize, child: Child, outer: &Aabb| {
        child.items().try_fold(Aabb::EMPTY, |bounds, i| match i < items {
            true => Ok(bounds.union(item(i, outer)?)),
            false => Err(Fault::Reference { node, what: format!("item {i}") }),
        })
    };
    if tree.root == Child::NONE {
        return Ok(());
    }
    if tree.root.is_leaf() {
        let inner = leaf_bounds(0, tree.root, &tree.bounds)?;
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
                contained(index, slot, &bounds, &leaf_bounds(index, child, &bounds)?)?;
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

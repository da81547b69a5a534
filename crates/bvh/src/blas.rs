//! The lower level: the triangles of one mesh.

use crate::{
    aabb::Aabb,
    build::{BinaryTree, BuildOptions, Cost, Item},
    error::BvhError,
    triangle::{BLOCK_SIZE, Block, MAX_COORDINATE, NO_PRIMITIVE},
    wide::{Child, MAX_LEAF_BLOCKS, WideTree},
};
use glam::Vec3;
use rayon::prelude::*;

/// A hierarchy over the triangles of one mesh, in the mesh's own space.
#[derive(Clone, Debug)]
pub struct Blas {
    tree: WideTree,
    blocks: Vec<Block>,
    triangles: usize,
}

impl Blas {
    /// Builds over indexed triangles. Triangles without area and duplicates are allowed: the first are never hit, of the others the
    /// one with the lowest index is. An empty list makes a hierarchy that nothing hits. The result does not depend on the number of threads.
    ///
    /// # Errors
    /// A position that is used and not finite or beyond ±10¹⁸, an index without a vertex, or more than 2²⁷ triangles.
    pub fn build(positions: &[Vec3], indices: &[[u32; 3]], options: &BuildOptions) -> Result<Self, BvhError> {
        let max = Child::MAX_INDEX / 2;
        if indices.len() > max {
            return Err(BvhError::TooMany { what: "triangles", got: indices.len(), max });
        }
        let triangle = |number: usize| indices[number].map(|v| positions[v as usize]);
        let items = indices
            .par_iter()
            .enumerate()
            .with_min_len(1024)
            .map(|(number, vertices)| {
                check(positions, number, vertices)?;
                Ok(Item::new(&Aabb::of_points(triangle(number)), number as u32))
            })
            .collect::<Result<Vec<_>, _>>()?;
        let options = BuildOptions { max_leaf_size: options.max_leaf_size.clamp(1, MAX_LEAF_BLOCKS * BLOCK_SIZE), ..*options };
        let binary = BinaryTree::build(items, &Cost { options, block: BLOCK_SIZE });
        // Which part of the order each block holds.
        let mut parts: Vec<&[u32]> = Vec::with_capacity(indices.len() / 2);
        let tree = WideTree::collapse(&binary, |range| {
            let first = parts.len();
            parts.extend(binary.order[range].chunks(BLOCK_SIZE));
            Child::leaf(first, parts.len() - first)
        });
        let blocks = parts
            .par_iter()
            .with_min_len(1024)
            .map(|numbers| {
                let mut block = Block::EMPTY;
                for (lane, &number) in numbers.iter().enumerate() {
                    block.set(lane, number, triangle(number as usize));
                }
                block
            })
            .collect();
        Ok(Self { tree, blocks, triangles: indices.len() })
    }

    /// Box around all triangles; empty when there are none.
    pub fn bounds(&self) -> Aabb {
        self.tree.bounds
    }

    /// Number of triangles.
    pub fn triangle_count(&self) -> usize {
        self.triangles
    }

    /// Bytes held by nodes and triangles.
    pub fn memory(&self) -> usize {
        self.tree.memory() + std::mem::size_of_val(&self.blocks[..])
    }

    /// Every triangle with its index, in the order of the leaves.
    pub fn triangles(&self) -> impl Iterator<Item = (u32, [Vec3; 3])> + '_ {
        self.blocks.iter().flat_map(|block| {
            (0..BLOCK_SIZE).filter(|&lane| block.primitives[lane] != NO_PRIMITIVE).map(|lane| (block.primitives[lane], block.get(lane)))
        })
    }

    pub(crate) fn tree(&self) -> &WideTree {
        &self.tree
    }

    #[cfg(test)]
    pub(crate) fn tree_mut(&mut self) -> &mut WideTree {
        &mut self.tree
    }

    #[cfg(test)]
    pub(crate) fn blocks_mut(&mut self) -> &mut [Block] {
        &mut self.blocks
    }

    pub(crate) fn blocks(&self) -> &[Block] {
        &self.blocks
    }
}

/// Whether a triangle's vertices exist and are usable.
fn check(positions: &[Vec3], triangle: usize, vertices: &[u32; 3]) -> Result<(), BvhError> {
    for &vertex in vertices {
        let Some(position) = positions.get(vertex as usize) else {
            return Err(BvhError::Index { triangle, vertex, vertices: positions.len() });
        };
        // A comparison with NaN is false.
        if !position.abs().cmple(Vec3::splat(MAX_COORDINATE)).all() {
            return Err(BvhError::Position { vertex: vertex as usize, position: position.to_array() });
        }
    }
    Ok(())
}

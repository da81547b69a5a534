//! The lower level: the triangles and shapes of one mesh.

use crate::{
    aabb::Aabb,
    build::{BinaryTree, BuildOptions, Sah},
    error::BvhError,
    geometry::{Geometry, Procedural},
    pages,
    ray::Ray,
    refit::UpdateReport,
    triangle::{BLOCK_SIZE, Block, Crossing, NO_PRIMITIVE},
    wide::{Child, MAX_LEAF_BLOCKS, WideTree},
};
use glam::Vec3;
use rayon::prelude::*;
use std::{collections::HashSet, mem::size_of, sync::Arc};

/// A hierarchy over the triangles and shapes of one mesh, in the mesh's own space.
#[derive(Clone, Debug)]
pub struct Blas {
    tree: WideTree,
    blocks: Vec<Block>,
    triangles: usize,
    /// Those with numbers from `triangles` on; `None` where there are none.
    shapes: Option<Arc<dyn Procedural>>,
    options: BuildOptions,
    /// Whether triangles were cut, so that several blocks may hold one.
    cut: bool,
    /// Expected work when it was built; 0 if it cannot be updated.
    built_cost: f32,
}

impl Blas {
    /// Builds over indexed triangles. Triangles without area and duplicates are allowed: the first are never hit, of the others the
    /// one with the lowest index is. An empty list makes a hierarchy that nothing hits. The result does not depend on the number of threads.
    ///
    /// # Errors
    /// A position that is used and not finite or beyond ±10¹⁸, an index without a vertex, or more than 2²⁷ triangles.
    pub fn build(positions: &[Vec3], indices: &[[u32; 3]], options: &BuildOptions) -> Result<Self, BvhError> {
        Self::build_geometry(&Geometry::triangles(positions, indices), options)
    }

    /// [`build`](Self::build) over triangles and shapes.
    ///
    /// # Errors
    /// Those of [`build`](Self::build), and a shape whose box is empty, not finite or beyond ±10¹⁸.
    pub fn build_geometry(geometry: &Geometry, options: &BuildOptions) -> Result<Self, BvhError> {
        let items = geometry.items()?;
        let sah = Sah { max_leaf_size: options.sah.max_leaf_size.clamp(1, MAX_LEAF_BLOCKS * BLOCK_SIZE), ..options.sah };
        let options = BuildOptions { sah, ..*options };
        let triangles = geometry.triangle_count();
        let corners = |number: u32| (number as usize) < triangles;
        let corners = |number: u32| corners(number).then(|| geometry.triangle(number as usize));
        let binary = BinaryTree::with_options(items, BLOCK_SIZE, &options, corners);
        // Which part of the order each block holds.
        let mut parts: Vec<&[u32]> = Vec::with_capacity(geometry.triangle_count() / 2);
        let mut references = 0;
        let tree = WideTree::collapse(&binary, |range| {
            let first = parts.len();
            references += range.len();
            parts.extend(binary.order[range].chunks(BLOCK_SIZE));
            Child::leaf(first, parts.len() - first)
        });
        let blocks = parts.par_iter().with_min_len(1024).map(|numbers| block_of(numbers, geometry)).collect();
        let shapes = geometry.used_shapes().cloned();
        let cut = references > triangles + geometry.shape_count();
        let mut blas = Self { tree, blocks, triangles, shapes, options, cut, built_cost: 0.0 };
        if !options.allow_compaction {
            blas.trim();
        }
        if options.allow_update {
            blas.built_cost = blas.sah_cost(options.sah.node_cost);
        }
        Ok(blas)
    }

    /// Gives back the room that the build left over.
    fn trim(&mut self) {
        self.tree.nodes = pages::settled(std::mem::take(&mut self.tree.nodes));
        self.blocks = pages::settled(std::mem::take(&mut self.blocks));
    }

    /// Moves what it was built over and keeps the tree: much faster than a build, but the boxes fit the worse, the more neighbours part. The report tells
    /// how much; the hits are those of a new build. Nothing changes on an error.
    ///
    /// # Errors
    /// A mesh that was built without [`BuildOptions::allow_update`], another number of triangles or shapes, and what [`build`](Self::build) refuses.
    pub fn update(&mut self, geometry: &Geometry) -> Result<UpdateReport, BvhError> {
        if !self.options.allow_update {
            return Err(BvhError::NotUpdatable { what: "mesh" });
        }
        for (what, got, expected) in
            [("triangles", geometry.triangle_count(), self.triangles), ("shapes", geometry.shape_count(), self.shape_count())]
        {
            if got != expected {
                return Err(BvhError::CountChanged { what, got, expected });
            }
        }
        let items = geometry.items()?;
        let blocks = &mut self.blocks;
        blocks.par_iter_mut().with_min_len(1024).for_each(|block| {
            let numbers = block.primitives;
            *block = block_of(numbers.split(|&number| number == NO_PRIMITIVE).next().expect("one part at least"), geometry);
        });
        self.shapes = geometry.used_shapes().cloned();
        let item = |block: usize| {
            let numbers = self.blocks[block].primitives;
            numbers.iter().filter(|&&n| n != NO_PRIMITIVE).fold(Aabb::EMPTY, |all, &n| all.union(items[n as usize].bounds()))
        };
        self.tree.refit(item);
        Ok(UpdateReport { built_cost: self.built_cost, cost: self.sah_cost(self.options.sah.node_cost) })
    }

    /// Bytes that [`compacted`](Self::compacted) would need.
    ///
    /// # Errors
    /// A mesh that was built without [`BuildOptions::allow_compaction`].
    pub fn compacted_memory(&self) -> Result<usize, BvhError> {
        match self.options.allow_compaction {
            true => Ok(self.tree.compacted_memory() + std::mem::size_of_val(&self.blocks[..])),
            false => Err(BvhError::NotCompactable),
        }
    }

    /// A copy without room to spare.
    ///
    /// # Errors
    /// A mesh that was built without [`BuildOptions::allow_compaction`].
    pub fn compacted(&self) -> Result<Self, BvhError> {
        self.compacted_memory()?;
        let mut copy = self.clone();
        copy.trim();
        Ok(copy)
    }

    /// Box around all triangles and shapes; empty when there are none.
    pub fn bounds(&self) -> Aabb {
        self.tree.bounds
    }

    /// Number of triangles.
    pub fn triangle_count(&self) -> usize {
        self.triangles
    }

    /// Number of shapes.
    pub fn shape_count(&self) -> usize {
        self.shapes.as_ref().map_or(0, |shapes| shapes.count())
    }

    /// How it was built.
    pub fn options(&self) -> &BuildOptions {
        &self.options
    }

    /// Bytes held by nodes and triangles, with those set aside.
    pub fn memory(&self) -> usize {
        self.tree.memory() + self.blocks.capacity() * size_of::<Block>()
    }

    /// Every triangle with its index, in the order of the leaves.
    pub fn triangles(&self) -> impl Iterator<Item = (u32, [Vec3; 3])> + '_ {
        let mut seen = self.cut.then(HashSet::new);
        self.blocks
            .iter()
            .flat_map(|block| {
                let held = (0..BLOCK_SIZE).filter(|&lane| (block.primitives[lane] as usize) < self.triangles);
                held.map(|lane| (block.primitives[lane], block.get(lane)))
            })
            .filter(move |(number, _)| seen.as_mut().is_none_or(|seen| seen.insert(*number)))
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

    pub(crate) fn shapes(&self) -> Option<&Arc<dyn Procedural>> {
        self.shapes.as_ref()
    }

    /// Where a ray in the space of the mesh first crosses a shape in `t_min ≤ t ≤ t_max`; `None` for what is no shape.
    pub(crate) fn cross_shape(&self, primitive: u32, ray: &Ray) -> Option<Crossing> {
        let shape = (primitive as usize).checked_sub(self.triangles)?;
        let crossing = self.shapes()?.intersect(shape, ray)?;
        (crossing.t >= ray.t_min && crossing.t <= ray.t_max).then_some(crossing)
    }

    pub(crate) fn is_cut(&self) -> bool {
        self.cut
    }
}

/// The triangles with the given numbers; a shape has a number and no vertices, so that no ray crosses them.
fn block_of(numbers: &[u32], geometry: &Geometry) -> Block {
    let mut block = Block::EMPTY;
    for (lane, &number) in numbers.iter().enumerate() {
        if (number as usize) < geometry.triangle_count() {
            block.set(lane, number, geometry.triangle(number as usize));
        } else {
            block.primitives[lane] = number;
        }
    }
    block
}

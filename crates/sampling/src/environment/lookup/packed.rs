//! The tree itself, eight bytes a node.

use crate::Steps;
use crate::environment::block::pixel;
use crate::environment::{Axis, Block, BlockTree, EnvironmentError, KdSampler, Split};
use glam::{UVec2, Vec2};

/// One node in two words.    \[Ergun15] chapter 6
///
/// ```text
/// word 0, inner: bit 0 = 0, bit 1 axis, bits 2 to 12 split index, bits 13 to 31 index of the right child
/// word 1, inner: 32-bit float, the probability of everything on the left
/// word 0, leaf:  bit 0 = 1;   word 1: 32-bit float, the probability of the block
/// ```
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PackedNode([u32; 2]);

impl PackedNode {
    const SPLIT_BITS: u32 = 11;
    const RIGHT_BITS: u32 = 19;

    fn inner(Split { axis, at }: Split, right: u32, left_probability: f32) -> Self {
        let axis = u32::from(axis == Axis::Y);
        Self([axis << 1 | u32::from(at) << 2 | right << (2 + Self::SPLIT_BITS), left_probability.to_bits()])
    }

    fn leaf(probability: f32) -> Self {
        Self([1, probability.to_bits()])
    }

    /// The plane and the index of the right child; `None` for a leaf.
    #[inline]
    pub fn split(self) -> Option<(Split, u32)> {
        let word = self.0[0];
        let axis = if word & 2 == 0 { Axis::X } else { Axis::Y };
        let at = (word >> 2 & ((1 << Self::SPLIT_BITS) - 1)) as u16;
        (word & 1 == 0).then_some((Split { axis, at }, word >> (2 + Self::SPLIT_BITS)))
    }

    /// Of a leaf its own, of an inner node that of its left subtree.
    #[inline]
    pub fn probability(self) -> f32 {
        f32::from_bits(self.0[1])
    }
}

/// A tree in preorder: the left child of a node is the next one. Finds and draws blocks in O(log n) by descent; bounds of blocks are rebuilt
/// on the way.
#[derive(Clone, Debug)]
pub struct PackedTree {
    size: UVec2,
    nodes: Vec<PackedNode>,
}

impl PackedTree {
    /// Largest side of an image, px: what 11 bits say of a plane inside of it.
    pub const MAX_SIDE: u32 = 1 << PackedNode::SPLIT_BITS;
    /// Most leaves: 19 bits number one node less than twice as many.
    pub const MAX_BLOCKS: usize = 1 << (PackedNode::RIGHT_BITS - 1);

    /// Packs a tree; probabilities are those of [`KdSampler::from_tree`].
    ///
    /// # Errors
    /// [`EnvironmentError::PackedTree`] beyond [`Self::MAX_SIDE`] or [`Self::MAX_BLOCKS`].
    pub fn new(tree: &BlockTree) -> Result<Self, EnvironmentError> {
        let (size, blocks) = (tree.size(), tree.leaf_count());
        if size.max_element() > Self::MAX_SIDE || blocks > Self::MAX_BLOCKS {
            let (max_blocks, max_side) = (Self::MAX_BLOCKS, Self::MAX_SIDE);
            return Err(EnvironmentError::PackedTree { blocks, width: size.x, height: size.y, max_blocks, max_side });
        }
        let law = *KdSampler::from_tree(tree).law();
        let mut probability = vec![0.0; tree.nodes().len()];
        for (rank, leaf) in tree.ranked_leaves().into_iter().enumerate() {
            probability[leaf as usize] = law.pmf(rank);
        }
        // Children come after their parent.
        for (index, node) in tree.nodes().iter().enumerate().rev() {
            if let Some((_, child)) = node.split {
                probability[index] = probability[child as usize] + probability[child as usize + 1];
            }
        }
        let mut nodes = Vec::with_capacity(tree.nodes().len());
        // Nodes to write, each with the place of the parent that waits for its index.
        let mut open = vec![(0u32, None)];
        while let Some((index, parent)) = open.pop() {
            let place = nodes.len();
            if let Some((parent, split)) = parent {
                let left: &mut PackedNode = &mut nodes[parent as usize];
                *left = PackedNode::inner(split, place as u32, left.probability());
            }
            match tree.nodes()[index as usize].split {
                None => nodes.push(PackedNode::leaf(probability[index as usize] as f32)),
                Some((split, child)) => {
                    nodes.push(PackedNode::inner(split, 0, probability[child as usize] as f32));
                    open.extend([(child + 1, Some((place as u32, split))), (child, None)]);
                }
            }
        }
        Ok(Self { size, nodes })
    }

    /// All nodes, in preorder.
    pub fn nodes(&self) -> &[PackedNode] {
        &self.nodes
    }

    /// Density per unit area at a point of [0, 1)².
    #[inline]
    pub fn density(&self, uv: Vec2) -> f32 {
        self.density_counted(uv, &mut ())
    }

    /// [`Self::density`], counting the nodes.
    #[inline]
    pub fn density_counted(&self, uv: Vec2, steps: &mut impl Steps) -> f32 {
        let pixel = pixel(uv, self.size);
        let (block, probability) = self.descend(steps, |split, _| match split.axis {
            Axis::X => pixel.x < split.at.into(),
            Axis::Y => pixel.y < split.at.into(),
        });
        self.density_of(block, probability)
    }

    /// A point in [0, 1)² and its density per unit area; `xi` chooses the block, `u` the place in it.
    pub fn sample(&self, mut xi: f64, u: Vec2) -> (Vec2, f32) {
        let (block, probability) = self.descend(&mut (), |_, left| {
            let left = f64::from(left);
            let before = xi < left;
            xi -= if before { 0.0 } else { left };
            before
        });
        (block.point(u, self.size), self.density_of(block, probability))
    }

    fn density_of(&self, block: Block, probability: f32) -> f32 {
        probability * self.size.element_product() as f32 / block.area() as f32
    }

    /// The leaf that is reached by going left where `left` says so, given the plane and the probability of the left side.
    #[inline]
    fn descend(&self, steps: &mut impl Steps, mut left: impl FnMut(Split, f32) -> bool) -> (Block, f32) {
        let (mut index, mut block) = (0, Block::whole(self.size));
        loop {
            steps.step();
            let node = self.nodes[index];
            let Some((split, right)) = node.split() else { return (block, node.probability()) };
            let (before, behind) = block.split(split);
            (index, block) = if left(split, node.probability()) { (index + 1, before) } else { (right as usize, behind) };
        }
    }

    /// Memory, bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(self.nodes.as_slice())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Rng;
    use crate::environment::test_maps::lamps;
    use crate::environment::{Criterion, DensityImage};
    use crate::statistics::chi_square_p_value;

    #[test]
    fn a_node_is_eight_bytes_and_returns_what_was_put_in() {
        assert_eq!(size_of::<PackedNode>(), 8);
        for axis in [Axis::X, Axis::Y] {
            for at in [1, 2, 1023, 1024, 2047] {
                for right in [2, 77, (1 << 18) + 5, (1 << 19) - 2] {
                    let node = PackedNode::inner(Split { axis, at }, right, 0.375);
                    assert_eq!((node.split(), node.probability()), (Some((Split { axis, at }, right)), 0.375));
                }
            }
        }
        assert_eq!((PackedNode::leaf(1e-7).split(), PackedNode::leaf(1e-7).probability()), (None, 1e-7));
    }

    #[test]
    fn the_packed_tree_is_the_tree() {
        let (size, luminance) = lamps(300, 150);
        let tree = BlockTree::new(&DensityImage::from_luminance(size, &luminance).unwrap(), 500, Criterion::default()).unwrap();
        let packed = PackedTree::new(&tree).unwrap();
        assert_eq!((packed.nodes().len(), packed.bytes()), (999, 999 * 8));
        // Both walked side by side.
        let mut open = vec![(0u32, 0u32)];
        while let Some((plain, small)) = open.pop() {
            let found = packed.nodes()[small as usize].split();
            match tree.nodes()[plain as usize].split {
                None => assert_eq!(found, None),
                Some((split, child)) => {
                    let (same, right) = found.unwrap();
                    assert_eq!(split, same);
                    open.extend([(child, small + 1), (child + 1, right)]);
                }
            }
        }
    }

    #[test]
    fn blocks_drawn_by_descent_follow_the_law() {
        let (size, luminance) = lamps(300, 150);
        let tree = BlockTree::new(&DensityImage::from_luminance(size, &luminance).unwrap(), 200, Criterion::default()).unwrap();
        let (packed, sampler) = (PackedTree::new(&tree).unwrap(), KdSampler::from_tree(&tree));
        let (mut rng, mut counts) = (Rng::new(95), vec![0.0; 200]);
        for _ in 0..200_000 {
            let at = pixel(packed.sample(rng.next_f64(), rng.next_2d()).0, size);
            counts[sampler.blocks().iter().position(|block| block.contains(at)).unwrap()] += 1.0;
        }
        let expected: Vec<f64> = (0..200).map(|i| sampler.law().pmf(i) * 200_000.0).collect();
        assert!(chi_square_p_value(&counts, &expected, 0) > 0.01);
        let mut shifted = expected.clone();
        shifted.rotate_left(1);
        assert!(chi_square_p_value(&counts, &shifted, 0) < 1e-6);
    }
}

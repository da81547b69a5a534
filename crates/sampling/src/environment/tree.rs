//! Blocks of an environment: where the light changes much they are small.

use super::sums::SummedArea;
use super::{Axis, Block, DensityImage, EnvironmentError, Split};
use glam::UVec2;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Which block is split next: the one with the largest criterion.    \[Ergun15] chapter 6
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Criterion {
    /// Sum of squared errors Σ f² − (Σ f)²/n: the error that the block's mean makes; the best of the three.
    #[default]
    SquaredError,
    /// max f − min f.
    Range,
    /// Variance \[Σ f² − (Σ f)²/n\] / (n − 1).
    Variance,
}

/// A binary tree of blocks; its leaves cover every pixel once.
#[derive(Clone, Debug)]
pub struct BlockTree {
    size: UVec2,
    nodes: Vec<BlockNode>,
}

/// A block and how it is split.
#[derive(Clone, Copy, Debug)]
pub struct BlockNode {
    /// The pixels.
    pub block: Block,
    /// Share of the light in them.
    pub share: f64,
    /// The plane and the index of the child before it; the one behind follows. `None` for a leaf.
    pub split: Option<(Split, u32)>,
}

impl BlockTree {
    /// Splits the image until there are `count` blocks: fewer only when every block is constant already.
    ///
    /// # Errors
    /// [`EnvironmentError::Blocks`] for none.
    pub fn new(image: &DensityImage, count: usize, criterion: Criterion) -> Result<Self, EnvironmentError> {
        if count == 0 {
            return Err(EnvironmentError::Blocks { got: count });
        }
        let sums = SummedArea::new(image);
        let leaf = |block| BlockNode { block, share: sums.sums(block)[0].max(0.0), split: None };
        let mut nodes = vec![leaf(Block::whole(image.size()))];
        let mut open = BinaryHeap::new();
        let candidate = |node: usize, block| Candidate { value: evaluate(criterion, image, &sums, block), node };
        open.push(candidate(0, nodes[0].block));
        let mut leaves = 1;
        while leaves < count
            && let Some(Candidate { value, node }) = open.pop()
            && value > 0.0
        {
            let Some(split) = best_split(&sums, nodes[node].block) else { continue };
            let (before, behind) = nodes[node].block.split(split);
            let first = nodes.len();
            nodes[node].split = Some((split, first as u32));
            nodes.extend([leaf(before), leaf(behind)]);
            open.extend([candidate(first, before), candidate(first + 1, behind)]);
            leaves += 1;
        }
        Ok(Self { size: image.size(), nodes })
    }

    /// Width and height of the image, px.
    pub fn size(&self) -> UVec2 {
        self.size
    }

    /// All nodes, the root first.
    pub fn nodes(&self) -> &[BlockNode] {
        &self.nodes
    }

    /// Number of leaves.
    pub fn leaf_count(&self) -> usize {
        self.nodes.len() / 2 + 1
    }

    /// Indices of the leaves, the largest share first.
    pub fn ranked_leaves(&self) -> Vec<u32> {
        let mut leaves: Vec<u32> = (0..self.nodes.len() as u32).filter(|&i| self.nodes[i as usize].split.is_none()).collect();
        let share = |leaf: u32| self.nodes[leaf as usize].share;
        leaves.sort_by(|&a, &b| share(b).total_cmp(&share(a)).then(a.cmp(&b)));
        leaves
    }

    /// The blocks of the leaves.
    pub fn leaves(&self) -> impl Iterator<Item = Block> {
        self.nodes.iter().filter(|node| node.split.is_none()).map(|node| node.block)
    }

    /// An image of which every block has its mean: what is left of `pixels` (`height × width`, row-major) in a tree made of them.
    ///
    /// # Panics
    /// When `pixels` has another size.
    pub fn reconstruct<const N: usize>(&self, pixels: &[[f32; N]]) -> Vec<[f32; N]> {
        assert_eq!(pixels.len(), self.size.element_product() as usize, "one value a pixel");
        let mut out = vec![[0.0; N]; pixels.len()];
        for block in self.leaves() {
            let rows = || (usize::from(block.y0)..usize::from(block.y1)).map(|y| y * self.size.x as usize);
            let columns = |row: usize| row + usize::from(block.x0)..row + usize::from(block.x1);
            let mut sum = [0.0f64; N];
            for pixel in rows().flat_map(|row| &pixels[columns(row)]) {
                sum.iter_mut().zip(pixel).for_each(|(sum, &value)| *sum += f64::from(value));
            }
            let mean = sum.map(|sum| (sum / f64::from(block.area())) as f32);
            rows().for_each(|row| out[columns(row)].fill(mean));
        }
        out
    }
}

/// A leaf that may be split; among equal values the older one is first.
struct Candidate {
    value: f64,
    node: usize,
}

impl Ord for Candidate {
    fn cmp(&self, other: &Self) -> Ordering {
        self.value.total_cmp(&other.value).then(other.node.cmp(&self.node))
    }
}

impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Candidate {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Candidate {}

/// Value of the criterion; 0 for blocks that need no split.
fn evaluate(criterion: Criterion, image: &DensityImage, sums: &SummedArea, block: Block) -> f64 {
    let n = f64::from(block.area());
    if n == 1.0 {
        return 0.0;
    }
    let rows = || (block.y0..block.y1).map(|y| usize::from(y) * image.size().x as usize);
    let pixels = || rows().flat_map(|row| &image.shares()[row + usize::from(block.x0)..row + usize::from(block.x1)]);
    let range = || {
        let (low, high) = pixels().fold((f64::INFINITY, 0.0f64), |(low, high), &f| (low.min(f), high.max(f)));
        high - low
    };
    let squared_error = || {
        let [sum, squares] = sums.sums(block);
        let error = squares - sum * sum / n;
        if error > sums.noise() {
            error
        } else if range() == 0.0 {
            0.0
        } else {
            // The tables have too few digits for a dim block beside a sun; its pixels have enough.
            pixels().map(|f| (f - sum / n).powi(2)).sum()
        }
    };
    match criterion {
        Criterion::SquaredError => squared_error(),
        Criterion::Variance => squared_error() / (n - 1.0),
        Criterion::Range => range(),
    }
}

/// The plane of either axis with the least pooled variance of both sides: the one that maximises
///
/// ```text
/// (Σ_left f)²/k + (Σ_right f)²/(n − k)                                              [Ergun15] eq. 6.2
/// ```
///
/// over all positions, with k of n pixels on the left. `None` for a single pixel. O(width + height).
fn best_split(sums: &SummedArea, block: Block) -> Option<Split> {
    let planes = (block.x0 + 1..block.x1)
        .map(|at| Split { axis: Axis::X, at })
        .chain((block.y0 + 1..block.y1).map(|at| Split { axis: Axis::Y, at }));
    let gain = |split| {
        let (left, right) = block.split(split);
        let term = |side: Block| sums.sums(side)[0].powi(2) / f64::from(side.area());
        term(left) + term(right)
    };
    planes.map(|split| (gain(split), split)).reduce(|best, next| if next.0 > best.0 { next } else { best }).map(|(_, split)| split)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Rng;
    use crate::environment::test_maps::{all_maps, sunny};

    const CRITERIA: [Criterion; 3] = [Criterion::SquaredError, Criterion::Range, Criterion::Variance];

    fn density((size, luminance): (UVec2, Vec<f32>)) -> DensityImage {
        DensityImage::from_luminance(size, &luminance).unwrap()
    }

    /// How often each pixel is covered.
    fn coverage(size: UVec2, blocks: impl Iterator<Item = Block>) -> Vec<u32> {
        let mut counts = vec![0; size.element_product() as usize];
        for block in blocks {
            for y in block.y0..block.y1 {
                for x in block.x0..block.x1 {
                    counts[usize::from(y) * size.x as usize + usize::from(x)] += 1;
                }
            }
        }
        counts
    }

    #[test]
    fn blocks_are_as_many_as_asked_and_cover_every_pixel_once_and_a_planted_fault_is_seen() {
        let image = density(sunny(97, 50));
        for criterion in CRITERIA {
            for count in [1, 2, 3, 64, 771, 97 * 50] {
                let tree = BlockTree::new(&image, count, criterion).unwrap();
                assert_eq!((tree.leaf_count(), tree.leaves().count()), (count, count), "{criterion:?}");
                assert!(coverage(image.size(), tree.leaves()).iter().all(|&n| n == 1), "{criterion:?}");
                let share: f64 = tree.nodes().iter().filter(|node| node.split.is_none()).map(|node| node.share).sum();
                assert!((share - 1.0).abs() < 1e-9);
            }
        }
        let tree = BlockTree::new(&image, 64, Criterion::default()).unwrap();
        assert!(coverage(image.size(), tree.leaves().skip(1)).contains(&0));
        assert!(coverage(image.size(), tree.leaves().chain(tree.leaves().take(1))).contains(&2));
        assert_eq!(BlockTree::new(&image, 0, Criterion::default()).unwrap_err(), EnvironmentError::Blocks { got: 0 });
    }

    /// Σ (f − block mean)² of a tree over the image.
    fn squared_error(image: &DensityImage, tree: &BlockTree) -> f64 {
        let mut total = 0.0;
        for node in tree.nodes().iter().filter(|node| node.split.is_none()) {
            let mean = node.share / f64::from(node.block.area());
            for y in node.block.y0..node.block.y1 {
                total += (node.block.x0..node.block.x1).map(|x| (image.share(x.into(), y.into()) - mean).powi(2)).sum::<f64>();
            }
        }
        total
    }

    #[test]
    fn the_squared_error_criterion_leaves_the_smallest_squared_error() {
        for (name, size, luminance) in all_maps() {
            let image = density((size, luminance));
            for count in [64, 256, 771] {
                let [ours, range, variance] = CRITERIA.map(|c| squared_error(&image, &BlockTree::new(&image, count, c).unwrap()));
                assert!(ours < range && ours < variance, "{name}, {count}: {ours:e}, range {range:e}, variance {variance:e}");
            }
        }
    }

    /// (6.1): pooled variance of both sides, from the pixels themselves.
    fn pooled_variance(image: &DensityImage, block: Block, split: Split) -> f64 {
        let (left, right) = block.split(split);
        let error = |side: Block| {
            let pixels = || (side.y0..side.y1).flat_map(|y| (side.x0..side.x1).map(move |x| image.share(x.into(), y.into())));
            let mean = pixels().sum::<f64>() / f64::from(side.area());
            pixels().map(|f| (f - mean).powi(2)).sum::<f64>()
        };
        (error(left) + error(right)) / (f64::from(block.area()) - 2.0)
    }

    #[test]
    fn splits_have_the_least_pooled_variance_and_a_planted_fault_is_seen() {
        let image = density(sunny(128, 64));
        let sums = SummedArea::new(&image);
        let mut rng = Rng::new(71);
        let mut range = |side: u32| {
            let (a, b) = (rng.below(side), rng.below(side));
            (a.min(b) as u16, a.max(b) as u16 + 1)
        };
        let mut worse_neighbours = 0;
        for _ in 0..100 {
            let ((x0, x1), (y0, y1)) = (range(128), range(64));
            let block = Block { x0, y0, x1, y1 };
            if block.area() < 3 {
                continue;
            }
            let columns = (x0 + 1..x1).map(|at| Split { axis: Axis::X, at });
            let rows = (y0 + 1..y1).map(|at| Split { axis: Axis::Y, at });
            let least = columns.chain(rows).map(|split| pooled_variance(&image, block, split)).fold(f64::INFINITY, f64::min);
            let best = best_split(&sums, block).unwrap();
            assert!(pooled_variance(&image, block, best) <= least * (1.0 + 1e-6), "{block:?} at {best:?}");
            let (low, high) = if best.axis == Axis::X { (x0, x1) } else { (y0, y1) };
            let beside = Split { at: if best.at + 1 < high { best.at + 1 } else { (best.at - 1).max(low + 1) }, ..best };
            worse_neighbours += u32::from(pooled_variance(&image, block, beside) > least * (1.0 + 1e-6));
        }
        assert!(worse_neighbours > 90, "only {worse_neighbours} of 100 neighbouring planes are worse");
    }

    #[test]
    fn constant_blocks_are_not_split() {
        let weights: Vec<f32> = (0..64 * 32).map(|i| if i % 64 < 20 { 5.0 } else { 1.0 }).collect();
        let image = DensityImage::from_weights(UVec2::new(64, 32), &weights).unwrap();
        for criterion in CRITERIA {
            let tree = BlockTree::new(&image, 100, criterion).unwrap();
            assert_eq!(tree.leaf_count(), 2, "{criterion:?}");
            let values: Vec<[f32; 1]> = weights.iter().map(|&w| [w]).collect();
            assert_eq!(tree.reconstruct(&values), values);
        }
    }
}

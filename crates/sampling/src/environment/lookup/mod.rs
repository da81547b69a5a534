//! The density of a direction that was found otherwise, which combining strategies needs: three ways to find its block.

mod alpha;
mod grid;
mod packed;

pub use alpha::AlphaPlane;
pub use grid::GridHash;
pub use packed::{PackedNode, PackedTree};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Rng;
    use crate::environment::test_maps::{all_maps, sunny};
    use crate::environment::{BlockTree, Criterion, DensityImage, EnvironmentError, KdSampler};
    use glam::UVec2;

    fn tree(size: UVec2, luminance: &[f32], blocks: usize) -> BlockTree {
        BlockTree::new(&DensityImage::from_luminance(size, luminance).unwrap(), blocks, Criterion::default()).unwrap()
    }

    /// Largest relative difference of the three at random points.
    fn disagreement(grid: &GridHash, packed: &PackedTree, alpha: &AlphaPlane, seed: u64) -> f32 {
        let mut rng = Rng::new(seed);
        let difference = |_| {
            let uv = rng.next_2d();
            let all = [grid.density(uv), packed.density(uv), alpha.density(uv)];
            let (low, high) = all.into_iter().fold((f32::INFINITY, 0.0f32), |(low, high), d| (low.min(d), high.max(d)));
            high / low - 1.0
        };
        (0..100_000).map(difference).fold(0.0, f32::max)
    }

    #[test]
    fn the_three_agree_everywhere_and_a_planted_fault_is_seen() {
        for (name, size, luminance) in all_maps() {
            let tree = tree(size, &luminance, 771);
            let sampler = KdSampler::from_tree(&tree);
            let (grid, packed, alpha) = (GridHash::new(&sampler), PackedTree::new(&tree).unwrap(), AlphaPlane::new(&sampler));
            let difference = disagreement(&grid, &packed, &alpha, 91);
            assert!(difference < 1e-5, "{name}: {difference}");
            let other = KdSampler::from_tree(&super::tests::tree(size, &luminance, 770));
            assert!(disagreement(&grid, &packed, &AlphaPlane::new(&other), 92) > 0.1, "{name}: another tree's plane");
        }
    }

    /// What is drawn has the density that is looked up, and the tree can draw as well.
    #[test]
    fn lookups_return_the_density_of_what_is_drawn() {
        let (size, luminance) = sunny(500, 250);
        let tree = tree(size, &luminance, 1000);
        let sampler = KdSampler::from_tree(&tree);
        let (grid, packed, alpha) = (GridHash::new(&sampler), PackedTree::new(&tree).unwrap(), AlphaPlane::new(&sampler));
        let mut rng = Rng::new(93);
        for _ in 0..20_000 {
            let (uv, density) = sampler.sample(rng.next_f64(), rng.next_2d());
            let (by_tree, of_tree) = packed.sample(rng.next_f64(), rng.next_2d());
            for (uv, density) in [(uv, density), (by_tree, of_tree)] {
                for found in [grid.density(uv), packed.density(uv), alpha.density(uv)] {
                    assert!((found / density - 1.0).abs() < 1e-5, "{uv}: {found} and {density}");
                }
            }
        }
    }

    #[test]
    fn the_tree_takes_the_logarithm_of_steps_and_the_plane_one() {
        let (size, luminance) = sunny(512, 256);
        let mean = |blocks: usize| {
            let tree = tree(size, &luminance, blocks);
            let sampler = KdSampler::from_tree(&tree);
            let (packed, alpha, grid) = (PackedTree::new(&tree).unwrap(), AlphaPlane::new(&sampler), GridHash::new(&sampler));
            let (mut rng, mut steps) = (Rng::new(94), [0u64; 3]);
            for _ in 0..10_000 {
                let uv = rng.next_2d();
                packed.density_counted(uv, &mut steps[0]);
                alpha.density_counted(uv, &mut steps[1]);
                grid.density_counted(uv, &mut steps[2]);
            }
            steps.map(|steps| steps as f64 / 1e4)
        };
        let [few, many] = [mean(256), mean(16_384)];
        assert!(few[1] == 1.0 && many[1] == 1.0);
        assert!(many[0] > few[0] + 3.0, "{few:?}, {many:?}");
        // A cell holds four blocks on average; small blocks crowd together where few directions fall.
        assert!(few[2] < 12.0 && many[2] < 12.0, "{few:?}, {many:?}");
    }

    #[test]
    fn what_the_packed_words_cannot_say_is_refused() {
        let refused = |size: UVec2, blocks: usize| {
            let weights: Vec<f32> = (0..size.element_product()).map(|i| (i % 7 + i % 11) as f32 + 1.0).collect();
            let tree = BlockTree::new(&DensityImage::from_weights(size, &weights).unwrap(), blocks, Criterion::default()).unwrap();
            assert_eq!(tree.leaf_count(), blocks);
            matches!(PackedTree::new(&tree), Err(EnvironmentError::PackedTree { .. }))
        };
        assert!(!refused(UVec2::new(2048, 4), 50) && refused(UVec2::new(2049, 4), 50) && refused(UVec2::new(4, 2049), 50));
        assert!(!refused(UVec2::new(1024, 512), 1 << 18) && refused(UVec2::new(1024, 512), (1 << 18) + 1));
    }
}

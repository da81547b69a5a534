//! The two inner loops, eight boxes and four triangles at a time, on each instruction set.

#[cfg(target_arch = "x86_64")]
mod avx2;
mod portable;

#[cfg(target_arch = "x86_64")]
pub(crate) use avx2::Avx2;
pub(crate) use portable::Portable;

use crate::{slab::SlabRay, triangle::Block, triangle::ShearedRay, wide::Node, wide::WIDTH};

/// Entry distances of the children of a node.
#[repr(C, align(32))]
pub(crate) struct Distances(pub [f32; WIDTH]);

/// Tests boxes and triangles side by side. Implementations may differ in rounding of box distances, within the margin of [`crate::slab`].
pub(crate) trait Lanes {
    /// Children whose box is met within `t_min ..= t_max`, one bit each, and where each is entered.
    fn boxes(ray: &SlabRay, node: &Node, t_max: f32) -> (u32, Distances);

    /// Lanes whose edge functions, in single precision, do not have two signs: one bit each. Exactly the same in every implementation.
    fn triangles(ray: &ShearedRay, block: &Block) -> u32;
}

/// Which instructions traversal uses. The hits are the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Backend {
    /// Plain Rust.
    Portable,
    /// AVX2 and FMA; x86-64 only.
    Avx2,
}

impl Backend {
    /// The fastest one that this processor runs.
    pub fn detect() -> Self {
        if Self::Avx2.is_supported() { Self::Avx2 } else { Self::Portable }
    }

    /// Whether this processor runs it.
    pub fn is_supported(self) -> bool {
        match self {
            Self::Portable => true,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma"),
            #[cfg(not(target_arch = "x86_64"))]
            Self::Avx2 => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Ray, aabb::Aabb, triangle::BLOCK_SIZE};
    use glam::Vec3;
    use proptest::prelude::*;

    /// Coordinates on a coarse grid, so that rays through edges and vertices, and flat and repeated triangles are common.
    fn grid_point() -> impl Strategy<Value = Vec3> {
        [-3i8..=3, -3i8..=3, -3i8..=3].prop_map(|p| Vec3::from_array(p.map(f32::from)))
    }

    fn any_point() -> impl Strategy<Value = Vec3> {
        prop_oneof![
            grid_point(),
            [-1e3f32..1e3, -1e3f32..1e3, -1e3f32..1e3].prop_map(Vec3::from_array),
            [-1e-20f32..1e-20, -1f32..1.0, -1e9f32..1e9].prop_map(Vec3::from_array)
        ]
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,fma")]
    fn avx2_triangles(ray: &ShearedRay, block: &Block) -> u32 {
        Avx2::triangles(ray, block)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,fma")]
    fn avx2_boxes(ray: &SlabRay, node: &Node, t_max: f32) -> (u32, Distances) {
        Avx2::boxes(ray, node, t_max)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn single_precision_never_rejects_a_triangle_that_is_hit(
            corners in prop::array::uniform4(prop::array::uniform3(any_point())),
            origin in any_point(),
            target in any_point(),
        ) {
            prop_assume!(target != origin);
            let ray = Ray::new(origin, target - origin);
            let sheared = ShearedRay::new(&ray);
            let mut block = Block::EMPTY;
            for (lane, &triangle) in corners[..3].iter().enumerate() {
                block.set(lane, lane as u32, triangle);
            }
            let candidates = Portable::triangles(&sheared, &block);
            prop_assert_eq!(candidates >> 3, 0, "an unused lane");
            for lane in 0..BLOCK_SIZE {
                prop_assert!(sheared.cross_lane(&block, lane).is_none() || candidates >> lane & 1 == 1);
            }
            #[cfg(target_arch = "x86_64")]
            if Backend::Avx2.is_supported() {
                // SAFETY: supported.
                prop_assert_eq!(unsafe { avx2_triangles(&sheared, &block) }, candidates);
            }
        }

        #[test]
        fn a_box_around_a_hit_is_entered_before_it(
            corners in prop::array::uniform3(any_point()),
            origin in any_point(),
            target in any_point(),
        ) {
            prop_assume!(target != origin);
            let ray = Ray::new(origin, target - origin);
            let bounds = Aabb::of_points(corners);
            if let Some(crossing) = ShearedRay::new(&ray).cross(corners.map(|p| p.to_array())) {
                let slab = SlabRay::new(&ray, &bounds, crate::slab::MARGIN, 0.0);
                let node = crate::wide::tests::node_of(&[bounds]);
                if crossing.t > ray.t_min && crossing.t < ray.t_max {
                    let (met, distances) = Portable::boxes(&slab, &node, crossing.t);
                    prop_assert_eq!(met, 1, "entered at {} for a hit at {}", distances.0[0], crossing.t);
                    #[cfg(target_arch = "x86_64")]
                    if Backend::Avx2.is_supported() {
                        // SAFETY: supported.
                        prop_assert_eq!(unsafe { avx2_boxes(&slab, &node, crossing.t) }.0, 1);
                    }
                }
            }
        }
    }
}

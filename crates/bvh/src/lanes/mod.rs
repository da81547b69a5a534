//! The two inner loops, eight boxes and four triangles at a time, on each instruction set.

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod portable;

#[cfg(target_arch = "x86_64")]
pub(crate) use avx2::Avx2;
#[cfg(target_arch = "x86_64")]
pub(crate) use avx512::Avx512;
pub(crate) use portable::Portable;

use crate::{
    packet::Frustum,
    slab::SlabRay,
    stack::Stack,
    triangle::{BLOCK_SIZE, Block, ShearedRay},
    wide::{Child, Node, WIDTH},
};

/// Entry distances of the children of a node.
#[repr(C, align(32))]
pub(crate) struct Distances(pub [f32; WIDTH]);

/// Tests boxes and triangles side by side. Implementations may differ in rounding of box distances, within the margin of [`crate::slab`].
pub(crate) trait Lanes: Sized {
    /// Runs a task in a function of its own that may use the instructions. Everything the task does must be inlined into it.
    fn call(task: &mut impl Task);

    /// Pushes the children whose box is met within `t_min ..= t_max`, the nearest last, but for the nearest, which is returned; [`Child::NONE`] if
    /// there is none. For a ray alone: with branches, which let the processor go on before the outcome is known.
    fn enter(ray: &SlabRay, node: &Node, t_max: f32, stack: &mut Stack) -> Child;

    /// Pushes all of them, the nearest last. For rays by turns: without branches, where the instructions can.
    fn enter_all(ray: &SlabRay, node: &Node, t_max: f32, stack: &mut Stack);

    /// Children that many rays may meet, one bit each, and where each is entered at the earliest; see [`Frustum`].
    fn frustum_boxes(frustum: &Frustum, node: &Node, t_max: f32) -> (u32, Distances);

    /// a b + c, rounded once where the instructions can.
    fn mul_add(a: f32, b: f32, c: f32) -> f32;

    /// Has the memory of something brought into the caches.
    fn call_for<T>(_: &T) {}

    /// Whether some triangle may be crossed, in single precision: `false` only if none is.
    fn may_cross(ray: &ShearedRay, block: &Block) -> bool;

    /// Triangles that the ray crosses at `t_min < t ≤ t_max`, one bit each, and where. Exactly the same in every implementation.
    fn triangles(ray: &ShearedRay, block: &Block, t_min: f32, t_max: f32, out: &mut Crossings) -> u32;
}

/// Crossings with the triangles of a block; only the lanes that were reported mean anything.
#[derive(Clone, Copy, Default)]
#[repr(C, align(16))]
pub(crate) struct Crossings {
    /// Ray parameters.
    pub t: [f32; BLOCK_SIZE],
    /// Weights of vertex 1.
    pub u: [f32; BLOCK_SIZE],
    /// Weights of vertex 2.
    pub v: [f32; BLOCK_SIZE],
}

/// Work that is compiled once for each set of instructions.
pub(crate) trait Task {
    /// Does it. Implementations are `#[inline(always)]`, so that they are compiled with the features of their caller.
    fn run<L: Lanes>(&mut self);
}

/// Which instructions traversal uses. The hits are the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Backend {
    /// Plain Rust.
    Portable,
    /// AVX2 and FMA; x86-64 only.
    Avx2,
    /// AVX-512 (F, VL, BW, DQ), BMI, LZCNT and POPCNT, which all processors with AVX-512 have; x86-64 only.
    Avx512,
}

impl Backend {
    /// The fastest one that this processor runs.
    pub fn detect() -> Self {
        [Self::Avx512, Self::Avx2].into_iter().find(|backend| backend.is_supported()).unwrap_or(Self::Portable)
    }

    /// Whether this processor runs it.
    pub fn is_supported(self) -> bool {
        match self {
            Self::Portable => true,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma"),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => {
                // All that `Avx512::call` enables: a virtual machine may hide any of them.
                let wide = is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("avx512vl");
                let wide = wide && is_x86_feature_detected!("avx512bw") && is_x86_feature_detected!("avx512dq");
                let bits = is_x86_feature_detected!("bmi1") && is_x86_feature_detected!("bmi2");
                let bits = bits && is_x86_feature_detected!("lzcnt") && is_x86_feature_detected!("popcnt");
                wide && bits && Self::Avx2.is_supported()
            }
            #[cfg(not(target_arch = "x86_64"))]
            Self::Avx2 | Self::Avx512 => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Ray, aabb::Aabb, stack::Storage};
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

    /// Lanes and crossings of a block, one after the other.
    fn listed<L: Lanes>(ray: &ShearedRay, block: &Block, t_min: f32, t_max: f32) -> Vec<(usize, [u32; 3])> {
        let mut out = Crossings::default();
        let mut lanes = 0;
        struct Triangles<'a>(&'a ShearedRay, &'a Block, [f32; 2], &'a mut Crossings, &'a mut u32);
        impl Task for Triangles<'_> {
            #[inline(always)]
            fn run<L: Lanes>(&mut self) {
                *self.4 = L::triangles(self.0, self.1, self.2[0], self.2[1], self.3);
            }
        }
        L::call(&mut Triangles(ray, block, [t_min, t_max], &mut out, &mut lanes));
        let lane = |i: usize| (i, [out.t[i], out.u[i], out.v[i]].map(f32::to_bits));
        (0..32).filter(|i| lanes >> i & 1 == 1).map(lane).collect()
    }

    /// The nearest child that is entered and how many others wait; then how many wait when all do.
    fn entered<L: Lanes>(ray: &SlabRay, node: &Node, t_max: f32) -> (Child, usize, usize) {
        let mut out = (Child::NONE, 0, 0);
        struct Boxes<'a>(&'a SlabRay, &'a Node, f32, &'a mut (Child, usize, usize));
        impl Task for Boxes<'_> {
            #[inline(always)]
            fn run<L: Lanes>(&mut self) {
                let mut place = Storage::UNINIT;
                let mut stack = Stack::new(Storage::empty(&mut place));
                self.3.0 = L::enter(self.0, self.1, self.2, &mut stack);
                while stack.pop().is_some() {
                    self.3.1 += 1;
                }
                L::enter_all(self.0, self.1, self.2, &mut stack);
                while stack.pop().is_some() {
                    self.3.2 += 1;
                }
            }
        }
        L::call(&mut Boxes(ray, node, t_max, &mut out));
        out
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn every_set_of_instructions_finds_exactly_the_crossings(
            corners in prop::array::uniform4(prop::array::uniform3(any_point())),
            origin in any_point(),
            target in any_point(),
            interval in prop_oneof![Just((0.0, f32::INFINITY)), (-2f32..2.0, 0f32..4.0)],
        ) {
            prop_assume!(target != origin);
            let sheared = ShearedRay::new(&Ray::new(origin, target - origin));
            let mut block = Block::EMPTY;
            for (lane, &triangle) in corners[..3].iter().enumerate() {
                block.set(lane, lane as u32, triangle);
            }
            let (t_min, t_max) = interval;
            let expected: Vec<_> = (0..3)
                .filter_map(|lane| sheared.cross(corners[lane].map(|p| p.to_array())).map(|c| (lane, c)))
                .filter(|(_, c)| c.t > t_min && c.t <= t_max)
                .map(|(lane, c)| (lane, [c.t, c.u, c.v].map(f32::to_bits)))
                .collect();
            prop_assert_eq!(&listed::<Portable>(&sheared, &block, t_min, t_max), &expected);
            #[cfg(target_arch = "x86_64")]
            if Backend::Avx2.is_supported() {
                prop_assert_eq!(&listed::<Avx2>(&sheared, &block, t_min, t_max), &expected);
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
                    let one = (Child::leaf(0, 1), 0, 1);
                    prop_assert_eq!(entered::<Portable>(&slab, &node, crossing.t), one, "hit at {}", crossing.t);
                    #[cfg(target_arch = "x86_64")]
                    if Backend::Avx2.is_supported() {
                        prop_assert_eq!(entered::<Avx2>(&slab, &node, crossing.t), one);
                    }
                    #[cfg(target_arch = "x86_64")]
                    if Backend::Avx512.is_supported() {
                        prop_assert_eq!(entered::<Avx512>(&slab, &node, crossing.t), one);
                    }
                }
            }
        }
    }
}

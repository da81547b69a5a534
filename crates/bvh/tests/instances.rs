//! Two levels: placement, masks, confirmation, exclusion, and the arrays for GPUs.

mod common;

use common::*;
use glam::{Affine3A, Quat, Vec3};
use kajo_bvh::gpu::FlatBvh;
use kajo_bvh::{BvhInstance, Filter, Ray, Tlas};
use std::sync::Arc;

/// A rotation, an uneven scale (mirrored for odd numbers) and a translation.
fn placement(number: usize, random: &mut Random) -> Affine3A {
    let scale = Vec3::new(0.5 + random.unit(), 0.5 + random.unit(), 0.5 + random.unit()) * if number % 2 == 1 { -1.0 } else { 1.0 };
    let turn = Quat::from_axis_angle(random.sphere(), random.unit() * 6.0);
    Affine3A::from_scale_rotation_translation(scale, turn, random.cube() * 20.0)
}

fn world(count: usize, seed: u64) -> (TestMesh, Tlas) {
    let mut random = Random::new(seed);
    let mesh = soup(50, 0.5, seed);
    let instances = (0..count).map(|i| BvhInstance::new(0, placement(i, &mut random))).collect();
    let tlas = Tlas::build(vec![Arc::new(mesh.blas())], instances).unwrap();
    (mesh, tlas)
}

fn far_rays(count: usize, seed: u64) -> impl Iterator<Item = Ray> {
    let mut random = Random::new(seed);
    (0..count).map(move |_| {
        let (from, to) = (random.cube() * 40.0, random.cube() * 20.0);
        Ray::new(from, (to - from) * (0.01 + random.unit()))
    })
}

#[test]
fn placed_meshes_equal_brute_force_bit_for_bit() {
    let (_, plain) = world(40, 3);
    for backend in backends() {
        let tlas = plain.clone().with_backend(backend);
        let mut hits = 0;
        for ray in far_rays(3_000, 4) {
            let expected = tlas.closest_hit_brute_force(&ray, Filter::ALL, |_| true);
            same(expected, tlas.closest_hit(&ray, Filter::ALL, |_| unreachable!("all are opaque"))).unwrap();
            hits += usize::from(expected.is_some());
        }
        assert!(hits > 100, "{hits}");
    }
}

/// A cube far from its own origin, and one stretched after a turn: rays are rounded on the way into their spaces, by more than the margins of a mesh allow
/// for. They are aimed at corners of cubes, beside corners of their boxes in the world.
#[test]
fn transforms_that_amplify_rounding_equal_brute_force() {
    let corner = |i: u32| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) - 0.5;
    let quads = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];
    let cube = TestMesh {
        positions: (0..8).map(corner).collect(),
        indices: quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect(),
    };
    for (away, stretch, distance) in [(0.0, 1.0, 8.0), (3e4, 1.0, 8.0), (0.0, 300.0, 3e3)] {
        let mut random = Random::new(31);
        let shift = Vec3::new(away, -0.5 * away, 0.25 * away);
        let mesh = cube.map(|p| p - shift);
        let instances: Vec<BvhInstance> = (0..4)
            .map(|_| {
                let turn = if away == 0.0 { Affine3A::from_rotation_z(random.unit() * 6.0) } else { Affine3A::IDENTITY };
                let stretched = Affine3A::from_scale(Vec3::new(stretch, 1.0, 1.0)) * turn * Affine3A::from_translation(shift);
                // Translations have a margin of their own.
                let place = if stretch == 1.0 { random.cube() * 4.0 } else { Vec3::ZERO };
                BvhInstance::new(0, Affine3A::from_translation(place) * stretched)
            })
            .collect();
        let tlas = Tlas::build(vec![Arc::new(mesh.blas())], instances.clone()).unwrap();
        let mut hits = 0;
        for _ in 0..20_000 {
            let instance = instances[random.bits() as usize % instances.len()].world_from_object;
            let target = instance.transform_point3(mesh.positions[random.bits() as usize % 8]) + random.cube() * 2e-4 * stretch;
            let origin = random.sphere() * Vec3::new(8.0, distance, distance);
            let ray = Ray::new(origin, target - origin);
            let expected = tlas.closest_hit_brute_force(&ray, Filter::ALL, |_| true);
            same(expected, tlas.closest_hit_opaque(&ray, Filter::ALL)).unwrap_or_else(|e| panic!("{away} {stretch} {ray:?}: {e}"));
            hits += usize::from(expected.is_some());
        }
        assert!(hits > 5_000, "{away} {stretch}: {hits}");
    }
}

#[test]
fn flat_arrays_give_the_same_hits() {
    let (_, tlas) = world(60, 5);
    let flat = FlatBvh::new(&tlas);
    let mut hits = 0;
    for ray in far_rays(20_000, 6) {
        let expected = tlas.closest_hit_opaque(&ray, Filter::ALL);
        same(expected, flat.closest_hit(&ray, Filter::ALL, |_| true)).unwrap();
        hits += usize::from(expected.is_some());
    }
    assert!(hits > 1_000, "{hits}");

    let single = Tlas::single(soup(10_000, 0.1, 1).blas());
    let flat = FlatBvh::new(&single);
    for ray in rays(20_000, 7) {
        same(single.closest_hit_opaque(&ray, Filter::ALL), flat.closest_hit(&ray, Filter::ALL, |_| true)).unwrap();
    }
}

#[test]
fn flat_arrays_have_the_documented_layout() {
    use kajo_bvh::gpu::{FlatInstance, FlatNode, FlatTriangle};
    use std::mem::{offset_of, size_of};
    assert_eq!((size_of::<FlatNode>(), size_of::<FlatTriangle>(), size_of::<FlatInstance>()), (32, 48, 64));
    assert_eq!((offset_of!(FlatNode, left_or_first), offset_of!(FlatNode, max), offset_of!(FlatNode, count)), (12, 16, 28));
    assert_eq!((offset_of!(FlatTriangle, primitive), offset_of!(FlatTriangle, v1), offset_of!(FlatTriangle, v2)), (12, 16, 32));
    assert_eq!((offset_of!(FlatInstance, root), offset_of!(FlatInstance, mask), offset_of!(FlatInstance, flags)), (48, 56, 60));
    let empty = FlatBvh::new(&Tlas::build(vec![], vec![]).unwrap());
    assert!(empty.is_empty() && empty.closest_hit(&Ray::new(Vec3::ZERO, Vec3::X), Filter::ALL, |_| true).is_none());
    assert_eq!([empty.tlas_nodes.len(), empty.blas_nodes.len(), empty.triangles.len(), empty.instances.len()], [1; 4]);
}

#[test]
fn a_mask_without_a_common_bit_hides_and_any_other_changes_nothing() {
    let (mesh, _) = world(1, 8);
    let blas = Arc::new(mesh.blas());
    let mut random = Random::new(9);
    let placements: Vec<Affine3A> = (0..64).map(|i| placement(i, &mut random)).collect();
    let masked = |mask: &dyn Fn(usize) -> u32| {
        let instances = placements.iter().enumerate().map(|(i, &p)| BvhInstance { mask: mask(i), ..BvhInstance::new(0, p) });
        Tlas::build(vec![blas.clone()], instances.collect()).unwrap()
    };
    let tlas = masked(&|i| 1 << (i % 3));
    let everything = masked(&|_| u32::MAX);
    let flat = FlatBvh::new(&tlas);
    let mut seen = [0; 8];
    for ray in far_rays(20_000, 10) {
        for mask in 0..8u32 {
            let filter = Filter { mask, ..Filter::ALL };
            let hit = tlas.closest_hit_opaque(&ray, filter);
            assert_eq!(hit.is_some(), tlas.any_hit_opaque(&ray, filter));
            if let Some(hit) = hit {
                assert_ne!(mask & 1 << (hit.instance % 3), 0, "mask {mask} saw {hit:?}");
                seen[mask as usize] += 1;
            }
            if ray.origin.x > 30.0 {
                same(hit, flat.closest_hit(&ray, filter, |_| true)).unwrap();
            }
        }
        same(everything.closest_hit_opaque(&ray, Filter::ALL), tlas.closest_hit_opaque(&ray, Filter { mask: 7, ..Filter::ALL })).unwrap();
    }
    assert_eq!(seen[0], 0);
    assert!(seen[1..].iter().all(|&n| n > 500), "{seen:?}");
}

//! What counts as a hit: intervals, ties, confirmation, exclusion, and inputs at the edge.

mod common;

use common::*;
use glam::{Affine3A, Mat3A, Vec3, Vec3A};
use kajo_bvh::{Blas, BuildOptions, BuildQuality, BvhError, BvhInstance, Counters, Filter, PrimitiveRef, Ray, Sah, Tlas, gpu::FlatBvh};
use proptest::prelude::*;
use std::sync::Arc;

/// Unit squares (two triangles each) at z = 0, 1, 2, …
fn stack_of_squares(count: u32) -> TestMesh {
    let mut mesh = TestMesh::default();
    for i in 0..count {
        let z = i as f32;
        mesh.positions.extend([[0.0, 0.0, z], [1.0, 0.0, z], [1.0, 1.0, z], [0.0, 1.0, z]].map(Vec3::from_array));
        mesh.indices.extend([[4 * i, 4 * i + 1, 4 * i + 2], [4 * i, 4 * i + 2, 4 * i + 3]]);
    }
    mesh
}

#[test]
fn both_ends_of_the_interval_are_excluded() {
    let tlas = Tlas::single(stack_of_squares(4).blas());
    let trace = |t_min: f32, t_max: f32| {
        let ray = Ray { t_min, t_max, ..Ray::new(Vec3::new(0.75, 0.25, -1.0), Vec3::Z) };
        let hit = tlas.closest_hit_opaque(&ray, Filter::ALL);
        assert_eq!(hit.is_some(), tlas.any_hit_opaque(&ray, Filter::ALL));
        hit.map(|h| h.t)
    };
    assert_eq!(trace(0.0, f32::INFINITY), Some(1.0));
    assert_eq!(trace(1.0, f32::INFINITY), Some(2.0));
    assert_eq!(trace(1.0f32.next_down(), f32::INFINITY), Some(1.0));
    assert_eq!(trace(0.0, 1.0), None);
    assert_eq!(trace(0.0, 1.0f32.next_up()), Some(1.0));
    assert_eq!(trace(1.0, 2.0), None);
    assert_eq!(trace(4.0, f32::INFINITY), None);
    assert_eq!(trace(2.5, 2.5), None);
    assert_eq!(trace(3.0, 2.0), None);
    assert_eq!(trace(f32::NAN, 2.0), None);
}

#[test]
fn no_hit_lies_outside_the_interval() {
    let tlas = Tlas::single(soup(5_000, 0.1, 11).blas());
    let mut random = Random::new(12);
    let mut hits = 0;
    for ray in rays(50_000, 13) {
        let (a, b) = (random.unit() * 3.0, random.unit() * 3.0);
        let ray = Ray { t_min: a.min(b), t_max: a.max(b), ..ray };
        if let Some(hit) = tlas.closest_hit_opaque(&ray, Filter::ALL) {
            assert!(hit.t > ray.t_min && hit.t < ray.t_max, "{hit:?} {ray:?}");
            hits += 1;
        }
    }
    assert!(hits > 10_000, "{hits}");
}

#[test]
fn equal_distances_go_to_the_lowest_instance_and_triangle() {
    let square = stack_of_squares(1);
    let mut mesh = TestMesh { positions: square.positions.clone(), indices: Vec::new() };
    for _ in 0..40 {
        mesh.indices.extend(&square.indices);
    }
    let blas = Arc::new(mesh.blas());
    let tlas = Tlas::build(vec![blas], vec![BvhInstance::new(0, Affine3A::IDENTITY); 20]).unwrap();
    let flat = FlatBvh::new(&tlas);
    for (x, y, first) in [(0.75, 0.25, 0), (0.25, 0.75, 1)] {
        let ray = Ray::new(Vec3::new(x, y, -3.0), Vec3::Z);
        let hit = tlas.closest_hit_opaque(&ray, Filter::ALL).unwrap();
        assert_eq!((hit.instance, hit.primitive, hit.t), (0, first, 3.0));
        same(Some(hit), flat.closest_hit(&ray, Filter::ALL, |_| true)).unwrap();
        let next = tlas.closest_hit_opaque(&ray, Filter::leaving(&hit)).unwrap();
        assert_eq!((next.instance, next.primitive), (0, first + 2));
    }
}

#[test]
fn confirmation_is_asked_of_instances_that_are_not_opaque_only() {
    let blas = Arc::new(stack_of_squares(1).blas());
    let at = |z: f32, opaque: bool| BvhInstance { opaque, ..BvhInstance::new(0, Affine3A::from_translation(Vec3::new(0.0, 0.0, z))) };
    let tlas = Tlas::build(vec![blas], vec![at(1.0, false), at(2.0, true), at(3.0, false)]).unwrap();
    let ray = Ray::new(Vec3::new(0.75, 0.25, 0.0), Vec3::Z);
    let mut asked = Vec::new();
    let refused = tlas.closest_hit(&ray, Filter::ALL, |hit| {
        asked.push(hit.instance);
        false
    });
    assert_eq!(refused.unwrap().instance, 1);
    assert!(asked.contains(&0) && !asked.contains(&1));
    assert_eq!(tlas.closest_hit(&ray, Filter::ALL, |_| true).unwrap().instance, 0);
    assert_eq!(tlas.closest_hit_opaque(&ray, Filter::ALL).unwrap().instance, 0);
    let before_the_opaque_one = Ray { t_max: 1.5, ..ray };
    assert!(!tlas.any_hit(&before_the_opaque_one, Filter::ALL, |_| false));
    assert!(tlas.any_hit(&before_the_opaque_one, Filter::ALL, |_| true));
    assert!(tlas.any_hit(&ray, Filter::ALL, |_| false));
}

#[test]
fn an_alpha_test_gives_the_same_hit_in_any_order_of_triangles() {
    let mesh = soup(3_000, 0.2, 14);
    let mut shuffled = mesh.clone();
    shuffled.indices.reverse();
    let world = |mesh: &TestMesh| {
        Tlas::build(vec![Arc::new(mesh.blas())], vec![BvhInstance { opaque: false, ..BvhInstance::new(0, Affine3A::IDENTITY) }]).unwrap()
    };
    let (forward, backward) = (world(&mesh), world(&shuffled));
    let checker = |u: f32, v: f32| ((u * 8.0) as i32 + (v * 8.0) as i32) % 2 == 0;
    let last = mesh.indices.len() as u32 - 1;
    let (mut hits, mut differs) = (0, 0);
    for ray in rays(10_000, 15) {
        let a = forward.closest_hit(&ray, Filter::ALL, |h| checker(h.u, h.v));
        let b =
            backward.closest_hit(&ray, Filter::ALL, |h| checker(h.u, h.v)).map(|h| kajo_bvh::Hit { primitive: last - h.primitive, ..h });
        same(a, b).unwrap();
        same(a, forward.closest_hit_brute_force(&ray, Filter::ALL, |h| checker(h.u, h.v))).unwrap();
        assert_eq!(a.is_some(), forward.any_hit(&ray, Filter::ALL, |h| checker(h.u, h.v)));
        hits += usize::from(a.is_some());
        differs += usize::from(a != forward.closest_hit_opaque(&ray, Filter::ALL));
    }
    assert!(hits > 3_000 && differs > 1_000, "{hits} {differs}");
}

#[test]
fn exclusion_hides_one_triangle_of_one_instance() {
    let blas = Arc::new(stack_of_squares(3).blas());
    let tlas = Tlas::build(vec![blas], vec![BvhInstance::new(0, Affine3A::IDENTITY); 2]).unwrap();
    let ray = Ray::new(Vec3::new(0.75, 0.25, -1.0), Vec3::Z);
    let exclude = |instance, primitive| Filter { exclude: Some(PrimitiveRef { instance, primitive }), ..Filter::ALL };
    assert_eq!(tlas.closest_hit_opaque(&ray, exclude(0, 0)).unwrap().primitive_ref(), PrimitiveRef { instance: 1, primitive: 0 });
    assert_eq!(tlas.closest_hit_opaque(&ray, exclude(1, 0)).unwrap().primitive_ref(), PrimitiveRef { instance: 0, primitive: 0 });
    assert_eq!(tlas.closest_hit_opaque(&ray, exclude(0, 2)).unwrap().primitive_ref(), PrimitiveRef { instance: 0, primitive: 0 });
}

#[test]
fn nothing_is_hit_where_there_is_nothing() {
    let ray = Ray::new(Vec3::ZERO, Vec3::Z);
    let empty_mesh = Arc::new(Blas::build(&[], &[], &BuildOptions::default()).unwrap());
    assert!(empty_mesh.bounds().is_empty() && empty_mesh.memory() == 0 && empty_mesh.sah_cost(1.0) == 0.0);
    let flat_mesh = Arc::new(Blas::build(&[Vec3::ONE; 3], &[[0, 1, 2]; 9], &BuildOptions::default()).unwrap());
    let dot = BvhInstance::new(1, Affine3A::IDENTITY);
    for instances in [vec![], vec![BvhInstance::new(0, Affine3A::IDENTITY)], vec![dot], vec![dot; 30]] {
        let tlas = Tlas::build(vec![empty_mesh.clone(), flat_mesh.clone()], instances).unwrap();
        tlas.validate().unwrap();
        assert_eq!(tlas.closest_hit_opaque(&ray, Filter::ALL), None);
        assert!(!tlas.any_hit_opaque(&Ray::new(Vec3::ZERO, Vec3::ONE), Filter::ALL));
    }
}

#[test]
fn unusable_rays_hit_nothing() {
    let tlas = Tlas::single(stack_of_squares(2).blas());
    let good = Ray::new(Vec3::new(0.5, 0.25, -1.0), Vec3::Z);
    assert!(tlas.any_hit_opaque(&good, Filter::ALL));
    for bad in [
        Ray { direction: Vec3::ZERO, ..good },
        Ray { direction: Vec3::new(0.0, f32::NAN, 1.0), ..good },
        Ray { direction: Vec3::new(0.0, 0.0, f32::INFINITY), ..good },
        Ray { origin: Vec3::new(f32::NAN, 0.25, -1.0), ..good },
        Ray { origin: Vec3::new(0.5, 0.25, f32::NEG_INFINITY), ..good },
        Ray { origin: Vec3::new(0.5, 0.25, -1e30), ..good },
        Ray { t_max: f32::NAN, ..good },
    ] {
        assert_eq!(tlas.closest_hit_opaque(&bad, Filter::ALL), None, "{bad:?}");
    }
}

#[test]
fn wrong_input_is_refused_with_its_place() {
    let build = |positions: &[Vec3], indices: &[[u32; 3]]| Blas::build(positions, indices, &BuildOptions::default()).map(|_| ());
    let good = [Vec3::ZERO, Vec3::X, Vec3::Y];
    assert_eq!(build(&good, &[[0, 1, 3]]), Err(BvhError::Index { triangle: 0, vertex: 3, vertices: 3 }));
    for bad in [f32::NAN, f32::INFINITY, -1e19] {
        let error = build(&[Vec3::ZERO, Vec3::X, Vec3::new(0.0, bad, 0.0)], &[[0, 1, 2]]).unwrap_err();
        assert!(matches!(error, BvhError::Position { vertex: 2, .. }), "{error}");
    }
    // A vertex that no triangle uses does not matter.
    build(&[Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::NAN], &[[0, 1, 2]]).unwrap();

    let blas = Arc::new(stack_of_squares(1).blas());
    let world = |instance: BvhInstance| Tlas::build(vec![blas.clone()], vec![instance]).map(|_| ());
    assert_eq!(world(BvhInstance::new(1, Affine3A::IDENTITY)), Err(BvhError::Blas { instance: 0, blas: 1, blases: 1 }));
    let translated = |x: f32| BvhInstance::new(0, Affine3A::from_translation(Vec3::new(x, 0.0, 0.0)));
    assert_eq!(world(translated(f32::NAN)), Err(BvhError::Transform { instance: 0 }));
    assert_eq!(world(translated(1e19)), Err(BvhError::Transform { instance: 0 }));
}

#[test]
fn singular_placements_are_left_out_and_listed() {
    let blas = Arc::new(stack_of_squares(1).blas());
    let scaled = |x: f32, y: f32, z: f32| BvhInstance::new(0, Affine3A::from_scale(Vec3::new(x, y, z)));
    let sheared = BvhInstance::new(0, Affine3A::from_mat3(Mat3A::from_cols(Vec3A::X, Vec3A::X, Vec3A::Z).into()));
    let tlas =
        Tlas::build(vec![blas], vec![scaled(1.0, 1.0, 0.0), scaled(1.0, 1.0, 1.0), scaled(0.0, 0.0, 0.0), sheared, scaled(1e-3, 1e3, 1.0)])
            .unwrap();
    assert_eq!(tlas.singular_instances(), [0, 2, 3]);
    assert_eq!(tlas.instance_count(), 5);
    let hit = tlas.closest_hit_opaque(&Ray::new(Vec3::new(0.75, 0.25, -1.0), Vec3::Z), Filter::ALL).unwrap();
    assert_eq!(hit.instance, 1);
}

#[test]
fn sizes_over_many_magnitudes_make_a_deep_tree_that_is_traced_right() {
    // Each triangle is twice as far and twice as large as the one before: every split cuts off one.
    let mut mesh = TestMesh::default();
    for i in 0..116 {
        let size = 2.0f32.powi(i - 58);
        let first = mesh.positions.len() as u32;
        mesh.positions.extend([Vec3::new(-1.0, -1.0, 1.0), Vec3::new(3.0, -1.0, 1.1), Vec3::new(-1.0, 3.0, 0.9)].map(|p| p * size));
        mesh.indices.extend([[first, first + 1, first + 2]; 3]);
    }
    let tlas = Tlas::single(mesh.blas());
    tlas.validate().unwrap();
    let mut random = Random::new(27);
    for _ in 0..300 {
        let scale = 2.0f32.powi((random.unit() * 110.0) as i32 - 55);
        let ray = Ray::new(random.cube() * scale, random.cube() + Vec3::Z);
        let expected = tlas.closest_hit_brute_force(&ray, Filter::ALL, |_| true);
        same(expected, tlas.closest_hit_opaque(&ray, Filter::ALL)).unwrap();
        assert_eq!(expected.map(|h| h.primitive % 3), expected.map(|_| 0), "the first of three equal triangles");
    }
}

#[test]
fn a_mesh_at_the_limit_of_coordinates_is_traced() {
    let mesh = stack_of_squares(1).map(|p| p * kajo_bvh::triangle::MAX_COORDINATE);
    let tlas = Tlas::single(mesh.blas());
    let ray = Ray::new(Vec3::new(0.75e18, 0.25e18, -1e18), Vec3::Z * 1e18);
    assert_eq!(tlas.closest_hit_opaque(&ray, Filter::ALL).map(|h| (h.t, h.primitive)), Some((1.0, 0)));
}

#[test]
fn any_thread_count_builds_the_same_tree() {
    let mesh = soup(30_000, 0.05, 16);
    let build = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| format!("{:?}", mesh.blas()))
    };
    let one = build(1);
    assert!(one == build(2) && one == build(5));
}

#[test]
fn sah_cost_of_known_trees() {
    assert_eq!(soup(1, 1.0, 1).blas().sah_cost(1.0), 1.0);
    // Two right triangles (box 1 × 1 × 0, half area 1) at z = 0 and z = 9; the box of both is 1 × 1 × 9, half area 19.
    let squares = stack_of_squares(10);
    let pair = TestMesh { indices: vec![squares.indices[0], squares.indices[18]], ..squares };
    let blas = Blas::build(
        &pair.positions,
        &pair.indices,
        &BuildOptions { sah: Sah { max_leaf_size: 1, ..Sah::default() }, ..BuildOptions::default() },
    )
    .unwrap();
    assert!((blas.sah_cost(3.0) - (3.0 + 2.0 / 19.0)).abs() < 1e-6, "{}", blas.sah_cost(3.0));
}

#[test]
fn memory_is_that_of_nodes_and_blocks() {
    let many = soup(10_000, 0.1, 1).blas();
    let per_triangle = many.memory() as f32 / 10_000.0;
    assert!(per_triangle > 40.0 && per_triangle < 160.0, "{per_triangle} bytes a triangle");
}

#[test]
fn counters_count_and_do_not_change_the_answer() {
    let tlas = Tlas::single(soup(10_000, 0.1, 1).blas());
    let mut total = Counters::default();
    for ray in rays(2_000, 17) {
        let mut counters = Counters::default();
        let counted = tlas.closest_hit_counted(&ray, Filter::ALL, |_| true, &mut counters);
        same(tlas.closest_hit_opaque(&ray, Filter::ALL), counted).unwrap();
        assert_eq!(counters.boxes, 8 * counters.nodes);
        assert!(counted.is_none() || (counters.nodes > 0 && counters.triangles > 0 && counters.instances == 1));
        total.nodes += counters.nodes;
        total.triangles += counters.triangles;
    }
    assert!(total.nodes > 2_000 && total.triangles < 2_000 * 500, "{total:?}");
}

/// Points on a coarse grid, anywhere, tiny or huge: degenerate triangles, duplicates and exact edge hits are common.
fn point() -> impl Strategy<Value = Vec3> {
    prop_oneof![
        4 => [-2i8..=2, -2i8..=2, -2i8..=2].prop_map(|p| Vec3::from_array(p.map(f32::from))),
        2 => [-1f32..1.0, -1f32..1.0, -1f32..1.0].prop_map(Vec3::from_array),
        1 => [-1e-6f32..1e-6, -1e-6f32..1e-6, -1e-6f32..1e-6].prop_map(Vec3::from_array),
        1 => [-1e9f32..1e9, -1e9f32..1e9, -1e9f32..1e9].prop_map(Vec3::from_array),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1_500))]

    #[test]
    fn any_soup_equals_brute_force(
        positions in prop::collection::vec(point(), 3..60),
        picks in prop::collection::vec(prop::array::uniform3(any::<prop::sample::Index>()), 0..120),
        origins in prop::collection::vec((point(), point()), 12),
        shift in point(),
        scale in [0.001f32..100.0, -100f32..-0.001, 0.5f32..2.0],
        options in (2usize..40, 0usize..50, 0f32..4.0),
        quality in prop::sample::select(BuildQuality::ALL.to_vec()),
        low_memory in prop::bool::weighted(0.2),
    ) {
        let indices: Vec<[u32; 3]> = picks.iter().map(|p| p.map(|i| i.index(positions.len()) as u32)).collect();
        let sah = Sah { bins: options.0, max_leaf_size: options.1, node_cost: options.2 };
        let options = BuildOptions { sah, quality, low_memory, ..BuildOptions::default() };
        let blas = Arc::new(Blas::build(&positions, &indices, &options).unwrap());
        let placed = Affine3A::from_translation(shift) * Affine3A::from_scale(Vec3::from_array(scale));
        let instances = vec![BvhInstance::new(0, placed), BvhInstance::new(0, Affine3A::IDENTITY), BvhInstance::new(0, placed.inverse())];
        let tlas = Tlas::build(vec![blas], instances).unwrap();
        prop_assert!(tlas.validate().is_ok(), "{:?}", tlas.validate());
        let flat = FlatBvh::new(&tlas);
        let portable = tlas.clone().with_backend(kajo_bvh::Backend::Portable);
        for &(origin, target) in &origins {
            let ray = Ray::new(origin, target - origin);
            let expected = tlas.closest_hit_brute_force(&ray, Filter::ALL, |_| true);
            for got in [
                tlas.closest_hit_opaque(&ray, Filter::ALL),
                portable.closest_hit_opaque(&ray, Filter::ALL),
                flat.closest_hit(&ray, Filter::ALL, |_| true),
            ] {
                prop_assert!(same(expected, got).is_ok(), "{ray:?}: {}", same(expected, got).unwrap_err());
            }
            prop_assert_eq!(expected.is_some(), tlas.any_hit_opaque(&ray, Filter::ALL));
        }
    }
}

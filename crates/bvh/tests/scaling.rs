//! T-03 to T-05 and A-02 at their full numbers: equal to brute force, cheaper any-hit, logarithmic growth, instances as one mesh.

mod common;

use common::*;
use glam::{Affine3A, Quat, Vec3};
use kajo_bvh::{BvhInstance, Counters, Filter, Ray, Tlas, gpu::FlatBvh};
use rayon::prelude::*;
use std::sync::Arc;

#[test]
fn ten_thousand_triangles_and_a_hundred_thousand_rays_equal_brute_force() {
    let tlas = Tlas::single(soup(10_000, 0.1, 1).blas());
    let hits: usize = rays(100_000, 19)
        .par_iter()
        .map(|ray| {
            let expected = tlas.closest_hit_brute_force(ray, Filter::ALL, |_| true);
            same(expected, tlas.closest_hit_opaque(ray, Filter::ALL)).unwrap();
            usize::from(expected.is_some())
        })
        .sum();
    assert!(hits > 30_000, "{hits}");
}

#[test]
fn any_hit_is_whether_there_is_a_closest_hit_with_less_work() {
    let tlas = Tlas::single(soup(10_000, 0.1, 1).blas());
    let (mut closest, mut any) = (Counters::default(), Counters::default());
    for ray in rays(100_000, 20) {
        let exists = tlas.closest_hit_counted(&ray, Filter::ALL, |_| true, &mut closest).is_some();
        assert_eq!(exists, tlas.any_hit_counted(&ray, Filter::ALL, |_| true, &mut any));
        assert_eq!(exists, tlas.any_hit_opaque(&ray, Filter::ALL));
    }
    assert!(any.nodes < closest.nodes, "{any:?} {closest:?}");
}

#[test]
fn work_grows_with_the_logarithm_of_the_triangles() {
    let visits = |around: u32, along: u32| {
        let tlas = Tlas::single(torus(around, along).blas());
        let mut counters = Counters::default();
        let mut random = Random::new(21);
        for _ in 0..20_000 {
            let origin = random.sphere() * 4.0;
            let ray = Ray::new(origin, random.cube() - origin);
            tlas.closest_hit_counted(&ray, Filter::ALL, |_| true, &mut counters);
        }
        (tlas.blases()[0].triangle_count(), counters.nodes as f64 / 20_000.0)
    };
    let (small, few) = visits(20, 25);
    let (large, many) = visits(500, 1000);
    assert_eq!((small, large), (1_000, 1_000_000));
    assert!(many < 4.0 * few, "{few} nodes at {small}, {many} at {large}");
}

#[test]
fn a_thousand_instances_equal_the_flattened_mesh() {
    // Cubes of powers of two, turned by quarters and placed on a grid: transforms are exact, so the flattened mesh is the same geometry.
    let mesh = soup(40, 0.5, 22).map(|p| (p * 256.0).round() / 256.0);
    let mut random = Random::new(23);
    let mut flattened = TestMesh::default();
    let instances: Vec<BvhInstance> = (0..1000)
        .map(|i| {
            let quarter = glam::Mat3::from_cols(Vec3::Y, Vec3::NEG_X, Vec3::Z);
            let turn = [glam::Mat3::IDENTITY, quarter, quarter * quarter][i % 3];
            let scale = Vec3::new([0.5, 1.0, 2.0][i % 3], 1.0, if i % 2 == 0 { 1.0 } else { -1.0 });
            let place = Vec3::new((i % 10) as f32, (i / 10 % 10) as f32, (i / 100) as f32) * 4.0;
            let placement = Affine3A::from_mat3_translation(turn * glam::Mat3::from_diagonal(scale), place);
            let first = flattened.positions.len() as u32;
            flattened.positions.extend(mesh.positions.iter().map(|&p| placement.transform_point3(p)));
            flattened.indices.extend(mesh.indices.iter().map(|t| t.map(|v| v + first)));
            BvhInstance::new(0, placement)
        })
        .collect();
    let blas = Arc::new(mesh.blas());
    let placed = Tlas::build(vec![blas.clone()], instances.clone()).unwrap();
    let flat = Tlas::single(flattened.blas());
    let gpu = FlatBvh::new(&placed);
    let (mut hits, mut tied) = (0, 0);
    for number in 0..100_000 {
        let origin = random.cube() * 60.0;
        let ray = Ray::new(origin, (Vec3::splat(18.0) + random.cube() * 20.0 - origin) * (0.02 + random.unit()));
        let one = flat.closest_hit_opaque(&ray, Filter::ALL);
        let two = placed.closest_hit_opaque(&ray, Filter::ALL);
        if number % 10 == 0 {
            same(two, gpu.closest_hit(&ray, Filter::ALL, |_| true)).unwrap();
        }
        match (one, two) {
            (None, None) => {}
            (Some(a), Some(b)) => {
                hits += 1;
                assert!((a.t - b.t).abs() <= 1e-5 * a.t, "{a:?} {b:?}");
                // The same triangle, unless two lie within rounding of each other.
                if a.primitive != b.instance * 40 + b.primitive {
                    tied += 1;
                }
            }
            _ => panic!("{one:?} {two:?}"),
        }
    }
    assert!(hits > 50_000 && tied <= 2, "{hits} {tied}");
    let one_less = Tlas::build(vec![blas], instances[1..].to_vec()).unwrap();
    let per_instance = placed.memory() - one_less.memory();
    assert!(per_instance <= 512, "an instance costs {per_instance} bytes, a mesh {}", placed.blases()[0].memory());
}

#[test]
fn turned_and_stretched_instances_equal_the_flattened_mesh_within_rounding() {
    let mesh = soup(200, 0.4, 24);
    let placement = Affine3A::from_scale_rotation_translation(
        Vec3::new(-2.0, 0.3, 5.0),
        Quat::from_axis_angle(Vec3::new(1.0, -1.0, 0.5).normalize(), 2.0),
        Vec3::new(10.0, -20.0, 5.0),
    );
    let placed = Tlas::build(vec![Arc::new(mesh.blas())], vec![BvhInstance::new(0, placement)]).unwrap();
    let flat = Tlas::single(mesh.map(|p| placement.transform_point3(p)).blas());
    let mut random = Random::new(25);
    let (mut hits, mut differ) = (0, 0);
    for _ in 0..100_000 {
        let target = placement.transform_point3(random.cube());
        let origin = Vec3::new(10.0, -20.0, 5.0) + random.sphere() * 12.0;
        let ray = Ray::new(origin, target - origin);
        let pair = (flat.closest_hit_opaque(&ray, Filter::ALL), placed.closest_hit_opaque(&ray, Filter::ALL));
        match pair {
            (None, None) => {}
            (Some(a), Some(b)) if a.primitive == b.primitive && (a.t - b.t).abs() < 1e-4 => hits += 1,
            _ => differ += 1,
        }
    }
    // Rays that graze a silhouette within rounding may fall to either side.
    assert!(hits > 50_000 && differ < 20, "{hits} {differ}");
}

#[test]
fn the_bunny_is_valid_and_flat_arrays_agree_on_it() {
    let root = std::env::var_os("KAJO_ASSETS")
        .map_or_else(|| std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/assets"), std::path::PathBuf::from);
    let Some(path) = std::fs::read_dir(root.join("bunny"))
        .ok()
        .and_then(|dir| dir.flatten().map(|entry| entry.path()).find(|path| path.extension().is_some_and(|e| e == "obj")))
    else {
        println!("skipped: needs bunny/*.obj in $KAJO_ASSETS ({})", root.display());
        return;
    };
    let (models, _) = tobj::load_obj(&path, &tobj::LoadOptions { triangulate: true, single_index: true, ..Default::default() }).unwrap();
    let mesh = TestMesh {
        positions: models[0].mesh.positions.as_chunks::<3>().0.iter().map(|&p| Vec3::from_array(p)).collect(),
        indices: models[0].mesh.indices.as_chunks::<3>().0.to_vec(),
    };
    let tlas = Tlas::single(mesh.blas());
    tlas.validate().unwrap();
    let flat = FlatBvh::new(&tlas);
    let bounds = tlas.bounds();
    let (center, size) = ((bounds.min + bounds.max) / 2.0, (bounds.max - bounds.min).length());
    let mut random = Random::new(26);
    let mut hits = 0;
    for number in 0..20_000 {
        let origin = center + random.sphere() * size;
        let ray = Ray::new(origin, center + random.cube() * 0.3 * size - origin);
        let hit = tlas.closest_hit_opaque(&ray, Filter::ALL);
        if number % 100 == 0 {
            same(tlas.closest_hit_brute_force(&ray, Filter::ALL, |_| true), hit).unwrap();
        }
        same(hit, flat.closest_hit(&ray, Filter::ALL, |_| true)).unwrap();
        hits += usize::from(hit.is_some());
    }
    assert!(hits > 8_000, "{hits}");
}

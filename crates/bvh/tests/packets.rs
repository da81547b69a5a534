//! Many rays at once give what each gives alone, bit for bit, on every backend.

mod common;

use common::*;
use glam::{Affine3A, Quat, Vec3};
use kajo_bvh::{BvhInstance, Filter, Hit, Ray, Tlas};
use std::sync::Arc;

/// Rows of pixels from points around the origin that look at it: alike in the middle of a row, less so where signs change. Some start or end in the middle.
fn camera_rays(views: usize, side: usize, size: f32, seed: u64) -> Vec<Ray> {
    let mut random = Random::new(seed);
    let mut rays = Vec::new();
    for view in 0..views {
        let eye = random.sphere() * size * 3.0;
        let forward = -eye.normalize();
        let right = forward.any_orthonormal_vector();
        let up = right.cross(forward);
        for y in 0..side {
            for x in 0..side {
                let [a, b] = [x, y].map(|i| 0.4 * ((i as f32 + 0.5) / side as f32 - 0.5));
                // Directions of any length, as shadow rays have them.
                let direction = (forward + a * right + b * up) * if view % 2 == 0 { 1.0 } else { size };
                let ray = Ray::new(eye, direction);
                let bounds = match view % 3 {
                    0 => (0.0, f32::INFINITY),
                    1 => (2.0 / direction.length(), f32::INFINITY),
                    _ => (0.0, 3.0 * size / direction.length()),
                };
                rays.push(Ray { t_min: bounds.0, t_max: bounds.1, ..ray });
            }
        }
    }
    rays
}

/// What is asked of hits on surfaces that are not opaque: depends on the ray too.
fn accepts(ray: usize, hit: &Hit) -> bool {
    !(hit.primitive as usize + ray).is_multiple_of(3)
}

/// Compares all rays with the loop over all triangles; gives the number of hits.
fn check(tlas: &Tlas, rays: &[Ray], filter: Filter) -> usize {
    let (mut hits, mut any) = (vec![None; rays.len()], vec![false; rays.len()]);
    tlas.closest_hits(rays, filter, accepts, &mut hits);
    tlas.any_hits(rays, filter, accepts, &mut any);
    for (i, ray) in rays.iter().enumerate() {
        let expected = tlas.closest_hit_brute_force(ray, filter, |hit| accepts(i, hit));
        same(expected, hits[i]).unwrap_or_else(|difference| panic!("ray {i} {ray:?}: {difference}"));
        assert_eq!(expected.is_some(), any[i], "ray {i} {ray:?}");
    }
    hits.iter().flatten().count()
}

#[test]
fn rows_of_pixels_equal_brute_force_bit_for_bit() {
    let plain = Tlas::single(soup(2_000, 0.2, 1).blas());
    // 61 is no multiple of a packet: rows and packets do not line up, and some rays are left over.
    let rays = camera_rays(6, 61, 1.0, 2);
    for backend in backends() {
        let hits = check(&plain.clone().with_backend(backend), &rays, Filter::ALL);
        assert!(hits > rays.len() / 10 && hits < rays.len(), "{hits} hits: the rays test nothing");
    }
}

#[test]
fn neighbours_may_start_and_end_anywhere() {
    let plain = Tlas::single(soup(2_000, 0.2, 26).blas());
    let (mut rays, mut random) = (camera_rays(3, 48, 1.0, 27), Random::new(28));
    for ray in &mut rays {
        let length = ray.direction.length();
        let (a, b) = (random.unit() * 4.0 / length, random.unit() * 4.0 / length);
        (ray.t_min, ray.t_max) = (a.min(b), a.max(b));
    }
    for backend in backends() {
        assert!(check(&plain.clone().with_backend(backend), &rays, Filter::ALL) > 500);
    }
}

#[test]
fn rays_without_order_equal_brute_force_bit_for_bit() {
    let plain = Tlas::single(soup(2_000, 0.2, 3).blas());
    let rays = rays(1_500, 4);
    for backend in backends() {
        assert!(check(&plain.clone().with_backend(backend), &rays, Filter::ALL) > 300);
    }
}

/// Coplanar triangles that share edges and vertices, and each of them twice: rays through vertices, and ties.
#[test]
fn ties_and_edges_are_decided_as_alone() {
    let mut mesh = TestMesh::default();
    for (x, y) in (0..8).flat_map(|x| (0..8).map(move |y| (x as f32, y as f32))) {
        let first = mesh.positions.len() as u32;
        mesh.positions.extend([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(a, b)| Vec3::new(x + a - 4.0, y + b - 4.0, 0.0)));
        mesh.indices.extend([[0, 1, 2], [0, 2, 3], [0, 1, 2]].map(|t| t.map(|v| v + first)));
    }
    // Every fourth ray meets a vertex, many an edge or a diagonal.
    let rays: Vec<Ray> = (0..33 * 33)
        .map(|i| Ray::new(Vec3::new((i % 33) as f32 * 0.25 - 4.0, (i / 33) as f32 * 0.25 - 4.0, 5.0), Vec3::new(0.0, 0.0, -1.0)))
        .collect();
    for backend in backends() {
        let tlas = Tlas::single(mesh.blas()).with_backend(backend);
        assert!(check(&tlas, &rays, Filter::ALL) > 900);
    }
}

#[test]
fn placed_masked_and_transparent_instances_equal_brute_force() {
    let mut random = Random::new(5);
    let mesh = Arc::new(soup(60, 0.5, 6).blas());
    let instances = (0..40)
        .map(|i| {
            let turn = Quat::from_axis_angle(random.sphere(), random.unit() * 6.0);
            let scale = Vec3::splat(0.5 + random.unit()) * if i % 2 == 1 { -1.0 } else { 1.0 };
            let placed = Affine3A::from_scale_rotation_translation(scale, turn, random.cube() * 5.0);
            let world_from_object = if i % 5 == 0 { Affine3A::IDENTITY } else { placed };
            BvhInstance { mask: 1 << (i % 3), opaque: i % 4 != 0, ..BvhInstance::new(0, world_from_object) }
        })
        .collect();
    let plain = Tlas::build(vec![mesh], instances).unwrap();
    let mut rays = camera_rays(4, 40, 5.0, 7);
    // By turns, in and out of instances.
    rays.extend(common::rays(1_000, 8).into_iter().map(|ray| Ray { origin: ray.origin * 5.0, ..ray }));
    let exclude = plain.closest_hit_opaque(&rays[800], Filter::ALL).map(|hit| hit.primitive_ref());
    assert!(exclude.is_some());
    for backend in backends() {
        let tlas = plain.clone().with_backend(backend);
        let all = check(&tlas, &rays, Filter::ALL);
        let some = check(&tlas, &rays, Filter { mask: 0b101, exclude });
        assert!(some > 500 && some < all, "{some} of {all}");
    }
}

/// Where boxes end: rays that are alike through vertices, edges and corners of a closed mesh, which their rounded boxes must not lose.
#[test]
fn vertices_and_edges_are_met_through_the_margins_of_boxes() {
    let mesh = sphere(4);
    let mut random = Random::new(25);
    let mut rays = Vec::new();
    for view in 0..12 {
        let eye = random.sphere() * [1.5, 30.0, 1000.0][view % 3];
        for first in (0..mesh.indices.len()).step_by(16) {
            // Neighbours stand beside each other in the list.
            rays.extend((0..16).map(|i| {
                let [a, b, c] = mesh.triangle(first + i / 2);
                Ray::new(eye, [a, b, c, a.midpoint(b)][(i + view) % 4] - eye)
            }));
        }
    }
    for backend in backends() {
        let hits = check(&Tlas::single(mesh.blas()).with_backend(backend), &rays, Filter::ALL);
        assert!(hits > rays.len() / 2, "{hits} of {}", rays.len());
    }
}

/// A ray that hits nothing, among others that are alike, takes nothing from them.
#[test]
fn rays_that_are_none_do_not_disturb_their_neighbours() {
    let plain = Tlas::single(soup(2_000, 0.2, 11).blas());
    let mut rays = camera_rays(3, 32, 1.0, 12);
    for (i, ray) in rays.iter_mut().enumerate().filter(|(i, _)| i % 16 == i / 16 % 16) {
        match i / 256 % 4 {
            0 => ray.t_max = f32::NAN,
            1 => ray.t_min = f32::NAN,
            2 => (ray.t_min, ray.t_max) = (f32::INFINITY, 0.0),
            _ => ray.direction = Vec3::ZERO,
        }
    }
    for backend in backends() {
        assert!(check(&plain.clone().with_backend(backend), &rays, Filter::ALL) > 300);
    }
}

/// Short directions make distances so large that boxes cannot be told apart, those of places without a child among them. Few triangles leave such places.
#[test]
fn directions_of_any_length_equal_brute_force() {
    for triangles in [1, 5, 11, 40, 300] {
        let mesh = Arc::new(soup(triangles, 1.0, 13).blas());
        let placed =
            BvhInstance::new(0, Affine3A::from_scale_rotation_translation(Vec3::splat(0.5), Quat::from_rotation_y(1.0), Vec3::ONE));
        let world = Tlas::build(vec![mesh], vec![BvhInstance::new(0, Affine3A::IDENTITY), placed]).unwrap();
        let lengths = [1e-44f32, 1e-38, 1e-37, 1e-36, 1e-30, 1e30, 1e37];
        for (plain, length) in
            [Tlas::single(soup(triangles, 1.0, 13).blas()), world].iter().flat_map(|world| lengths.map(|length| (world, length)))
        {
            let mut rays = camera_rays(2, 16, 1.0, 14);
            rays.extend(common::rays(200, 15));
            for (i, ray) in rays.iter_mut().enumerate() {
                // Some with a usual one between them.
                ray.direction = ray.direction.normalize() * if i % 7 == 3 { 1.0 } else { length };
                (ray.t_min, ray.t_max) = (0.0, if i % 2 == 0 { f32::MAX } else { f32::INFINITY });
            }
            for backend in backends() {
                let tlas = plain.clone().with_backend(backend);
                check(&tlas, &rays, Filter::ALL);
                for (i, ray) in rays.iter().enumerate() {
                    let expected = tlas.closest_hit_brute_force(ray, Filter::ALL, |hit| accepts(i, hit));
                    same(expected, tlas.closest_hit(ray, Filter::ALL, |hit| accepts(i, hit)))
                        .unwrap_or_else(|difference| panic!("{ray:?}: {difference}"));
                }
            }
        }
    }
}

/// Long directions make distances so small that they lose their digits, and large instances make directions so short that they do.
#[test]
fn scenes_and_directions_of_any_size_equal_brute_force() {
    let turn = |random: &mut Random| Quat::from_axis_angle(random.sphere(), random.unit() * 6.0);
    // Size of the mesh, of its instances, and length of the directions.
    for (size, scale, length) in [
        (1e-10, 1.0, 1e34f32),
        (1e-10, 1.0, 1e35),
        (1e-20, 1.0, 1e24),
        (1e-20, 1.0, 1e25),
        (1.0, 1.0, 3e38),
        (1e-10, 1e10, 1e-34),
        (1e-10, 1e10, 1e-35),
        (1e-24, 1e24, 1e-20),
        (1e-28, 1e28, 1.0),
        (1e17, 1e-17, 1e20),
    ] {
        let mesh = soup(300, 0.3, 16).map(|p| p * size);
        let mut random = Random::new(17);
        let instances = (0..if scale == 1.0 { 1 } else { 20 })
            .map(|_| {
                let placed = Affine3A::from_scale_rotation_translation(Vec3::splat(scale), turn(&mut random), random.cube() * 3.0);
                BvhInstance::new(0, if scale == 1.0 { Affine3A::IDENTITY } else { placed })
            })
            .collect();
        let plain = Tlas::build(vec![Arc::new(mesh.blas())], instances).unwrap();
        let world = if scale == 1.0 { size } else { 3.0 };
        let mut rays = camera_rays(1, 16, 1.0, 18);
        rays.extend(common::rays(600, 19));
        for ray in &mut rays {
            (ray.origin, ray.direction) = (ray.origin * world, ray.direction.normalize() * length);
            (ray.t_min, ray.t_max) = (0.0, f32::INFINITY);
        }
        for backend in backends() {
            let tlas = plain.clone().with_backend(backend);
            check(&tlas, &rays, Filter::ALL);
            for (i, ray) in rays.iter().enumerate() {
                let expected = tlas.closest_hit_brute_force(ray, Filter::ALL, |hit| accepts(i, hit));
                same(expected, tlas.closest_hit(ray, Filter::ALL, |hit| accepts(i, hit)))
                    .unwrap_or_else(|difference| panic!("{size} {scale} {ray:?}: {difference}"));
            }
        }
    }
}

#[test]
fn a_single_instance_is_hidden_by_its_mask_from_all() {
    let instance = BvhInstance { mask: 0b01, ..BvhInstance::new(0, Affine3A::IDENTITY) };
    let plain = Tlas::build(vec![Arc::new(soup(500, 0.3, 20).blas())], vec![instance]).unwrap();
    let mut rays = camera_rays(1, 32, 1.0, 21);
    rays.extend(common::rays(500, 22));
    for backend in backends() {
        let tlas = plain.clone().with_backend(backend);
        assert_eq!(check(&tlas, &rays, Filter { mask: 0b10, exclude: None }), 0);
        assert!(check(&tlas, &rays, Filter { mask: 0b11, exclude: None }) > 300);
    }
}

/// Threads of Rust have 2 MiB; rays in flight take 300 KiB of it.
#[test]
fn a_batch_fits_into_a_small_thread() {
    let tlas = Tlas::single(soup(500, 0.3, 23).blas());
    for backend in backends() {
        let tlas = tlas.clone().with_backend(backend);
        let small = std::thread::Builder::new().stack_size(512 << 10);
        let thread = small.spawn(move || {
            let rays = rays(500, 24);
            let mut hits = vec![None; rays.len()];
            tlas.closest_hits(&rays, Filter::ALL, |_, _| true, &mut hits);
            hits.iter().flatten().count()
        });
        assert!(thread.unwrap().join().unwrap() > 100);
    }
}

#[test]
fn no_rays_and_no_triangles_are_no_hits() {
    let empty = Tlas::build(vec![], vec![]).unwrap();
    let rays = camera_rays(1, 8, 1.0, 8);
    assert_eq!(check(&empty, &rays, Filter::ALL), 0);
    assert_eq!(check(&Tlas::single(soup(50, 0.5, 9).blas()), &[], Filter::ALL), 0);
}

//! T-01, T-02: rays leave surfaces without meeting them again, and closed surfaces have no cracks and no seams counted twice.

mod common;

use common::*;
use glam::{Affine3A, Quat, Vec3};
use kajo_bvh::{BvhInstance, Filter, Ray, SurfacePoint, Tlas};
use rayon::prelude::*;
use std::sync::Arc;

/// A ray through a closed mesh, aimed where cracks are: at vertices, at points of edges, or anywhere.
fn aimed(mesh: &TestMesh, number: u64) -> Ray {
    let mut random = Random::new(number);
    let triangle = mesh.triangle(random.bits() as usize % mesh.indices.len());
    let target = match number % 4 {
        0 => triangle[0],
        1 => triangle[0].lerp(triangle[1], random.unit()),
        2 => triangle[1].midpoint(triangle[2]),
        _ => random.sphere() * 0.99,
    };
    let origin = random.sphere() * 3.0;
    // Every other ray starts at a vertex's coordinates moved along an axis: it meets vertices and edges exactly.
    let origin = if (number / 4).is_multiple_of(2) { origin } else { target + [Vec3::X, Vec3::Y, Vec3::Z][number as usize / 8 % 3] * 4.0 };
    Ray::new(origin, target - origin)
}

#[test]
fn a_closed_mesh_has_no_cracks_from_inside() {
    let mesh = sphere(4);
    let tlas = Tlas::single(mesh.blas());
    let missed = (0..1_000_000u64)
        .into_par_iter()
        .filter(|&number| {
            let ray = aimed(&mesh, number);
            let mut random = Random::new(!number);
            let from_inside = Ray { origin: random.cube() * 0.3, direction: ray.at(1.0) - ray.origin, ..ray };
            let to_vertex = Ray { direction: ray.at(1.0) - from_inside.origin, ..from_inside };
            let ray = if number.is_multiple_of(2) { from_inside } else { to_vertex };
            tlas.closest_hit_opaque(&ray, Filter::ALL).is_none()
        })
        .count();
    assert_eq!(missed, 0, "of a million rays");
}

#[test]
fn a_ray_crosses_a_convex_closed_mesh_twice_or_never() {
    let mesh = sphere(3);
    // Not opaque: a callback that refuses every hit is shown all of them.
    let shown = BvhInstance { opaque: false, ..BvhInstance::new(0, Affine3A::IDENTITY) };
    let tlas = Tlas::build(vec![Arc::new(mesh.blas())], vec![shown]).unwrap();
    let counts: Vec<usize> = (0..1_000_000u64)
        .into_par_iter()
        .map(|number| {
            let mut hits = 0;
            tlas.closest_hit(&aimed(&mesh, number), Filter::ALL, |_| {
                hits += 1;
                false
            });
            hits
        })
        .collect();
    let odd = counts.iter().filter(|&&n| n != 0 && n != 2).count();
    assert_eq!(odd, 0, "of a million rays; {:?}", counts.iter().position(|&n| n != 0 && n != 2).map(|i| (i, counts[i])));
    let through = counts.iter().filter(|&&n| n == 2).count();
    assert!(through > 700_000, "{through}");
}

/// Rays from random points of a mesh placed in the world; returns how often they meet the triangle they start on.
fn self_hits(mesh: &TestMesh, placement: Affine3A, rays: u64, offset: bool) -> usize {
    let tlas = Tlas::build(vec![Arc::new(mesh.blas())], vec![BvhInstance::new(0, placement)]).unwrap();
    (0..rays)
        .into_par_iter()
        .filter(|&number| {
            let mut random = Random::new(number);
            let primitive = random.bits() as usize % mesh.indices.len();
            let (a, b) = (random.unit(), random.unit());
            let (u, v) = if a + b > 1.0 { (1.0 - a, 1.0 - b) } else { (a, b) };
            let point = SurfacePoint::new(&placement, mesh.triangle(primitive), u, v);
            let mut direction = random.sphere();
            if number.is_multiple_of(3) {
                // Grazing.
                let flat = direction - point.geometric_normal * direction.dot(point.geometric_normal);
                direction = flat + point.geometric_normal * (random.unit() * 2.0 - 1.0) * 1e-3;
            }
            let origin = if offset { point.ray_origin(direction) } else { point.position };
            let ray = Ray::new(origin, direction);
            let nearest = tlas.closest_hit_opaque(&ray, Filter::ALL);
            nearest.is_some_and(|hit| hit.primitive == primitive as u32)
        })
        .count()
}

#[test]
fn rays_that_leave_a_surface_do_not_meet_it_again_at_any_scale() {
    let meshes = [sphere(2), soup(2_000, 0.3, 18)];
    let scales = [1e-3, 1e-1, 1.0, 1e3, 1e5];
    for (m, mesh) in meshes.iter().enumerate() {
        for scale in scales {
            // In the mesh itself, and far from the origin; then by the instance's transform.
            for (mesh, placement) in [
                (mesh.map(|p| p * scale), Affine3A::IDENTITY),
                (mesh.map(|p| (p + Vec3::new(30.0, -7.0, 2.0)) * scale), Affine3A::IDENTITY),
                (
                    mesh.clone(),
                    Affine3A::from_scale_rotation_translation(
                        Vec3::new(1.0, 2.0, -0.5) * scale,
                        Quat::from_axis_angle(Vec3::new(1.0, 2.0, 3.0).normalize(), 1.0),
                        Vec3::new(3.0, 50.0, -20.0) * scale,
                    ),
                ),
            ] {
                assert_eq!(self_hits(&mesh, placement, 35_000, true), 0, "mesh {m}, scale {scale}, {placement:?}");
            }
        }
    }
}

#[test]
fn without_the_offset_rays_do_meet_their_surface_again() {
    assert!(self_hits(&sphere(2), Affine3A::IDENTITY, 20_000, false) > 1_000);
}

#[test]
fn the_offset_stays_small() {
    let mesh = sphere(2);
    for number in 0..mesh.indices.len() {
        let point = SurfacePoint::new(&Affine3A::IDENTITY, mesh.triangle(number), 0.3, 0.3);
        assert!((point.ray_origin(point.geometric_normal) - point.position).length() < 1e-5);
        assert!(point.geometric_normal.dot(point.position) > 0.9);
        let mirrored = SurfacePoint::new(&Affine3A::from_scale(Vec3::new(-1.0, 1.0, 1.0)), mesh.triangle(number), 0.3, 0.3);
        assert!(mirrored.geometric_normal.dot(mirrored.position) > 0.9, "a mirrored instance keeps its front faces");
    }
}

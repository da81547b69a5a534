//! Builds over any triangles and traces any rays. The input is a byte of options, a byte that tells how many rays there are, rays of seven numbers and
//! triangles of nine, little-endian f32 as they stand: what is no number must be refused, anything else must be hit as by the loop over all triangles,
//! one ray at a time and many, in the hierarchy and in its arrays for GPUs.
#![no_main]

use glam::{Affine3A, Quat, Vec3};
use kajo_bvh::gpu::FlatBvh;
use kajo_bvh::{Blas, BuildOptions, BuildQuality, BvhInstance, Filter, Geometry, Hit, Ray, Tlas};
use libfuzzer_sys::fuzz_target;
use std::sync::Arc;

fuzz_target!(|data: &[u8]| {
    let [choice, rays, rest @ ..] = data else { return };
    let numbers: Vec<f32> = rest.as_chunks::<4>().0.iter().map(|&bytes| f32::from_le_bytes(bytes)).collect();
    let (rays, triangles) = numbers.split_at((7 * usize::from(rays % 32)).min(numbers.len()));
    let positions: Vec<Vec3> = triangles.as_chunks::<3>().0.iter().map(|&p| Vec3::from_array(p)).collect();
    let indices: Vec<[u32; 3]> = (0..positions.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let options = BuildOptions {
        quality: BuildQuality::ALL[usize::from(choice % 3)],
        allow_update: choice & 4 != 0,
        low_memory: choice & 8 != 0,
        ..BuildOptions::default()
    };
    let built = Blas::build(&positions, &indices, &options);
    let used = &positions[..3 * indices.len()];
    assert_eq!(built.is_ok(), used.iter().all(|p| p.abs().cmple(Vec3::splat(1e18)).all()));
    let Ok(mut blas) = built else { return };
    if options.allow_update {
        blas.update(&Geometry::triangles(&positions, &indices)).expect("it was allowed");
    }
    let in_place = BvhInstance { opaque: choice & 16 != 0, ..BvhInstance::new(0, Affine3A::IDENTITY) };
    let turned = Affine3A::from_scale_rotation_translation(Vec3::new(-0.5, 2.0, 1.0), Quat::from_rotation_z(0.7), Vec3::new(0.25, 0.0, -1.0));
    let instances = if choice & 32 == 0 { vec![in_place] } else { vec![BvhInstance::new(0, turned), in_place] };
    // At the limit of coordinates there is no room for a larger instance.
    let Ok(tlas) = Tlas::build(vec![Arc::new(blas)], instances) else { return assert!(choice & 32 != 0) };
    tlas.validate().expect("a valid tree");
    let flat = FlatBvh::new(&tlas);

    let number = |hit: &Hit| (hit.t.to_bits(), hit.u.to_bits(), hit.v.to_bits(), hit.primitive, hit.instance);
    let accept = |hit: &Hit| hit.primitive % 3 != 1;
    let rays: Vec<Ray> = rays
        .as_chunks::<7>()
        .0
        .iter()
        .map(|n| Ray { origin: Vec3::new(n[0], n[1], n[2]), t_min: 0.0, direction: Vec3::new(n[3], n[4], n[5]), t_max: n[6] })
        .collect();
    let (mut together, mut any) = (vec![None; rays.len()], vec![false; rays.len()]);
    tlas.closest_hits(&rays, Filter::ALL, |_, hit| accept(hit), &mut together);
    tlas.any_hits(&rays, Filter::ALL, |_, hit| accept(hit), &mut any);
    for ((ray, together), any) in rays.iter().zip(together).zip(any) {
        let expected = tlas.closest_hit_brute_force(ray, Filter::ALL, accept);
        let alone = tlas.closest_hit(ray, Filter::ALL, accept);
        assert_eq!(expected.as_ref().map(number), alone.as_ref().map(number), "{ray:?}");
        assert_eq!(expected.as_ref().map(number), together.as_ref().map(number), "{ray:?}");
        let flat = flat.closest_hit(ray, Filter::ALL, accept);
        assert_eq!(expected.as_ref().map(number), flat.as_ref().map(number), "{ray:?}");
        assert_eq!([expected.is_some(); 2], [tlas.any_hit(ray, Filter::ALL, accept), any], "{ray:?}");
    }
});

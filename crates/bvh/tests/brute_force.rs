//! The hierarchy gives the answer of the loop over all triangles, on every backend.

mod common;

use common::*;
use kajo_bvh::{Filter, Hit, Tlas};

#[test]
fn closest_hit_equals_brute_force_bit_for_bit() {
    let plain = Tlas::single(soup(10_000, 0.1, 1).blas());
    let rays = rays(4_000, 2);
    for backend in backends() {
        let tlas = plain.clone().with_backend(backend);
        let mut hits = 0;
        for ray in &rays {
            let expected = tlas.closest_hit_brute_force(ray, Filter::ALL, |_| true);
            same(expected, tlas.closest_hit_opaque(ray, Filter::ALL)).unwrap();
            assert_eq!(expected.is_some(), tlas.any_hit_opaque(ray, Filter::ALL));
            hits += usize::from(expected.is_some());
        }
        assert!(hits > 1000 && hits < 4000, "{hits} hits: the rays test nothing");
    }
}

#[test]
fn comparison_of_hits_sees_one_bit() {
    let hit = Hit { t: 1.0, u: 0.25, v: 0.5, primitive: 3, instance: 4 };
    assert!(same(Some(hit), Some(hit)).is_ok() && same(None, None).is_ok());
    for wrong in [
        Hit { t: 1.0f32.next_up(), ..hit },
        Hit { u: 0.25f32.next_up(), ..hit },
        Hit { v: 0.5f32.next_down(), ..hit },
        Hit { primitive: 2, ..hit },
        Hit { instance: 5, ..hit },
    ] {
        assert!(same(Some(hit), Some(wrong)).is_err(), "{wrong:?}");
    }
    assert!(same(Some(hit), None).is_err() && same(None, Some(hit)).is_err());
}

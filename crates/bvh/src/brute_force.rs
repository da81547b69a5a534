//! The definition of the answer: every triangle of every instance, one after the other.

use crate::{
    lanes::{Lanes, Portable},
    ray::{Filter, Hit, Ray},
    tlas::Tlas,
    traverse::Nearest,
    triangle::{BLOCK_SIZE, ShearedRay},
};

impl Tlas {
    /// What [`closest_hit`](Self::closest_hit) must return, bit for bit, in time proportional to the number of triangles.
    pub fn closest_hit_brute_force(&self, ray: &Ray, filter: Filter, mut accept: impl FnMut(&Hit) -> bool) -> Option<Hit> {
        let mut nearest = Nearest::before(ray.t_max);
        self.visit_all(ray, filter, |hit, opaque| {
            if nearest.is_beaten_by(&hit) && (opaque || accept(&hit)) {
                nearest = Nearest { hit, found: true };
            }
        });
        nearest.into_option()
    }

    /// Every crossing of the ray with a triangle inside `t_min < t < t_max`, in no order, whether opaque or not.
    pub fn all_hits_brute_force(&self, ray: &Ray, filter: Filter) -> Vec<Hit> {
        let mut hits = Vec::new();
        self.visit_all(ray, filter, |hit, _| hits.push(hit));
        hits
    }

    fn visit_all(&self, ray: &Ray, filter: Filter, mut visit: impl FnMut(Hit, bool)) {
        if !ray.is_usable() {
            return;
        }
        for placed in self.placed().iter().filter(|p| p.mask & filter.mask != 0) {
            let local = placed.local_ray(ray);
            if !local.is_usable() {
                continue;
            }
            let sheared = ShearedRay::new(&local);
            for block in self.blases()[placed.blas as usize].blocks() {
                let candidates = Portable::triangles(&sheared, block);
                for lane in (0..BLOCK_SIZE).filter(|lane| candidates >> lane & 1 == 1) {
                    let Some(crossing) = sheared.cross_lane(block, lane) else { continue };
                    let primitive = block.primitives[lane];
                    let hit = Hit { t: crossing.t, u: crossing.u, v: crossing.v, primitive, instance: placed.instance };
                    if hit.t > ray.t_min && hit.t < ray.t_max && filter.exclude != Some(hit.primitive_ref()) {
                        visit(hit, placed.opaque);
                    }
                }
            }
        }
    }
}

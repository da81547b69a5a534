//! The definition of the answer: every triangle of every instance, one after the other.

use crate::{
    lanes::{Crossings, Lanes, Portable},
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
            let Some(local) = placed.local_ray(ray) else { continue };
            let sheared = ShearedRay::new(&local);
            let mut crossings = Crossings::default();
            for block in self.blases()[placed.blas as usize].blocks() {
                let crossed = Portable::triangles(&sheared, block, ray.t_min, ray.t_max, &mut crossings);
                for lane in (0..BLOCK_SIZE).filter(|lane| crossed >> lane & 1 == 1) {
                    let (t, u, v) = (crossings.t[lane], crossings.u[lane], crossings.v[lane]);
                    let hit = Hit { t, u, v, primitive: block.primitives[lane], instance: placed.instance };
                    if hit.t < ray.t_max && filter.exclude != Some(hit.primitive_ref()) {
                        visit(hit, placed.opaque);
                    }
                }
            }
        }
    }
}

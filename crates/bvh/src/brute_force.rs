//! The definition of the answer: every triangle of every instance, one after the other.

use crate::{
    ray::{Filter, Hit, Ray},
    tlas::Tlas,
    traverse::Nearest,
    triangle::ShearedRay,
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
            for (primitive, triangle) in self.blases()[placed.blas as usize].triangles() {
                let Some(crossing) = sheared.cross(triangle.map(|p| p.to_array())) else { continue };
                let hit = Hit { t: crossing.t, u: crossing.u, v: crossing.v, primitive, instance: placed.instance };
                if hit.t > ray.t_min && hit.t < ray.t_max && filter.exclude != Some(hit.primitive_ref()) {
                    visit(hit, placed.opaque);
                }
            }
        }
    }
}

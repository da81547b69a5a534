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
            if nearest.admits(&hit) && (opaque || accept(&hit)) {
                nearest = Nearest { hit, found: true };
            }
        });
        nearest.into_option()
    }

    /// Every crossing of the ray with a triangle inside `t_min < t < t_max`, and the first with each shape inside `t_min ≤ t ≤ t_max`, ordered by
    /// (instance, primitive), whether opaque or not.
    pub fn all_hits_brute_force(&self, ray: &Ray, filter: Filter) -> Vec<Hit> {
        let mut hits = Vec::new();
        self.visit_all(ray, filter, |hit, _| hits.push(hit));
        // A triangle that was cut stands in several blocks.
        hits.sort_by_key(|hit: &Hit| hit.primitive_ref().key());
        hits.dedup_by_key(|hit| hit.primitive_ref().key());
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
            let blas = &self.blases()[placed.blas as usize];
            for block in blas.blocks() {
                let crossed = Portable::triangles(&sheared, block, ray.t_min, ray.t_max, &mut crossings);
                for lane in (0..BLOCK_SIZE).filter(|lane| crossed >> lane & 1 == 1) {
                    let (t, u, v) = (crossings.t[lane], crossings.u[lane], crossings.v[lane]);
                    let hit = Hit { t, u, v, primitive: block.primitives[lane], instance: placed.instance };
                    if hit.t < ray.t_max && filter.exclude != Some(hit.primitive_ref()) {
                        visit(hit, placed.opaque);
                    }
                }
            }
            for shape in 0..blas.shape_count() {
                let primitive = (blas.triangle_count() + shape) as u32;
                let Some(crossing) = blas.cross_shape(primitive, &local) else { continue };
                let hit = Hit { t: crossing.t, u: crossing.u, v: crossing.v, primitive, instance: placed.instance };
                if filter.exclude != Some(hit.primitive_ref()) {
                    visit(hit, placed.opaque);
                }
            }
        }
    }
}

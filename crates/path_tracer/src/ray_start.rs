//! Where rays start that leave a surface on the side from which it was seen.
//!
//! # Free space
//! A hit is rounded, so rays start a little off their triangle. A step along the normal crosses whatever is nearer than it is long: the
//! sphere that stands on the floor, and at an edge, by rounding alone, the wall beside it. So the point moves back along the ray that
//! found it, where it has just been seen that nothing is in the way. Light that passes to the far side has no such path; it steps along
//! the normal, unless another body is nearer: then it starts in front of its own triangle, which it ignores.
//!
//! # Terminator
//! On coarse meshes with smooth normals the facets shadow themselves near the terminator. There, rays start on a smoother surface: the
//! point is lifted to the mean of its projections on the vertices' tangent planes \[Hanika21]. The smooth surface may pass through other
//! objects that the mesh only touches; a point whose way up is blocked stays on the mesh. Flat-shaded triangles are not
//! moved, nor is a point that would rise by less than its own error.

use crate::world::{Placed, World};
use glam::Vec3;
use kajo_bvh::{Hit, PrimitiveRef, Ray, SurfacePoint, offset_origin};

/// Least cosine for which a point moves back along its ray all the way: sideways it moves by no more than 1/`GRAZING` of its error.
const GRAZING: f32 = 1.0 / 256.0;

impl World {
    /// The start of rays that leave `point`, which `hit` is, on the side of `normal`, the geometric one on the side of `wo`. With `smooth`,
    /// the point is lifted off coarse meshes.
    #[inline(always)]
    pub(crate) fn ray_start(&self, hit: &Hit, point: &SurfacePoint, normal: Vec3, wo: Vec3, smooth: bool) -> Vec3 {
        let start = seen_before(point, normal, wo, hit.t);
        if !smooth || self.instances[hit.instance as usize].flat { start } else { self.lifted_start(hit, point, normal, start) }
    }

    /// The start lifted off a coarse mesh, or `start` where something is in the way.
    fn lifted_start(&self, hit: &Hit, point: &SurfacePoint, normal: Vec3, start: Vec3) -> Vec3 {
        let placed = &self.instances[hit.instance as usize];
        let lifted = placed.lifted(hit, point.position, normal.dot(point.geometric_normal).signum());
        if lifted.distance_squared(point.position) <= point.error * point.error {
            return start;
        }
        let lifted = offset_origin(lifted, normal, point.error);
        let blocked = self.between(start, lifted, point.error, hit.primitive_ref()).is_some();
        if blocked { start } else { lifted }
    }

    /// The start of rays that pass through `leaving`, the triangle of `point`, away from `normal`, where `front` is the start of rays on the
    /// other side.
    pub(crate) fn ray_start_beyond(&self, leaving: PrimitiveRef, point: &SurfacePoint, normal: Vec3, front: Vec3) -> Vec3 {
        let step = |error| offset_origin(point.position, -normal, error);
        // From outside in: near its edges the way also crosses neighbours of the triangle, which are left behind.
        let nearest = self.between(step(2.0 * point.error), front, 0.0, leaving);
        let blocked = nearest.is_some_and(|hit| hit.instance != leaving.instance);
        if blocked { front } else { step(point.error) }
    }

    /// The nearest surface between two points or within `margin` behind `to`, but for `leaving`; masks and blended surfaces count as solid.
    fn between(&self, from: Vec3, to: Vec3, margin: f32, leaving: PrimitiveRef) -> Option<Hit> {
        let way = to - from;
        let length = way.length();
        let ray = Ray { origin: from, t_min: 0.0, direction: way / length, t_max: length + margin };
        self.geometry.closest_opaque(&ray, Some(leaving))
    }
}

/// The point moved off its triangle by its error, back along its ray of length `t`, but by no more than half of that, nor further than
/// [`GRAZING`] allows; what is left of the way goes along the normal.
#[inline(always)]
fn seen_before(point: &SurfacePoint, normal: Vec3, wo: Vec3, t: f32) -> Vec3 {
    let cos = wo.dot(normal);
    let back = (point.error / cos.max(GRAZING)).min(0.5 * t);
    offset_origin(point.position + back * wo, normal, (point.error - back * cos).max(0.0))
}

impl Placed {
    /// The position raised to the mean of its projections on those tangent planes of the vertices that lie above it, where `side` (±1) says
    /// on which side of the front faces above is.    \[Hanika21]
    fn lifted(&self, hit: &Hit, position: Vec3, side: f32) -> Vec3 {
        let corners = self.world_triangle(hit.primitive);
        let indices = self.mesh.indices[hit.primitive as usize];
        let weights = [1.0 - hit.u - hit.v, hit.u, hit.v];
        let mut lift = Vec3::ZERO;
        for ((corner, index), weight) in corners.into_iter().zip(indices).zip(weights) {
            let normal = side * (self.normal_from_object * self.mesh.normals[index as usize]).normalize_or_zero();
            lift -= weight * (position - corner).dot(normal).min(0.0) * normal;
        }
        position + lift
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Tracer;
    use crate::surface::Surface;
    use crate::tests::scenes::{Stage, at, floor, lambert, tracer};
    use kajo_sampling::Rng;
    use kajo_scene::{Material, shapes};

    /// A coarse sphere that stands on the floor: near the point of contact the smooth sphere lies below the floor, and the gap is lower than
    /// the step along the floor's normal.
    fn contact() -> Tracer {
        let sphere = shapes::sphere(0.5, 32);
        tracer(&Stage::default().mesh(floor(), lambert(0.5), at(Vec3::ZERO)).mesh(sphere, lambert(0.5), at(Vec3::Y * 0.5)).0)
    }

    /// Share of rays into the gap whose start, as `start` finds it, lies below the floor, and inside of the sphere.
    fn misplaced(tracer: &Tracer, start: impl Fn(&Hit, &SurfacePoint, Vec3, Vec3) -> Vec3) -> [f64; 2] {
        let (mut rng, world) = (Rng::new(5), &tracer.world);
        let (mut wrong, mut hits) = ([0; 2], [0; 2]);
        for _ in 0..20_000 {
            let place = |radius: f32, height: f32, rng: &mut Rng| {
                let angle = std::f32::consts::TAU * rng.next_1d();
                Vec3::new(radius * angle.cos(), height * rng.next_1d(), radius * angle.sin())
            };
            let (from, to) = (place(0.3, 0.08, &mut rng), place(0.005, 0.0001, &mut rng));
            let direction = (to - from).normalize();
            let Some(hit) = world.closest(&Ray::new(from, direction), None, 0) else { continue };
            let placed = &world.instances[hit.instance as usize];
            let point = SurfacePoint::new(&placed.world_from_object, placed.triangle(hit.primitive), hit.u, hit.v);
            let normal = point.geometric_normal * -point.geometric_normal.dot(direction).signum();
            let start = start(&hit, &point, normal, -direction);
            let above = world.closest(&Ray::new(start, Vec3::Y), Some(hit.primitive_ref()), 0);
            let inside = hit.instance == 0
                && above.is_some_and(|above| {
                    let sphere = &world.instances[1];
                    let above = SurfacePoint::new(&sphere.world_from_object, sphere.triangle(above.primitive), above.u, above.v);
                    above.geometric_normal.y > 0.0
                });
            hits[hit.instance as usize] += 1;
            wrong[0] += u32::from(hit.instance == 1 && start.y <= 0.0);
            wrong[1] += u32::from(inside);
        }
        assert!(hits.iter().all(|&n| n > 1000), "{hits:?}");
        [f64::from(wrong[0]) / f64::from(hits[1]), f64::from(wrong[1]) / f64::from(hits[0])]
    }

    #[test]
    fn rays_start_between_a_sphere_and_the_floor_below_it() {
        let tracer = contact();
        for smooth in [false, true] {
            let wrong = misplaced(&tracer, |hit, point, normal, wo| tracer.world.ray_start(hit, point, normal, wo, smooth));
            assert_eq!(wrong, [0.0; 2], "smooth: {smooth}");
        }
    }

    /// The checks above see points that are lifted without looking, and points that are moved along the normal.
    #[test]
    fn planted_fault_careless_starts_lie_below_the_floor_and_inside_of_the_sphere() {
        let tracer = contact();
        let wrong = misplaced(&tracer, |hit, point, normal, _| {
            let placed = &tracer.world.instances[hit.instance as usize];
            let position = if placed.flat { point.position } else { placed.lifted(hit, point.position, 1.0) };
            offset_origin(position, normal, point.error)
        });
        assert!(wrong.iter().all(|&share| share > 0.01), "{wrong:?}");
    }

    #[test]
    fn a_coarse_sphere_is_left_from_the_smooth_one() {
        let tracer = tracer(&Stage::default().mesh(shapes::sphere(1.0, 16), lambert(0.5), at(Vec3::ZERO)).0);
        for i in 0..64 {
            let wo = Vec3::new(1.0, 0.3 * (i as f32).sin(), 0.05 * i as f32 - 1.6).normalize();
            let hit = tracer.world.closest(&Ray::new(3.0 * wo, -wo), None, 0).expect("the sphere");
            let placed = &tracer.world.instances[0];
            let point = SurfacePoint::new(&placed.world_from_object, placed.triangle(hit.primitive), hit.u, hit.v);
            let start = |smooth| tracer.world.ray_start(&hit, &point, point.geometric_normal, wo, smooth).length();
            // The planes of the vertices lie as far outside of the sphere as the facet lies inside.
            let (rough, smooth) = (1.0 - start(false), 1.0 - start(true));
            assert!(smooth < 1e-5 && smooth > -1.2 * rough - 1e-5, "{smooth} m below the smooth sphere, {rough} m on the coarse one");
        }
    }

    /// A body of glass that stands on a floor: light that leaves it next to the floor meets the floor.
    #[test]
    fn light_that_passes_through_a_surface_meets_what_touches_it() {
        let glass = Material { transmission: 1.0, thickness: 1.0, ..Material::default() };
        let scene = Stage::default().mesh(floor(), lambert(0.5), at(Vec3::ZERO)).mesh(shapes::sphere(0.5, 32), glass, at(Vec3::Y * 0.5)).0;
        let (tracer, mut rng, mut careless) = (tracer(&scene), Rng::new(3), 0);
        for _ in 0..1000 {
            let target = Vec3::new(2e-5 * rng.next_1d(), 0.0, 2e-5 * rng.next_1d());
            let direction = (target - Vec3::new(0.1, 0.4, rng.next_1d() * 0.1)).normalize();
            let from = target - 0.3 * direction;
            let hit = tracer.world.closest(&Ray::new(from, direction), None, 0).expect("the sphere from inside");
            let mut room = None;
            let surface = Surface::new(&tracer.world, &hit, -direction, true, &mut room).expect("a triangle with area");
            let next = |start| tracer.world.closest(&Ray::new(start, direction), Some(hit.primitive_ref()), 0).map(|hit| hit.instance);
            if hit.instance == 1 {
                assert_eq!(next(surface.origin_towards(&tracer.world, direction)), Some(0), "{direction}");
                careless += u32::from(next(surface.point.ray_origin(direction)) != Some(0));
            }
        }
        assert!(careless > 500, "planted fault: only {careless} steps along the normal cross the floor");
    }
}

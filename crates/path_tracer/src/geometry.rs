//! What rays hit: the hierarchy over the instances, in which meshes that stand in one place share a tree.
//!
//! A ray pays for every mesh whose box it enters, and boxes of furniture overlap. Meshes that one instance alone uses are joined in the world's space,
//! those with holes apart from those without. Callers see instances and their triangles all the same.
//!
//! Joining rounds the corners of a mesh that is not in place to the world's numbers, at most half of the last digit of a coordinate, which is little
//! beside what the points of hits are known to; a mesh whose triangles are not large beside that stays alone.

use crate::PathTracerError;
use glam::Vec3;
use kajo_bvh::{Aabb, Blas, BuildOptions, BvhError, BvhInstance, Filter, Hit, PrimitiveRef, Ray, Tlas};
use kajo_scene::{Mesh, Snapshot};
use rayon::prelude::*;
use std::sync::Arc;

/// Triangles of meshes that are joined, at most: a larger mesh has a tree of many levels, to which the upper tree adds little.
const JOINED: usize = 1 << 20;

/// Mean size of a mesh's triangles, in units of the last digit of the greatest coordinate, from which on rounding does not change their shape.
const LARGE: f32 = 4096.0;

pub(crate) struct Geometry {
    tlas: Tlas,
    /// By instance of `tlas`: what it holds.
    held: Vec<Held>,
    /// By instance of the world: its first triangle in `tlas`.
    places: Vec<PrimitiveRef>,
}

/// What an instance of the hierarchy holds.
enum Held {
    /// One of the world.
    One(u32),
    /// Triangles of many.
    Joined(Vec<PrimitiveRef>),
}

impl Held {
    /// The first instance of the world in it.
    fn first(&self) -> usize {
        match self {
            Self::One(instance) => *instance as usize,
            Self::Joined(triangles) => triangles[0].instance as usize,
        }
    }
}

impl Geometry {
    /// `opaque` says of each instance whether all its hits count.
    ///
    /// # Errors
    /// [`PathTracerError::Bvh`] for what no hierarchy can be built over.
    pub(crate) fn new(snapshot: &Snapshot, opaque: &[bool]) -> Result<Self, PathTracerError> {
        Self::of_kept(snapshot, opaque, &vec![true; opaque.len()])
    }

    /// The same without the instances that are not `kept`.
    ///
    /// # Errors
    /// As [`Geometry::new`].
    pub(crate) fn of_kept(snapshot: &Snapshot, opaque: &[bool], kept: &[bool]) -> Result<Self, PathTracerError> {
        let mut geometry = Parts { places: vec![PrimitiveRef { instance: u32::MAX, primitive: 0 }; opaque.len()], ..Parts::default() };
        for solid in [true, false] {
            geometry.join(snapshot, (0..opaque.len()).filter(|&instance| kept[instance] && opaque[instance] == solid), solid);
        }
        geometry.place(snapshot, opaque, kept)?;
        let Parts { blases, placed, held, places } = geometry;
        let failed = |e| match e {
            BvhError::Transform { instance } => BvhError::Transform { instance: held[instance].first() },
            e => e,
        };
        let tlas = Tlas::build(blases, placed).map_err(|e| PathTracerError::Bvh { mesh: "(all)".into(), source: failed(e) })?;
        Ok(Self { tlas, held, places })
    }

    pub(crate) fn bounds(&self) -> Aabb {
        self.tlas.bounds()
    }

    /// Memory of the hierarchy, bytes.
    pub(crate) fn memory(&self) -> usize {
        let joined = |held: &Held| if let Held::Joined(triangles) = held { size_of_val(triangles.as_slice()) } else { 0 };
        let tables = size_of_val(&self.places[..]) + size_of_val(&self.held[..]);
        self.tlas.memory() + tables + self.held.iter().map(joined).sum::<usize>()
    }

    /// The nearest hit that `accept` takes, but for `exclude`; hits of opaque instances are not asked for.
    #[inline]
    pub(crate) fn closest(&self, ray: &Ray, exclude: Option<PrimitiveRef>, mut accept: impl FnMut(&Hit) -> bool) -> Option<Hit> {
        self.tlas.closest_hit(ray, self.filter(exclude), |hit| accept(&self.own(*hit))).map(|hit| self.own(hit))
    }

    /// The nearest hit, all taken as opaque.
    #[inline]
    pub(crate) fn closest_opaque(&self, ray: &Ray, exclude: Option<PrimitiveRef>) -> Option<Hit> {
        self.tlas.closest_hit_opaque(ray, self.filter(exclude)).map(|hit| self.own(hit))
    }

    /// Whether there is a hit that `accept` takes.
    #[inline]
    pub(crate) fn any(&self, ray: &Ray, exclude: Option<PrimitiveRef>, mut accept: impl FnMut(&Hit) -> bool) -> bool {
        self.tlas.any_hit(ray, self.filter(exclude), |hit| accept(&self.own(*hit)))
    }

    /// Whether anything is hit, all taken as opaque.
    #[inline]
    pub(crate) fn any_opaque(&self, ray: &Ray, exclude: Option<PrimitiveRef>) -> bool {
        self.tlas.any_hit_opaque(ray, self.filter(exclude))
    }

    /// [`Geometry::closest`] of many rays; `accept` is given the number of the ray.
    pub(crate) fn closest_of(&self, rays: &[Ray], mut accept: impl FnMut(usize, &Hit) -> bool, hits: &mut [Option<Hit>]) {
        self.tlas.closest_hits(rays, Filter::ALL, |ray, hit| accept(ray, &self.own(*hit)), hits);
        for hit in hits.iter_mut().flatten() {
            *hit = self.own(*hit);
        }
    }

    #[inline]
    fn filter(&self, exclude: Option<PrimitiveRef>) -> Filter {
        let placed = |PrimitiveRef { instance, primitive }| {
            let first = self.places[instance as usize];
            PrimitiveRef { primitive: first.primitive + primitive, ..first }
        };
        Filter { exclude: exclude.map(placed), ..Filter::ALL }
    }

    /// A hit of the hierarchy as one of the world.
    #[inline]
    fn own(&self, hit: Hit) -> Hit {
        match &self.held[hit.instance as usize] {
            Held::One(instance) => Hit { instance: *instance, ..hit },
            Held::Joined(triangles) => {
                let PrimitiveRef { instance, primitive } = triangles[hit.primitive as usize];
                Hit { instance, primitive, ..hit }
            }
        }
    }
}

/// A geometry in the making.
#[derive(Default)]
struct Parts {
    blases: Vec<Arc<Blas>>,
    placed: Vec<BvhInstance>,
    held: Vec<Held>,
    places: Vec<PrimitiveRef>,
}

impl Parts {
    /// Joins those of the instances that can be; the others are left to [`Parts::place`].
    fn join(&mut self, snapshot: &Snapshot, instances: impl Iterator<Item = usize>, opaque: bool) {
        let mut uses = vec![0; snapshot.meshes.len()];
        snapshot.instances.iter().for_each(|instance| uses[instance.mesh] += 1);
        let (mut members, mut total) = (Vec::new(), 0);
        for index in instances {
            let mesh = &snapshot.meshes[snapshot.instances[index].mesh];
            let fits = uses[snapshot.instances[index].mesh] == 1 && total + mesh.indices.len() <= JOINED;
            if fits && let Some(corners) = corners_in_world(snapshot, index) {
                total += mesh.indices.len();
                members.push((index, corners));
            }
        }
        if members.len() < 2 {
            return;
        }
        let (mut positions, mut indices, mut triangles) = (Vec::new(), Vec::with_capacity(total), Vec::with_capacity(total));
        for (index, corners) in &members {
            let (first, mesh) = (positions.len() as u32, &snapshot.meshes[snapshot.instances[*index].mesh]);
            positions.extend_from_slice(corners);
            indices.extend(mesh.indices.iter().map(|triangle| triangle.map(|corner| first + corner)));
            triangles.extend((0..mesh.indices.len() as u32).map(|primitive| PrimitiveRef { instance: *index as u32, primitive }));
        }
        // What cannot be built together is built apart, and says what is wrong with it.
        let Ok(blas) = Blas::build(&positions, &indices, &BuildOptions::default()) else { return };
        let mut primitive = 0;
        for (index, _) in members {
            self.places[index] = PrimitiveRef { instance: self.held.len() as u32, primitive };
            primitive += snapshot.meshes[snapshot.instances[index].mesh].indices.len() as u32;
        }
        self.placed.push(BvhInstance { opaque, ..BvhInstance::new(self.blases.len(), glam::Affine3A::IDENTITY) });
        self.blases.push(Arc::new(blas));
        self.held.push(Held::Joined(triangles));
    }

    /// Places every instance that was not joined.
    fn place(&mut self, snapshot: &Snapshot, opaque: &[bool], kept: &[bool]) -> Result<(), PathTracerError> {
        let alone: Vec<usize> =
            (0..opaque.len()).filter(|&instance| kept[instance] && self.places[instance].instance == u32::MAX).collect();
        let mut needed: Vec<usize> = alone.iter().map(|&instance| snapshot.instances[instance].mesh).collect();
        needed.sort_unstable();
        needed.dedup();
        let build = |&mesh: &usize| -> Result<Arc<Blas>, PathTracerError> {
            let mesh: &Mesh = &snapshot.meshes[mesh];
            let failed = |e: BvhError| PathTracerError::Bvh { mesh: mesh.name.clone(), source: e };
            Ok(Arc::new(Blas::build(&mesh.positions, &mesh.indices, &BuildOptions::default()).map_err(failed)?))
        };
        let first = self.blases.len();
        self.blases.extend(needed.par_iter().map(build).collect::<Result<Vec<_>, _>>()?);
        for index in alone {
            let instance = &snapshot.instances[index];
            let blas = first + needed.binary_search(&instance.mesh).expect("a mesh that is needed");
            self.places[index] = PrimitiveRef { instance: self.held.len() as u32, primitive: 0 };
            self.placed.push(BvhInstance { opaque: opaque[index], ..BvhInstance::new(blas, instance.world_from_object) });
            self.held.push(Held::One(index as u32));
        }
        Ok(())
    }
}

/// The vertices of an instance in the world's space; `None` where rounding would change the shape of its triangles, and for a singular transform, under
/// which nothing is hit.
fn corners_in_world(snapshot: &Snapshot, index: usize) -> Option<Vec<Vec3>> {
    let instance = &snapshot.instances[index];
    let mesh = &snapshot.meshes[instance.mesh];
    if instance.world_from_object == glam::Affine3A::IDENTITY {
        return Some(mesh.positions.clone());
    }
    if BvhInstance::new(0, instance.world_from_object).is_singular() {
        return None;
    }
    let corners: Vec<Vec3> = mesh.positions.iter().map(|&corner| instance.world_from_object.transform_point3(corner)).collect();
    let (low, high) = corners.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), &corner| (low.min(corner), high.max(corner)));
    let (reach, size) = (low.abs().max(high.abs()).max_element(), (high - low).length() / (mesh.indices.len() as f32).sqrt());
    (size > LARGE * f32::EPSILON * reach && reach.is_finite()).then_some(corners)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::scenes::{Stage, at, floor, lambert};
    use glam::Quat;
    use kajo_sampling::Rng;
    use kajo_scene::{AlphaMode, Instance, Material, Scene, Transform, shapes};

    fn snapshot(scene: &Scene) -> Snapshot {
        Snapshot::new(scene, kajo_units::Seconds(0.0))
    }

    fn placed(translation: Vec3, scale: Vec3) -> Transform {
        Transform::Trs { translation, rotation: Quat::from_scaled_axis(Vec3::new(0.3, 1.0, -0.5)), scale }
    }

    /// Meshes in place, turned, mirrored, used twice, and with holes.
    fn bodies() -> Scene {
        let ball = || shapes::sphere(0.4, 16);
        let masked = || Material { alpha_mode: AlphaMode::Mask(0.5), ..lambert(0.5) };
        let stage = Stage::default()
            .mesh(floor(), lambert(0.5), at(Vec3::ZERO))
            .mesh(ball(), lambert(0.5), placed(Vec3::new(-1.0, 0.4, 0.0), Vec3::new(1.0, 0.5, 1.5)))
            .mesh(ball(), lambert(0.5), placed(Vec3::new(-0.8, 0.5, 0.3), Vec3::new(-1.0, 1.0, 1.0)))
            .mesh(ball(), masked(), at(Vec3::new(0.3, 0.4, 0.0)))
            .mesh(ball(), masked(), at(Vec3::new(0.5, 0.4, 0.2)))
            .mesh(ball(), lambert(0.5), placed(Vec3::new(1.0, 0.4, 0.0), Vec3::splat(0.7)));
        let mut scene = stage.perspective(Vec3::Z, Vec3::ZERO, 60.0).0;
        let mut twin = scene.nodes[5].clone();
        twin.transform = placed(Vec3::new(1.1, 0.6, 0.1), Vec3::splat(0.6));
        scene.nodes.push(twin);
        scene
    }

    /// Which of them have no holes.
    const SOLID: [bool; 7] = [true, true, true, false, false, true, true];

    /// The hierarchy without any meshes joined.
    fn apart(snapshot: &Snapshot) -> Tlas {
        let build = |mesh: &Arc<Mesh>| Arc::new(Blas::build(&mesh.positions, &mesh.indices, &BuildOptions::default()).unwrap());
        let place =
            |(instance, opaque): (&Instance, bool)| BvhInstance { opaque, ..BvhInstance::new(instance.mesh, instance.world_from_object) };
        Tlas::build(snapshot.meshes.iter().map(build).collect(), snapshot.instances.iter().zip(SOLID).map(place).collect()).unwrap()
    }

    /// Share of rays on which joined and single meshes differ, also in what lies behind the nearest hit. What has holes is there for every other triangle;
    /// `shift` plants a fault.
    fn differences(geometry: &Geometry, apart: &Tlas, shift: u32) -> f64 {
        let (mut rng, mut wrong) = (Rng::new(3), 0);
        let is_there = |hit: &Hit| hit.primitive.is_multiple_of(2);
        let ray = |rng: &mut Rng| {
            let mut point = |scale: f32| (Vec3::from_array([(); 3].map(|()| rng.next_1d())) - 0.5) * scale;
            let (from, to) = (point(6.0) + Vec3::Y * 2.0, point(2.5));
            Ray::new(from, (to - from).normalize())
        };
        let rays: Vec<Ray> = (0..20_000).map(|_| ray(&mut rng)).filter(|ray| apart.any_hit_opaque(ray, Filter::ALL)).collect();
        assert!(rays.len() > 10_000, "{}", rays.len());
        let mut together = vec![None; rays.len()];
        for (rays, hits) in rays.chunks(16).zip(together.chunks_mut(16)) {
            geometry.closest_of(rays, |_, hit| is_there(hit), hits);
        }
        let same = |a: Option<Hit>, b: Option<Hit>| match (a, b) {
            (Some(a), Some(b)) => a.primitive_ref() == b.primitive_ref() && (a.t - b.t).abs() < 1e-5 * b.t && (a.u - b.u).abs() < 1e-3,
            (a, b) => a.is_none() && b.is_none(),
        };
        for (ray, found) in rays.iter().zip(together) {
            let solid = apart.closest_hit_opaque(ray, Filter::ALL);
            let first = apart.closest_hit(ray, Filter::ALL, is_there);
            let exclude = first.map(|hit| hit.primitive_ref());
            let second = apart.closest_hit(ray, Filter { exclude, ..Filter::ALL }, is_there);
            let near = exclude.map(|PrimitiveRef { instance, primitive }| PrimitiveRef { instance, primitive: primitive ^ shift });
            let agrees = same(geometry.closest_opaque(ray, None), solid)
                && geometry.any_opaque(ray, None)
                && same(geometry.closest(ray, None, is_there), first)
                && same(found, first)
                && same(geometry.closest(ray, near, is_there), second)
                && geometry.any(ray, near, is_there) == second.is_some();
            wrong += u32::from(!agrees);
        }
        f64::from(wrong) / rays.len() as f64
    }

    #[test]
    fn joined_meshes_are_hit_as_single_ones_are_and_a_planted_fault_is_seen() {
        let snapshot = snapshot(&bodies());
        let (geometry, apart) = (Geometry::new(&snapshot, &SOLID).unwrap(), apart(&snapshot));
        let joined = geometry.held.iter().filter(|held| matches!(held, Held::Joined(_))).count();
        assert_eq!((joined, geometry.held.len()), (2, 4), "solid bodies, those with holes, and the two that share a mesh");
        let wrong = differences(&geometry, &apart, 0);
        assert!(wrong < 1e-3, "{wrong}: only rays along edges of triangles may differ");
        assert!(differences(&geometry, &apart, 1) > 0.3);
    }

    #[test]
    fn meshes_that_rounding_would_change_stay_alone() {
        let far = |distance: f32| {
            let moved = |x| Transform::Trs { translation: Vec3::X * (distance + x), rotation: Quat::IDENTITY, scale: Vec3::ONE };
            let stage = Stage::default().mesh(shapes::sphere(0.1, 16), lambert(0.5), moved(0.0)).mesh(
                shapes::sphere(0.1, 16),
                lambert(0.5),
                moved(1.0),
            );
            Geometry::new(&snapshot(&stage.0), &[true; 2]).unwrap().held.len()
        };
        assert_eq!((far(1.0), far(1e5)), (1, 2));
    }

    #[test]
    fn flattened_meshes_are_hit_neither_alone_nor_among_others() {
        let flat = Transform::Trs { translation: Vec3::ZERO, rotation: Quat::IDENTITY, scale: Vec3::new(1.0, 0.0, 1.0) };
        let stage = Stage::default().mesh(shapes::sphere(1.0, 16), lambert(0.5), flat);
        let ray = Ray::new(Vec3::new(0.1, 2.0, 0.2), Vec3::NEG_Y);
        for (stage, solid) in
            [(stage.clone(), 1), (stage.mesh(floor(), lambert(0.5), at(Vec3::NEG_Y)).mesh(floor(), lambert(0.5), at(Vec3::NEG_Y * 2.0)), 3)]
        {
            let geometry = Geometry::new(&snapshot(&stage.0), &vec![true; solid]).unwrap();
            assert!(geometry.closest_opaque(&ray, None).is_none_or(|hit| hit.instance == 1), "{solid} meshes");
        }
    }
}

//! The upper level: meshes placed in the world.

#[cfg(target_arch = "x86_64")]
use crate::lanes::{Avx2, Avx512};
use crate::{
    aabb::Aabb,
    blas::Blas,
    build::{BinaryTree, BuildOptions, Item, Sah},
    counters::{Count, NoCounters},
    error::BvhError,
    lanes::{Backend, Portable},
    limits::Limits,
    ray::{Filter, Hit, Ray},
    refit::UpdateReport,
    slab::MARGIN,
    stream::FAR_MEMORY,
    traverse::{Nearest, Query, World},
    triangle::MAX_COORDINATE,
    wide::{Child, WideTree},
};
use glam::{Affine3A, DAffine3, DMat3};
use rayon::prelude::*;
use std::sync::Arc;

/// A mesh in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BvhInstance {
    /// Index into the meshes.
    pub blas: usize,
    /// Object to world; may mirror, shear and scale unevenly.
    pub world_from_object: Affine3A,
    /// Seen by rays whose mask shares a bit.
    pub mask: u32,
    /// Hits need not be confirmed by the caller.
    pub opaque: bool,
}

impl BvhInstance {
    /// An opaque instance that every ray sees.
    pub fn new(blas: usize, world_from_object: Affine3A) -> Self {
        Self { blas, world_from_object, mask: u32::MAX, opaque: true }
    }

    /// Whether the transform is singular to single precision, so that nothing of the instance is hit; see [`Tlas::build`].
    pub fn is_singular(&self) -> bool {
        invert(&self.world_from_object).is_none()
    }
}

/// An instance as traversal needs it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placed {
    pub object_from_world: Affine3A,
    pub world_from_object: Affine3A,
    pub blas: u32,
    pub instance: u32,
    pub mask: u32,
    pub opaque: bool,
    identity: bool,
}

impl Placed {
    /// Whether object space is the world.
    #[inline(always)]
    pub fn is_in_place(&self) -> bool {
        self.identity
    }

    /// The rays in object space.
    #[inline(always)]
    pub fn local_rays<const N: usize>(&self, rays: &[Ray; N]) -> [Ray; N] {
        let mut local = *rays;
        for ray in &mut local {
            *ray = self.in_object(ray);
        }
        local
    }

    /// The ray in object space, where `t` means the same; `None` if it cannot hit anything there.
    #[inline(always)]
    pub fn local_ray(&self, ray: &Ray) -> Option<Ray> {
        if self.identity {
            return Some(*ray);
        }
        let local = self.in_object(ray);
        local.is_usable().then_some(local)
    }

    #[inline(always)]
    fn in_object(&self, ray: &Ray) -> Ray {
        Ray {
            origin: self.object_from_world.transform_point3(ray.origin),
            direction: self.object_from_world.transform_vector3(ray.direction),
            ..*ray
        }
    }
}

/// A transform that amplifies rounding more than this cannot be inverted in single precision in any useful sense.
const MAX_CONDITION: f64 = 1e6;

/// A hierarchy over instances of meshes.
#[derive(Clone, Debug)]
pub struct Tlas {
    blases: Vec<Arc<Blas>>,
    placed: Vec<Placed>,
    tree: WideTree,
    instances: usize,
    singular: Vec<usize>,
    margin: f32,
    extra: f32,
    backend: Backend,
    /// Whether it is too large to stay near the processor.
    far: bool,
    options: BuildOptions,
    /// Expected work when it was built; 0 if it cannot be updated.
    built_cost: f32,
}

/// What an instance turns out to be.
enum Standing {
    /// Its mesh has nothing to hit.
    Empty,
    /// Its transform cannot be inverted.
    Singular,
    Active(Found),
}

/// An instance that can be hit.
struct Found {
    placed: Placed,
    bounds: Aabb,
    /// By how much its transform amplifies rounding.
    condition: f64,
    /// That times its translation, and the smallest numbers of its space, m.
    shift: f64,
}

impl Standing {
    fn active(&self) -> Option<&Found> {
        match self {
            Self::Active(found) => Some(found),
            _ => None,
        }
    }

    /// Checks all instances.
    fn of_all(blases: &[Arc<Blas>], instances: &[BvhInstance]) -> Result<Vec<Self>, BvhError> {
        Limits::HERE.check_instances(instances.len())?;
        instances.par_iter().enumerate().with_min_len(256).map(|(number, instance)| Self::of(blases, number, instance)).collect()
    }

    fn of(blases: &[Arc<Blas>], number: usize, instance: &BvhInstance) -> Result<Self, BvhError> {
        let Some(blas) = blases.get(instance.blas) else {
            return Err(BvhError::Blas { instance: number, blas: instance.blas, blases: blases.len() });
        };
        if !instance.world_from_object.is_finite() {
            return Err(BvhError::Transform { instance: number });
        }
        if blas.bounds().is_empty() {
            return Ok(Self::Empty);
        }
        let bounds = world_bounds(blas, &instance.world_from_object);
        if bounds.max_abs().is_nan() || bounds.max_abs() > MAX_COORDINATE {
            return Err(BvhError::Transform { instance: number });
        }
        let Some((object_from_world, condition)) = invert(&instance.world_from_object) else {
            return Ok(Self::Singular);
        };
        let placed = Placed {
            object_from_world,
            world_from_object: instance.world_from_object,
            blas: instance.blas as u32,
            instance: number as u32,
            mask: instance.mask,
            opaque: instance.opaque,
            identity: instance.world_from_object == Affine3A::IDENTITY,
        };
        let axes = instance.world_from_object.matrix3.as_dmat3();
        let stretch = (axes.x_axis.abs() + axes.y_axis.abs() + axes.z_axis.abs()).max_element();
        let shift =
            condition * f64::from(instance.world_from_object.translation.abs().max_element()) + stretch * f64::from(f32::MIN_POSITIVE);
        Ok(Self::Active(Found { placed, bounds, condition, shift }))
    }
}

/// Margins of the boxes of instances: see [`Tlas::margin`].
fn margins(all: &[Standing]) -> (f32, f32) {
    let active = all.iter().filter_map(Standing::active);
    let (condition, shift) =
        active.fold((1.0f64, 0.0f64), |(condition, shift), found| (condition.max(found.condition), shift.max(found.shift)));
    (MARGIN * condition as f32, MARGIN * shift as f32)
}

impl Tlas {
    /// Builds over instances. Instances of empty meshes are never hit. Those whose transform is singular to single precision (a zero
    /// scale, or a condition number above 10⁶) have no inside to hit: they are left out and listed by
    /// [`singular_instances`](Self::singular_instances).
    ///
    /// # Errors
    /// An instance of a mesh that does not exist, a transform that is not finite or moves its mesh beyond ±10¹⁸, or too many instances.
    pub fn build(blases: Vec<Arc<Blas>>, instances: Vec<BvhInstance>) -> Result<Self, BvhError> {
        Self::build_with(blases, &instances, &BuildOptions::default())
    }

    /// [`build`](Self::build) as the options say. Instances are never cut, and a leaf holds one.
    ///
    /// # Errors
    /// Those of [`build`](Self::build).
    pub fn build_with(blases: Vec<Arc<Blas>>, instances: &[BvhInstance], options: &BuildOptions) -> Result<Self, BvhError> {
        let options = BuildOptions { sah: Sah { max_leaf_size: 1, ..options.sah }, low_memory: false, ..*options };
        let all = Standing::of_all(&blases, instances)?;
        let items = all.iter().enumerate().filter_map(|(number, standing)| match standing {
            Standing::Active(found) => Some(Item::new(&found.bounds, number as u32)),
            _ => None,
        });
        let binary = BinaryTree::with_options(items.collect(), 1, &options, |_| None);
        let mut placed = Vec::with_capacity(binary.order.len());
        let tree = WideTree::collapse(&binary, |range| {
            let first = placed.len();
            placed.extend(binary.order[range].iter().filter_map(|&number| all[number as usize].active()).map(|found| found.placed));
            Child::leaf(first, placed.len() - first)
        });
        let singular = (0..all.len()).filter(|&number| matches!(all[number], Standing::Singular)).collect();
        let (margin, extra) = margins(&all);
        let backend = Backend::detect();
        let mut tlas =
            Self { blases, placed, tree, instances: all.len(), singular, margin, extra, backend, far: false, options, built_cost: 0.0 };
        tlas.far = tlas.memory() > FAR_MEMORY;
        if options.allow_update {
            tlas.built_cost = tlas.sah_cost(options.sah.node_cost);
        }
        Ok(tlas)
    }

    /// Moves instances, or gives them other meshes, masks and opacity, and keeps the tree: see [`Blas::update`]. After a mesh was updated, this
    /// is what tells the world. Nothing changes on an error.
    ///
    /// # Errors
    /// A world that was built without [`BuildOptions::allow_update`], another number of instances, an instance that would appear or vanish (its mesh
    /// has become empty or its transform singular, or no longer is), and what [`build`](Self::build) refuses.
    pub fn update(&mut self, blases: Vec<Arc<Blas>>, instances: &[BvhInstance]) -> Result<UpdateReport, BvhError> {
        if !self.options.allow_update {
            return Err(BvhError::NotUpdatable { what: "world" });
        }
        if instances.len() != self.instances {
            return Err(BvhError::CountChanged { what: "instances", got: instances.len(), expected: self.instances });
        }
        let all = Standing::of_all(&blases, instances)?;
        let mut was_active = vec![false; all.len()];
        self.placed.iter().for_each(|placed| was_active[placed.instance as usize] = true);
        for (instance, standing) in all.iter().enumerate() {
            match (was_active[instance], standing.active().is_some()) {
                (false, true) => return Err(BvhError::Activity { instance, change: "would appear" }),
                (true, false) => return Err(BvhError::Activity { instance, change: "would vanish" }),
                _ => {}
            }
        }
        let found = |placed: &Placed| all[placed.instance as usize].active().expect("checked above");
        self.placed.par_iter_mut().with_min_len(256).for_each(|placed| *placed = found(placed).placed);
        let placed = &self.placed;
        self.tree.refit(|slot| found(&placed[slot]).bounds);
        (self.margin, self.extra) = margins(&all);
        self.singular = (0..all.len()).filter(|&number| matches!(all[number], Standing::Singular)).collect();
        self.blases = blases;
        self.far = self.memory() > FAR_MEMORY;
        Ok(UpdateReport { built_cost: self.built_cost, cost: self.sah_cost(self.options.sah.node_cost) })
    }

    /// One mesh at the origin, opaque.
    pub fn single(blas: Blas) -> Self {
        Self::build(vec![Arc::new(blas)], vec![BvhInstance::new(0, Affine3A::IDENTITY)]).expect("one finite mesh in place")
    }

    /// The same tree traced with other instructions.
    ///
    /// # Panics
    /// If this processor does not run them: ask [`Backend::is_supported`] first.
    pub fn with_backend(self, backend: Backend) -> Self {
        assert!(backend.is_supported(), "{backend:?} is not supported by this processor");
        Self { backend, ..self }
    }

    /// The instructions that traversal uses.
    pub fn backend(&self) -> Backend {
        self.backend
    }

    /// The nearest hit that `accept` confirms; hits on opaque instances need no confirmation.
    ///
    /// `accept` should depend on the hit alone; it may be asked about hits that turn out not to be the nearest.
    #[inline]
    pub fn closest_hit(&self, ray: &Ray, filter: Filter, accept: impl FnMut(&Hit) -> bool) -> Option<Hit> {
        self.run::<_, _, false, false>(ray, filter, accept, &mut NoCounters)
    }

    /// The nearest hit, with every instance taken as opaque.
    #[inline]
    pub fn closest_hit_opaque(&self, ray: &Ray, filter: Filter) -> Option<Hit> {
        self.run::<_, _, false, true>(ray, filter, |_: &Hit| true, &mut NoCounters)
    }

    /// Whether anything that `accept` confirms is hit.
    #[inline]
    pub fn any_hit(&self, ray: &Ray, filter: Filter, accept: impl FnMut(&Hit) -> bool) -> bool {
        self.run::<_, _, true, false>(ray, filter, accept, &mut NoCounters).is_some()
    }

    /// Whether anything is hit, with every instance taken as opaque.
    #[inline]
    pub fn any_hit_opaque(&self, ray: &Ray, filter: Filter) -> bool {
        self.run::<_, _, true, true>(ray, filter, |_: &Hit| true, &mut NoCounters).is_some()
    }

    /// [`closest_hit`](Self::closest_hit) that counts its work.
    pub fn closest_hit_counted(
        &self,
        ray: &Ray,
        filter: Filter,
        accept: impl FnMut(&Hit) -> bool,
        counters: &mut impl Count,
    ) -> Option<Hit> {
        self.run::<_, _, false, false>(ray, filter, accept, counters)
    }

    /// [`any_hit`](Self::any_hit) that counts its work.
    pub fn any_hit_counted(&self, ray: &Ray, filter: Filter, accept: impl FnMut(&Hit) -> bool, counters: &mut impl Count) -> bool {
        self.run::<_, _, true, false>(ray, filter, accept, counters).is_some()
    }

    /// The nearest hit, or any.
    #[inline(always)]
    pub(crate) fn nearest<F: FnMut(&Hit) -> bool, const ANY: bool>(&self, ray: &Ray, filter: Filter, accept: F) -> Nearest {
        self.query::<_, _, ANY, false>(ray, filter, accept, &mut NoCounters)
    }

    #[inline(always)]
    fn run<C: Count, F: FnMut(&Hit) -> bool, const ANY: bool, const OPAQUE: bool>(
        &self,
        ray: &Ray,
        filter: Filter,
        accept: F,
        counters: &mut C,
    ) -> Option<Hit> {
        self.query::<C, F, ANY, OPAQUE>(ray, filter, accept, counters).into_option()
    }

    #[inline(always)]
    fn query<C: Count, F: FnMut(&Hit) -> bool, const ANY: bool, const OPAQUE: bool>(
        &self,
        ray: &Ray,
        filter: Filter,
        accept: F,
        counters: &mut C,
    ) -> Nearest {
        let mut query = Query { ray, filter, accept, counters, nearest: Nearest::before(ray.t_max) };
        let world = World::<F, C, ANY, OPAQUE> { tlas: self, query: &mut query };
        match self.backend {
            #[cfg(target_arch = "x86_64")]
            Backend::Avx512 => world.trace::<Avx512>(),
            #[cfg(target_arch = "x86_64")]
            Backend::Avx2 => world.trace::<Avx2>(),
            _ => world.trace::<Portable>(),
        }
        query.nearest
    }

    /// Box around everything in the world; empty when there is nothing.
    pub fn bounds(&self) -> Aabb {
        self.tree.bounds
    }

    /// Instances given to the build, whether or not they can be hit.
    pub fn instance_count(&self) -> usize {
        self.instances
    }

    /// How it was built.
    pub fn options(&self) -> &BuildOptions {
        &self.options
    }

    /// Instances left out because their transform cannot be inverted.
    pub fn singular_instances(&self) -> &[usize] {
        &self.singular
    }

    /// The meshes.
    pub fn blases(&self) -> &[Arc<Blas>] {
        &self.blases
    }

    /// Bytes held by both levels; a mesh counts once however often it is placed.
    pub fn memory(&self) -> usize {
        self.tree.memory() + std::mem::size_of_val(&self.placed[..]) + self.blases.iter().map(|b| b.memory()).sum::<usize>()
    }

    /// Whether what rays visit is better called for ahead.
    pub(crate) fn is_far(&self) -> bool {
        self.far
    }

    pub(crate) fn tree(&self) -> &WideTree {
        &self.tree
    }

    pub(crate) fn placed(&self) -> &[Placed] {
        &self.placed
    }

    /// Margin of boxes of instances: [`MARGIN`] times what the transforms amplify, and the part that their translations add, m.
    pub(crate) fn margin(&self) -> (f32, f32) {
        (self.margin, self.extra)
    }
}

/// Box around a mesh in the world; exactly that of the mesh where it is not moved.
pub(crate) fn world_bounds(blas: &Blas, world_from_object: &Affine3A) -> Aabb {
    if *world_from_object == Affine3A::IDENTITY { blas.bounds() } else { blas.bounds().transformed(world_from_object) }
}

/// The inverse, rounded from double precision, and by how much going there and back amplifies a rounding error: the greatest row sum
/// of |M| |M⁻¹|. `None` when the map is singular to single precision.
fn invert(map: &Affine3A) -> Option<(Affine3A, f64)> {
    let linear = map.matrix3.as_dmat3();
    let inverse = linear.inverse();
    if !inverse.is_finite() {
        return None;
    }
    let absolute = |m: DMat3| DMat3::from_cols(m.x_axis.abs(), m.y_axis.abs(), m.z_axis.abs());
    let product = absolute(linear) * absolute(inverse);
    let amplification = (product.x_axis + product.y_axis + product.z_axis).max_element();
    let there = DAffine3 { matrix3: inverse, translation: -(inverse * map.translation.as_dvec3()) };
    let rounded = Affine3A::from_mat3_translation(there.matrix3.as_mat3(), there.translation.as_vec3());
    // Of a transform that magnifies by more than 10³⁸ nothing would be left.
    let greatest = there.matrix3.to_cols_array().into_iter().fold(0.0f64, |m, x| m.max(x.abs()));
    (amplification <= MAX_CONDITION && rounded.is_finite() && greatest >= f64::from(f32::MIN_POSITIVE)).then_some((rounded, amplification))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{Quat, Vec3};

    #[test]
    fn margins_follow_an_update() {
        let blas = Arc::new(Blas::build(&[Vec3::ZERO, Vec3::X, Vec3::Y], &[[0, 1, 2]], &BuildOptions::default()).unwrap());
        let near = vec![BvhInstance::new(0, Affine3A::IDENTITY), BvhInstance::new(0, Affine3A::from_translation(Vec3::X))];
        let sheared = Affine3A::from_scale(Vec3::new(100.0, 1.0, 1.0)) * Affine3A::from_quat(Quat::from_rotation_z(1.0));
        let far = vec![near[0], BvhInstance::new(0, Affine3A::from_translation(Vec3::X * 1e4) * sheared)];
        let options = BuildOptions { allow_update: true, ..BuildOptions::default() };
        let mut world = Tlas::build_with(vec![blas.clone()], &near, &options).unwrap();
        let before = world.margin();
        world.update(vec![blas.clone()], &far).unwrap();
        assert_eq!(world.margin(), Tlas::build(vec![blas.clone()], far).unwrap().margin());
        assert!(world.margin().0 > 50.0 * before.0 && world.margin().1 > 1e5 * before.1, "{before:?} {:?}", world.margin());
        world.update(vec![blas], &near).unwrap();
        assert_eq!(world.margin(), before);
    }
}

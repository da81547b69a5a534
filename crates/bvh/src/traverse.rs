//! Traversal of both levels, generic over instructions, counters and the question asked.

use crate::{
    blas::Blas,
    counters::Count,
    lanes::{Crossings, Lanes, Task},
    packet::Frustum,
    ray::{Filter, Hit, Ray},
    slab::{MARGIN, SlabRay},
    stack::{Stack, Storage},
    tlas::{Placed, Tlas},
    triangle::{BLOCK_SIZE, Block, NO_PRIMITIVE, ShearedRay},
    wide::{Child, Node, WideTree},
};
use std::ops::Range;

/// The nearest accepted hit so far. Of two at the same `t` the one with the lower (instance, primitive) is nearer.
#[derive(Clone, Copy)]
pub(crate) struct Nearest {
    pub hit: Hit,
    pub found: bool,
}

impl Nearest {
    pub fn before(t_max: f32) -> Self {
        Self { hit: Hit { t: t_max, u: 0.0, v: 0.0, primitive: 0, instance: 0 }, found: false }
    }

    /// Whether `hit` would replace the one kept. Without one, (0, 0) stands at `t_max`, so nothing wins the tie: the interval is open.
    #[inline(always)]
    pub fn is_beaten_by(&self, hit: &Hit) -> bool {
        hit.t < self.hit.t || (hit.t == self.hit.t && hit.primitive_ref().key() < self.hit.primitive_ref().key())
    }

    /// [`is_beaten_by`](Self::is_beaten_by), for shapes too, whose interval is closed: at `t_max` they beat nothing.
    pub fn admits(&self, hit: &Hit) -> bool {
        self.is_beaten_by(hit) || (!self.found && hit.t == self.hit.t)
    }

    pub fn into_option(self) -> Option<Hit> {
        self.found.then_some(self.hit)
    }
}

/// An instance that is entered.
#[derive(Clone, Copy)]
pub(crate) struct Inside<'a> {
    pub blas: &'a Blas,
    pub instance: u32,
    /// Whether its hits need to be accepted.
    pub ask: bool,
    /// The triangle of it that is never hit, [`NO_PRIMITIVE`] for none.
    pub exclude: u32,
}

impl<'a> Inside<'a> {
    #[inline(always)]
    pub fn new(tlas: &'a Tlas, placed: &Placed, filter: &Filter) -> Self {
        let blas = &*tlas.blases()[placed.blas as usize];
        Self { blas, instance: placed.instance, ask: !placed.opaque, exclude: filter.excluded_in(placed.instance) }
    }

    /// Traces a ray through its mesh; `ray` is the ray of the query in the space of the mesh.
    #[inline(always)]
    pub fn trace<L: Lanes, F: FnMut(&Hit) -> bool, C: Count, const ANY: bool>(self, ray: &Ray, query: &mut Query<F, C>) {
        if self.blas.shapes().is_none() {
            L::call(&mut Mesh::<F, C, ANY, false> { inside: self, ray, query });
        } else {
            L::call(&mut Mesh::<F, C, ANY, true> { inside: self, ray, query });
        }
    }
}

/// Everything about one ray that both levels share.
pub(crate) struct Query<'a, F, C> {
    pub ray: &'a Ray,
    pub filter: Filter,
    pub accept: F,
    pub counters: &'a mut C,
    pub nearest: Nearest,
}

/// Traces one ray through the world. `ANY` ends at the first accepted hit; `OPAQUE` never asks `accept`.
pub(crate) struct World<'a, 'q, F, C, const ANY: bool, const OPAQUE: bool> {
    pub tlas: &'a Tlas,
    pub query: &'a mut Query<'q, F, C>,
}

impl<C: Count, F: FnMut(&Hit) -> bool, const ANY: bool, const OPAQUE: bool> World<'_, '_, F, C, ANY, OPAQUE> {
    #[inline(always)]
    pub fn trace<L: Lanes>(mut self) {
        let root = self.tlas.tree().root;
        if !self.query.ray.is_usable() || root == Child::NONE {
        } else if root.is_leaf() {
            // With a single instance there is no box to test.
            self.leaf::<L>(root.items());
        } else {
            L::call(&mut self);
        }
    }
}

impl<C: Count, F: FnMut(&Hit) -> bool, const ANY: bool, const OPAQUE: bool> Task for World<'_, '_, F, C, ANY, OPAQUE> {
    #[inline(always)]
    fn run<L: Lanes>(&mut self) {
        let tree = self.tlas.tree();
        let (margin, extra) = self.tlas.margin();
        let slab = SlabRay::new(self.query.ray, &tree.bounds, margin, extra);
        walk::<L, _, _>(tree, &slab, self);
    }
}

/// What a walk through one level asks and tells.
pub(crate) trait Visitor {
    /// Boxes entered beyond this are skipped.
    fn limit(&self) -> f32;
    /// A node is about to be tested.
    fn node(&mut self);
    /// Of the children whose boxes are met, those worth a visit.
    #[inline(always)]
    fn refine<L: Lanes>(&self, _node: &Node, met: u32) -> u32 {
        met
    }
    /// Tests the items of a leaf; `true` ends the walk.
    fn leaf<L: Lanes>(&mut self, items: Range<usize>) -> bool;
}

/// What nodes are tested against: a ray, or many.
pub(crate) trait AgainstBoxes {
    /// The nearest of the children that are met before `t_max`; the others are pushed, the nearest last. [`Child::NONE`] if there is none.
    fn enter<L: Lanes, V: Visitor>(&self, node: &Node, t_max: f32, visitor: &V, stack: &mut Stack) -> Child;
}

impl AgainstBoxes for SlabRay {
    #[inline(always)]
    fn enter<L: Lanes, V: Visitor>(&self, node: &Node, t_max: f32, _: &V, stack: &mut Stack) -> Child {
        L::enter(self, node, t_max, stack)
    }
}

impl AgainstBoxes for Frustum {
    #[inline(always)]
    fn enter<L: Lanes, V: Visitor>(&self, node: &Node, t_max: f32, visitor: &V, stack: &mut Stack) -> Child {
        let (met, distances) = L::frustum_boxes(self, node, t_max);
        let met = visitor.refine::<L>(node, met);
        stack.push_farther(node, self.octant, met, &distances)
    }
}

/// Visits leaves roughly front to back (by the order of the children for the octant of the direction).
#[inline(always)]
pub(crate) fn walk<L: Lanes, B: AgainstBoxes, V: Visitor>(tree: &WideTree, against: &B, visitor: &mut V) {
    let mut place = Storage::UNINIT;
    let mut stack = Stack::new(Storage::empty(&mut place));
    let mut limit = visitor.limit();
    let mut child = tree.root;
    loop {
        if child.is_leaf() {
            // What is not there is met by rays that lack axes.
            if child != Child::NONE && visitor.leaf::<L>(child.items()) {
                return;
            }
            limit = visitor.limit();
        } else {
            visitor.node();
            child = against.enter::<L, V>(&tree.nodes[child.index()], limit, visitor, &mut stack);
            if child != Child::NONE {
                continue;
            }
        }
        child = loop {
            match stack.pop() {
                Some(next) if next.t_near <= limit => break next.child,
                Some(_) => {}
                None => return,
            }
        };
    }
}

/// Leaves of the upper level are instances.
impl<C: Count, F: FnMut(&Hit) -> bool, const ANY: bool, const OPAQUE: bool> Visitor for World<'_, '_, F, C, ANY, OPAQUE> {
    #[inline(always)]
    fn limit(&self) -> f32 {
        self.query.nearest.hit.t
    }

    #[inline(always)]
    fn node(&mut self) {
        self.query.counters.node();
    }

    #[inline(always)]
    fn leaf<L: Lanes>(&mut self, items: Range<usize>) -> bool {
        for placed in &self.tlas.placed()[items] {
            if placed.mask & self.query.filter.mask == 0 {
                continue;
            }
            self.query.counters.instance();
            let moved;
            let ray = if placed.is_in_place() {
                self.query.ray
            } else if let Some(ray) = placed.local_ray(self.query.ray) {
                moved = ray;
                &moved
            } else {
                continue;
            };
            let inside = Inside::new(self.tlas, placed, &self.query.filter);
            Inside { ask: !OPAQUE && inside.ask, ..inside }.trace::<L, _, _, ANY>(ray, self.query);
            if ANY && self.query.nearest.found {
                return true;
            }
        }
        false
    }
}

/// Traces a ray through one mesh, in its space. `SHAPES` tells whether it has any.
struct Mesh<'a, 'q, F, C, const ANY: bool, const SHAPES: bool> {
    inside: Inside<'a>,
    ray: &'a Ray,
    query: &'a mut Query<'q, F, C>,
}

impl<C: Count, F: FnMut(&Hit) -> bool, const ANY: bool, const SHAPES: bool> Task for Mesh<'_, '_, F, C, ANY, SHAPES> {
    #[inline(always)]
    fn run<L: Lanes>(&mut self) {
        let tree = self.inside.blas.tree();
        let slab = SlabRay::new(self.ray, &tree.bounds, MARGIN, 0.0);
        let sheared = ShearedRay::new(self.ray);
        walk::<L, _, _>(tree, &slab, &mut InMesh { sheared, mesh: self });
    }
}

/// Leaves of the lower level are blocks of triangles.
struct InMesh<'m, 'a, 'q, F, C, const ANY: bool, const SHAPES: bool> {
    sheared: ShearedRay,
    mesh: &'m mut Mesh<'a, 'q, F, C, ANY, SHAPES>,
}

impl<C: Count, F: FnMut(&Hit) -> bool, const ANY: bool, const SHAPES: bool> Visitor for InMesh<'_, '_, '_, F, C, ANY, SHAPES> {
    #[inline(always)]
    fn limit(&self) -> f32 {
        self.mesh.query.nearest.hit.t
    }

    #[inline(always)]
    fn node(&mut self) {
        self.mesh.query.counters.node();
    }

    #[inline(always)]
    fn leaf<L: Lanes>(&mut self, items: Range<usize>) -> bool {
        for block in &self.mesh.inside.blas.blocks()[items] {
            self.mesh.query.counters.triangles(|| block.len());
            let mut crossings = Crossings::default();
            let mut crossed = L::triangles(&self.sheared, block, self.mesh.ray.t_min, self.limit(), &mut crossings);
            while crossed != 0 {
                let lane = crossed.trailing_zeros() as usize % BLOCK_SIZE;
                crossed &= crossed - 1;
                self.consider(block.primitives[lane], crossings.t[lane], crossings.u[lane], crossings.v[lane]);
                if ANY && self.mesh.query.nearest.found {
                    return true;
                }
            }
            if SHAPES {
                self.shapes(block);
                if ANY && self.mesh.query.nearest.found {
                    return true;
                }
            }
        }
        false
    }
}

impl<C: Count, F: FnMut(&Hit) -> bool, const ANY: bool, const SHAPES: bool> InMesh<'_, '_, '_, F, C, ANY, SHAPES> {
    /// Asks the shapes of a block.
    #[inline(never)]
    fn shapes(&mut self, block: &Block) {
        for primitive in block.primitives.into_iter().filter(|&primitive| primitive != NO_PRIMITIVE) {
            let Inside { blas, instance, ask, exclude } = self.mesh.inside;
            let Some(crossing) = blas.cross_shape(primitive, self.mesh.ray) else { continue };
            let hit = Hit { t: crossing.t, u: crossing.u, v: crossing.v, primitive, instance };
            let query = &mut *self.mesh.query;
            if query.nearest.admits(&hit) && primitive != exclude && (!ask || (query.accept)(&hit)) {
                query.nearest = Nearest { hit, found: true };
            }
        }
    }

    /// Keeps a hit if it is nearer than the one before and accepted.
    #[inline(always)]
    fn consider(&mut self, primitive: u32, t: f32, u: f32, v: f32) {
        let Inside { instance, ask, exclude, .. } = self.mesh.inside;
        let hit = Hit { t, u, v, primitive, instance };
        let query = &mut *self.mesh.query;
        if query.nearest.is_beaten_by(&hit) && primitive != exclude && (!ask || (query.accept)(&hit)) {
            query.nearest = Nearest { hit, found: true };
        }
    }
}

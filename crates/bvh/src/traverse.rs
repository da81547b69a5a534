//! Traversal of both levels, generic over instructions, counters and the question asked.

use crate::{
    counters::Count,
    lanes::Lanes,
    ray::{Filter, Hit, PrimitiveRef, Ray},
    slab::{MARGIN, SlabRay},
    stack::{Stack, Waiting},
    tlas::Tlas,
    triangle::{Block, NO_PRIMITIVE, ShearedRay},
    wide::{Child, WideTree},
};
use std::{marker::PhantomData, ops::Range};

/// The nearest accepted hit so far. Of two at the same `t` the one with the lower (instance, primitive) is nearer.
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

    pub fn into_option(self) -> Option<Hit> {
        self.found.then_some(self.hit)
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

/// Traces a ray through the world. `ANY` ends at the first accepted hit; `OPAQUE` never asks `accept`.
#[inline(always)]
pub(crate) fn trace<L: Lanes, C: Count, F: FnMut(&Hit) -> bool, const ANY: bool, const OPAQUE: bool>(tlas: &Tlas, query: &mut Query<F, C>) {
    if !query.ray.is_usable() {
        return;
    }
    let (margin, extra) = tlas.margin();
    let slab = SlabRay::new(query.ray, &tlas.tree().bounds, margin, extra);
    walk::<L, _>(tlas.tree(), &slab, &mut World::<L, F, C, ANY, OPAQUE> { tlas, query, lanes: PhantomData });
}

/// What a walk through one level asks and tells.
trait Visitor {
    /// Whether near children should come first.
    const ORDERED: bool;
    /// Boxes entered beyond this are skipped.
    fn limit(&self) -> f32;
    /// A node is about to be tested.
    fn node(&mut self);
    /// Tests the items of a leaf; `true` ends the walk.
    fn leaf(&mut self, items: Range<usize>) -> bool;
}

/// Visits leaves front to back (by the entry into their boxes).
#[inline(always)]
fn walk<L: Lanes, V: Visitor>(tree: &WideTree, slab: &SlabRay, visitor: &mut V) {
    if tree.root == Child::NONE {
        return;
    }
    let mut stack = Stack::new();
    let mut child = tree.root;
    loop {
        if child.is_leaf() {
            if visitor.leaf(child.items()) {
                return;
            }
        } else {
            visitor.node();
            let node = &tree.nodes[child.index()];
            let (mut met, distances) = L::boxes(slab, node, visitor.limit());
            let waiting = |slot: usize| Waiting { child: node.children[slot], t_near: distances.0[slot] };
            if met.is_power_of_two() {
                child = node.children[met.trailing_zeros() as usize];
                continue;
            }
            let start = stack.len();
            while met != 0 {
                stack.push(waiting(met.trailing_zeros() as usize));
                met &= met - 1;
            }
            if V::ORDERED {
                stack.sort_from(start);
            }
        }
        child = loop {
            match stack.pop() {
                Some(next) if next.t_near <= visitor.limit() => break next.child,
                Some(_) => {}
                None => return,
            }
        };
    }
}

/// The upper level: leaves are instances.
struct World<'a, 'q, L, F, C, const ANY: bool, const OPAQUE: bool> {
    tlas: &'a Tlas,
    query: &'a mut Query<'q, F, C>,
    lanes: PhantomData<L>,
}

impl<L: Lanes, C: Count, F: FnMut(&Hit) -> bool, const ANY: bool, const OPAQUE: bool> Visitor for World<'_, '_, L, F, C, ANY, OPAQUE> {
    const ORDERED: bool = !ANY;

    #[inline(always)]
    fn limit(&self) -> f32 {
        self.query.nearest.hit.t
    }

    #[inline(always)]
    fn node(&mut self) {
        self.query.counters.node();
    }

    #[inline(always)]
    fn leaf(&mut self, items: Range<usize>) -> bool {
        for slot in items {
            let placed = &self.tlas.placed()[slot];
            if placed.mask & self.query.filter.mask == 0 {
                continue;
            }
            self.query.counters.instance();
            let blas = &self.tlas.blases()[placed.blas as usize];
            let ray = placed.local_ray(self.query.ray);
            if !ray.is_usable() {
                continue;
            }
            let exclude = match self.query.filter.exclude {
                Some(PrimitiveRef { instance, primitive }) if instance == placed.instance => primitive,
                _ => NO_PRIMITIVE,
            };
            let slab = SlabRay::new(&ray, &blas.tree().bounds, MARGIN, 0.0);
            let mut mesh = Mesh::<L, F, C, ANY> {
                sheared: ShearedRay::new(&ray),
                blocks: blas.blocks(),
                instance: placed.instance,
                ask: !OPAQUE && !placed.opaque,
                exclude,
                query: self.query,
                lanes: PhantomData,
            };
            walk::<L, _>(blas.tree(), &slab, &mut mesh);
            if ANY && self.query.nearest.found {
                return true;
            }
        }
        false
    }
}

/// The lower level: leaves are blocks of triangles.
struct Mesh<'a, 'q, L, F, C, const ANY: bool> {
    sheared: ShearedRay,
    blocks: &'a [Block],
    instance: u32,
    ask: bool,
    exclude: u32,
    query: &'a mut Query<'q, F, C>,
    lanes: PhantomData<L>,
}

impl<L: Lanes, C: Count, F: FnMut(&Hit) -> bool, const ANY: bool> Visitor for Mesh<'_, '_, L, F, C, ANY> {
    const ORDERED: bool = !ANY;

    #[inline(always)]
    fn limit(&self) -> f32 {
        self.query.nearest.hit.t
    }

    #[inline(always)]
    fn node(&mut self) {
        self.query.counters.node();
    }

    #[inline(always)]
    fn leaf(&mut self, items: Range<usize>) -> bool {
        for block in &self.blocks[items] {
            self.query.counters.triangles(|| block.len());
            let mut candidates = L::triangles(&self.sheared, block);
            while candidates != 0 {
                let lane = candidates.trailing_zeros() as usize;
                candidates &= candidates - 1;
                self.consider(block, lane);
                if ANY && self.query.nearest.found {
                    return true;
                }
            }
        }
        false
    }
}

impl<L: Lanes, C: Count, F: FnMut(&Hit) -> bool, const ANY: bool> Mesh<'_, '_, L, F, C, ANY> {
    /// Decides a candidate and keeps it if it is nearer and accepted.
    #[inline(always)]
    fn consider(&mut self, block: &Block, lane: usize) {
        let Some(crossing) = self.sheared.cross_lane(block, lane) else { return };
        let primitive = block.primitives[lane];
        let hit = Hit { t: crossing.t, u: crossing.u, v: crossing.v, primitive, instance: self.instance };
        let query = &mut *self.query;
        if hit.t > query.ray.t_min && query.nearest.is_beaten_by(&hit) && primitive != self.exclude && (!self.ask || (query.accept)(&hit)) {
            query.nearest = Nearest { hit, found: true };
        }
    }
}

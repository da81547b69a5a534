//! Many rays in flight, each on its own way.
//!
//! A ray alone waits: for memory, for one test to end before the next can begin, and after every branch that was guessed wrong. Here many take turns. Each
//! takes the top of its stack; then those that took a node test it, and those that took a leaf test a block of triangles, in loops without
//! branches that depend on what is found, so that the processor overlaps the work of several rays. A ray that is done makes room for the next. Every hit
//! is, bit for bit, that of the ray alone.
//! Unlike streams that are sorted to share nodes, these rays share nothing but the processor. Their stacks stand on that of the thread and take 300 KiB of
//! it, once more for each batch that is traced while another one asks whether a hit is accepted.

use crate::{
    counters::NoCounters,
    lanes::{Crossings, Lanes, Task},
    ray::{Filter, Hit, Ray},
    slab::{MARGIN, SlabRay},
    stack::{Stack, Storage},
    tlas::Tlas,
    traverse::{Inside, Nearest, Query},
    triangle::{BLOCK_SIZE, ShearedRay},
    wide::{Child, WideTree},
};

/// Rays in flight.
const FLIGHTS: usize = 32;

/// Hierarchies larger than this do not stay in a processor's second cache, and what is visited next is called for ahead. Bytes.
pub(crate) const FAR_MEMORY: usize = 8 << 20;

/// Traces all of `rays`; `ANY` stops each at its first accepted hit.
pub(crate) struct Stream<'a, F, R, const ANY: bool> {
    pub tlas: &'a Tlas,
    pub rays: &'a [Ray],
    pub filter: Filter,
    /// Asked with the number of the ray.
    pub accept: F,
    /// Told the number of each ray and its hit.
    pub report: R,
    /// The next ray to send off.
    pub next: usize,
}

/// A ray on its way.
#[derive(Clone, Copy)]
struct Flight<'a> {
    /// The ray, prepared for the boxes of `tree`.
    slab: SlabRay,
    /// Of the level that it is in.
    tree: &'a WideTree,
    /// The instance that it is in.
    inside: Option<Inside<'a>>,
    /// What it took from its stack.
    child: Child,
    /// Index of the ray.
    ray: usize,
    nearest: Nearest,
    /// The ray, prepared for the triangles of the instance.
    sheared: ShearedRay,
    /// The ray, prepared for the boxes of the upper level.
    slab_in_world: SlabRay,
}

/// Some of the flights.
struct List {
    flights: [u8; FLIGHTS],
    count: usize,
}

impl List {
    const EMPTY: Self = Self { flights: [0; FLIGHTS], count: 0 };

    /// Adds one if it is `wanted`; no branch.
    #[inline(always)]
    fn add(&mut self, flight: u8, wanted: bool) {
        self.flights[self.count % FLIGHTS] = flight;
        self.count += usize::from(wanted);
    }

    fn remove(&mut self, flight: u8) {
        let place = self.get().iter().position(|&other| other == flight).expect("it is in the list");
        self.count -= 1;
        self.flights[place] = self.flights[self.count];
    }

    #[inline(always)]
    fn get(&self) -> &[u8] {
        &self.flights[..self.count.min(FLIGHTS)]
    }
}

impl<F: FnMut(usize, &Hit) -> bool, R: FnMut(usize, Nearest), const ANY: bool> Task for Stream<'_, F, R, ANY> {
    #[inline(always)]
    fn run<L: Lanes>(&mut self) {
        let Some(first) = self.rays.first() else { return };
        let (mut flights, mut places) = ([Flight::idle(first, self.tlas); FLIGHTS], [const { Storage::UNINIT }; FLIGHTS]);
        let stacks = places.each_mut().map(Storage::empty);
        let only = self.only();
        let far = self.tlas.is_far();
        let mut active = List::EMPTY;
        while active.count < FLIGHTS && self.start(&only, &mut flights[active.count], stacks[active.count]) {
            active.add(active.count as u8, true);
        }
        while active.count > 0 {
            let (mut at_nodes, mut at_blocks, mut at_ends) = (List::EMPTY, List::EMPTY, List::EMPTY);
            for &i in active.get() {
                let (flight, mut stack) = (&mut flights[i as usize % FLIGHTS], Stack::of(stacks[i as usize % FLIGHTS]));
                let Some(top) = stack.pop() else { continue };
                stack.put_aside();
                flight.child = top.child;
                let end = (top.child == Child::NONE) | flight.inside.is_none();
                at_nodes.add(i, !top.child.is_leaf());
                at_blocks.add(i, top.child.is_leaf() & !end);
                at_ends.add(i, top.child.is_leaf() & end);
                if far {
                    flight.call_for::<L>();
                }
            }
            for &i in at_nodes.get() {
                let (flight, mut stack) = (&flights[i as usize % FLIGHTS], Stack::of(stacks[i as usize % FLIGHTS]));
                L::enter_all(&flight.slab, &flight.tree.nodes[flight.child.index()], flight.nearest.hit.t, &mut stack);
                stack.put_aside();
            }
            let mut at_triangles = List::EMPTY;
            for &i in at_blocks.get() {
                let (flight, mut stack) = (&flights[i as usize % FLIGHTS], Stack::of(stacks[i as usize % FLIGHTS]));
                let Some(inside) = &flight.inside else { continue };
                let (first, rest) = flight.child.split_first();
                stack.push_if(rest.is_some(), rest.unwrap_or(Child::NONE));
                stack.put_aside();
                at_triangles.add(i, L::may_cross(&flight.sheared, &inside.blas.blocks()[first]));
            }
            for &i in at_triangles.get() {
                let flight = &mut flights[i as usize % FLIGHTS];
                self.triangles::<L>(flight, stacks[i as usize % FLIGHTS]);
            }
            for &i in at_ends.get() {
                let (flight, storage) = (&mut flights[i as usize % FLIGHTS], &mut *stacks[i as usize % FLIGHTS]);
                if flight.child != Child::NONE {
                    self.enter::<L>(flight, storage);
                } else if !Stack::of(storage).is_empty() {
                    flight.leave(self.tlas);
                } else {
                    (self.report)(flight.ray, flight.nearest);
                    if !self.start(&only, flight, storage) {
                        active.remove(i);
                    }
                }
            }
        }
    }
}

impl<'a, F: FnMut(usize, &Hit) -> bool, R: FnMut(usize, Nearest), const ANY: bool> Stream<'a, F, R, ANY> {
    /// The instance, if it is all there is, in its place and without shapes: rays start in it.
    fn only(&self) -> Option<Inside<'a>> {
        let tlas = self.tlas;
        let [placed] = tlas.placed() else { return None };
        let plain = placed.is_in_place() && tlas.blases()[placed.blas as usize].shapes().is_none();
        (plain && placed.mask & self.filter.mask != 0).then(|| Inside::new(tlas, placed, &self.filter))
    }

    /// Sends off the next ray that can hit anything; those before it are reported. `false` if there is none.
    #[inline(always)]
    fn start(&mut self, only: &Option<Inside<'a>>, flight: &mut Flight<'a>, storage: &mut Storage) -> bool {
        let tlas = self.tlas;
        loop {
            let Some(ray) = self.rays.get(self.next) else { return false };
            flight.ray = self.next;
            self.next += 1;
            flight.nearest = Nearest::before(ray.t_max);
            if !ray.is_usable() || tlas.tree().root == Child::NONE {
                (self.report)(flight.ray, flight.nearest);
                continue;
            }
            flight.inside = *only;
            if let Some(inside) = only {
                flight.tree = inside.blas.tree();
                flight.slab = SlabRay::new(ray, &flight.tree.bounds, MARGIN, 0.0);
                flight.sheared = ShearedRay::new(ray);
            } else {
                let (margin, extra) = tlas.margin();
                flight.tree = tlas.tree();
                flight.slab = SlabRay::new(ray, &flight.tree.bounds, margin, extra);
                flight.slab_in_world = flight.slab;
            }
            if flight.slab.lacks_axes() {
                self.start_alone(flight);
                continue;
            }
            let mut stack = Stack::new(storage);
            stack.push_child(Child::NONE);
            stack.push_child(flight.tree.root);
            stack.put_aside();
            return true;
        }
    }

    /// The whole of a ray that lacks axes: it meets children that are not there, which here are marks.
    #[cold]
    fn start_alone(&mut self, flight: &mut Flight<'a>) {
        let accept = &mut self.accept;
        let nearest = self.tlas.nearest::<_, ANY>(&self.rays[flight.ray], self.filter, |hit| accept(flight.ray, hit));
        (self.report)(flight.ray, nearest);
    }

    /// A leaf of the upper level is an instance. One with shapes is traced at once, and a ray that lacks axes in it.
    #[inline(always)]
    fn enter<L: Lanes>(&mut self, flight: &mut Flight<'a>, storage: &mut Storage) {
        let mut stack = Stack::of(storage);
        let (first, rest) = flight.child.split_first();
        stack.push_if(rest.is_some(), rest.unwrap_or(Child::NONE));
        let placed = &self.tlas.placed()[first];
        if placed.mask & self.filter.mask != 0
            && let Some(ray) = placed.local_ray(&self.rays[flight.ray])
        {
            let inside = Inside::new(self.tlas, placed, &self.filter);
            let slab = SlabRay::new(&ray, &inside.blas.tree().bounds, MARGIN, 0.0);
            if inside.blas.shapes().is_some() || slab.lacks_axes() {
                self.alone::<L>(flight, inside, &ray);
                flight.hit::<ANY>(&mut stack);
            } else {
                flight.tree = inside.blas.tree();
                flight.slab = slab;
                flight.sheared = ShearedRay::new(&ray);
                flight.inside = Some(inside);
                stack.push_child(Child::NONE);
                stack.push_child(flight.tree.root);
            }
        }
        stack.put_aside();
    }

    /// The whole of an instance.
    #[inline(never)]
    fn alone<L: Lanes>(&mut self, flight: &mut Flight<'a>, inside: Inside, ray: &Ray) {
        let accept = &mut self.accept;
        let accept = |hit: &Hit| accept(flight.ray, hit);
        let mut query =
            Query { ray: &self.rays[flight.ray], filter: self.filter, accept, counters: &mut NoCounters, nearest: flight.nearest };
        inside.trace::<L, _, _, ANY>(ray, &mut query);
        flight.nearest = query.nearest;
    }

    /// Tests the triangles of a block.
    #[inline(always)]
    fn triangles<L: Lanes>(&mut self, flight: &mut Flight<'a>, storage: &mut Storage) {
        let Some(Inside { blas, instance, ask, exclude }) = flight.inside else { return };
        let block = &blas.blocks()[flight.child.split_first().0];
        let mut crossings = Crossings::default();
        let mut crossed = L::triangles(&flight.sheared, block, flight.slab.t_min, flight.nearest.hit.t, &mut crossings);
        while crossed != 0 {
            let lane = crossed.trailing_zeros() as usize % BLOCK_SIZE;
            crossed &= crossed - 1;
            let (t, u, v, primitive) = (crossings.t[lane], crossings.u[lane], crossings.v[lane], block.primitives[lane]);
            let hit = Hit { t, u, v, primitive, instance };
            if flight.nearest.is_beaten_by(&hit) && primitive != exclude && (!ask || (self.accept)(flight.ray, &hit)) {
                flight.nearest = Nearest { hit, found: true };
                let mut stack = Stack::of(storage);
                flight.hit::<ANY>(&mut stack);
                stack.put_aside();
                if ANY {
                    return;
                }
            }
        }
    }
}

impl<'a> Flight<'a> {
    /// Not under way.
    fn idle(ray: &Ray, tlas: &'a Tlas) -> Self {
        let tree = tlas.tree();
        let slab = SlabRay::new(ray, &tree.bounds, 0.0, 0.0);
        let (nearest, sheared) = (Nearest::before(0.0), ShearedRay::new(ray));
        Self { slab, tree, inside: None, child: Child::NONE, ray: 0, nearest, sheared, slab_in_world: slab }
    }

    /// After what may have been a hit: what begins behind it is forgotten, so that nothing on the stack needs a second look.
    #[inline(always)]
    fn hit<const ANY: bool>(&mut self, stack: &mut Stack) {
        if ANY && self.nearest.found {
            // The lowest entry ends the ray.
            stack.keep_first();
            self.inside = None;
        } else {
            stack.forget_beyond(self.nearest.hit.t);
        }
    }

    /// Back to the upper level.
    #[inline(always)]
    fn leave(&mut self, tlas: &'a Tlas) {
        self.inside = None;
        self.tree = tlas.tree();
        self.slab = self.slab_in_world;
    }

    /// Has the memory of the child brought.
    #[inline(always)]
    fn call_for<L: Lanes>(&self) {
        if self.child.is_leaf() {
            if let Some(block) = self.inside.as_ref().and_then(|inside| inside.blas.blocks().get(self.child.split_first().0)) {
                L::call_for(block);
            }
        } else if let Some(node) = self.tree.nodes.get(self.child.index()) {
            L::call_for(node);
        }
    }
}

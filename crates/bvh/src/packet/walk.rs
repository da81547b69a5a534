//! The walk of a packet through both levels.

use super::{Frustum, NearestHits, Packet, SIZE};
use crate::{
    counters::NoCounters,
    lanes::{Lanes, Task},
    ray::{Filter, Hit, PrimitiveRef, Ray},
    slab::MARGIN,
    tlas::{Placed, Tlas},
    traverse::{Inside, Query, Visitor, walk},
    triangle::{BLOCK_SIZE, NO_PRIMITIVE},
    wide::{Child, Node},
};
use std::ops::Range;

/// Traces rays that run alike through the world; `ANY` stops each at its first accepted hit.
pub(crate) struct PacketWorld<'a, F, const ANY: bool> {
    pub tlas: &'a Tlas,
    pub rays: &'a [Ray; SIZE],
    pub filter: Filter,
    /// Asked with the number of the ray.
    pub accept: F,
    pub nearest: NearestHits,
    /// Whether the rays were alike; if not, nothing was traced.
    pub traced: bool,
    /// Nodes and triangles that were tested.
    pub work: u32,
}

impl<F: FnMut(usize, &Hit) -> bool, const ANY: bool> Task for PacketWorld<'_, F, ANY> {
    #[inline(always)]
    fn run<L: Lanes>(&mut self) {
        // No closures around what is inlined here: they would be compiled without the instructions.
        let packet = Packet::new(self.rays);
        if !packet.alike {
            return;
        }
        let tree = self.tlas.tree();
        if tree.root == Child::NONE {
        } else if tree.root.is_leaf() {
            // With a single instance there is no box to test.
            InWorld { packet: &packet, world: self }.leaf::<L>(tree.root.items());
        } else {
            let (margin, extra) = self.tlas.margin();
            let frustum = packet.frustum(&tree.bounds, margin, extra);
            if !frustum.fits {
                return;
            }
            walk::<L, _, _>(tree, &frustum, &mut InWorld { packet: &packet, world: self });
        }
        self.traced = true;
    }
}

/// Leaves of the upper level are instances.
struct InWorld<'w, 'a, F, const ANY: bool> {
    packet: &'w Packet,
    world: &'w mut PacketWorld<'a, F, ANY>,
}

impl<F: FnMut(usize, &Hit) -> bool, const ANY: bool> Visitor for InWorld<'_, '_, F, ANY> {
    #[inline(always)]
    fn limit(&self) -> f32 {
        self.world.nearest.farthest()
    }

    #[inline(always)]
    fn node(&mut self) {
        self.world.work += 1;
    }

    #[inline(always)]
    fn leaf<L: Lanes>(&mut self, items: Range<usize>) -> bool {
        let tlas = self.world.tlas;
        for placed in &tlas.placed()[items] {
            if placed.mask & self.world.filter.mask == 0 {
                continue;
            }
            let inside = Inside::new(tlas, placed, &self.world.filter);
            if placed.is_in_place() {
                self.world.enter::<L>(placed, inside, self.packet);
            } else {
                // A ray that cannot hit anything there is none that is alike.
                self.world.enter::<L>(placed, inside, &Packet::new(&placed.local_rays(self.world.rays)));
            }
            if ANY && self.limit() == f32::NEG_INFINITY {
                return true;
            }
        }
        false
    }
}

impl<F: FnMut(usize, &Hit) -> bool, const ANY: bool> PacketWorld<'_, F, ANY> {
    /// All rays together, `packet` being what they are there.
    #[inline(always)]
    fn enter<L: Lanes>(&mut self, placed: &Placed, inside: Inside, packet: &Packet) {
        let tree = inside.blas.tree();
        let frustum = packet.frustum(&tree.bounds, MARGIN, 0.0);
        if packet.alike && frustum.fits && inside.blas.shapes().is_none() {
            let limit = self.nearest.farthest();
            walk::<L, _, _>(tree, &frustum, &mut InMesh { inside, packet, frustum: &frustum, limit, world: self });
        } else {
            self.enter_alone::<L>(placed, inside);
        }
    }

    /// One ray after the other, where they are not alike in the instance's space.
    fn enter_alone<L: Lanes>(&mut self, placed: &Placed, inside: Inside) {
        for i in 0..SIZE {
            if ANY && self.nearest.is_found(i) {
                continue;
            }
            let Some(ray) = placed.local_ray(&self.rays[i]) else { continue };
            let accept = &mut self.accept;
            let accept = |hit: &Hit| accept(i, hit);
            let (nearest, counters) = (self.nearest.get::<ANY>(i), &mut NoCounters);
            let mut query = Query { ray: &self.rays[i], filter: self.filter, accept, counters, nearest };
            inside.trace::<L, _, _, ANY>(&ray, &mut query);
            let nearest = query.nearest;
            self.nearest.set::<ANY>(i, nearest);
        }
    }
}

/// Leaves of the lower level are blocks of triangles.
struct InMesh<'w, 'a, F, const ANY: bool> {
    inside: Inside<'w>,
    packet: &'w Packet,
    frustum: &'w Frustum,
    /// The farthest that a ray may still hit something.
    limit: f32,
    world: &'w mut PacketWorld<'a, F, ANY>,
}

impl<F: FnMut(usize, &Hit) -> bool, const ANY: bool> Visitor for InMesh<'_, '_, F, ANY> {
    #[inline(always)]
    fn limit(&self) -> f32 {
        self.limit
    }

    #[inline(always)]
    fn node(&mut self) {
        self.world.work += 1;
    }

    #[inline(always)]
    fn refine<L: Lanes>(&self, node: &Node, met: u32) -> u32 {
        self.frustum.refine(node, met, self.world.nearest.distances(), L::mul_add)
    }

    #[inline(always)]
    fn leaf<L: Lanes>(&mut self, items: Range<usize>) -> bool {
        let [x, y, z] = self.packet.axes();
        for block in &self.inside.blas.blocks()[items] {
            for lane in 0..BLOCK_SIZE {
                let primitive = block.primitives[lane];
                if primitive == NO_PRIMITIVE {
                    break;
                }
                self.world.work += 1;
                let [a, b, c] = &block.vertices;
                let vertices =
                    [[a[x][lane], a[y][lane], a[z][lane]], [b[x][lane], b[y][lane], b[z][lane]], [c[x][lane], c[y][lane], c[z][lane]]];
                if let Some(crossings) = self.packet.cross(&vertices, self.world.nearest.distances())
                    && primitive != self.inside.exclude
                {
                    let world = &mut *self.world;
                    let found = PrimitiveRef { instance: self.inside.instance, primitive };
                    world.nearest.consider::<ANY>(found, &crossings, self.inside.ask, &mut world.accept);
                    self.limit = world.nearest.farthest();
                    if ANY && self.limit == f32::NEG_INFINITY {
                        return true;
                    }
                }
            }
        }
        false
    }
}

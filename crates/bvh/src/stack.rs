//! The stack of children still to visit.

use crate::{
    lanes::Distances,
    wide::{Child, Node, WIDTH},
};
use std::mem::MaybeUninit;

/// Entries a traversal can need: a node leaves at most seven children waiting on each of the at most [`MAX_DEPTH`] levels; both levels and the
/// marks between them; and [room](Stack::room).
pub const CAPACITY: usize = 2 * (WIDTH - 1) * MAX_DEPTH + 4 * WIDTH;

/// Deepest tree that the builder makes.
pub const MAX_DEPTH: usize = 80;

/// A child to visit and the distance at which the ray enters its box.
#[derive(Clone, Copy)]
pub struct Waiting {
    pub child: Child,
    pub t_near: f32,
}

/// Place for a stack. Left uninitialised: clearing it would cost more than a ray.
pub struct Storage {
    children: [MaybeUninit<Child>; CAPACITY],
    distances: [MaybeUninit<f32>; CAPACITY],
    /// Entries of the stack that was put aside.
    len: usize,
}

impl Storage {
    /// Where nothing is yet.
    pub const UNINIT: MaybeUninit<Self> = MaybeUninit::uninit();

    /// An empty one in its place: built elsewhere it would be copied.
    #[inline(always)]
    pub fn empty(place: &mut MaybeUninit<Self>) -> &mut Self {
        // SAFETY: the length is written, and the arrays may be uninitialised.
        unsafe {
            (&raw mut (*place.as_mut_ptr()).len).write(0);
            place.assume_init_mut()
        }
    }
}

/// Apart from its storage, so that the length can live in a register. Invariant: entries below `len` are written.
pub struct Stack<'a> {
    children: &'a mut [MaybeUninit<Child>; CAPACITY],
    distances: &'a mut [MaybeUninit<f32>; CAPACITY],
    aside: &'a mut usize,
    len: usize,
}

impl<'a> Stack<'a> {
    /// An empty one.
    #[inline(always)]
    pub fn new(storage: &'a mut Storage) -> Self {
        Self { children: &mut storage.children, distances: &mut storage.distances, aside: &mut storage.len, len: 0 }
    }

    /// The one that was put aside.
    #[inline(always)]
    pub fn of(storage: &'a mut Storage) -> Self {
        let len = storage.len;
        Self { children: &mut storage.children, distances: &mut storage.distances, aside: &mut storage.len, len }
    }

    /// Leaves it in its storage.
    #[inline(always)]
    pub fn put_aside(self) {
        *self.aside = self.len;
    }

    #[inline(always)]
    pub fn push(&mut self, waiting: Waiting) {
        self.children[self.len].write(waiting.child);
        self.distances[self.len].write(waiting.t_near);
        self.len += 1;
    }

    /// Pushes what is visited in any case.
    #[inline(always)]
    pub fn push_child(&mut self, child: Child) {
        self.push(Waiting { child, t_near: f32::NEG_INFINITY });
    }

    /// Pushes a child if it is `wanted`; no branch.
    #[inline(always)]
    pub fn push_if(&mut self, wanted: bool, child: Child) {
        self.push_child(child);
        self.len -= usize::from(!wanted);
    }

    #[inline(always)]
    pub fn pop(&mut self) -> Option<Waiting> {
        self.len = self.len.checked_sub(1)?;
        // SAFETY: by the invariant.
        Some(unsafe { Waiting { child: self.children[self.len].assume_init(), t_near: self.distances[self.len].assume_init() } })
    }

    #[inline(always)]
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Drops all but the lowest entry.
    #[inline(always)]
    pub fn keep_first(&mut self) {
        self.len = self.len.min(1);
    }

    /// Drops what begins beyond `limit`.
    #[inline(always)]
    pub fn forget_beyond(&mut self, limit: f32) {
        let mut kept = 0;
        for i in 0..self.len {
            // SAFETY: by the invariant.
            let t_near = unsafe { self.distances[i].assume_init() };
            self.children[kept] = self.children[i];
            self.distances[kept] = self.distances[i];
            kept += usize::from(t_near <= limit);
        }
        self.len = kept;
    }

    /// Pushes those children of a node that are `met`, the nearest last, but for the nearest, which is returned; [`Child::NONE`] if there is none.
    #[inline(always)]
    pub fn push_farther(&mut self, node: &Node, octant: usize, mut met: u32, distances: &Distances) -> Child {
        if met == 0 {
            return Child::NONE;
        }
        let rest = met & (met - 1);
        if rest == 0 {
            return node.children[met.trailing_zeros() as usize % WIDTH];
        }
        if rest & (rest - 1) == 0 {
            return self.push_farther_of_two(node, met, rest, distances);
        }
        let mut order = node.orders[octant % 8];
        loop {
            let slot = order as usize % WIDTH;
            let bit = 1 << slot;
            if met == bit {
                return node.children[slot];
            }
            if met & bit != 0 {
                self.push(Waiting { child: node.children[slot], t_near: distances.0[slot] });
                met ^= bit;
            }
            order >>= 3;
        }
    }

    /// The same where two are met, the least bits of `met` and of `rest`: by the distances, which are better than the order. No branch.
    #[inline(always)]
    pub fn push_farther_of_two(&mut self, node: &Node, met: u32, rest: u32, Distances(distances): &Distances) -> Child {
        let (a, b) = (met.trailing_zeros() as usize % WIDTH, rest.trailing_zeros() as usize % WIDTH);
        let b_is_nearer = distances[b] < distances[a];
        let (near, far) = if b_is_nearer { (b, a) } else { (a, b) };
        self.push(Waiting { child: node.children[far], t_near: distances[far] });
        node.children[near]
    }

    /// Room for the children of a node and their distances on top of the stack.
    #[inline(always)]
    pub fn room(&mut self) -> (&mut [MaybeUninit<Child>; WIDTH], &mut [MaybeUninit<f32>; WIDTH]) {
        let room = "the capacity covers the deepest tree";
        (self.children[self.len..].first_chunk_mut().expect(room), self.distances[self.len..].first_chunk_mut().expect(room))
    }

    /// Makes the first entries of [`room`](Self::room) part of the stack.
    ///
    /// # Safety
    /// They have been written.
    #[inline(always)]
    pub unsafe fn grow(&mut self, count: usize) {
        self.len += count;
    }
}

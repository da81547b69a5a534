//! The stack of children still to visit.

use crate::wide::Child;
use std::mem::MaybeUninit;

/// Entries a traversal can need: a node leaves at most seven children waiting on each of the at most [`MAX_DEPTH`] levels.
pub const CAPACITY: usize = 7 * MAX_DEPTH + 8;

/// Deepest tree that the builder makes.
pub const MAX_DEPTH: usize = 80;

/// A child to visit and the distance at which the ray enters its box.
#[derive(Clone, Copy)]
pub struct Waiting {
    pub child: Child,
    pub t_near: f32,
}

/// Place for a stack. Left uninitialised: clearing 4.5 KiB would cost as much as a third of a ray.
pub struct Storage([MaybeUninit<Waiting>; CAPACITY]);

impl Storage {
    #[inline(always)]
    pub fn new() -> Self {
        Self([const { MaybeUninit::uninit() }; CAPACITY])
    }
}

/// Apart from its storage, so that the length can live in a register.
pub struct Stack<'a> {
    entries: &'a mut [MaybeUninit<Waiting>; CAPACITY],
    len: usize,
}

impl<'a> Stack<'a> {
    #[inline(always)]
    pub fn new(storage: &'a mut Storage) -> Self {
        Self { entries: &mut storage.0, len: 0 }
    }

    #[inline(always)]
    pub fn push(&mut self, waiting: Waiting) {
        self.entries[self.len].write(waiting);
        self.len += 1;
    }

    #[inline(always)]
    pub fn pop(&mut self) -> Option<Waiting> {
        self.len = self.len.checked_sub(1)?;
        // SAFETY: entries below the old `len` were written by `push`, and `len` only grows there.
        Some(unsafe { self.entries[self.len].assume_init() })
    }

    #[inline(always)]
    pub fn len(&self) -> usize {
        self.len
    }

    /// Sorts the entries from `start` so that the nearest is popped first. Short lists: insertion.
    #[inline(always)]
    pub fn sort_from(&mut self, start: usize) {
        // SAFETY: entries below `len` were written by `push`, and `Waiting` has the layout of `MaybeUninit<Waiting>`.
        let fresh: &mut [Waiting] = unsafe { std::mem::transmute(&mut self.entries[start..self.len]) };
        for i in 1..fresh.len() {
            let moving = fresh[i];
            let mut hole = i;
            while hole > 0 && fresh[hole - 1].t_near < moving.t_near {
                fresh[hole] = fresh[hole - 1];
                hole -= 1;
            }
            fresh[hole] = moving;
        }
    }
}

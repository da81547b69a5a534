//! Building anew on another thread, while the refitted tree serves.

use super::LightTree;
use std::thread::{JoinHandle, spawn};

/// A tree that is being built elsewhere. Refitting keeps a tree right, but not good: as emitters mix, its clusters grow. \[Moreau19] section 3.3
#[derive(Debug)]
pub struct Rebuild {
    thread: JoinHandle<LightTree>,
}

impl LightTree {
    /// Begins to build the tree of the emitters as they are now, on a thread of its own.
    pub fn rebuild(&self) -> Rebuild {
        let emitters = self.emitters.clone();
        Rebuild { thread: spawn(move || LightTree::new(emitters)) }
    }

    /// Puts the rebuilt tree in the place of this one, fitted to where the emitters are by now. Waits for it if it is not ready.
    ///
    /// # Panics
    /// When the rebuild is one of another number of emitters.
    pub fn swap(&mut self, rebuild: Rebuild) {
        let mut fresh = rebuild.thread.join().expect("building a light tree does not panic");
        fresh.refit(&self.emitters);
        *self = fresh;
    }
}

impl Rebuild {
    /// Whether [`LightTree::swap`] would not wait.
    pub fn is_ready(&self) -> bool {
        self.thread.is_finished()
    }
}

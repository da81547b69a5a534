//! Trees of meshes under a tree of the scene, so that what moves is all that changes.

use super::bounds::{EmitterBounds, is_similarity};
use super::importance::Receiver;
use super::{LightTree, Rebuild};
use glam::Affine3A;
use std::sync::Arc;

/// What the upper tree holds.
#[derive(Clone, Debug)]
pub enum Entry {
    /// A single emitter.
    Single(EmitterBounds),
    /// Emitters of an object: triangles of a mesh. Objects may share a tree.
    Object {
        /// The emitters in the object's own space.
        tree: Arc<LightTree>,
        /// Where the object is: a similarity, see [`is_similarity`]. Emitters of an object that is stretched are given in the world.
        world_from_object: Affine3A,
    },
}

/// An emitter that was chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoLevelChoice {
    /// Number of the entry.
    pub entry: usize,
    /// Number of the emitter in the entry's tree; 0 for a single one.
    pub emitter: usize,
    /// Probability of the choice.
    pub pmf: f32,
    /// What is left of the random number: uniform in [0, 1).
    pub rest: f64,
}

/// Single emitters and objects of many under one tree.    \[Moreau19] section 3
#[derive(Clone, Debug)]
pub struct TwoLevelTree {
    top: LightTree,
    entries: Vec<Placed>,
}

#[derive(Clone, Debug)]
struct Placed {
    entry: Entry,
    /// The inverse of the entry's transform.
    object_from_world: Affine3A,
}

impl Placed {
    /// # Panics
    /// For a transform that is no similarity: bounds would not hold.
    fn new(entry: Entry) -> Self {
        let object_from_world = match &entry {
            Entry::Single(_) => Affine3A::IDENTITY,
            Entry::Object { world_from_object, .. } => {
                assert!(is_similarity(world_from_object), "cones do not survive the stretch {world_from_object:?}");
                world_from_object.inverse()
            }
        };
        Self { entry, object_from_world }
    }

    fn bounds(&self) -> EmitterBounds {
        match &self.entry {
            Entry::Single(bounds) => *bounds,
            Entry::Object { tree, world_from_object } => tree.bounds().transformed(world_from_object),
        }
    }
}

impl TwoLevelTree {
    /// The tree over these entries.
    ///
    /// # Panics
    /// For an object's transform that is no similarity.
    pub fn new(entries: Vec<Entry>) -> Self {
        let entries: Vec<Placed> = entries.into_iter().map(Placed::new).collect();
        Self { top: LightTree::new(entries.iter().map(Placed::bounds).collect()), entries }
    }

    /// True without entries.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// The upper tree.
    pub fn top(&self) -> &LightTree {
        &self.top
    }

    /// An entry.
    pub fn entry(&self, index: usize) -> &Entry {
        &self.entries[index].entry
    }

    /// Puts another entry in the place of one, moved, deformed or changed; the nodes of the upper tree above it are bounded anew and nothing else is
    /// touched. Returns their number.
    ///
    /// # Panics
    /// For an object's transform that is no similarity.
    pub fn replace(&mut self, index: usize, entry: Entry) -> usize {
        self.entries[index] = Placed::new(entry);
        self.top.update(index, self.entries[index].bounds())
    }

    /// Begins to build the upper tree anew, see [`LightTree::rebuild`].
    pub fn rebuild(&self) -> Rebuild {
        self.top.rebuild()
    }

    /// Takes the rebuilt upper tree, see [`LightTree::swap`].
    pub fn swap(&mut self, rebuild: Rebuild) {
        self.top.swap(rebuild);
    }

    /// An emitter for `receiver`; `u` is a uniform number in [0, 1). `None` where no light can arrive.
    #[inline]
    pub fn sample(&self, receiver: &Receiver, u: f64) -> Option<TwoLevelChoice> {
        let upper = self.top.sample(receiver, u)?;
        let Placed { entry, object_from_world } = &self.entries[upper.index];
        match entry {
            Entry::Single(_) => Some(TwoLevelChoice { entry: upper.index, emitter: 0, pmf: upper.pmf, rest: upper.rest }),
            Entry::Object { tree, .. } => {
                let lower = tree.descend(0, &receiver.transformed(object_from_world), upper.rest, false)?;
                Some(TwoLevelChoice { entry: upper.index, emitter: lower.index, pmf: upper.pmf * lower.pmf, rest: lower.rest })
            }
        }
    }

    /// Probability with which [`TwoLevelTree::sample`] chooses an emitter.
    pub fn pmf(&self, receiver: &Receiver, entry: usize, emitter: usize) -> f32 {
        let upper = self.top.pmf(receiver, entry);
        match &self.entries[entry] {
            Placed { entry: Entry::Object { tree, .. }, object_from_world } if upper > 0.0 => {
                upper * tree.ascend(&receiver.transformed(object_from_world), emitter, false)
            }
            _ => upper,
        }
    }
}

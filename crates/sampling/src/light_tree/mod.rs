//! Choosing among many lights: a tree over bounds of emitters, descended by how much light each part can send to a point.
//!
//! A [`LightTree`] knows emitters by their bounds alone: a box, a cone of normals and an intensity. A descent takes one child a level with probability
//! proportional to its estimated irradiance \[Estevez18]; the product is the probability of the emitter, which [`LightTree::pmf`] finds again for
//! multiple importance sampling. Nodes are eight wide: one choice among eight near estimates is better, and with vector instructions
//! cheaper, than three among pairs of wide ones. [`TwoLevelTree`] puts trees of meshes under one tree of the scene \[Moreau19].

mod background;
mod bounds;
mod build;
mod importance;
mod refit;
mod split;
#[cfg(test)]
mod tests;
mod two_level;

pub use background::Rebuild;
pub use bounds::{EmitterBounds, is_similarity};
pub use importance::Receiver;
pub use split::SplitThreshold;
pub use two_level::{Entry, TwoLevelChoice, TwoLevelTree};

use crate::bits::BELOW_ONE;
use importance::Lanes;

/// Children of a node.
const WIDTH: usize = 8;

/// Marks a child that is an emitter.
const LEAF: u32 = 1 << 31;

/// No such node, child or emitter.
const NONE: u32 = u32::MAX;

/// A light tree over emitters, numbered as they were given.
#[derive(Clone, Debug)]
pub struct LightTree {
    nodes: Vec<Node>,
    /// What splitting and refitting need of each node.
    clusters: Vec<Cluster>,
    /// For each emitter the place it is kept in: node · 8 + child.
    slots: Vec<u32>,
    emitters: Vec<EmitterBounds>,
}

#[derive(Clone, Debug)]
struct Node {
    lanes: Lanes,
    /// A node, or an emitter with [`LEAF`]; [`NONE`] behind the last.
    children: [u32; WIDTH],
    /// Place of this node in its parent; [`NONE`] for the root.
    parent: u32,
}

/// The emitters under a node.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Cluster {
    bounds: EmitterBounds,
    count: u32,
    /// Sum of the squared intensities.
    squares: f64,
}

/// An emitter that was chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightChoice {
    /// Number of the emitter.
    pub index: usize,
    /// Probability of the choice.
    pub pmf: f32,
    /// What is left of the random number: uniform in [0, 1).
    pub rest: f64,
}

impl LightTree {
    /// Number of emitters.
    pub fn len(&self) -> usize {
        self.emitters.len()
    }

    /// True without emitters.
    pub fn is_empty(&self) -> bool {
        self.emitters.is_empty()
    }

    /// Bounds of all emitters.
    pub fn bounds(&self) -> EmitterBounds {
        self.clusters.first().map_or(EmitterBounds::NONE, |root| root.bounds)
    }

    /// Bounds of each emitter.
    pub fn emitters(&self) -> &[EmitterBounds] {
        &self.emitters
    }

    /// An emitter for `receiver`; `u` is a uniform number in [0, 1). `None` where no light can arrive.
    #[inline]
    pub fn sample(&self, receiver: &Receiver, u: f64) -> Option<LightChoice> {
        self.descend(0, receiver, u, true)
    }

    /// One emitter under a node; `None` where `may_end` and no child of the node can contribute.
    #[inline]
    fn descend(&self, mut node: usize, receiver: &Receiver, mut u: f64, may_end: bool) -> Option<LightChoice> {
        if let [0] = self.slots[..] {
            return Some(LightChoice { index: 0, pmf: 1.0, rest: u });
        }
        let (mut pmf, mut may_end) = (1.0, may_end);
        loop {
            let (weights, total) = self.nodes.get(node)?.weights(receiver, may_end)?;
            may_end = false;
            let lane;
            (lane, u) = choose(&weights, total, u);
            pmf *= weights[lane] / total;
            let child = self.nodes[node].children[lane];
            if child & LEAF != 0 {
                return Some(LightChoice { index: (child & !LEAF) as usize, pmf, rest: u });
            }
            node = child as usize;
        }
    }

    /// Probability with which [`LightTree::sample`] chooses an emitter.
    pub fn pmf(&self, receiver: &Receiver, index: usize) -> f32 {
        self.ascend(receiver, index, true)
    }

    /// The product of the choices that lead to an emitter, from below.
    #[inline]
    fn ascend(&self, receiver: &Receiver, index: usize, may_end: bool) -> f32 {
        let mut slot = self.slots[index];
        if slot == NONE || self.emitters.len() == 1 {
            return if slot == NONE { 0.0 } else { 1.0 };
        }
        let mut pmf = 1.0;
        while slot != NONE && pmf > 0.0 {
            let (node, lane) = (slot as usize / WIDTH, slot as usize % WIDTH);
            let Some((weights, total)) = self.nodes[node].weights(receiver, may_end && node == 0) else { return 0.0 };
            pmf *= weights[lane] / total;
            slot = self.nodes[node].parent;
        }
        pmf
    }
}

impl Node {
    /// Weights of the children and their sum. Where none can contribute, which only the children's tighter bounds may know, the choice goes by
    /// intensity: probabilities still sum to 1. Where the search may end it does.
    #[inline]
    fn weights(&self, receiver: &Receiver, may_end: bool) -> Option<([f32; WIDTH], f32)> {
        let weights = self.lanes.importance(receiver);
        let total: f32 = weights.iter().sum();
        if total > 0.0 {
            return Some((weights, total));
        }
        let weights = self.lanes.intensities();
        let total: f32 = weights.iter().sum();
        (!may_end && total > 0.0).then_some((weights, total))
    }
}

/// An index by weight, and what is left of `u`.
#[inline]
fn choose(weights: &[f32; WIDTH], total: f32, u: f64) -> (usize, f64) {
    let mut left = u * f64::from(total);
    let mut last = 0;
    for (lane, &weight) in weights.iter().enumerate().filter(|&(_, &weight)| weight > 0.0) {
        let weight = f64::from(weight);
        if left < weight {
            return (lane, (left / weight).min(BELOW_ONE));
        }
        left -= weight;
        last = lane;
    }
    // The sum was rounded up.
    (last, BELOW_ONE)
}

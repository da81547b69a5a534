//! Building a light tree: from the top, by the surface area orientation heuristic.

use super::bounds::EmitterBounds;
use super::importance::Lanes;
use super::{Cluster, LEAF, LightTree, NONE, Node, WIDTH};
use glam::Vec3;

/// Bins along an axis.
const BINS: usize = 12;

/// Depth from which on halves have equal numbers of emitters: lights at ever smaller distances from each other must not exhaust the stack.
const BALANCED_FROM: u32 = 48;

/// A node with two children, before they are gathered by eight.
struct Pair {
    bounds: EmitterBounds,
    children: [u32; 2],
}

struct Builder<'a> {
    emitters: &'a [EmitterBounds],
    centers: Vec<Vec3>,
    pairs: Vec<Pair>,
}

impl LightTree {
    /// The tree of these emitters, in O(n log n). Where one has no finite place it is never chosen.
    pub fn new(emitters: Vec<EmitterBounds>) -> Self {
        let places = |e: &EmitterBounds| e.min.is_finite() && e.max.is_finite() && e.axis.is_finite();
        let mut order: Vec<u32> = (0..emitters.len() as u32).filter(|&i| places(&emitters[i as usize])).collect();
        let centers = emitters.iter().map(EmitterBounds::center).collect();
        let mut builder = Builder { emitters: &emitters, centers, pairs: Vec::with_capacity(order.len()) };
        let root = (!order.is_empty()).then(|| builder.split(&mut order, 0));
        let pairs = builder.pairs;
        let mut tree = Self { nodes: Vec::new(), clusters: Vec::new(), slots: vec![NONE; emitters.len()], emitters };
        if let Some(root) = root {
            tree.gather(&pairs, root, NONE);
            tree.refit_nodes();
        }
        tree
    }

    /// Adds the node of `pair` and all below it: pairs are opened, the worst first, until there are eight children.
    fn gather(&mut self, pairs: &[Pair], pair: u32, parent: u32) -> u32 {
        let index = self.nodes.len();
        self.nodes.push(Node { lanes: Lanes::default(), children: [NONE; WIDTH], parent });
        self.clusters.push(Cluster { bounds: EmitterBounds::NONE, count: 0, squares: 0.0 });
        let mut children = vec![pair];
        while children.len() < WIDTH {
            let inner = children.iter().enumerate().filter(|&(_, &child)| child & LEAF == 0);
            let measure = |child: u32| pairs[child as usize].bounds.measure();
            let Some((worst, _)) = inner.max_by(|a, b| measure(*a.1).total_cmp(&measure(*b.1))) else { break };
            let [left, right] = pairs[children[worst] as usize].children;
            children[worst] = left;
            children.push(right);
        }
        for (lane, child) in children.into_iter().enumerate() {
            let slot = (index * WIDTH + lane) as u32;
            self.nodes[index].children[lane] = if child & LEAF != 0 {
                self.slots[(child & !LEAF) as usize] = slot;
                child
            } else {
                self.gather(pairs, child, slot)
            };
        }
        index as u32
    }
}

impl Builder<'_> {
    /// The subtree of these emitters: a pair, or a leaf.
    fn split(&mut self, order: &mut [u32], depth: u32) -> u32 {
        if let [single] = order {
            return *single | LEAF;
        }
        let bounds = self.union(order);
        let middle = match self.best_split(order).filter(|_| depth < BALANCED_FROM) {
            Some((axis, limit)) => partition(order, |i| self.centers[i as usize][axis] < limit),
            None => {
                let extent = bounds.max - bounds.min;
                let (axis, middle) = (extent.max_position(), order.len() / 2);
                order.select_nth_unstable_by(middle, |&a, &b| {
                    self.centers[a as usize][axis].total_cmp(&self.centers[b as usize][axis]).then(a.cmp(&b))
                });
                middle
            }
        };
        let (left, right) = order.split_at_mut(middle);
        let children = [self.split(left, depth + 1), self.split(right, depth + 1)];
        self.pairs.push(Pair { bounds, children });
        self.pairs.len() as u32 - 1
    }

    fn union(&self, order: &[u32]) -> EmitterBounds {
        order.iter().fold(EmitterBounds::NONE, |sum, &i| sum.union(&self.emitters[i as usize]))
    }

    /// The axis and the place along it that part the emitters best; `None` where their middles coincide.
    ///
    /// Cost of a split: the measures of both sides times the greatest extent over that of the axis, which keeps clusters from
    /// becoming thin.    \[Estevez18] eq. 2
    fn best_split(&self, order: &[u32]) -> Option<(usize, f32)> {
        let centers = order.iter().map(|&i| self.centers[i as usize]);
        let (low, high) = centers.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), c| (low.min(c), high.max(c)));
        let extent = high - low;
        let mut best = (f32::INFINITY, None);
        for axis in (0..3).filter(|&axis| extent[axis] > 0.0) {
            let mut bins = [EmitterBounds::NONE; BINS];
            let limit = |bin: usize| low[axis] + extent[axis] * (bin as f32 / BINS as f32);
            for &i in order {
                let place = (self.centers[i as usize][axis] - low[axis]) / extent[axis];
                let bin = &mut bins[((place * BINS as f32) as usize).min(BINS - 1)];
                *bin = bin.union(&self.emitters[i as usize]);
            }
            let mut right = [0.0; BINS];
            let mut sum = EmitterBounds::NONE;
            for bin in (1..BINS).rev() {
                sum = sum.union(&bins[bin]);
                right[bin] = sum.measure();
            }
            let regular = extent.max_element() / extent[axis];
            let mut left = EmitterBounds::NONE;
            for bin in 1..BINS {
                left = left.union(&bins[bin - 1]);
                let cost = regular * (left.measure() + right[bin]);
                if cost < best.0 {
                    best = (cost, Some((axis, limit(bin))));
                }
            }
        }
        // Rounding, or one-sided bins, may leave a side empty.
        best.1.filter(|&(axis, limit)| low[axis] < limit && high[axis] >= limit)
    }
}

/// Moves what fulfils the condition to the front; how many those are.
fn partition(order: &mut [u32], condition: impl Fn(u32) -> bool) -> usize {
    let mut front = 0;
    for i in 0..order.len() {
        if condition(order[i]) {
            order.swap(front, i);
            front += 1;
        }
    }
    front
}

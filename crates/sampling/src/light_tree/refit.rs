//! New bounds for the same tree: emitters that moved or changed, without building anew.

use super::bounds::EmitterBounds;
use super::{Cluster, LEAF, LightTree, NONE, WIDTH};

impl LightTree {
    /// Takes new bounds of every emitter, in their order; all nodes are bounded anew, in O(n). Returns their number.
    ///
    /// # Panics
    /// For another number of emitters.
    pub fn refit(&mut self, emitters: &[EmitterBounds]) -> usize {
        assert_eq!(emitters.len(), self.emitters.len(), "a refit keeps the emitters and changes their bounds");
        self.emitters.copy_from_slice(emitters);
        self.refit_nodes();
        self.nodes.len()
    }

    /// Takes new bounds of one emitter; the nodes above it are bounded anew, in O(log n). Returns their number.
    pub fn update(&mut self, index: usize, bounds: EmitterBounds) -> usize {
        self.emitters[index] = bounds;
        let mut slot = self.slots[index];
        let mut touched = 0;
        while slot != NONE {
            let node = slot as usize / WIDTH;
            self.refit_node(node);
            touched += 1;
            slot = self.nodes[node].parent;
        }
        touched
    }

    /// Bounds every node anew, children first: they stand behind their parents.
    pub(super) fn refit_nodes(&mut self) {
        (0..self.nodes.len()).rev().for_each(|node| self.refit_node(node));
    }

    fn refit_node(&mut self, index: usize) {
        let children = self.nodes[index].children;
        let mut sum = Cluster { bounds: EmitterBounds::NONE, count: 0, squares: 0.0 };
        for (lane, &child) in children.iter().enumerate().filter(|&(_, &child)| child != NONE) {
            let cluster = self.cluster(child);
            self.nodes[index].lanes.set(lane, &cluster.bounds);
            sum.bounds = sum.bounds.union(&cluster.bounds);
            sum.count += cluster.count;
            sum.squares += cluster.squares;
        }
        self.clusters[index] = sum;
    }

    /// What is known of a child.
    fn cluster(&self, child: u32) -> Cluster {
        if child & LEAF == 0 {
            return self.clusters[child as usize];
        }
        let bounds = self.emitters[(child & !LEAF) as usize];
        Cluster { bounds, count: 1, squares: f64::from(bounds.intensity).powi(2) }
    }

    /// The cost that building tries to keep low, summed over all nodes: intensity times extent of positions times that of directions.
    pub fn cost(&self) -> f64 {
        self.clusters.iter().map(|cluster| f64::from(cluster.bounds.measure())).sum()
    }

    /// Whether every node encloses the emitters under it, each emitter stands in one place, and parents know their children.
    ///
    /// # Errors
    /// What is wrong, for the report of a test.
    pub fn validate(&self) -> Result<(), String> {
        for (index, emitter) in self.emitters.iter().enumerate() {
            let mut slot = self.slots[index];
            let mut child = index as u32 | LEAF;
            while slot != NONE {
                let (node, lane) = (slot as usize / WIDTH, slot as usize % WIDTH);
                if self.nodes[node].children[lane] != child {
                    return Err(format!("child {lane} of node {node} is {:#x}, not {child:#x}", self.nodes[node].children[lane]));
                }
                if !self.clusters[node].bounds.encloses(emitter) {
                    return Err(format!("node {node} {:?} leaves out emitter {index} {emitter:?}", self.clusters[node].bounds));
                }
                child = node as u32;
                slot = self.nodes[node].parent;
            }
        }
        let leaves = self.nodes.iter().flat_map(|node| node.children).filter(|&child| child != NONE && child & LEAF != 0).count();
        let placed = self.slots.iter().filter(|&&slot| slot != NONE).count();
        if leaves == placed { Ok(()) } else { Err(format!("{leaves} leaves for {placed} emitters")) }
    }
}

//! Adaptive splitting: several lights for one receiver, where one descent would know too little.

use super::{Cluster, LEAF, LightTree, NONE, Receiver};

/// How readily a cluster is split into its children.
///
/// ```text
/// split where (1 / (1 + s))^(1/4) ≤ threshold
/// s² = N² (Ve Vg + Ve Eg² + Ee² Vg) / E²,    Eg = 1/(a b),    Vg = (b³ − a³) / (3 (b − a) a³ b³) − Eg²              [Estevez18] section 5.4
/// ```
///
/// N, Ee and Ve: number, mean and variance of the intensities; [a, b] the distances of the box. Deviation: s is relative to the estimate E of all
/// light at the receiver, so that the threshold knows no unit and clusters that hardly count are left together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SplitThreshold(f32);

impl SplitThreshold {
    /// One light for a receiver.
    pub const NEVER: Self = Self(0.0);
    /// Every light that can contribute.
    pub const ALWAYS: Self = Self(1.0);

    /// A threshold in [0, 1]; other numbers are clamped.
    pub fn new(threshold: f32) -> Self {
        Self(if threshold > 0.0 { threshold.min(1.0) } else { 0.0 })
    }

    fn splits(self, cluster: &Cluster, receiver: &Receiver, estimate: f32) -> bool {
        if self == Self::NEVER || self == Self::ALWAYS {
            return self == Self::ALWAYS;
        }
        let bounds = &cluster.bounds;
        let radius = 0.5 * f64::from((bounds.max - bounds.min).length());
        let distance = f64::from(receiver.point.distance(bounds.center()));
        let (a, b) = (distance - radius, distance + radius);
        if a <= 0.0 {
            return true;
        }
        let n = f64::from(cluster.count);
        let mean = f64::from(bounds.intensity) / n;
        let variance = (cluster.squares / n - mean * mean).max(0.0);
        let geometry = 1.0 / (a * b);
        // (b³ − a³) / (b − a) = a² + a b + b²: nothing cancels.
        let spread = ((a * a + a * b + b * b) / 3.0 * geometry.powi(3) - geometry * geometry).max(0.0);
        let s = n * (variance * spread + variance * geometry * geometry + mean * mean * spread).sqrt() / f64::from(estimate);
        (1.0 / (1.0 + s)).powf(0.25) <= f64::from(self.0)
    }
}

impl LightTree {
    /// Visits the emitters that are chosen for `receiver`, each with its probability: the sum of f / probability over the visits has the mean Σ f.
    /// `random` gives uniform numbers in [0, 1), one for each cluster that is left together.
    pub fn sample_split(
        &self,
        receiver: &Receiver,
        threshold: SplitThreshold,
        mut random: impl FnMut() -> f64,
        mut visit: impl FnMut(usize, f32),
    ) {
        let Some(root) = self.nodes.first() else { return };
        let estimate = root.lanes.importance(receiver).iter().sum();
        let mut waiting = vec![0];
        while let Some(node) = waiting.pop() {
            if !threshold.splits(&self.clusters[node], receiver, estimate) {
                if let Some(chosen) = self.descend(node, receiver, random(), node == 0) {
                    visit(chosen.index, chosen.pmf);
                }
                continue;
            }
            let weights = self.nodes[node].lanes.importance(receiver);
            for (&child, _) in self.nodes[node].children.iter().zip(weights).filter(|&(&child, weight)| child != NONE && weight > 0.0) {
                if child & LEAF != 0 {
                    visit((child & !LEAF) as usize, 1.0);
                } else {
                    waiting.push(child as usize);
                }
            }
        }
    }

    /// Probability with which [`LightTree::sample_split`] visits an emitter: the expected number of visits.
    pub fn pmf_split(&self, receiver: &Receiver, threshold: SplitThreshold, index: usize) -> f32 {
        let (Some(root), mut slot) = (self.nodes.first(), self.slots[index]) else { return 0.0 };
        let estimate = root.lanes.importance(receiver).iter().sum();
        // From the emitter to the root; splits end where the first cluster is left together, seen from the root.
        let mut path = Vec::new();
        while slot != NONE {
            path.push(slot as usize);
            slot = self.nodes[slot as usize / super::WIDTH].parent;
        }
        let mut together = false;
        let mut pmf = 1.0;
        for (depth, &slot) in path.iter().rev().enumerate() {
            let (node, lane) = (slot / super::WIDTH, slot % super::WIDTH);
            let starts = !together && !threshold.splits(&self.clusters[node], receiver, estimate);
            // The only emitter is chosen wherever the receiver is, as in `descend`.
            if starts && self.emitters.len() == 1 {
                return 1.0;
            }
            together |= starts;
            let weights = self.nodes[node].lanes.importance(receiver);
            if !together {
                pmf *= if weights[lane] > 0.0 { 1.0 } else { 0.0 };
            } else {
                let Some((weights, total)) = self.nodes[node].weights(receiver, starts && depth == 0) else { return 0.0 };
                pmf *= weights[lane] / total;
            }
        }
        pmf
    }
}

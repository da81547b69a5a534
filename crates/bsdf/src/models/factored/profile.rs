//! A function of one variable, linear between nodes, and the density that its absolute values at the nodes make.
//!
//! ```text
//! |u(x)| ≤ û(x),    û linear between |u_k|,    P(x) = ∫ û dx / ∫ û      inverted segment by segment: a quadratic
//! ```

/// A function of one variable.
#[derive(Clone, Debug)]
pub struct Profile {
    values: Vec<f64>,
    /// ∫ û up to each node.
    cumulative: Vec<f64>,
}

impl Profile {
    /// Of values at increasing `nodes`; a periodic function repeats its first value at the end.
    ///
    /// # Panics
    /// Without two nodes, or with other numbers of values.
    pub fn new(values: Vec<f64>, nodes: &[f64]) -> Self {
        assert!(nodes.len() > 1 && values.len() == nodes.len(), "{} values at {} nodes", values.len(), nodes.len());
        let mut sum = 0.0;
        let area = |k: usize| 0.5 * (values[k].abs() + values[k + 1].abs()) * (nodes[k + 1] - nodes[k]);
        let segments = (0..nodes.len() - 1).map(|k| {
            sum += area(k);
            sum
        });
        Self { cumulative: std::iter::once(0.0).chain(segments).collect(), values }
    }

    /// The function at the share `t` of a segment.
    #[inline]
    pub fn value(&self, segment: usize, t: f64) -> f64 {
        let (a, b) = (self.values[segment], self.values[segment + 1]);
        a + t * (b - a)
    }

    /// û at the share `t` of a segment: not less than the absolute value of the function, and equal to it where no sign changes.
    #[inline]
    pub fn bound(&self, segment: usize, t: f64) -> f64 {
        let (a, b) = (self.values[segment].abs(), self.values[segment + 1].abs());
        a + t * (b - a)
    }

    /// ∫ û.
    #[inline]
    pub fn total(&self) -> f64 {
        self.cumulative[self.cumulative.len() - 1]
    }

    /// The segment, and the share of it, of a random number in [0, 1) that is distributed by û; where û is 0 everywhere, the last segment.
    pub fn sample(&self, u: f64) -> (usize, f64) {
        let target = u * self.total();
        let segment = self.cumulative.partition_point(|&c| c <= target).clamp(1, self.cumulative.len() - 1) - 1;
        let (low, high) = (self.cumulative[segment], self.cumulative[segment + 1]);
        let rest = if high > low { ((target - low) / (high - low)).clamp(0.0, 1.0) } else { 0.0 };
        let (a, b) = (self.values[segment].abs(), self.values[segment + 1].abs());
        // a t + (b − a) t²/2 = rest (a + b)/2, the root that does not cancel.
        let root = a + (a * a + rest * (b * b - a * a)).max(0.0).sqrt();
        (segment, if root > 0.0 { (rest * (a + b) / root).min(1.0) } else { rest })
    }
}

/// The segment of increasing `nodes` that `x` is in, and the share of it.
#[inline]
pub(super) fn locate(nodes: &[f64], x: f64) -> (usize, f64) {
    let segment = nodes.partition_point(|&node| node <= x).clamp(1, nodes.len() - 1) - 1;
    (segment, ((x - nodes[segment]) / (nodes[segment + 1] - nodes[segment])).clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    const NODES: [f64; 5] = [0.0, 0.1, 0.4, 0.5, 1.0];

    /// The largest distance between u and P(x(u)), P the integral of a bound.
    fn distance(sampled: &Profile, density: &Profile) -> f64 {
        let below = |segment: usize, t: f64| {
            let width = NODES[segment + 1] - NODES[segment];
            density.cumulative[segment] + 0.5 * t * width * (density.bound(segment, 0.0) + density.bound(segment, t))
        };
        (0..1000).map(|i| f64::from(i) / 1000.0).fold(0.0, |worst, u| {
            let (segment, t) = sampled.sample(u);
            f64::max(worst, (below(segment, t) / density.total() - u).abs())
        })
    }

    #[test]
    fn samples_invert_the_integral_of_the_bound() {
        let profile = Profile::new(vec![3.0, 0.0, -2.0, 5.0, 1.0], &NODES);
        assert!(distance(&profile, &profile) < 1e-12, "{}", distance(&profile, &profile));
        let other = Profile::new(vec![3.0, 0.0, -2.0, 5.1, 1.0], &NODES);
        assert!(distance(&profile, &other) > 1e-3, "planted fault");
        for k in 0..4 {
            for t in [0.0, 0.3, 0.9] {
                assert!(profile.bound(k, t) >= profile.value(k, t).abs() - 1e-15);
            }
        }
    }

    #[test]
    fn segments_of_nothing_are_never_drawn() {
        let profile = Profile::new(vec![0.0, 0.0, 1.0, 0.0, 0.0], &NODES);
        assert!((0..1000).all(|i| matches!(profile.sample(f64::from(i) / 1000.0).0, 1 | 2)));
        assert!(Profile::new(vec![0.0; 5], &NODES).sample(0.5).1.is_finite());
        assert_eq!(locate(&NODES, 0.45).0, 2);
        assert_eq!([locate(&NODES, -1.0), locate(&NODES, 7.0)], [(0, 0.0), (3, 1.0)]);
    }
}

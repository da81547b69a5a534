//! Resampled importance sampling: drawing nearly in proportion to a target that can be evaluated and not sampled.
//!
//! Of M candidates, drawn from a density that is easy to draw from, one is kept with probability in proportion to weight = target / density \[Talbot05]. A
//! [`Reservoir`] does so in one pass, without a list \[Chao82], and reservoirs of neighbours or of earlier frames merge \[Bitterli20].

/// One candidate kept of a stream, and what an estimate needs to know of the rest.
///
/// ```text
/// F = f(Y) W,    W = 1/(M g(Y)) Σ g(Xj)/p(Xj)                                [Talbot05] eq. 5, [Bitterli20] eq. 6
/// ```
///
/// Unbiased for every M ≥ 1 if target g and density p are positive wherever f is not 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reservoir<T> {
    kept: Option<Kept<T>>,
    /// Σ g/p.
    weights: f64,
    /// M: candidates seen, by this reservoir or by those merged into it.
    count: u32,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Kept<T> {
    sample: T,
    target: f32,
}

impl<T> Reservoir<T> {
    /// One that has seen nothing.
    pub fn new() -> Self {
        Self { kept: None, weights: 0.0, count: 0 }
    }

    /// Shows a candidate with its target value and the density it was drawn with; `u` in [0, 1) decides whether it takes the place of the one that was
    /// kept. Candidates without target or density count and are never kept. Candidates of several strategies are given their [`mixture_density`].
    #[inline]
    pub fn offer(&mut self, candidate: T, target: f32, density: f32, u: f64) {
        let weight = f64::from(target) / f64::from(density);
        self.take(candidate, target, if density > 0.0 { weight } else { 0.0 }, 1, u);
    }

    /// Merges what `other` has seen. `target_here` is the target of its kept sample as this reservoir has it: for another pixel, that of this one.
    ///
    /// Its sample comes with weight g(Y) W M.    \[Bitterli20] alg. 4
    ///
    /// # Surprises
    /// Unbiased only where the target is positive for `other` wherever it is here: what a neighbour cannot see it never offers.
    #[inline]
    pub fn merge(&mut self, other: &Self, target_here: f32, u: f64)
    where
        T: Clone,
    {
        match &other.kept {
            Some(kept) => {
                let weight = f64::from(target_here) * f64::from(other.contribution_weight()) * f64::from(other.count);
                self.take(kept.sample.clone(), target_here, weight, other.count, u);
            }
            None => self.count += other.count,
        }
    }

    #[inline]
    fn take(&mut self, sample: T, target: f32, weight: f64, count: u32, u: f64) {
        self.count += count;
        if target > 0.0 && weight > 0.0 && weight.is_finite() {
            self.weights += weight;
            if u * self.weights < weight {
                self.kept = Some(Kept { sample, target });
            }
        }
    }

    /// Forgets candidates beyond the first `most`, as if fewer had been seen: keeps old frames from outweighing new ones.
    pub fn limit(&mut self, most: u32) {
        if self.count > most {
            self.weights *= f64::from(most) / f64::from(self.count);
            self.count = most;
        }
    }

    /// The sample that was kept; `None` while no candidate had a target.
    #[inline]
    pub fn sample(&self) -> Option<&T> {
        self.kept.as_ref().map(|kept| &kept.sample)
    }

    /// Target of the kept sample.
    #[inline]
    pub fn target(&self) -> f32 {
        self.kept.as_ref().map_or(0.0, |kept| kept.target)
    }

    /// W, which stands for 1/density of the kept sample; 0 without one.
    #[inline]
    pub fn contribution_weight(&self) -> f32 {
        self.kept.as_ref().map_or(0.0, |kept| (self.weights / (f64::from(self.count) * f64::from(kept.target))) as f32)
    }

    /// Number of candidates seen.
    #[inline]
    pub fn count(&self) -> u32 {
        self.count
    }
}

/// Density of a candidate when `M_i` of them are drawn with density `p_i`, for (M, p) of every strategy at the candidate.
///
/// ```text
/// p(x) = Σ Mi pi(x) / Σ Mi
/// ```
///
/// With it resampling by several strategies is (4.21) of the source again. Its (4.22), weights Mi g / Σ Mk pk under a factor 1/M, counts 1/M twice and
/// loses light: an estimate of 0.167 for 1/3 with four candidates of each of two strategies.
#[inline]
pub fn mixture_density(strategies: &[(u32, f32)]) -> f32 {
    let count: u32 = strategies.iter().map(|(count, _)| count).sum();
    strategies.iter().map(|&(count, density)| count as f32 * density).sum::<f32>() / count as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Rng;
    use crate::statistics::{Moments, chi_square_p_value};

    type Function = fn(f32) -> f32;

    /// How candidates of one strategy are drawn, and their density.
    type Strategy = (fn(f32) -> f32, Function);

    const UNIFORM: Strategy = (|u| u, |_| 1.0);
    /// Density 2 x.
    const LINEAR: Strategy = (f32::sqrt, |x| 2.0 * x);

    fn square(x: f32) -> f32 {
        x * x
    }

    /// Estimates of ∫ f over [0, 1] with target g, `M_i` candidates of each strategy.
    fn estimates(f: Function, g: Function, strategies: &[(u32, Strategy)], count: u32) -> Moments {
        let mut rng = Rng::new(9);
        let estimate = |_| {
            let mut reservoir = Reservoir::new();
            for &(m, (draw, _)) in strategies {
                for _ in 0..m {
                    let x = draw(rng.next_1d());
                    let densities: Vec<(u32, f32)> = strategies.iter().map(|&(m, (_, p))| (m, p(x))).collect();
                    reservoir.offer(x, g(x), mixture_density(&densities), rng.next_f64());
                }
            }
            reservoir.sample().map_or(0.0, |&y| f64::from(f(y)) * f64::from(reservoir.contribution_weight()))
        };
        (0..count).map(estimate).collect()
    }

    /// The source's (4.22) to the letter.
    fn literal_estimates(f: Function, g: Function, strategies: &[(u32, Strategy)], count: u32) -> Moments {
        let mut rng = Rng::new(9);
        let estimate = |_| {
            let (mut kept, mut weights, mut all) = (0.0, 0.0, 0);
            for &(m, (draw, density)) in strategies {
                for _ in 0..m {
                    let x = draw(rng.next_1d());
                    let sum: f32 = strategies.iter().map(|&(m, (_, p))| m as f32 * p(x)).sum();
                    let weight = f64::from(m as f32 * density(x) / sum * g(x) / density(x));
                    (weights, all) = (weights + weight, all + 1);
                    if rng.next_f64() * weights < weight {
                        kept = x;
                    }
                }
            }
            f64::from(f(kept)) / f64::from(g(kept)) * weights / f64::from(all)
        };
        (0..count).map(estimate).collect()
    }

    /// Row M-09: with f = g = x² and p = 1 the variance is 0.0889/M, 1/5 − 1/9 over M, within 5 %, and the mean 1/3. A target unlike f changes
    /// no mean.
    #[test]
    fn variance_is_that_of_the_mean_weight_where_the_target_is_the_function() {
        for m in [1, 2, 4, 8, 16, 32] {
            let own = estimates(square, square, &[(m, UNIFORM)], 100_000);
            assert!((own.variance() * f64::from(m) / (4.0 / 45.0) - 1.0).abs() < 0.05, "M = {m}: {}", own.variance());
            assert!((own.mean() - 1.0 / 3.0).abs() < 4.0 * own.standard_error(), "M = {m}: {}", own.mean());
            let unlike = estimates(square, |x| 1.2 - x, &[(m, UNIFORM)], 100_000);
            assert!((unlike.mean() - 1.0 / 3.0).abs() < 4.0 * unlike.standard_error(), "M = {m}: {}", unlike.mean());
        }
    }

    /// Row M-10: f = x², g = x² + 0.2, densities 1 and 2 x.
    #[test]
    fn several_strategies_are_unbiased_and_the_printed_weight_is_not() {
        let g: Function = |x| x * x + 0.2;
        let off = |estimates: Moments| (estimates.mean() - 1.0 / 3.0).abs() / estimates.standard_error();
        for (m1, m2) in [(4, 4), (2, 6), (6, 2)] {
            let strategies = [(m1, UNIFORM), (m2, LINEAR)];
            let ours = off(estimates(square, g, &strategies, 200_000));
            assert!(ours < 4.0, "({m1}, {m2}): {ours} standard errors");
            let literal = literal_estimates(square, g, &strategies, 200_000);
            assert!(off(literal) > 4.0, "({m1}, {m2}): {} is not seen to be wrong", literal.mean());
        }
        let literal = |m1, m2| literal_estimates(square, g, &[(m1, UNIFORM), (m2, LINEAR)], 200_000).mean();
        assert!((literal(4, 4) - 0.1669).abs() < 0.002 && (literal(2, 6) - 0.2176).abs() < 0.002);
    }

    /// Row RM-33: unbiased for M = 1, 4, 32; two equal strategies are one; the variance falls with M.
    #[test]
    fn resampling_is_unbiased_for_every_number_of_candidates_and_splitting_a_strategy_changes_nothing() {
        let (f, g): (Function, Function) = (|x| (3.0 * x).exp(), |x| 1.0 + 9.0 * x * x);
        let exact = (3f64.exp() - 1.0) / 3.0;
        let mut last = f64::INFINITY;
        for m in [1, 4, 32] {
            let one = estimates(f, g, &[(m, UNIFORM)], 60_000);
            assert!((one.mean() - exact).abs() < 3.0 * one.standard_error(), "M = {m}: {}", one.mean());
            assert!(one.variance() < 0.6 * last, "M = {m}: {} after {last}", one.variance());
            last = one.variance();
            // The same random numbers, so equal up to the rounding of the densities.
            let halves = [(m.div_ceil(2), UNIFORM), (m / 2, UNIFORM)];
            let two = estimates(f, g, &halves, 60_000);
            assert!((two.mean() / one.mean() - 1.0).abs() < 1e-5, "M = {m}: {} and {}", two.mean(), one.mean());
        }
    }

    #[test]
    fn the_kept_sample_is_chosen_by_weight() {
        let weights = [0.5f32, 0.0, 3.0, 1.0, 0.25];
        let mut rng = Rng::new(3);
        let mut counts = [0.0; 5];
        for _ in 0..50_000 {
            let mut reservoir = Reservoir::new();
            weights.iter().enumerate().for_each(|(i, &w)| reservoir.offer(i, w, 1.0, rng.next_f64()));
            counts[*reservoir.sample().unwrap()] += 1.0;
        }
        let expected = |w: [f32; 5]| w.map(|w| f64::from(w) / 4.75 * 50_000.0);
        assert!(chi_square_p_value(&counts, &expected(weights), 0) > 1e-3);
        assert!(chi_square_p_value(&counts, &expected([0.4, 0.0, 3.1, 1.0, 0.25]), 0) < 1e-6);
    }

    /// Merged reservoirs estimate what one over all candidates does, with another target there, and after forgetting.
    #[test]
    fn merging_keeps_the_mean() {
        let mut rng = Rng::new(4);
        let (here, there): (Function, Function) = (|x| x * x, |x| 0.3 + x);
        let estimate = |_| {
            let mut one = Reservoir::new();
            for m in [4, 9] {
                let mut other = Reservoir::new();
                (0..m).for_each(|_| {
                    let x = rng.next_1d();
                    other.offer(x, there(x), 1.0, rng.next_f64());
                });
                other.limit(6);
                let target = other.sample().map_or(0.0, |&y| here(y));
                one.merge(&other, target, rng.next_f64());
            }
            assert_eq!(one.count(), 10);
            one.sample().map_or(0.0, |&y| f64::from(square(y)) * f64::from(one.contribution_weight()))
        };
        let moments: Moments = (0..100_000).map(estimate).collect();
        assert!((moments.mean() - 1.0 / 3.0).abs() < 3.0 * moments.standard_error(), "{}", moments.mean());
    }

    #[test]
    fn candidates_without_light_are_counted_and_never_kept() {
        let mut reservoir = Reservoir::new();
        for (target, density) in [(0.0, 1.0), (1.0, 0.0), (f32::NAN, 1.0), (1.0, f32::NAN), (f32::INFINITY, 1.0)] {
            reservoir.offer("dark", target, density, 0.0);
        }
        assert_eq!((reservoir.sample(), reservoir.contribution_weight(), reservoir.count()), (None, 0.0, 5));
        reservoir.offer("bright", 2.0, 0.5, 0.999);
        assert_eq!((reservoir.sample(), reservoir.target()), (Some(&"bright"), 2.0));
        assert!((reservoir.contribution_weight() - 4.0 / (6.0 * 2.0)).abs() < 1e-7);
        // So are those of another reservoir that found nothing.
        let mut dark = Reservoir::new();
        (0..3).for_each(|_| dark.offer("dark", 0.0, 1.0, 0.0));
        reservoir.merge(&dark, 0.0, 0.0);
        assert_eq!((reservoir.sample(), reservoir.count()), (Some(&"bright"), 9));
        assert!((reservoir.contribution_weight() - 4.0 / (9.0 * 2.0)).abs() < 1e-7);
    }
}

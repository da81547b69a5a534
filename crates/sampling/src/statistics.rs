//! Tests of hypotheses on samples: is this histogram drawn from that distribution?

use statrs::function::gamma::gamma_ur;

/// p-value of Pearson's χ² test of observed against expected counts (same length, same total).
///
/// ```text
/// χ² = Σ (O − E)² / E,    p = Q(ν/2, χ²/2)            [Pearson1900]
/// ```
///
/// Cells with few expected counts are pooled (in order of expectation) until each pool expects at least 5, the usual domain of
/// the approximation. ν = pools − 1 − `fitted`, with `fitted` the number of parameters estimated from the data. Observations in
/// a cell where none can be (expectation 0) give p = 0. Fewer than two pools: 1.
pub fn chi_square_p_value(observed: &[f64], expected: &[f64], fitted: usize) -> f64 {
    assert_eq!(observed.len(), expected.len(), "one expectation a cell");
    let mut order: Vec<usize> = (0..observed.len()).collect();
    order.sort_by(|&a, &b| expected[a].total_cmp(&expected[b]));
    let (mut statistic, mut pools) = (0.0, 0usize);
    let (mut o, mut e) = (0.0, 0.0);
    let mut rest: f64 = expected.iter().sum();
    for i in order {
        if expected[i] <= 0.0 {
            if observed[i] > 0.0 {
                return 0.0;
            }
            continue;
        }
        o += observed[i];
        e += expected[i];
        rest -= expected[i];
        // A remainder too small for a pool of its own joins the last one.
        if e >= 5.0 && rest >= 5.0 {
            statistic += (o - e) * (o - e) / e;
            pools += 1;
            (o, e) = (0.0, 0.0);
        }
    }
    if e > 0.0 {
        statistic += (o - e) * (o - e) / e;
        pools += 1;
    }
    match pools.checked_sub(1 + fitted) {
        None | Some(0) => 1.0,
        Some(freedom) => gamma_ur(freedom as f64 / 2.0, (statistic / 2.0).max(0.0)),
    }
}

/// Running mean and variance.    \[Welford62]
#[derive(Clone, Copy, Debug, Default)]
pub struct Moments {
    count: u64,
    mean: f64,
    sum_squares: f64,
}

impl Moments {
    /// Takes one observation.
    pub fn add(&mut self, x: f64) {
        self.count += 1;
        let delta = x - self.mean;
        self.mean += delta / self.count as f64;
        self.sum_squares += delta * (x - self.mean);
    }

    /// Number of observations.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Sample mean; 0 without observations.
    pub fn mean(&self) -> f64 {
        self.mean
    }

    /// Unbiased sample variance; 0 below two observations.
    pub fn variance(&self) -> f64 {
        if self.count < 2 { 0.0 } else { self.sum_squares / (self.count - 1) as f64 }
    }

    /// Standard deviation of the mean, σ/√N.
    pub fn standard_error(&self) -> f64 {
        (self.variance() / self.count.max(1) as f64).sqrt()
    }
}

impl FromIterator<f64> for Moments {
    fn from_iter<I: IntoIterator<Item = f64>>(iter: I) -> Self {
        let mut m = Self::default();
        iter.into_iter().for_each(|x| m.add(x));
        m
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Rng;

    /// χ² = 3.84146 with one degree of freedom is the 5 % point.
    #[test]
    fn chi_square_matches_the_tables() {
        let d = (3.841_458_8f64 * 50.0).sqrt();
        let p = chi_square_p_value(&[50.0 + d / 2f64.sqrt(), 50.0 - d / 2f64.sqrt()], &[50.0, 50.0], 0);
        assert!((p - 0.05).abs() < 1e-6, "{p}");
    }

    #[test]
    fn p_values_of_true_hypotheses_are_uniform_and_a_planted_fault_is_seen() {
        let mut rng = Rng::new(11);
        let below = (0..400)
            .filter(|_| {
                let mut counts = vec![0.0; 20];
                (0..2000).for_each(|_| counts[rng.below(20) as usize] += 1.0);
                chi_square_p_value(&counts, &[100.0; 20], 0) < 0.1
            })
            .count();
        assert!((20..=60).contains(&below), "{below} of 400 p-values lie below 0.1");
        let mut counts = vec![0.0; 20];
        (0..20_000).for_each(|_| counts[(rng.next_1d().powf(1.1) * 20.0) as usize] += 1.0);
        assert!(chi_square_p_value(&counts, &[1000.0; 20], 0) < 1e-9);
        assert_eq!(chi_square_p_value(&[1.0, 99.0], &[0.0, 100.0], 0), 0.0);
    }

    #[test]
    fn moments_of_small_sets() {
        let m: Moments = [1.0, 2.0, 3.0, 4.0].into_iter().collect();
        assert_eq!((m.count(), m.mean(), m.variance()), (4, 2.5, 5.0 / 3.0));
        assert_eq!(Moments::default().variance(), 0.0);
    }
}

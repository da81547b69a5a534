//! Discrete choice in constant time.

use super::clean;
use crate::bits::{BELOW_ONE, ONE_MINUS_EPSILON};

/// Chooses an index with probability proportional to its weight, in constant time.    \[Walker77], built as in \[Vose91]
#[derive(Clone, Debug)]
pub struct AliasTable {
    bins: Vec<Bin>,
    total: f64,
}

#[derive(Clone, Copy, Debug)]
struct Bin {
    /// Probability to stay in this bin.
    keep: f32,
    alias: u32,
    pmf: f32,
}

impl AliasTable {
    /// The table of these weights. `None` when there are none.
    pub fn new(weights: &[f32]) -> Option<Self> {
        if weights.is_empty() {
            return None;
        }
        let n = weights.len();
        let total: f64 = weights.iter().map(|&w| clean(w)).sum();
        let pmf: Vec<f64> = weights.iter().map(|&w| if total > 0.0 { clean(w) / total } else { 1.0 / n as f64 }).collect();
        let mut scaled: Vec<f64> = pmf.iter().map(|p| p * n as f64).collect();
        let mut bins: Vec<Bin> = (0..n).map(|i| Bin { keep: 1.0, alias: i as u32, pmf: pmf[i] as f32 }).collect();
        let (mut small, mut large): (Vec<usize>, Vec<usize>) = (0..n).partition(|&i| scaled[i] < 1.0);
        while let (Some(&s), Some(&l)) = (small.last(), large.last()) {
            small.pop();
            bins[s].keep = scaled[s] as f32;
            bins[s].alias = l as u32;
            scaled[l] -= 1.0 - scaled[s];
            if scaled[l] < 1.0 {
                large.pop();
                small.push(l);
            }
        }
        // Bins left in either list are full up to rounding; an empty one must still never be chosen.
        let heaviest = (0..n).max_by(|&a, &b| pmf[a].total_cmp(&pmf[b])).unwrap_or(0);
        for i in small.into_iter().filter(|&i| pmf[i] == 0.0) {
            bins[i] = Bin { keep: 0.0, alias: heaviest as u32, pmf: 0.0 };
        }
        Some(Self { bins, total })
    }

    /// An index, its probability, and a fresh uniform number in [0, 1) made from what is left of `u`.
    #[inline]
    pub fn sample(&self, u: f32) -> (usize, f32, f32) {
        let (index, pmf, left) = self.sample_f64(f64::from(u));
        (index, pmf, (left as f32).min(ONE_MINUS_EPSILON))
    }

    /// [`AliasTable::sample`] for a number of more digits, of which more are left: each choice takes the logarithm of one over its probability.
    #[inline]
    pub fn sample_f64(&self, u: f64) -> (usize, f32, f64) {
        let x = u * self.bins.len() as f64;
        let i = (x as usize).min(self.bins.len() - 1);
        let (rest, bin) = (x - i as f64, &self.bins[i]);
        let keep = f64::from(bin.keep);
        let (index, left) = if rest < keep { (i, rest / keep) } else { (bin.alias as usize, (rest - keep) / (1.0 - keep)) };
        (index, self.bins[index].pmf, left.clamp(0.0, BELOW_ONE))
    }

    /// Probability of `index`.
    #[inline]
    pub fn pmf(&self, index: usize) -> f32 {
        self.bins[index].pmf
    }

    /// Sum of the weights.
    pub fn total(&self) -> f64 {
        self.total
    }

    /// Memory, bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(self.bins.as_slice())
    }

    /// True when all weights are zero and the choice is uniform.
    pub fn is_zero(&self) -> bool {
        self.total <= 0.0
    }

    /// Number of indices, at least 1.
    #[allow(clippy::len_without_is_empty, reason = "a table is never empty")]
    pub fn len(&self) -> usize {
        self.bins.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Rng;
    use crate::statistics::chi_square_p_value;

    fn p_value(table: &AliasTable, expected: &[f32]) -> f64 {
        let n = 200_000;
        let mut rng = Rng::new(31);
        let mut counts = vec![0.0; expected.len()];
        for _ in 0..n {
            let (i, pmf, left) = table.sample(rng.next_1d());
            assert_eq!(pmf, table.pmf(i));
            assert!((0.0..1.0).contains(&left));
            counts[i] += 1.0;
        }
        let total: f64 = expected.iter().map(|&w| f64::from(w)).sum();
        chi_square_p_value(&counts, &expected.iter().map(|&w| f64::from(w) / total * f64::from(n)).collect::<Vec<_>>(), 0)
    }

    #[test]
    fn choices_follow_the_weights_and_a_planted_fault_is_seen() {
        let weights = [0.1, 0.0, 5.0, 1.0, 1.0, 1e-3, 2.5, 0.0, 0.7];
        let table = AliasTable::new(&weights).unwrap();
        assert!(p_value(&table, &weights) > 1e-3);
        let mut wrong = weights;
        wrong[2] *= 1.05;
        assert!(p_value(&table, &wrong) < 1e-6);
        assert!((0..weights.len()).map(|i| table.pmf(i)).sum::<f32>() - 1.0 < 1e-6);
    }

    #[test]
    fn what_is_left_of_the_number_is_uniform() {
        let table = AliasTable::new(&[1.0, 3.0, 0.5]).unwrap();
        let mut rng = Rng::new(32);
        let mut counts = vec![0.0; 10];
        (0..50_000).for_each(|_| counts[(table.sample(rng.next_1d()).2 * 10.0) as usize] += 1.0);
        assert!(chi_square_p_value(&counts, &[5000.0; 10], 0) > 1e-3);
    }

    /// After a choice of probability 2⁻²⁰ a number of 24 digits has 4 left, of which all are multiples of 1/16.
    #[test]
    fn double_precision_leaves_digits_after_rare_choices() {
        let table = AliasTable::new(&[1.0, (1u32 << 20) as f32 - 1.0]).unwrap();
        let rare = 0.5f64.powi(20);
        let mut counts = vec![0.0; 64];
        let mut rng = Rng::new(33);
        for _ in 0..20_000 {
            let (index, pmf, left) = table.sample_f64(rng.next_f64() * rare);
            assert_eq!((index, pmf), (0, rare as f32));
            counts[(left * 64.0) as usize] += 1.0;
        }
        assert!(chi_square_p_value(&counts, &[20_000.0 / 64.0; 64], 0) > 1e-3);
        assert!((0..1000).all(|_| (table.sample((rng.next_1d() * 16.0).floor() * 0.5f32.powi(24)).2 * 16.0).fract() == 0.0));
        assert!(table.sample_f64(BELOW_ONE).2 < 1.0 && table.sample(ONE_MINUS_EPSILON).2 < 1.0);
    }

    #[test]
    fn zero_weights_are_never_chosen_and_all_zero_is_uniform() {
        let table = AliasTable::new(&[0.0, 1.0, f32::NAN, -3.0, 0.0, f32::INFINITY, 2.0]).unwrap();
        for i in 0..100_000 {
            assert!(matches!(table.sample(i as f32 / 100_000.0).0, 1 | 6));
        }
        let zero = AliasTable::new(&[0.0; 4]).unwrap();
        assert!(zero.is_zero() && zero.pmf(2) == 0.25 && zero.sample(0.99).0 == 3);
        assert!(AliasTable::new(&[]).is_none());
    }
}

//! One number instead of a table: sorted probabilities of blocks fall about like 1/(u + i).

/// The discrete distribution f(i) of an index i in 0 .. n whose cumulative distribution has a closed inverse.
///
/// ```text
/// F(x) = ln(1 + x/u) / ln(1 + n/u),   f(i) = F(i + 1) − F(i) = ln(1 + 1/(u + i)) / ln(1 + n/u)
/// F⁻¹(ξ) = u ((1 + n/u)^ξ − 1),   i = ⌊F⁻¹(ξ)⌋                                       [Ergun15] eq. 6.3 to 6.5
/// ```
///
/// # Surprises
/// Whatever is drawn by it has density f, never the probability it was fitted to: the fit decides about noise, not about the mean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReciprocalLaw {
    n: usize,
    u: f64,
    /// ln(1 + n/u).
    log_ratio: f64,
}

impl ReciprocalLaw {
    /// The interval of ln u that is searched.
    const LOG_U: (f64, f64) = (-14.0, 14.0);

    /// The law over `n` indices, at least 1, with u > 0.
    pub(crate) fn new(n: usize, u: f64) -> Self {
        Self { n, u, log_ratio: (n as f64 / u).ln_1p() }
    }

    /// The law of greatest likelihood Σ P_i ln f(i; u) for probabilities in descending order, at least one; by golden sections over ln u.
    pub(crate) fn fit(probabilities: &[f64]) -> Self {
        const SECTION: f64 = 0.618_033_988_749_894_9;
        let likelihood = |log_u: f64| Self::new(probabilities.len(), log_u.exp()).log_likelihood(probabilities);
        let (mut low, mut high) = Self::LOG_U;
        let (mut a, mut b) = (high - SECTION * (high - low), low + SECTION * (high - low));
        let (mut at_a, mut at_b) = (likelihood(a), likelihood(b));
        // The interval shrinks to 28 · 0.618⁴⁰ ≈ 10⁻⁷.
        for _ in 0..40 {
            if at_a < at_b {
                (low, a, at_a) = (a, b, at_b);
                b = low + SECTION * (high - low);
                at_b = likelihood(b);
            } else {
                (high, b, at_b) = (b, a, at_a);
                a = high - SECTION * (high - low);
                at_a = likelihood(a);
            }
        }
        Self::new(probabilities.len(), (0.5 * (low + high)).exp())
    }

    fn log_likelihood(&self, probabilities: &[f64]) -> f64 {
        probabilities.iter().enumerate().map(|(i, p)| p * self.pmf(i).ln()).sum()
    }

    /// The parameter u.
    pub fn u(&self) -> f64 {
        self.u
    }

    /// Number of indices.
    #[allow(clippy::len_without_is_empty, reason = "a law is never empty")]
    pub fn len(&self) -> usize {
        self.n
    }

    /// f(i).
    #[inline]
    pub fn pmf(&self, index: usize) -> f64 {
        (1.0 / (self.u + index as f64)).ln_1p() / self.log_ratio
    }

    /// F(x) for x in [0, n].
    pub fn cdf(&self, x: f64) -> f64 {
        (x / self.u).ln_1p() / self.log_ratio
    }

    /// F⁻¹(ξ) for ξ in [0, 1].
    #[inline]
    pub fn inverse(&self, xi: f64) -> f64 {
        self.u * ((xi * self.log_ratio).exp() - 1.0)
    }

    /// The index that a number ξ in [0, 1) chooses: one formula, no search.
    #[inline]
    pub fn index(&self, xi: f64) -> usize {
        (self.inverse(xi) as usize).min(self.n - 1)
    }

    /// Half the sum of |f(i) − P_i|: the largest difference in the probability of any set of indices.
    pub fn total_variation(&self, probabilities: &[f64]) -> f64 {
        0.5 * probabilities.iter().enumerate().map(|(i, p)| (self.pmf(i) - p).abs()).sum::<f64>()
    }
}

/// ξ in stratum `k` of `count` of [0, 1): `u` moves inside it. The inverse of the law is a formula, so the strata of ξ are strata of blocks.
#[inline]
pub fn stratum(k: u32, count: u32, u: f32) -> f64 {
    (f64::from(k) + f64::from(u)) / f64::from(count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::environment::test_maps::all_maps;
    use crate::environment::{BlockTree, Criterion, DensityImage, KdSampler};

    #[test]
    fn probabilities_sum_to_one_and_the_inverse_returns() {
        for n in [1, 2, 256, 771, 3084, 16_384] {
            for u in [1e-6, 0.01, 1.0, 8.0, 1e3, 1e6] {
                let law = ReciprocalLaw::new(n, u);
                let sum: f64 = (0..n).map(|i| law.pmf(i)).sum();
                assert!((sum - 1.0).abs() < 1e-6, "n {n}, u {u}: {sum}");
                for k in 0..=1000 {
                    let xi = f64::from(k) / 1000.0;
                    assert!((law.cdf(law.inverse(xi)) - xi).abs() < 1e-6, "n {n}, u {u}, ξ {xi}");
                    assert!(law.index(xi) < n);
                }
            }
        }
    }

    fn shares(image: &DensityImage, blocks: usize) -> Vec<f64> {
        let tree = BlockTree::new(image, blocks, Criterion::default()).unwrap();
        tree.ranked_leaves().iter().map(|&leaf| tree.nodes()[leaf as usize].share).collect()
    }

    #[test]
    fn the_fit_is_the_best_of_a_grid_and_near_the_shares_at_the_preset_and_a_planted_fault_is_seen() {
        for (name, size, luminance) in all_maps() {
            let image = DensityImage::from_luminance(size, &luminance).unwrap();
            for blocks in [KdSampler::default_count(size), 256, 3084] {
                let shares = shares(&image, blocks);
                assert!(shares.is_sorted_by(|a, b| a >= b));
                let law = ReciprocalLaw::fit(&shares);
                // Steps of half a per cent.
                let grid = (0..5600).map(|k| ReciprocalLaw::new(shares.len(), (-14.0 + 0.005 * f64::from(k)).exp()));
                let best = grid.max_by(|a, b| a.log_likelihood(&shares).total_cmp(&b.log_likelihood(&shares))).unwrap();
                assert!((law.u() / best.u() - 1.0).abs() < 0.01, "{name}, {blocks}: u {} and {}", law.u(), best.u());
            }
            let shares = shares(&image, KdSampler::default_count(size));
            let law = ReciprocalLaw::fit(&shares);
            let distance = law.total_variation(&shares);
            assert!(distance < 0.25, "{name}: u {}, distance {distance}", law.u());
            let wrong = ReciprocalLaw::new(shares.len(), law.u() * 300.0);
            assert!(wrong.total_variation(&shares) > 0.25, "{name}");
        }
    }

    #[test]
    fn strata_keep_their_order_and_cover_the_interval() {
        for k in 0..7 {
            assert!(stratum(k, 7, 0.0) == f64::from(k) / 7.0 && stratum(k, 7, 0.999_999_9) < f64::from(k + 1) / 7.0);
        }
    }
}

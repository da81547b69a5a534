//! A plane through the pixels of a window: weighted least squares of colour over features.
//!
//! ```text
//! (β₀, β) = argmin Σ_q w(p, q) |c(q) − β₀ − β·(f(q) − f(p))|²  +  ridge,      the answer is β₀        [Bitterli16] eq. 3
//! ```
//!
//! Sixteen neighbouring pixels are solved side by side, one a lane.

#![allow(clippy::needless_range_loop, reason = "lanes and matrices are indexed as in their formulas")]

/// Pixels solved together.
pub(crate) const LANES: usize = 16;
pub(crate) type Lanes = [f32; LANES];

/// Features of a pixel.
pub(crate) const FEATURES: usize = 7;
/// Entries of the symmetric matrix of the features, row by row up to the diagonal.
const PAIRS: usize = FEATURES * (FEATURES + 1) / 2;

/// Ridge relative to a feature's own scatter.
const RELATIVE_RIDGE: f32 = 1e-3;
/// Ridge: variance of a feature below which it says nothing.
const RIDGE: f32 = 1e-3;

/// Weighted sums over a window.
#[derive(Clone, Copy)]
pub(crate) struct Sums {
    weight: Lanes,
    features: [Lanes; FEATURES],
    pairs: [Lanes; PAIRS],
    colors: [Lanes; 3],
    /// Feature by colour.
    mixed: [[Lanes; 3]; FEATURES],
}

impl Sums {
    pub(crate) const ZERO: Self = Self {
        weight: [0.0; LANES],
        features: [[0.0; LANES]; FEATURES],
        pairs: [[0.0; LANES]; PAIRS],
        colors: [[0.0; LANES]; 3],
        mixed: [[[0.0; LANES]; 3]; FEATURES],
    };

    /// Adds a pixel of the window: its weight, its colour, and its features relative to the centre's.
    #[inline(always)]
    pub(crate) fn add(&mut self, weight: &Lanes, color: &[Lanes; 3], features: &[Lanes; FEATURES]) {
        for l in 0..LANES {
            self.weight[l] += weight[l];
        }
        let mut weighted = [[0.0; LANES]; 3];
        for c in 0..3 {
            for l in 0..LANES {
                weighted[c][l] = weight[l] * color[c][l];
                self.colors[c][l] += weighted[c][l];
            }
        }
        let mut pair = 0;
        for i in 0..FEATURES {
            let mut scaled = [0.0; LANES];
            for l in 0..LANES {
                scaled[l] = weight[l] * features[i][l];
                self.features[i][l] += scaled[l];
            }
            for c in 0..3 {
                for l in 0..LANES {
                    self.mixed[i][c][l] += features[i][l] * weighted[c][l];
                }
            }
            for j in 0..=i {
                for l in 0..LANES {
                    self.pairs[pair][l] += scaled[l] * features[j][l];
                }
                pair += 1;
            }
        }
    }

    /// Colour at the centre.
    #[inline(always)]
    pub(crate) fn solve(&self) -> [Lanes; 3] {
        let mut inverse = [0.0; LANES];
        for l in 0..LANES {
            inverse[l] = 1.0 / self.weight[l];
        }
        // About the mean of the window; lower triangle of the Cholesky factor in place.
        let mut matrix = self.pairs;
        let mut right = self.mixed;
        let mut pair = 0;
        for i in 0..FEATURES {
            for j in 0..=i {
                for l in 0..LANES {
                    matrix[pair][l] -= self.features[i][l] * self.features[j][l] * inverse[l];
                    if i == j {
                        matrix[pair][l] = matrix[pair][l].max(0.0) * (1.0 + RELATIVE_RIDGE) + RIDGE * self.weight[l];
                    }
                }
                pair += 1;
            }
            for c in 0..3 {
                for l in 0..LANES {
                    right[i][c][l] -= self.features[i][l] * self.colors[c][l] * inverse[l];
                }
            }
        }
        factor(&mut matrix);
        let mut out = [[0.0; LANES]; 3];
        for c in 0..3 {
            let mut slope = [[0.0; LANES]; FEATURES];
            for i in 0..FEATURES {
                slope[i] = right[i][c];
            }
            substitute(&matrix, &mut slope);
            for l in 0..LANES {
                let drift: f32 = (0..FEATURES).map(|i| slope[i][l] * self.features[i][l]).sum();
                out[c][l] = ((self.colors[c][l] - drift) * inverse[l]).max(0.0);
            }
        }
        out
    }
}

/// Place of row `i`, column `j ≤ i`.
#[inline(always)]
const fn at(i: usize, j: usize) -> usize {
    i * (i + 1) / 2 + j
}

/// A = L Lᵀ in place; the diagonal holds 1/L_ii.
#[inline(always)]
fn factor(a: &mut [Lanes; PAIRS]) {
    for i in 0..FEATURES {
        for j in 0..=i {
            let mut sum = a[at(i, j)];
            for k in 0..j {
                for l in 0..LANES {
                    sum[l] -= a[at(i, k)][l] * a[at(j, k)][l];
                }
            }
            for l in 0..LANES {
                a[at(i, j)][l] = if i == j { 1.0 / sum[l].max(f32::MIN_POSITIVE).sqrt() } else { sum[l] * a[at(j, j)][l] };
            }
        }
    }
}

/// x ← A⁻¹ x with the factor of A.
#[inline(always)]
fn substitute(factor: &[Lanes; PAIRS], x: &mut [Lanes; FEATURES]) {
    for i in 0..FEATURES {
        for k in 0..i {
            for l in 0..LANES {
                x[i][l] -= factor[at(i, k)][l] * x[k][l];
            }
        }
        for l in 0..LANES {
            x[i][l] *= factor[at(i, i)][l];
        }
    }
    for i in (0..FEATURES).rev() {
        for k in i + 1..FEATURES {
            for l in 0..LANES {
                x[i][l] -= factor[at(k, i)][l] * x[k][l];
            }
        }
        for l in 0..LANES {
            x[i][l] *= factor[at(i, i)][l];
        }
    }
}

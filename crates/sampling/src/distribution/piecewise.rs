//! Piecewise constant densities on the unit interval and the unit square.

use super::clean;
use crate::Steps;
use crate::bits::ONE_MINUS_EPSILON;
use glam::Vec2;

/// A density on [0, 1) that is constant in each of n equal cells.
#[derive(Clone, Debug)]
pub struct Piecewise1d {
    /// n + 1 values from 0 to 1.
    cdf: Vec<f32>,
    /// Density in each cell; mean 1.
    density: Vec<f32>,
    mean: f32,
}

impl Piecewise1d {
    /// The density proportional to `values`. `None` when there are none.
    pub fn new(values: &[f32]) -> Option<Self> {
        if values.is_empty() {
            return None;
        }
        let n = values.len() as f64;
        let total: f64 = values.iter().map(|&v| clean(v)).sum();
        let share = |v: f32| if total > 0.0 { clean(v) / total } else { 1.0 / n };
        let mut cdf = Vec::with_capacity(values.len() + 1);
        let mut sum = 0.0;
        cdf.push(0.0);
        for &v in values {
            sum += share(v);
            cdf.push(sum.min(1.0) as f32);
        }
        // Cells after the last positive one must stay empty, so all of them end at exactly 1.
        let last = values.iter().rposition(|&v| share(v) > 0.0).unwrap_or(values.len() - 1);
        cdf[last + 1..].fill(1.0);
        Some(Self { cdf, density: values.iter().map(|&v| (share(v) * n) as f32).collect(), mean: (total / n) as f32 })
    }

    /// A point x in [0, 1), its density and its cell.
    #[inline]
    pub fn sample(&self, u: f32) -> (f32, f32, usize) {
        self.sample_counted(u, &mut ())
    }

    /// [`Self::sample`], counting the reads of the search.
    #[inline]
    pub fn sample_counted(&self, u: f32, steps: &mut impl Steps) -> (f32, f32, usize) {
        let below = |&c: &f32| {
            steps.step();
            c <= u
        };
        // The last cell whose lower bound is ≤ u; empty cells are skipped because their bounds coincide.
        let cell = (self.cdf.partition_point(below)).clamp(1, self.density.len()) - 1;
        let (low, high) = (self.cdf[cell], self.cdf[cell + 1]);
        let t = if high > low { ((u - low) / (high - low)).clamp(0.0, ONE_MINUS_EPSILON) } else { 0.5 };
        // Rounding must not move x into a neighbouring cell: stay two units in the last place inside the bounds.
        let n = self.density.len() as f32;
        let (first, last) = (cell as f32 / n * (1.0 + 2.0 * f32::EPSILON), (cell + 1) as f32 / n * (1.0 - 2.0 * f32::EPSILON));
        (((cell as f32 + t) / n).clamp(first, last), self.density[cell], cell)
    }

    /// Density at x in [0, 1).
    #[inline]
    pub fn pdf(&self, x: f32) -> f32 {
        self.density[self.cell(x)]
    }

    /// The inverse of [`Piecewise1d::sample`]: the cumulative distribution at x.
    pub fn inverse(&self, x: f32) -> f32 {
        let cell = self.cell(x);
        let t = (x * self.density.len() as f32 - cell as f32).clamp(0.0, 1.0);
        (self.cdf[cell] + t * (self.cdf[cell + 1] - self.cdf[cell])).min(ONE_MINUS_EPSILON)
    }

    /// Mean of the values, which is the integral of the function they describe.
    pub fn mean(&self) -> f32 {
        self.mean
    }

    /// True when all values are zero and the density is uniform.
    pub fn is_zero(&self) -> bool {
        self.mean <= 0.0
    }

    /// Number of cells, at least 1.
    #[allow(clippy::len_without_is_empty, reason = "a distribution is never empty")]
    pub fn len(&self) -> usize {
        self.density.len()
    }

    #[inline]
    fn cell(&self, x: f32) -> usize {
        ((x.max(0.0) * self.density.len() as f32) as usize).min(self.density.len() - 1)
    }
}

/// A density on [0, 1)² that is constant in each of width × height equal cells: marginal in y, conditional in x.    \[Pharr04]
#[derive(Clone, Debug)]
pub struct Piecewise2d {
    rows: Vec<Piecewise1d>,
    marginal: Piecewise1d,
}

impl Piecewise2d {
    /// The density proportional to `values`: height × width, row-major. `None` when either size is zero or does not fit.
    pub fn new(values: &[f32], width: usize, height: usize) -> Option<Self> {
        if width == 0 || height == 0 || values.len() != width.checked_mul(height)? {
            return None;
        }
        let rows: Vec<_> = values.chunks_exact(width).map(Piecewise1d::new).collect::<Option<_>>()?;
        let marginal = Piecewise1d::new(&rows.iter().map(Piecewise1d::mean).collect::<Vec<_>>())?;
        Some(Self { rows, marginal })
    }

    /// A point and its density per unit area of the square.
    #[inline]
    pub fn sample(&self, u: Vec2) -> (Vec2, f32) {
        self.sample_counted(u, &mut ())
    }

    /// [`Self::sample`], counting the reads of both searches: O(log width + log height).
    #[inline]
    pub fn sample_counted(&self, u: Vec2, steps: &mut impl Steps) -> (Vec2, f32) {
        let (y, pdf_y, row) = self.marginal.sample_counted(u.y, steps);
        let (x, pdf_x, _) = self.rows[row].sample_counted(u.x, steps);
        (Vec2::new(x, y), pdf_x * pdf_y)
    }

    /// Density per unit area at p in [0, 1)².
    #[inline]
    pub fn pdf(&self, p: Vec2) -> f32 {
        let row = self.marginal.cell(p.y);
        self.marginal.density[row] * self.rows[row].pdf(p.x)
    }

    /// The inverse of [`Piecewise2d::sample`].
    pub fn inverse(&self, p: Vec2) -> Vec2 {
        Vec2::new(self.rows[self.marginal.cell(p.y)].inverse(p.x), self.marginal.inverse(p.y))
    }

    /// Memory of the tables, bytes.
    pub fn bytes(&self) -> usize {
        self.rows.iter().chain([&self.marginal]).map(|row| size_of_val(row.cdf.as_slice()) + size_of_val(row.density.as_slice())).sum()
    }

    /// Memory of the cumulative values alone, bytes: densities are their differences, and a program short of memory would store only these.
    pub fn cumulative_bytes(&self) -> usize {
        self.rows.iter().chain([&self.marginal]).map(|row| size_of_val(row.cdf.as_slice())).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Rng;
    use crate::statistics::chi_square_p_value;

    const VALUES: [f32; 12] = [0.0, 1.0, 2.0, 0.5, 0.0, 0.0, 0.0, 0.0, 4.0, 0.1, 0.0, 3.0];

    fn p_value(expected: &[f32]) -> f64 {
        let d = Piecewise2d::new(&VALUES, 4, 3).unwrap();
        let n = 200_000;
        let mut rng = Rng::new(41);
        let mut counts = vec![0.0; 12];
        for _ in 0..n {
            let (p, pdf) = d.sample(rng.next_2d());
            assert_eq!(pdf, d.pdf(p));
            counts[(p.y * 3.0) as usize * 4 + (p.x * 4.0) as usize] += 1.0;
        }
        let total: f64 = expected.iter().map(|&v| f64::from(v)).sum();
        chi_square_p_value(&counts, &expected.iter().map(|&v| f64::from(v) / total * f64::from(n)).collect::<Vec<_>>(), 0)
    }

    #[test]
    fn points_follow_the_values_and_a_planted_fault_is_seen() {
        assert!(p_value(&VALUES) > 1e-3);
        let mut transposed = VALUES;
        transposed.swap(1, 3);
        assert!(p_value(&transposed) < 1e-9);
    }

    #[test]
    fn density_integrates_to_one_and_inverse_returns() {
        let d = Piecewise2d::new(&VALUES, 4, 3).unwrap();
        let sum: f32 = (0..12).map(|i| d.pdf(Vec2::new(((i % 4) as f32 + 0.5) / 4.0, ((i / 4) as f32 + 0.5) / 3.0))).sum();
        assert!((sum / 12.0 - 1.0).abs() < 1e-6);
        assert!((d.marginal.mean() - VALUES.iter().sum::<f32>() / 12.0).abs() < 1e-6);
        let mut rng = Rng::new(42);
        for _ in 0..10_000 {
            let u = rng.next_2d();
            assert!(d.inverse(d.sample(u).0).abs_diff_eq(u, 1e-5));
        }
    }

    #[test]
    fn the_search_grows_with_the_logarithm_of_the_map() {
        let reads = |width: usize, height: usize| {
            let d = Piecewise2d::new(&vec![1.0; width * height], width, height).unwrap();
            let (mut reads, mut rng) = (0u64, Rng::new(43));
            for _ in 0..1000 {
                d.sample_counted(rng.next_2d(), &mut reads);
            }
            reads as f64 / 1000.0
        };
        let [small, middle, large] = [reads(64, 32), reads(256, 128), reads(1024, 512)];
        assert!((middle - small - 4.0).abs() < 0.5 && (large - middle - 4.0).abs() < 0.5, "{small}, {middle}, {large}");
    }

    #[test]
    fn empty_cells_are_never_chosen_at_the_ends_of_the_interval() {
        let d = Piecewise1d::new(&[0.0, 0.0, 1.0, 0.0, 2.0, 0.0, 0.0]).unwrap();
        for u in [0.0, f32::MIN_POSITIVE, 1.0 / 3.0, 0.333_333_3, 0.999_999_9, ONE_MINUS_EPSILON] {
            let (x, pdf, cell) = d.sample(u);
            assert!(matches!(cell, 2 | 4) && pdf > 0.0 && d.pdf(x) == pdf, "u = {u}: cell {cell}, x = {x}");
        }
    }

    #[test]
    fn all_zero_is_uniform_and_bad_input_is_handled() {
        let d = Piecewise2d::new(&[0.0; 6], 3, 2).unwrap();
        assert_eq!(d.pdf(Vec2::splat(0.5)), 1.0);
        assert!(d.sample(Vec2::new(0.25, 0.75)).0.abs_diff_eq(Vec2::new(0.25, 0.75), 1e-6));
        assert!(Piecewise1d::new(&[]).is_none() && Piecewise2d::new(&[1.0], 0, 1).is_none() && Piecewise2d::new(&[1.0], 2, 2).is_none());
        let odd = Piecewise1d::new(&[f32::NAN, -1.0, 2.0, f32::INFINITY]).unwrap();
        assert_eq!((odd.pdf(0.1), odd.pdf(0.6), odd.pdf(0.9)), (0.0, 4.0, 0.0));
    }
}

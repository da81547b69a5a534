//! Choice of a point of the unit square in constant time.

use super::AliasTable;
use glam::Vec2;

/// A density on [0, 1)² that is constant in each of width × height equal cells: a row by one alias table, a column by another.
///
/// Two tables keep the digits of the numbers: one table over 2²³ cells would leave a 24-bit number two values to decide on the alias.
#[derive(Clone, Debug)]
pub struct Alias2d {
    rows: Vec<AliasTable>,
    marginal: AliasTable,
}

impl Alias2d {
    /// The density proportional to `values`: height × width, row-major. `None` when either size is zero or does not fit.
    pub fn new(values: &[f32], width: usize, height: usize) -> Option<Self> {
        if width == 0 || height == 0 || values.len() != width.checked_mul(height)? {
            return None;
        }
        let rows: Vec<_> = values.chunks_exact(width).map(AliasTable::new).collect::<Option<_>>()?;
        let marginal = AliasTable::new(&rows.iter().map(|row| row.total() as f32).collect::<Vec<_>>())?;
        Some(Self { rows, marginal })
    }

    /// A point and its density per unit area of the square.
    #[inline]
    pub fn sample(&self, u: Vec2) -> (Vec2, f32) {
        let (row, pmf_y, y) = self.marginal.sample(u.y);
        let (column, pmf_x, x) = self.rows[row].sample(u.x);
        let cells = Vec2::new(self.rows[row].len() as f32, self.rows.len() as f32);
        let low = Vec2::new(column as f32, row as f32);
        // Rounding must not move the point into a neighbouring cell: stay two units in the last place inside the bounds.
        let ends = (low / cells * (1.0 + 2.0 * f32::EPSILON), (low + 1.0) / cells * (1.0 - 2.0 * f32::EPSILON));
        (((low + Vec2::new(x, y)) / cells).clamp(ends.0, ends.1), pmf_x * pmf_y * cells.x * cells.y)
    }

    /// Density per unit area at p in [0, 1)².
    #[inline]
    pub fn pdf(&self, p: Vec2) -> f32 {
        let cell = |x: f32, n: usize| ((x.max(0.0) * n as f32) as usize).min(n - 1);
        let (height, row) = (self.rows.len(), cell(p.y, self.rows.len()));
        let width = self.rows[row].len();
        self.marginal.pmf(row) * self.rows[row].pmf(cell(p.x, width)) * width as f32 * height as f32
    }

    /// Memory of the tables, bytes.
    pub fn bytes(&self) -> usize {
        self.rows.iter().chain([&self.marginal]).map(AliasTable::bytes).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Rng;
    use crate::statistics::chi_square_p_value;

    const VALUES: [f32; 12] = [0.0, 1.0, 2.0, 0.5, 0.0, 0.0, 0.0, 0.0, 4.0, 0.1, 0.0, 3.0];

    fn p_value(expected: &[f32]) -> f64 {
        let d = Alias2d::new(&VALUES, 4, 3).unwrap();
        let mut rng = Rng::new(44);
        let mut counts = vec![0.0; 12];
        for _ in 0..200_000 {
            let (p, pdf) = d.sample(rng.next_2d());
            assert!((pdf - d.pdf(p)).abs() < 1e-5);
            counts[(p.y * 3.0) as usize * 4 + (p.x * 4.0) as usize] += 1.0;
        }
        let total: f64 = expected.iter().map(|&v| f64::from(v)).sum();
        chi_square_p_value(&counts, &expected.iter().map(|&v| f64::from(v) / total * 200_000.0).collect::<Vec<_>>(), 0)
    }

    #[test]
    fn points_follow_the_values_and_a_planted_fault_is_seen() {
        assert!(p_value(&VALUES) > 1e-3);
        let mut transposed = VALUES;
        transposed.swap(1, 3);
        assert!(p_value(&transposed) < 1e-9);
    }

    #[test]
    fn density_integrates_to_one_and_bad_input_is_handled() {
        let d = Alias2d::new(&VALUES, 4, 3).unwrap();
        let sum: f32 = (0..12).map(|i| d.pdf(Vec2::new(((i % 4) as f32 + 0.5) / 4.0, ((i / 4) as f32 + 0.5) / 3.0))).sum();
        assert!((sum / 12.0 - 1.0).abs() < 1e-6);
        assert!(Alias2d::new(&[1.0], 0, 1).is_none() && Alias2d::new(&[1.0], 2, 2).is_none());
        assert_eq!(Alias2d::new(&[0.0; 6], 3, 2).unwrap().pdf(Vec2::splat(0.5)), 1.0);
    }
}

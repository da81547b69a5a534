//! Non-negative factors of a matrix.
//!
//! ```text
//! D(Y ‖ FG) = Σ Y ln(Y/FG) − Y + FG                                                               [LeeSeung01]
//! F_ij ← F_ij Σ_h G_jh Y_ih/(FG)_ih / Σ_h G_jh,    G likewise: D never grows
//! ```
//!
//! The divergence is chosen before the squared distance because an error e counts as e²/(2Y), so that a highlight a thousand times brighter than its
//! surroundings does not have all terms for itself; and because its optimum of rank 1 is known: row sums times column sums.

/// Below, a sum of products is not divided by.
const LEAST: f32 = 1e-30;

/// One term of FG.
#[derive(Clone, Debug)]
pub(super) struct Product {
    pub rows: Vec<f32>,
    pub columns: Vec<f32>,
}

/// y/ŷ.
#[inline]
pub(super) fn ratio(y: f32, found: f32) -> f32 {
    y / found.max(LEAST)
}

/// What an entry adds to D.
#[inline]
pub(super) fn divergence(y: f32, found: f32) -> f64 {
    let (y, found) = (f64::from(y), f64::from(found.max(LEAST)));
    if y > 0.0 { y * (y / found).ln() - y + found } else { found }
}

impl Product {
    /// The product nearest to a matrix; `None` of nothing but zeros.
    pub fn nearest(matrix: &[f32], columns: usize) -> Option<Self> {
        let rows: Vec<f32> = matrix.chunks(columns).map(|row| row.iter().sum()).collect();
        let total: f32 = rows.iter().sum();
        let mut sums = vec![0.0; columns];
        for row in matrix.chunks(columns) {
            sums.iter_mut().zip(row).for_each(|(sum, v)| *sum += v);
        }
        (total > 0.0).then(|| Self { rows, columns: sums.into_iter().map(|sum| sum / total).collect() })
    }
}

/// F and G of at most `terms` terms: each the nearest product to what those before it leave, all improved together `sweeps` times after each.
pub(super) fn factor(matrix: &[f32], columns: usize, terms: usize, sweeps: usize) -> Vec<Product> {
    let mut products: Vec<Product> = Vec::new();
    for _ in 0..terms {
        let excess: Vec<f32> = matrix.iter().zip(sum(&products, matrix.len(), columns)).map(|(y, found)| (y - found).max(0.0)).collect();
        let Some(mut next) = Product::nearest(&excess, columns) else { break };
        // Half of it, so that the terms before have room to change and D does not grow.
        next.rows.iter_mut().for_each(|v| *v *= if products.is_empty() { 1.0 } else { 0.5 });
        products.push(next);
        for _ in 0..sweeps {
            sweep(matrix, columns, &mut products);
        }
    }
    products
}

fn sum(products: &[Product], length: usize, columns: usize) -> Vec<f32> {
    let mut out = vec![0.0; length];
    for (i, row) in out.chunks_mut(columns).enumerate() {
        for product in products {
            row.iter_mut().zip(&product.columns).for_each(|(sum, v)| *sum += product.rows[i] * v);
        }
    }
    out
}

fn sweep(matrix: &[f32], columns: usize, products: &mut [Product]) {
    for of_rows in [true, false] {
        let ratios: Vec<f32> = matrix.iter().zip(sum(products, matrix.len(), columns)).map(|(y, found)| ratio(*y, found)).collect();
        for product in products.iter_mut() {
            if of_rows {
                let whole: f32 = product.columns.iter().sum();
                for (factor, row) in product.rows.iter_mut().zip(ratios.chunks(columns)) {
                    *factor *= row.iter().zip(&product.columns).map(|(r, v)| r * v).sum::<f32>() / whole.max(LEAST);
                }
            } else {
                let whole: f32 = product.rows.iter().sum();
                let mut sums = vec![0.0; columns];
                for (row, factor) in ratios.chunks(columns).zip(&product.rows) {
                    sums.iter_mut().zip(row).for_each(|(sum, r)| *sum += factor * r);
                }
                product.columns.iter_mut().zip(sums).for_each(|(v, sum)| *v *= sum / whole.max(LEAST));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn off(matrix: &[f32], products: &[Product], columns: usize) -> f64 {
        let all: f64 = matrix.iter().map(|v| f64::from(*v)).sum();
        matrix.iter().zip(sum(products, matrix.len(), columns)).map(|(y, found)| divergence(*y, found)).sum::<f64>() / all
    }

    fn planted(terms: usize, rows: usize, columns: usize) -> Vec<f32> {
        let mut rng = kajo_sampling::Rng::new(terms as u64);
        let mut random = |count: usize| (0..count).map(|_| rng.next_1d().powi(3)).collect::<Vec<f32>>();
        let products: Vec<Product> = (0..terms).map(|_| Product { rows: random(rows), columns: random(columns) }).collect();
        sum(&products, rows * columns, columns)
    }

    #[test]
    fn planted_factors_are_found_by_as_many_terms_and_not_by_fewer() {
        let matrix = planted(3, 20, 30);
        let found: Vec<f64> = (1..=3).map(|terms| off(&matrix, &factor(&matrix, 30, terms, 2000), 30)).collect();
        assert!(found[2] < 1e-4 && found[1] > 10.0 * found[2] && found[0] > found[1], "{found:?}");
    }

    #[test]
    fn one_term_is_the_sums_and_no_sweep_makes_it_worse() {
        let matrix = planted(4, 12, 15);
        let one = factor(&matrix, 15, 1, 0);
        assert!((off(&matrix, &one, 15) - off(&matrix, &factor(&matrix, 15, 1, 50), 15)).abs() < 1e-6);
        let mut products = factor(&matrix, 15, 3, 1);
        let mut before = off(&matrix, &products, 15);
        for _ in 0..50 {
            sweep(&matrix, 15, &mut products);
            let now = off(&matrix, &products, 15);
            assert!(now <= before * (1.0 + 1e-5) + 1e-9, "{before} {now}");
            before = now;
        }
        assert!(factor(&[0.0; 12], 4, 2, 3).is_empty());
    }
}

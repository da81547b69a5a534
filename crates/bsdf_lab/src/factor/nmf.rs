//! Non-negative factorisation of a table on two levels.
//!
//! ```text
//! Y ≈ F G,    Y_(ω_o, colour),(θ_h, φ_h) = Q,    G_j ≈ Σ_k u_jk(θ_h) v_jk(φ_h)                     [Lawrence04]
//! ```
//!
//! The colours are rows of one matrix: they share G, which is most of the numbers, and each term has a colour by viewer.
//! Deviation: the two levels are not factored once after each other but improved together, by the same multiplicative updates through both, because the
//! first level alone does not know what the second can keep; and terms are added one by one, so that each has an error of its own to report.

use super::kullback_leibler::{Product, divergence, factor, ratio};
use super::{Step, Table};
use kajo_bsdf::models::factored::Grid;
use kajo_bsdf::models::nmf::Factors;
use rayon::prelude::*;

/// How much is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NmfOptions {
    /// Functions of the viewer, J.
    pub outer: usize,
    /// Products of functions of θ_h and φ_h for each of them, K.
    pub inner: usize,
    /// Improvements after each outer term.
    pub sweeps: usize,
}

/// Sweeps of the second level before both are improved together.
const INNER_SWEEPS: usize = 30;
/// Rows that one thread works on: a constant, so that sums have the same order on every machine.
const ROWS: usize = 16;

/// A term: F_j with its colours as rows of Y, and G_j as products.
struct Term {
    views: Vec<f32>,
    half_vectors: Vec<Product>,
}

impl Term {
    fn expanded(&self, grid: Grid) -> Vec<f32> {
        let mut out = vec![0.0; grid.half_vectors()];
        for product in &self.half_vectors {
            for (row, u) in out.chunks_mut(grid.phi_h).zip(&product.rows) {
                row.iter_mut().zip(&product.columns).for_each(|(sum, v)| *sum += u * v);
            }
        }
        out
    }
}

/// Factors a table. `on_step` is told of every outer term, and ends the work by `false`.
///
/// What is darker than the constant part of f counts as 0.
pub fn nmf(table: &Table, options: NmfOptions, mut on_step: impl FnMut(&Step) -> bool) -> Factors {
    let grid = table.grid;
    let matrix: Vec<f32> = table.values.iter().map(|v| v.max(0.0)).collect();
    let columns = grid.half_vectors();
    let mut terms: Vec<Term> = Vec::new();
    let mut whole = None;
    for count in 1..=options.outer {
        let excess: Vec<f32> = matrix.iter().zip(sum(&terms, grid)).map(|(y, found)| (y - found).max(0.0)).collect();
        let nearest = Product::nearest(&excess, columns)
            .unwrap_or_else(|| Product { rows: vec![0.0; grid.viewers() * grid.channels], columns: vec![1.0; columns] });
        let mut half_vectors = factor(&nearest.columns, grid.phi_h, options.inner, INNER_SWEEPS);
        half_vectors.resize_with(options.inner, || Product { rows: vec![0.0; grid.theta_h], columns: vec![0.0; grid.phi_h] });
        let share = if terms.is_empty() { 1.0 } else { 0.5 };
        terms.push(Term { views: nearest.rows.iter().map(|v| share * v).collect(), half_vectors });
        for _ in 0..options.sweeps {
            sweep(&matrix, grid, &mut terms);
        }
        let found = sum(&terms, grid);
        let rest: f64 = matrix.iter().zip(&found).map(|(y, found)| divergence(*y, *found)).sum();
        let whole = *whole.get_or_insert_with(|| flat(&matrix));
        let numbers = grid.channels + count * (grid.viewers() * grid.channels + options.inner * (grid.theta_h + grid.phi_h));
        if !on_step(&Step { count, numbers, errors: table.errors(&found, rest / whole) }) {
            break;
        }
    }
    collect(table, options.inner, &terms)
}

/// D of the matrix from its mean.
fn flat(matrix: &[f32]) -> f64 {
    let mean = (matrix.iter().map(|v| f64::from(*v)).sum::<f64>() / matrix.len() as f64) as f32;
    matrix.iter().map(|y| divergence(*y, mean)).sum::<f64>().max(f64::MIN_POSITIVE)
}

fn collect(table: &Table, inner: usize, terms: &[Term]) -> Factors {
    let grid = table.grid;
    let viewers = grid.viewers();
    let products = || terms.iter().flat_map(|term| &term.half_vectors);
    Factors {
        grid,
        diffuse: table.diffuse.iter().map(|v| *v as f32).collect(),
        outer: terms.len(),
        inner,
        views: terms
            .iter()
            .flat_map(|term| (0..viewers).flat_map(move |viewer| (0..grid.channels).map(move |c| term.views[c * viewers + viewer])))
            .collect(),
        inclinations: products().flat_map(|product| product.rows.iter().copied()).collect(),
        azimuths: products().flat_map(|product| product.columns.iter().copied()).collect(),
    }
}

fn sum(terms: &[Term], grid: Grid) -> Vec<f32> {
    let expanded: Vec<Vec<f32>> = terms.iter().map(|term| term.expanded(grid)).collect();
    let mut out = vec![0.0; grid.numbers()];
    out.par_chunks_mut(grid.half_vectors()).enumerate().for_each(|(i, row)| add(terms, &expanded, i, row));
    out
}

fn add(terms: &[Term], expanded: &[Vec<f32>], i: usize, row: &mut [f32]) {
    for (term, expanded) in terms.iter().zip(expanded) {
        let factor = term.views[i];
        row.iter_mut().zip(expanded).for_each(|(sum, v)| *sum += factor * v);
    }
}

/// One update of F, of u, and of v.
fn sweep(matrix: &[f32], grid: Grid, terms: &mut [Term]) {
    update_views(matrix, grid, terms);
    for inclinations in [true, false] {
        let gradients = gradients(matrix, grid, terms);
        for (term, gradient) in terms.iter_mut().zip(gradients) {
            let views: f32 = term.views.iter().sum();
            for product in &mut term.half_vectors {
                let Product { rows, columns } = product;
                if inclinations {
                    let whole = views * columns.iter().sum::<f32>();
                    for (u, row) in rows.iter_mut().zip(gradient.chunks(grid.phi_h)) {
                        *u *= ratio(row.iter().zip(&*columns).map(|(r, v)| r * v).sum(), whole);
                    }
                } else {
                    let whole = views * rows.iter().sum::<f32>();
                    let mut sums = vec![0.0; grid.phi_h];
                    for (row, u) in gradient.chunks(grid.phi_h).zip(&*rows) {
                        sums.iter_mut().zip(row).for_each(|(sum, r)| *sum += u * r);
                    }
                    columns.iter_mut().zip(sums).for_each(|(v, sum)| *v *= ratio(sum, whole));
                }
            }
        }
    }
}

fn update_views(matrix: &[f32], grid: Grid, terms: &mut [Term]) {
    let expanded: Vec<Vec<f32>> = terms.iter().map(|term| term.expanded(grid)).collect();
    let wholes: Vec<f32> = expanded.iter().map(|g| g.iter().sum()).collect();
    let columns = grid.half_vectors();
    let updated: Vec<Vec<f32>> = matrix
        .par_chunks(columns)
        .enumerate()
        .map(|(i, y)| {
            let ratios = ratios(terms, &expanded, i, y);
            let dot = |g: &Vec<f32>| g.iter().zip(&ratios).map(|(g, r)| g * r).sum::<f32>();
            terms.iter().zip(&expanded).zip(&wholes).map(|((term, g), whole)| term.views[i] * ratio(dot(g), *whole)).collect()
        })
        .collect();
    for (i, row) in updated.into_iter().enumerate() {
        terms.iter_mut().zip(row).for_each(|(term, v)| term.views[i] = v);
    }
}

fn ratios(terms: &[Term], expanded: &[Vec<f32>], i: usize, y: &[f32]) -> Vec<f32> {
    let mut row = vec![0.0; y.len()];
    add(terms, expanded, i, &mut row);
    row.iter_mut().zip(y).for_each(|(found, y)| *found = ratio(*y, *found));
    row
}

/// Σ_i F_ij Y_ih/(FG)_ih of every term.
fn gradients(matrix: &[f32], grid: Grid, terms: &[Term]) -> Vec<Vec<f32>> {
    let expanded: Vec<Vec<f32>> = terms.iter().map(|term| term.expanded(grid)).collect();
    let columns = grid.half_vectors();
    let zeros = || vec![vec![0.0; columns]; terms.len()];
    let parts: Vec<Vec<Vec<f32>>> = matrix
        .par_chunks(ROWS * columns)
        .enumerate()
        .map(|(chunk, rows)| {
            let mut sums = zeros();
            for (k, y) in rows.chunks(columns).enumerate() {
                let i = chunk * ROWS + k;
                let ratios = ratios(terms, &expanded, i, y);
                for (term, sums) in terms.iter().zip(&mut sums) {
                    let factor = term.views[i];
                    sums.iter_mut().zip(&ratios).for_each(|(sum, r)| *sum += factor * r);
                }
            }
            sums
        })
        .collect();
    parts.into_iter().fold(zeros(), |mut all, part| {
        all.iter_mut().zip(part).for_each(|(all, part)| all.iter_mut().zip(part).for_each(|(a, p)| *a += p));
        all
    })
}

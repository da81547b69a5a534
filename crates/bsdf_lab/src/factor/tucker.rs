//! Tucker factorisation of a table, then of its residual, and so on.    \[Bilgili11]

use super::tensor::Tensor;
use super::{Step, Table};
use kajo_bsdf::models::tucker::{Factors, MODES, Pass, nodes, ranks};

/// How much is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TuckerOptions {
    /// Terms along each mode in a pass: 1 makes every pass a product of five functions.
    pub rank: usize,
    /// Tensors: the first is that of the table, each other one that of the residual.
    pub passes: usize,
}

/// Factors a table. `on_step` is told of every pass, and ends the work by `false`.
///
/// Least squares of Q itself would spend all terms on the brightest values. Rings of equal θ_h are divided by the root of their mean instead, an error
/// counts as e²/mean, and the factors u_p(θ_h) are multiplied by it again. (\[Bilgili11] are reported to factor logarithms. Their sum is a product of
/// functions of several angles, which has no sampler from its factors.)
pub fn tucker(table: &Table, options: TuckerOptions, mut on_step: impl FnMut(&Step) -> bool) -> Factors {
    let grid = table.grid;
    let scale = ring_scale(table);
    let ring = |i: usize| scale[i / grid.phi_h % grid.theta_h];
    let mut residual =
        Tensor { sizes: nodes(grid), values: table.values.iter().enumerate().map(|(i, v)| f64::from(*v) / ring(i)).collect() };
    let whole = residual.squares();
    let mut found = vec![0.0_f32; table.values.len()];
    let mut factors = Factors { grid, diffuse: table.diffuse.iter().map(|v| *v as f32).collect(), rank: options.rank, passes: Vec::new() };
    for count in 1..=options.passes {
        let pass = residual.tucker(ranks(grid, options.rank));
        for (i, (residual, caught)) in residual.values.iter_mut().zip(pass.expanded().values).enumerate() {
            *residual -= caught;
            found[i] += (caught * ring(i)) as f32;
        }
        factors.passes.push(Pass {
            functions: std::array::from_fn(|mode| {
                let functions = &pass.functions[mode];
                let scaled = |term: usize, node: usize| functions[(term, node)] * if mode == THETA_H { scale[node] } else { 1.0 };
                (0..functions.nrows())
                    .flat_map(|term| (0..functions.ncols()).map(move |node| (term, node)))
                    .map(|(t, n)| scaled(t, n) as f32)
                    .collect()
            }),
            core: pass.core.values.iter().map(|v| *v as f32).collect(),
        });
        let errors = table.errors(&found, (residual.squares() / whole.max(f64::MIN_POSITIVE)).sqrt());
        if !on_step(&Step { count, numbers: factors.numbers(), errors }) {
            break;
        }
    }
    factors
}

/// For each θ_h the root of the mean of |Q|.
fn ring_scale(table: &Table) -> Vec<f64> {
    let grid = table.grid;
    let mut rings = vec![0.0; grid.theta_h];
    for (i, ring) in table.values.chunks(grid.phi_h).enumerate() {
        rings[i % grid.theta_h] += ring.iter().map(|v| f64::from(v.abs())).sum::<f64>();
    }
    let count = (grid.numbers() / grid.theta_h) as f64;
    // Rings of nothing, such as that of the horizon, would be divided by 0; so small, they are within rounding.
    let least = 1e-6 * rings.iter().fold(0.0, |most: f64, ring| most.max(*ring)) / count;
    rings.iter().map(|ring| (ring / count).max(least).max(f64::MIN_POSITIVE).sqrt()).collect()
}

/// Which mode is the half vector's inclination.
const THETA_H: usize = MODES - 2;

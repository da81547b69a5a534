//! Tensors of five modes, and the best tensor of low rank along each of them.
//!
//! ```text
//! T ≈ G ×₁ A₁ … ×₅ A₅,    A_nᵀA_n = 1         Tucker; G = T ×₁ A₁ᵀ … ×₅ A₅ᵀ
//! A_n = leading eigenvectors of T₍ₙ₎T₍ₙ₎ᵀ                        the start, HOSVD     [DeLathauwer00]
//! A_n = the same of T with all other modes projected            repeated, HOOI       [DeLathauwer00b]
//! ```

use nalgebra::{DMatrix, SymmetricEigen};

/// Modes.
pub(super) const MODES: usize = 5;
/// Repetitions at most.
const MOST_ROUNDS: usize = 40;
/// Relative growth of what is caught at which they end.
const ENOUGH: f64 = 1e-7;

/// Numbers with five indices, the last the fastest.
#[derive(Clone, Debug)]
pub(super) struct Tensor {
    pub sizes: [usize; MODES],
    pub values: Vec<f64>,
}

/// A tensor as core and orthonormal functions.
#[derive(Clone, Debug)]
pub(super) struct Tucker {
    /// Terms × nodes of each mode.
    pub functions: [DMatrix<f64>; MODES],
    pub core: Tensor,
}

impl Tensor {
    /// Σ of squares.
    pub fn squares(&self) -> f64 {
        self.values.iter().map(|v| v * v).sum()
    }

    /// Numbers before and after a mode.
    fn around(&self, mode: usize) -> (usize, usize) {
        (self.sizes[..mode].iter().product(), self.sizes[mode + 1..].iter().product())
    }

    /// T ×_mode M, M having as many columns as the mode has nodes.
    fn times(&self, mode: usize, matrix: &DMatrix<f64>) -> Self {
        let (before, after) = self.around(mode);
        let (rows, nodes) = matrix.shape();
        assert_eq!(nodes, self.sizes[mode], "columns and nodes");
        let mut values = vec![0.0; before * rows * after];
        for outer in 0..before {
            for row in 0..rows {
                let out = &mut values[(outer * rows + row) * after..][..after];
                for node in 0..nodes {
                    let factor = matrix[(row, node)];
                    let slice = &self.values[(outer * nodes + node) * after..][..after];
                    out.iter_mut().zip(slice).for_each(|(sum, v)| *sum += factor * v);
                }
            }
        }
        let mut sizes = self.sizes;
        sizes[mode] = rows;
        Self { sizes, values }
    }

    /// The tensor projected on all functions but those of one mode.
    fn projected(&self, functions: &[DMatrix<f64>; MODES], but: Option<usize>) -> Self {
        let mut modes: Vec<usize> = (0..MODES).filter(|mode| Some(*mode) != but).collect();
        // The largest reduction first.
        modes.sort_by_key(|&mode| functions[mode].nrows() * 1000 / self.sizes[mode]);
        modes.into_iter().fold(self.clone(), |tensor, mode| tensor.times(mode, &functions[mode]))
    }

    /// T₍ₙ₎T₍ₙ₎ᵀ.
    fn gram(&self, mode: usize) -> DMatrix<f64> {
        let (before, after) = self.around(mode);
        let nodes = self.sizes[mode];
        let mut gram = DMatrix::zeros(nodes, nodes);
        for outer in 0..before {
            let slice = |node: usize| &self.values[(outer * nodes + node) * after..][..after];
            for a in 0..nodes {
                for b in 0..=a {
                    gram[(a, b)] += slice(a).iter().zip(slice(b)).map(|(x, y)| x * y).sum::<f64>();
                }
            }
        }
        gram.fill_upper_triangle_with_lower_triangle();
        gram
    }

    /// The leading eigenvectors of the Gram matrix, as rows.
    fn leading(&self, mode: usize, count: usize) -> DMatrix<f64> {
        let eigen = SymmetricEigen::new(self.gram(mode));
        let mut order: Vec<usize> = (0..self.sizes[mode]).collect();
        order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
        DMatrix::from_fn(count, self.sizes[mode], |row, node| eigen.eigenvectors[(node, order[row])])
    }

    /// The best approximation with so many terms along the modes that alternation finds.
    pub fn tucker(&self, ranks: [usize; MODES]) -> Tucker {
        let mut functions: [DMatrix<f64>; MODES] = std::array::from_fn(|mode| self.leading(mode, ranks[mode]));
        let mut caught = 0.0;
        for _ in 0..MOST_ROUNDS {
            for mode in 0..MODES {
                functions[mode] = self.projected(&functions, Some(mode)).leading(mode, ranks[mode]);
            }
            let now = self.projected(&functions, None).squares();
            if now <= caught * (1.0 + ENOUGH) {
                break;
            }
            caught = now;
        }
        let core = self.projected(&functions, None);
        Tucker { functions, core }
    }
}

impl Tucker {
    /// The tensor that it stands for.
    pub fn expanded(&self) -> Tensor {
        (0..MODES).fold(self.core.clone(), |tensor, mode| tensor.times(mode, &self.functions[mode].transpose()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn random(sizes: [usize; MODES], seed: u64) -> Tensor {
        let mut rng = kajo_sampling::Rng::new(seed);
        Tensor { sizes, values: (0..sizes.iter().product()).map(|_| rng.next_f64() - 0.5).collect() }
    }

    fn off(a: &Tensor, b: &Tensor) -> f64 {
        let squares: f64 = a.values.iter().zip(&b.values).map(|(a, b)| (a - b) * (a - b)).sum();
        (squares / a.squares()).sqrt()
    }

    #[test]
    fn a_tensor_of_low_rank_is_found_and_a_higher_one_is_not() {
        let ranks = [2, 3, 1, 2, 3];
        let sizes = [3, 7, 5, 6, 8];
        let core = random(ranks, 1);
        let functions = std::array::from_fn(|mode| {
            let values = random([ranks[mode], sizes[mode], 1, 1, 1], 2 + mode as u64).values;
            DMatrix::from_row_slice(ranks[mode], sizes[mode], &values)
        });
        let planted = Tucker { functions, core }.expanded();
        assert!(off(&planted, &planted.tucker(ranks).expanded()) < 1e-10);
        assert!(off(&planted, &planted.tucker([2, 2, 1, 2, 3]).expanded()) > 1e-3, "one term less is not enough");
    }

    #[test]
    fn functions_are_orthonormal_and_the_core_holds_what_is_caught() {
        let tensor = random([3, 5, 4, 6, 7], 9);
        let found = tensor.tucker([2, 2, 2, 2, 2]);
        for functions in &found.functions {
            let unit = functions * functions.transpose();
            assert!((unit - DMatrix::identity(2, 2)).norm() < 1e-12);
        }
        let missed = off(&tensor, &found.expanded()).powi(2);
        assert!((missed - (1.0 - found.core.squares() / tensor.squares())).abs() < 1e-12, "Pythagoras");
    }
}

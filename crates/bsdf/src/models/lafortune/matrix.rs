//! The general cosine lobe with nine coefficients and an exponent, and the frame in which a reciprocal one is diagonal.

use super::CosineLobe;
use glam::{DMat3, DVec3};

/// f = max(0, Θ_rᵀ M Θ_i)ⁿ.    \[Lafortune97] eq. 6, \[Falski04] (4.29)
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MatrixLobe {
    /// M.
    pub m: DMat3,
    /// Exponent ≥ 0.
    pub n: f64,
}

/// M = Qᵀ D Q: rows of Q are eigenvectors, D is diagonal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eigen {
    /// Turns directions into the lobe's frame.
    pub q: DMat3,
    /// C_x, C_y, C_z in that frame.
    pub d: DVec3,
}

impl MatrixLobe {
    /// The lobe of the cosine about the mirror direction, f = cosⁿα: M = 2 N Nᵀ − I.    (4.28)
    pub fn mirror(n: f64) -> Self {
        Self { m: DMat3::from_diagonal(DVec3::new(-1.0, -1.0, 1.0)), n }
    }

    /// The value for two directions in the local frame.
    pub fn value(&self, wi: DVec3, wo: DVec3) -> f64 {
        wo.dot(self.m * wi).max(0.0).powf(self.n)
    }

    /// Is M = Mᵀ up to rounding? Exactly then the lobe is reciprocal, but for n = 0.
    pub fn is_reciprocal(&self) -> bool {
        let difference = self.m - self.m.transpose();
        largest(difference) <= 1e-12 * largest(self.m)
    }

    /// The frame in which a reciprocal lobe is diagonal, C_x ≤ C_y ≤ C_z; `None` if it is not reciprocal.
    pub fn eigen(&self) -> Option<Eigen> {
        self.is_reciprocal().then(|| jacobi(self.m))
    }
}

impl Eigen {
    /// Qᵀ D Q.
    pub fn matrix(&self) -> DMat3 {
        self.q.transpose() * DMat3::from_diagonal(self.d) * self.q
    }

    /// The diagonal lobe, for directions turned by Q.
    pub fn lobe(&self, n: f64) -> CosineLobe<f64> {
        CosineLobe { c: self.d.into(), n }
    }
}

fn largest(m: DMat3) -> f64 {
    m.to_cols_array().into_iter().fold(0.0, |largest, x| f64::max(largest, x.abs()))
}

/// Eigenvectors and eigenvalues of a symmetric matrix by rotations that make one off-diagonal element vanish at a time.    \[Jacobi1846]
fn jacobi(matrix: DMat3) -> Eigen {
    let (mut a, mut v) = (matrix, DMat3::IDENTITY);
    // Converges quadratically: six sweeps reach rounding, the rest are a guard.
    for _ in 0..20 {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            let off = a.col(q)[p];
            if off == 0.0 {
                continue;
            }
            let tau = (a.col(q)[q] - a.col(p)[p]) / (2.0 * off);
            let t = tau.signum() / (tau.abs() + tau.hypot(1.0));
            let c = 1.0 / t.hypot(1.0);
            let s = t * c;
            let mut turn = DMat3::IDENTITY;
            turn.col_mut(p)[p] = c;
            turn.col_mut(q)[q] = c;
            turn.col_mut(q)[p] = s;
            turn.col_mut(p)[q] = -s;
            a = turn.transpose() * a * turn;
            v *= turn;
        }
    }
    let mut pairs = [0, 1, 2].map(|k| (a.col(k)[k], v.col(k)));
    pairs.sort_by(|x, y| x.0.total_cmp(&y.0));
    Eigen { q: DMat3::from_cols(pairs[0].1, pairs[1].1, pairs[2].1).transpose(), d: DVec3::new(pairs[0].0, pairs[1].0, pairs[2].0) }
}

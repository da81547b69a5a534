//! What single scattering between GGX facets loses, 1 − E(v), as a formula: the crate's albedo tables fitted once per material.
//!
//! ```text
//! 1 − E ≈ c_0 + c_1 s + … + c_6 s⁶ + c_7 s ln s,    s = cos θ/√(α_x² v_x² + α_y² v_y² + v_z²)
//! ```
//!
//! s is the cosine in the configuration where the facets have unit roughness, in which narrow lobes look like wide ones. Narrower facets than α = 0.01 look like those:
//! between the first nodes the tables know less. Anisotropic facets have a fit along each axis and one between them, with a parabola through the three in the share of the
//! spread that lies along x. A formula, unlike a table, runs over any number and on the GPU from constants alone.

use crate::ggx_albedo_aniso;
use crate::models::{Real, V3};
use glam::{Vec2, Vec3};

/// The narrowest facets that the tables are read for.
const NARROWEST: f64 = 0.01;

/// Terms of the fit.
const TERMS: usize = 8;

/// 1 − E along y, between the axes, and along x.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lost<T> {
    pub fits: [[T; TERMS]; 3],
    alpha2: [T; 2],
}

impl<T: Real> Lost<T> {
    /// For these widths, in (0, 1].
    pub fn new(alpha_x: f64, alpha_y: f64) -> Self {
        let table = [alpha_x, alpha_y].map(|alpha| alpha.max(NARROWEST));
        let along = |share: f64| {
            let points: Vec<_> = (1..=96)
                .map(|k| {
                    let s = f64::from(k) / 96.0;
                    (terms(s), 1.0 - f64::from(white(table, stretched_back(table, s, share))))
                })
                .collect();
            least_squares(&points).map(T::of)
        };
        let fits = if table[0] == table[1] { [along(1.0); 3] } else { [0.0, 0.5, 1.0].map(along) };
        Self { fits, alpha2: [alpha_x * alpha_x, alpha_y * alpha_y].map(T::of) }
    }

    /// 1 − E seen from `v`, in [0, 1].
    #[inline(always)]
    pub fn at(&self, v: V3<T>) -> T {
        let (x2, y2) = (self.alpha2[0] * v.x.squared(), self.alpha2[1] * v.y.squared());
        let powers = terms(v.z / (x2 + y2 + v.z.squared()).sqrt());
        let [y, middle, x] = [series(&self.fits[0], &powers), series(&self.fits[1], &powers), series(&self.fits[2], &powers)];
        // Along the normal all three say the same.
        let t = x2 / (x2 + y2).max(T::of(1e-36));
        let (one, two) = (T::one(), T::of(2.0));
        let parabola = y * ((one - t) * (one - two * t)) + middle * (T::of(4.0) * t * (one - t)) + x * (t * (two * t - one));
        parabola.clamp(0.0, 1.0)
    }
}

/// E of white facets from the tables, which want the wider axis first.
fn white([x, y]: [f64; 2], v: Vec3) -> f32 {
    let (alpha, v) = if x >= y { (Vec2::new(x as f32, y as f32), v) } else { (Vec2::new(y as f32, x as f32), Vec3::new(v.y, v.x, v.z)) };
    ggx_albedo_aniso(alpha, v).white()
}

/// The direction whose stretched cosine is `s`, with this share of its spread α_x² v_x² + α_y² v_y² along x.
fn stretched_back([alpha_x, alpha_y]: [f64; 2], s: f64, share: f64) -> Vec3 {
    let (along_x, along_y) = (share / (alpha_x * alpha_x), (1.0 - share) / (alpha_y * alpha_y));
    let spread = (1.0 - s * s) / (s * s + (along_x + along_y) * (1.0 - s * s));
    let (x2, y2) = (spread * along_x, spread * along_y);
    Vec3::new(x2.sqrt() as f32, y2.sqrt() as f32, (1.0 - x2 - y2).max(0.0).sqrt() as f32)
}

impl Lost<f64> {
    /// 1 − Ē: the cosine-weighted mean.
    pub fn mean(&self) -> f64 {
        // Uniform in cos²θ and in azimuth; a quadrant stands for all.
        let (rows, columns) = (256, 16);
        let sum: f64 = (0..rows * columns)
            .map(|k| {
                let cos = ((f64::from(k / columns) + 0.5) / f64::from(rows)).sqrt();
                let phi = (f64::from(k % columns) + 0.5) / f64::from(columns) * std::f64::consts::FRAC_PI_2;
                let sin = (1.0 - cos * cos).sqrt();
                self.at(V3::new(sin * phi.cos(), sin * phi.sin(), cos))
            })
            .sum();
        sum / f64::from(rows * columns)
    }
}

/// 1, s, …, s⁶, s ln s.
#[inline(always)]
fn terms<T: Real>(s: T) -> [T; TERMS] {
    let mut out = [T::one(); TERMS];
    for k in 1..TERMS - 1 {
        out[k] = out[k - 1] * s;
    }
    out[TERMS - 1] = s * s.max(T::of(1e-20)).ln();
    out
}

/// Σ_k c_k t_k.
#[inline(always)]
fn series<T: Real>(c: &[T; TERMS], t: &[T; TERMS]) -> T {
    let mut sum = T::zero();
    for k in 0..TERMS {
        sum = c[k].mul_add(t[k], sum);
    }
    sum
}

/// The coefficients c with the least Σ (Σ_k c_k t_k − y)², by normal equations.
fn least_squares(points: &[([f64; TERMS], f64)]) -> [f64; TERMS] {
    let mut rows = [[0.0; TERMS + 1]; TERMS];
    for (t, y) in points {
        for (row, a) in rows.iter_mut().zip(t) {
            for (cell, b) in row.iter_mut().zip(t.iter().chain([y])) {
                *cell += a * b;
            }
        }
    }
    for k in 0..TERMS {
        let pivot = (k..TERMS).max_by(|&a, &b| rows[a][k].abs().total_cmp(&rows[b][k].abs())).expect("at least one row");
        rows.swap(k, pivot);
        let (above, below) = rows.split_at_mut(k + 1);
        for row in below {
            let factor = row[k] / above[k][k];
            for (cell, known) in row.iter_mut().zip(&above[k]).skip(k) {
                *cell -= factor * known;
            }
        }
    }
    let mut out = [0.0; TERMS];
    for k in (0..TERMS).rev() {
        let known: f64 = (k + 1..TERMS).map(|j| rows[k][j] * out[j]).sum();
        out[k] = (rows[k][TERMS] - known) / rows[k][k];
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tables::quadrature;

    /// The tables where they are good, the integral behind them for narrower facets.
    #[test]
    fn the_fit_is_within_4e_3_of_tables_and_integral() {
        let pairs = [(1e-4, 1e-4), (0.001, 0.001), (0.02, 0.02), (0.05, 0.05), (0.3, 0.3), (1.0, 1.0), (0.05, 0.5), (1.0, 0.2)];
        for (alpha_x, alpha_y) in pairs {
            let (double, single) = (Lost::<f64>::new(alpha_x, alpha_y), Lost::<f32>::new(alpha_x, alpha_y));
            let alpha = Vec2::new(alpha_x as f32, alpha_y as f32);
            let mut worst: f64 = 0.0;
            for k in 0..200 {
                // From the normal to where the facets are hidden half: there is what narrow ones lose.
                let s = (f64::from(k % 40) + 1.0) / 40.0;
                let cos = s * alpha_x / (1.0 - s * s * (1.0 - alpha_x * alpha_x)).sqrt();
                let v = V3::from_angles(cos.min(1.0).acos(), f64::from(k / 40) * 0.35);
                let table = Vec3::new(v.x as f32, v.y as f32, v.z as f32);
                let white = if alpha_x < NARROWEST {
                    let [f0, f90] = quadrature::ggx_albedo(table, alpha, 4096);
                    f0 + f90
                } else {
                    super::white([alpha_x, alpha_y], table)
                };
                worst = worst.max((double.at(v) - 1.0 + f64::from(white)).abs());
                let single = f64::from(single.at(V3 { x: table.x, y: table.y, z: table.z }));
                assert!((double.at(v) - single).abs() < 1e-4, "α {alpha_x}, {alpha_y}: {single} in f32");
            }
            assert!(worst < 4e-3, "α {alpha_x}, {alpha_y}: {worst}");
            assert!(double.mean() > 0.0 && double.mean() < 0.6, "α {alpha_x}, {alpha_y}: {} lost on average", double.mean());
        }
    }
}

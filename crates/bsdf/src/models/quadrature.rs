//! Integrals over the hemisphere above a surface, for checks and tables: Gauss-Legendre nodes in the inclination, equal steps in the azimuth.
//!
//! ```text
//! ∫_Ω f dω = ∫_0^2π ∫_0^π/2 f(θ, φ) sin θ dθ dφ                      (1.4)
//! ```
//!
//! Smooth functions come out to the last digits; lobes as narrow as the step of the nodes need more of them.

use super::Reflectance;
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::ops::{AddAssign, Mul};
use std::sync::LazyLock;

/// Nodes over the hemisphere about +z.
#[derive(Clone, Debug)]
pub struct Hemisphere {
    /// (sin θ, cos θ, weight sin θ dθ dφ) of each ring.
    rings: Vec<[f64; 3]>,
    /// (cos φ, sin φ) of each direction on a ring.
    azimuths: Vec<[f64; 2]>,
}

impl Hemisphere {
    /// The nodes for albedos of every model: 900 inclinations × 1440 azimuths.
    pub fn fine() -> &'static Self {
        static FINE: LazyLock<Hemisphere> = LazyLock::new(|| Hemisphere::new(900, 1440));
        &FINE
    }

    /// Nodes at `inclinations` × `azimuths` directions.
    ///
    /// # Panics
    /// Without any of either.
    pub fn new(inclinations: usize, azimuths: usize) -> Self {
        assert!(inclinations > 0 && azimuths > 0, "{inclinations} × {azimuths} directions");
        let step = TAU / azimuths as f64;
        let ring = |(x, weight): (f64, f64)| {
            let (sin, cos) = (x * FRAC_PI_2).sin_cos();
            [sin, cos, weight * FRAC_PI_2 * sin * step]
        };
        let azimuth = |j: usize| {
            let (sin, cos) = ((j as f64 + 0.5) * step).sin_cos();
            [cos, sin]
        };
        Self { rings: gauss_legendre(inclinations).into_iter().map(ring).collect(), azimuths: (0..azimuths).map(azimuth).collect() }
    }

    /// ∫ f dω over the directions above the surface.
    pub fn integrate<V: Default + AddAssign + Mul<f64, Output = V>>(&self, mut f: impl FnMut(DVec3) -> V) -> V {
        let mut total = V::default();
        for [sin, cos, weight] in &self.rings {
            let mut ring = V::default();
            for [x, y] in &self.azimuths {
                ring += f(DVec3::new(x * sin, y * sin, *cos));
            }
            total += ring * *weight;
        }
        total
    }

    /// The share of uniform light that `model` sends to `wo`: ∫ f cos θ_i dω_i, or ∫ S dω_i/π, and the perfect mirror's share.
    pub fn albedo(&self, model: &dyn Reflectance, wo: DVec3) -> DVec3 {
        let scale = match model.kind() {
            super::Kind::Brdf => 1.0,
            super::Kind::Bsf => 1.0 / PI,
        };
        self.integrate(|wi| model.f_cos(wi, wo)) * scale + model.mirror(wo)
    }
}

/// Nodes and weights on [0, 1] that integrate polynomials up to degree 2n − 1 exactly, in increasing order.
///
/// The roots of the Legendre polynomial by Newton's method; the weight of x on [−1, 1] is 2/((1 − x²) P'_n(x)²).    \[AbramowitzStegun64] 25.4.29
pub fn gauss_legendre(n: usize) -> Vec<(f64, f64)> {
    let mut nodes = vec![(0.5, 1.0); n];
    for i in 0..n.div_ceil(2) {
        let mut x = (PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..10 {
            let (mut p, mut previous) = (x, 1.0);
            for k in 2..=n {
                let k = k as f64;
                (p, previous) = (((2.0 * k - 1.0) * x * p - (k - 1.0) * previous) / k, p);
            }
            slope = n as f64 * (previous - x * p) / (1.0 - x * x);
            let step = p / slope;
            x -= step;
            if step.abs() < 1e-15 {
                break;
            }
        }
        let weight = 1.0 / ((1.0 - x * x) * slope * slope);
        nodes[i] = (0.5 - 0.5 * x, weight);
        nodes[n - 1 - i] = (0.5 + 0.5 * x, weight);
    }
    nodes
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Row BR-1.
    #[test]
    fn the_hemisphere_has_two_pi_steradians_and_a_projected_area_of_pi() {
        for nodes in [Hemisphere::fine(), &Hemisphere::new(20, 8)] {
            assert!((nodes.integrate(|_| 1.0) - TAU).abs() < 1e-10);
            assert!((nodes.integrate(|w| w.z) - PI).abs() < 1e-10);
            // An odd direction vanishes, a squared one is a third of the whole.
            let second = nodes.integrate(|w| w * w);
            assert!((second - DVec3::splat(TAU / 3.0)).abs().max_element() < 1e-10, "{second}");
            assert!(nodes.integrate(|w| w.x).abs() < 1e-10);
        }
    }

    #[test]
    fn too_few_nodes_are_noticed() {
        // Two nodes integrate sin θ cos θ only roughly: the check above would fail.
        assert!((Hemisphere::new(2, 4).integrate(|w| w.z) - PI).abs() > 1e-4);
    }

    #[test]
    fn gauss_legendre_is_exact_for_polynomials_up_to_its_degree() {
        for n in [1, 2, 3, 7, 64] {
            let moment = |k: i32| gauss_legendre(n).iter().map(|(x, w)| w * x.powi(k)).sum::<f64>();
            for k in 0..2 * n as i32 {
                assert!((moment(k) - 1.0 / f64::from(k + 1)).abs() < 1e-14, "{n} nodes, x^{k}");
            }
            let beyond = 2 * n as i32;
            assert!(n > 7 || (moment(beyond) - 1.0 / f64::from(beyond + 1)).abs() > 1e-10, "{n} nodes cannot integrate x^{beyond}");
        }
    }
}

//! Adaptive quadrature over parts of the hemisphere, told where the integrand is narrow.

use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Nodes and weights of Gauss and Legendre's rule with five nodes on [0, 1].
const NODES: [(f64, f64); 5] = [
    (0.046_910_077_030_668_0, 0.118_463_442_528_094_54),
    (0.230_765_344_947_158_45, 0.239_314_335_249_683_23),
    (0.5, 0.284_444_444_444_444_45),
    (0.769_234_655_052_841_5, 0.239_314_335_249_683_23),
    (0.953_089_922_969_332, 0.118_463_442_528_094_54),
];

/// A cell is halved at most this often: 2⁻¹⁴ of the hemisphere is 10⁻⁴ rad, narrower than any lobe of slope 0.001.
const DEEPEST: u32 = 14;

/// Cells that a narrow peak is in are halved at least this often, or the rule could step over it.
const DEPTH_AT_PEAKS: u32 = 9;

/// Cells that no peak is in are halved at most this often, or the steps of a table would be followed for ever.
const DEEPEST_ELSEWHERE: u32 = 10;

/// A part of the hemisphere: θ and φ from and to, rad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// Inclination.
    pub theta: [f64; 2],
    /// Azimuth in [0, 2π].
    pub phi: [f64; 2],
}

impl Cell {
    /// The whole hemisphere.
    pub const HEMISPHERE: Self = Self { theta: [0.0, FRAC_PI_2], phi: [0.0, TAU] };

    /// Does it hold the direction with these angles?
    pub fn contains(&self, theta: f64, phi: f64) -> bool {
        (self.theta[0]..=self.theta[1]).contains(&theta) && (self.phi[0]..=self.phi[1]).contains(&phi)
    }

    fn quarters(&self) -> [Self; 4] {
        let middle = |[a, b]: [f64; 2]| 0.5 * (a + b);
        let (t, p) = (middle(self.theta), middle(self.phi));
        [[self.theta[0], t], [t, self.theta[1]]]
            .map(|theta| [[self.phi[0], p], [p, self.phi[1]]].map(|phi| Self { theta, phi }))
            .concat()
            .try_into()
            .expect("four")
    }

    fn rule(&self, f: &impl Fn(DVec3) -> DVec3) -> DVec3 {
        let (width, height) = (self.phi[1] - self.phi[0], self.theta[1] - self.theta[0]);
        let mut sum = DVec3::ZERO;
        for (v, theta_weight) in NODES {
            let (sin, cos) = (self.theta[0] + height * v).sin_cos();
            for (u, phi_weight) in NODES {
                let (y, x) = (self.phi[0] + width * u).sin_cos();
                sum += f(DVec3::new(x * sin, y * sin, cos)) * (sin * theta_weight * phi_weight);
            }
        }
        sum * width * height
    }
}

/// Inclination and azimuth in [0, 2π) of a unit vector.
pub fn angles(direction: DVec3) -> (f64, f64) {
    (direction.z.clamp(-1.0, 1.0).acos(), direction.y.atan2(direction.x).rem_euclid(TAU))
}

/// ∫ f dω over a cell to about the absolute tolerance; `peaks` are directions where f is large, e.g. samples of it.
pub fn integrate(cell: Cell, peaks: &[DVec3], tolerance: f64, f: impl Fn(DVec3) -> DVec3) -> DVec3 {
    let peaks: Vec<(f64, f64)> = peaks.iter().map(|&peak| angles(peak)).filter(|&(theta, phi)| cell.contains(theta, phi)).collect();
    refine(cell, cell.rule(&f), &peaks, tolerance, 0, &f)
}

fn refine(cell: Cell, coarse: DVec3, peaks: &[(f64, f64)], tolerance: f64, depth: u32, f: &impl Fn(DVec3) -> DVec3) -> DVec3 {
    let parts = cell.quarters().map(|part| (part, part.rule(f)));
    let fine = parts.iter().fold(DVec3::ZERO, |sum, (_, value)| sum + *value);
    let settled = (fine - coarse).abs().max_element() <= tolerance && (peaks.is_empty() || depth >= DEPTH_AT_PEAKS) && depth >= 2;
    if settled || depth >= DEEPEST || (peaks.is_empty() && depth >= DEEPEST_ELSEWHERE) {
        return fine;
    }
    parts
        .into_iter()
        .map(|(part, value)| {
            let inside: Vec<(f64, f64)> = peaks.iter().copied().filter(|&(theta, phi)| part.contains(theta, phi)).collect();
            // Errors of neighbours are independent: half the tolerance each.
            refine(part, value, &inside, 0.5 * tolerance, depth + 1, f)
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Row BR-1.
    #[test]
    fn the_hemisphere_has_two_pi_steradians_and_pi_projected() {
        let all = integrate(Cell::HEMISPHERE, &[], 1e-12, |w| DVec3::new(1.0, w.z, w.z * w.z));
        assert!((all.x - TAU).abs() < 1e-10 && (all.y - TAU / 2.0).abs() < 1e-10 && (all.z - TAU / 3.0).abs() < 1e-10, "{all}");
    }

    #[test]
    fn a_narrow_lobe_is_found_where_it_is_announced() {
        // (n + 1)/2π cosⁿ about an axis integrates to 1.
        let (axis, n) = (DVec3::new(0.6, 0.0, 0.8), 1e6);
        let lobe = |w: DVec3| DVec3::splat((n + 1.0) / TAU * w.dot(axis).max(0.0).powf(n));
        // On both sides of the seam at φ = 0.
        let peaks = [-1e-3, 1e-3].map(|y| (axis + DVec3::Y * y).normalize());
        let found = integrate(Cell::HEMISPHERE, &peaks, 1e-6, lobe).x;
        assert!((found - 1.0).abs() < 1e-5, "{found}");
        let missed = integrate(Cell::HEMISPHERE, &[], 1e-6, lobe).x;
        assert!((missed - 1.0).abs() > 0.1, "without the announcement it would be missed: {missed}");
    }
}

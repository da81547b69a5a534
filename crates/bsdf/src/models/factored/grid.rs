//! The nodes of a factored table: half vectors, viewers, colours.

use crate::models::V3;
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, TAU};

/// How near to the horizon the last viewers are, as a share of the right angle: at the horizon itself there is nothing to see.
const LAST_VIEW: f64 = 0.995;

/// Numbers of nodes. Half vectors have θ_h = (k/(n − 1))² π/2, the finer the nearer to the normal, and equal steps of φ_h; viewers equal steps of θ_o
/// up to the horizon, and of φ_o.
///
/// With one azimuth of the viewer the table is isotropic, and φ_h counts from the viewer's azimuth; otherwise from the tangent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Grid {
    /// Inclinations of the half vector.
    pub theta_h: usize,
    /// Azimuths of the half vector.
    pub phi_h: usize,
    /// Inclinations of the viewer.
    pub theta_o: usize,
    /// Azimuths of the viewer, 1 for isotropic materials.
    pub phi_o: usize,
    /// 1 for greys, 3 for colours.
    pub channels: usize,
}

/// Where a viewer is among the nodes.
#[derive(Clone, Copy, Debug)]
pub struct Viewer {
    /// The four nodes around, as θ_o · (azimuths) + φ_o, with their shares, which sum to 1.
    pub nodes: [(usize, f64); 4],
    /// Cosine and sine of the azimuth that φ_h counts from.
    pub zero: [f64; 2],
}

impl Grid {
    /// For isotropic materials: enough for lobes of slope 0.05.
    pub const ISOTROPIC: Self = Self { theta_h: 64, phi_h: 32, theta_o: 24, phi_o: 1, channels: 3 };
    /// For the others.
    pub const ANISOTROPIC: Self = Self { theta_h: 64, phi_h: 32, theta_o: 16, phi_o: 16, channels: 3 };

    /// Does the material look the same after a turn about the normal?
    pub fn is_isotropic(self) -> bool {
        self.phi_o == 1
    }

    /// Viewers.
    pub fn viewers(self) -> usize {
        self.theta_o * self.phi_o
    }

    /// Half vectors.
    pub fn half_vectors(self) -> usize {
        self.theta_h * self.phi_h
    }

    /// Numbers of the table that the factors stand for.
    pub fn numbers(self) -> usize {
        self.channels * self.viewers() * self.half_vectors()
    }

    /// The nodes of 1 − cos θ_h: dω_h = dσ dφ, and nothing cancels near the normal.
    pub fn sigma(self) -> Vec<f64> {
        let node = |k: usize| 2.0 * (0.5 * FRAC_PI_2 * (k as f64 / (self.theta_h - 1) as f64).powi(2)).sin().powi(2);
        (0..self.theta_h).map(node).collect()
    }

    /// The viewer at a node.
    pub fn viewer(self, node: usize) -> DVec3 {
        let theta = FRAC_PI_2 * LAST_VIEW * (node / self.phi_o) as f64 / (self.theta_o - 1) as f64;
        V3::from_angles(theta, (node % self.phi_o) as f64 / self.phi_o as f64 * TAU).into()
    }

    /// Which nodes a viewer above the surface is between.
    pub fn place(self, wo: DVec3) -> Viewer {
        let sin = wo.truncate().length();
        let direction = if sin > 0.0 { [wo.x / sin, wo.y / sin] } else { [1.0, 0.0] };
        let at = (sin.atan2(wo.z) / (FRAC_PI_2 * LAST_VIEW)).min(1.0) * (self.theta_o - 1) as f64;
        let row = (at as usize).min(self.theta_o - 2);
        let t = at - row as f64;
        let (low, share) = self.around(direction);
        let node = |row: usize, column: usize| row * self.phi_o + column % self.phi_o;
        Viewer {
            nodes: [
                (node(row, low), (1.0 - t) * (1.0 - share)),
                (node(row, low + 1), (1.0 - t) * share),
                (node(row + 1, low), t * (1.0 - share)),
                (node(row + 1, low + 1), t * share),
            ],
            zero: if self.is_isotropic() { direction } else { [1.0, 0.0] },
        }
    }

    fn around(self, [x, y]: [f64; 2]) -> (usize, f64) {
        if self.is_isotropic() {
            return (0, 0.0);
        }
        let at = y.atan2(x).rem_euclid(TAU) / TAU * self.phi_o as f64;
        let low = (at as usize).min(self.phi_o - 1);
        (low, at - low as f64)
    }

    /// The half vector with 1 − cos θ_h = σ, the azimuth counted from `zero`.
    pub fn half_vector(sigma: f64, phi: f64, [cos_0, sin_0]: [f64; 2]) -> DVec3 {
        let sin = (sigma * (2.0 - sigma)).max(0.0).sqrt();
        let (y, x) = phi.sin_cos();
        DVec3::new(sin * (x * cos_0 - y * sin_0), sin * (y * cos_0 + x * sin_0), 1.0 - sigma)
    }

    /// σ and the azimuth, in [0, 2π), of a half vector.
    pub fn coordinates(h: DVec3, [cos_0, sin_0]: [f64; 2]) -> (f64, f64) {
        // sin²/(1 + cos) is 1 − cos without cancellation.
        let sigma = (h.x * h.x + h.y * h.y) / (1.0 + h.z);
        (sigma, (h.y * cos_0 - h.x * sin_0).atan2(h.x * cos_0 + h.y * sin_0).rem_euclid(TAU))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_are_the_inverse_of_half_vectors() {
        let mut rng = kajo_sampling::Rng::new(4);
        for _ in 0..10_000 {
            let [a, b, c] = std::array::from_fn(|_| rng.next_f64());
            let (sigma, phi, zero) = (a.powi(8), b * TAU, (c * TAU).sin_cos().into());
            let h = Grid::half_vector(sigma, phi, zero);
            let (s, p) = Grid::coordinates(h, zero);
            assert!((h.length() - 1.0).abs() < 1e-14 && (s - sigma).abs() < 1e-9 * sigma.max(1e-12), "{sigma} {s}");
            assert!((p - phi).abs() < 1e-6 || sigma < 1e-12, "{phi} {p}");
        }
    }

    #[test]
    fn a_viewer_at_a_node_is_that_node() {
        for grid in [Grid::ISOTROPIC, Grid::ANISOTROPIC] {
            for node in grid.phi_o..grid.viewers() {
                let place = grid.place(grid.viewer(node));
                let share: f64 = place.nodes.iter().filter(|(n, _)| *n == node).map(|(_, share)| share).sum();
                assert!((share - 1.0).abs() < 1e-9, "{node}: {place:?}");
                assert!((place.nodes.iter().map(|(_, share)| share).sum::<f64>() - 1.0).abs() < 1e-12);
            }
            assert_eq!(grid.place(DVec3::X).nodes[3].0 / grid.phi_o, grid.theta_o - 1, "the horizon belongs to the last viewers");
        }
    }
}

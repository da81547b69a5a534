//! Directions as the half vector and the difference from it.
//!
//! ```text
//! h = (ω_i + ω_o)/|ω_i + ω_o|                         θ_h from the normal, φ_h from the tangent
//! d = R_y(−θ_h) R_z(−φ_h) ω_i                         θ_d from h, φ_d about it          [Rusinkiewicz98]
//! ```

use glam::DVec3;
use std::f64::consts::PI;

/// An isotropic, reciprocal BRDF depends on these three angles, rad: φ_h is left out, and φ_d is known but for half a turn, in [0, π).
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs, reason = "the names say it")]
pub struct HalfDifference {
    pub theta_h: f64,
    pub theta_d: f64,
    pub phi_d: f64,
}

impl HalfDifference {
    /// Of two unit vectors above the surface.
    pub fn new(wi: DVec3, wo: DVec3) -> Self {
        let h = (wi + wo).normalize();
        let sin = h.truncate().length();
        let (cos_phi, sin_phi) = if sin > 0.0 { (h.x / sin, h.y / sin) } else { (1.0, 0.0) };
        let x = wi.dot(DVec3::new(h.z * cos_phi, h.z * sin_phi, -sin));
        let y = wi.y * cos_phi - wi.x * sin_phi;
        let phi = y.atan2(x);
        let phi = if phi < 0.0 { phi + PI } else { phi };
        Self { theta_h: sin.atan2(h.z), theta_d: x.hypot(y).atan2(wi.dot(h)), phi_d: if phi < PI { phi } else { 0.0 } }
    }

    /// Directions to the light and to the viewer that have these angles, with φ_h = 0.
    pub fn directions(self) -> (DVec3, DVec3) {
        let (sin_h, cos_h) = self.theta_h.sin_cos();
        let (sin_d, cos_d) = self.theta_d.sin_cos();
        let (sin_phi, cos_phi) = self.phi_d.sin_cos();
        let h = DVec3::new(sin_h, 0.0, cos_h);
        let across = sin_d * (cos_phi * DVec3::new(cos_h, 0.0, -sin_h) + sin_phi * DVec3::Y);
        (cos_d * h + across, cos_d * h - across)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::V3;
    use std::f64::consts::{FRAC_PI_2, TAU};

    #[test]
    fn angles_and_directions_are_inverse() {
        let mut rng = kajo_sampling::Rng::new(2);
        for _ in 0..10_000 {
            let [a, b, c] = std::array::from_fn(|_| rng.next_f64());
            let angles = HalfDifference { theta_h: a * FRAC_PI_2, theta_d: b * FRAC_PI_2, phi_d: c * PI };
            let (wi, wo) = angles.directions();
            let back = HalfDifference::new(wi, wo);
            assert!((back.theta_h - angles.theta_h).abs() < 1e-12 && (back.theta_d - angles.theta_d).abs() < 1e-12, "{angles:?} {back:?}");
            let turn = (back.phi_d - angles.phi_d).abs() * angles.theta_d.sin();
            assert!(turn < 1e-9 || (turn - PI * angles.theta_d.sin()).abs() < 1e-9, "{angles:?} {back:?}");
        }
    }

    #[test]
    fn the_same_from_the_other_side_and_after_a_turn() {
        let mut rng = kajo_sampling::Rng::new(3);
        let near = |a: HalfDifference, b: HalfDifference| {
            let turn = (a.phi_d - b.phi_d).abs();
            (a.theta_h - b.theta_h).abs() < 1e-9 && (a.theta_d - b.theta_d).abs() < 1e-9 && turn.min(PI - turn) < 1e-6
        };
        for _ in 0..10_000 {
            let mut angles = || (0.05 + rng.next_f64() * 1.4, rng.next_f64() * TAU);
            let (i, o) = (angles(), angles());
            let direction = |(theta, phi): (f64, f64), turn: f64| DVec3::from(V3::from_angles(theta, phi + turn));
            let there = HalfDifference::new(direction(i, 0.0), direction(o, 0.0));
            assert!(near(there, HalfDifference::new(direction(o, 0.0), direction(i, 0.0))), "reciprocity {there:?}");
            assert!(near(there, HalfDifference::new(direction(i, 1.0), direction(o, 1.0))), "isotropy {there:?}");
            assert!(!near(there, HalfDifference::new(direction(i, 0.1), direction(o, 0.0))), "planted fault");
        }
    }
}

//! Pairs of directions as points of a box: every point is a pair above the surface, so that a table over the box has no node without a value.
//!
//! ```text
//! h = (ω_i + ω_o)/|ω_i + ω_o|,    θ_h, φ_h its angles,    θ_d, φ_d those of ω_i about h               [Rusinkiewicz98]
//! θ_max = atan(cot θ_h/|cos φ_d|)        both directions are above the surface for θ_d < θ_max
//! (√(θ_h/(π/2)), φ_h/2π, φ_d/2π, 1 − √(1 − θ_d/θ_max))        the finer the nearer to the normal and to the horizon
//! ```

use glam::Vec3;
use std::f32::consts::{FRAC_PI_2, TAU};

/// θ_h is not larger, as a share of π/2: at the right angle directions have no room.
const LAST_HALF: f32 = 0.999;
/// Nor is θ_d, as a share of its largest: at the horizon itself there is nothing to see.
const LAST_DIFFERENCE: f32 = 0.9998;

/// Each in [0, 1]; φ_h and φ_d count turns and go on at their other end.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs, reason = "the names say it")]
pub struct Coordinates {
    pub theta_h: f32,
    pub phi_h: f32,
    pub phi_d: f32,
    pub theta_d: f32,
}

impl Coordinates {
    /// Of two unit vectors above the surface.
    pub fn new(wi: Vec3, wo: Vec3) -> Self {
        let h = (wi + wo).normalize();
        let sin_h = h.truncate().length();
        let (cos_phi, sin_phi) = if sin_h > 1e-7 { (h.x / sin_h, h.y / sin_h) } else { (1.0, 0.0) };
        let x = wi.dot(Vec3::new(h.z * cos_phi, h.z * sin_phi, -sin_h));
        let y = wi.y * cos_phi - wi.x * sin_phi;
        let sin_d = x.hypot(y);
        let (cos_phi_d, sin_phi_d) = if sin_d > 1e-7 { (x / sin_d, y / sin_d) } else { (1.0, 0.0) };
        let theta_d = sin_d.atan2(wi.dot(h)) / largest_difference(sin_h, h.z, cos_phi_d);
        Self {
            theta_h: (sin_h.atan2(h.z) / FRAC_PI_2).min(1.0).sqrt(),
            phi_h: turn(sin_phi, cos_phi),
            phi_d: turn(sin_phi_d, cos_phi_d),
            theta_d: 1.0 - (1.0 - theta_d).max(0.0).sqrt(),
        }
    }

    /// Directions to the light and to the viewer, both above the surface.
    pub fn directions(self) -> (Vec3, Vec3) {
        let (sin_h, cos_h) = ((self.theta_h * self.theta_h).min(LAST_HALF) * FRAC_PI_2).sin_cos();
        let (sin_phi, cos_phi) = (self.phi_h * TAU).sin_cos();
        let (sin_phi_d, cos_phi_d) = (self.phi_d * TAU).sin_cos();
        let share = (1.0 - (1.0 - self.theta_d).powi(2)).min(LAST_DIFFERENCE);
        let (sin_d, cos_d) = (share * largest_difference(sin_h, cos_h, cos_phi_d)).sin_cos();
        let h = Vec3::new(sin_h * cos_phi, sin_h * sin_phi, cos_h);
        let x = Vec3::new(cos_h * cos_phi, cos_h * sin_phi, -sin_h);
        let y = Vec3::new(-sin_phi, cos_phi, 0.0);
        let across = sin_d * (cos_phi_d * x + sin_phi_d * y);
        (cos_d * h + across, cos_d * h - across)
    }
}

/// θ_max, rad.
fn largest_difference(sin_h: f32, cos_h: f32, cos_phi_d: f32) -> f32 {
    cos_h.atan2(sin_h * cos_phi_d.abs()).max(1e-6)
}

/// An azimuth in turns, [0, 1].
fn turn(sin: f32, cos: f32) -> f32 {
    let turns = sin.atan2(cos) / TAU;
    if turns < 0.0 { turns + 1.0 } else { turns }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_sampling::{Rng, warp};

    #[test]
    fn every_point_is_a_pair_above_the_surface_and_comes_back() {
        let mut rng = Rng::new(2);
        for _ in 0..20_000 {
            let [theta_h, phi_h, phi_d, theta_d] = std::array::from_fn(|_| 0.02 + 0.94 * rng.next_1d());
            let at = Coordinates { theta_h, phi_h, phi_d, theta_d };
            let (wi, wo) = at.directions();
            assert!(wi.z > 0.0 && wo.z > 0.0, "{at:?} {wi} {wo}");
            let back = Coordinates::new(wi, wo);
            let off = [back.theta_h - theta_h, back.phi_h - phi_h, back.phi_d - phi_d, back.theta_d - theta_d];
            assert!(off.iter().all(|off| off.abs() < 3e-3), "{at:?} {back:?}");
        }
    }

    #[test]
    fn every_pair_above_the_surface_is_a_point() {
        let mut rng = Rng::new(3);
        let mut directions = || warp::uniform_hemisphere(rng.next_2d());
        let random: Vec<_> = (0..20_000).map(|_| (directions(), directions())).collect();
        let special = [(Vec3::Z, Vec3::Z), (Vec3::X, Vec3::X), (Vec3::X, -Vec3::X + 1e-4 * Vec3::Z), (Vec3::Z, Vec3::Y)];
        for (wi, wo) in random.into_iter().chain(special) {
            let at = Coordinates::new(wi, wo);
            let all = [at.theta_h, at.phi_h, at.phi_d, at.theta_d];
            assert!(all.iter().all(|x| (0.0..=1.0).contains(x)), "{wi} {wo} {at:?}");
        }
    }
}

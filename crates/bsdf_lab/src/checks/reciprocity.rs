//! f(a, b) = f(b, a)?

use super::{brdf, random_direction};
use glam::DVec3;
use kajo_bsdf::models::Reflectance;
use kajo_sampling::Rng;

/// The largest asymmetry found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reciprocity {
    /// |f(a, b) − f(b, a)| / max(f(a, b), f(b, a)), over channels and pairs.
    pub worst: f64,
    /// The pair it was found at.
    pub pair: [DVec3; 2],
    /// Pairs looked at.
    pub pairs: u32,
}

impl Reciprocity {
    /// The worst asymmetry that rounding explains.
    pub const LIMIT: f64 = 1e-6;

    /// Does the model pass?
    pub fn holds(&self) -> bool {
        self.worst < Self::LIMIT
    }
}

/// Compares `pairs` random pairs of directions, uniform on the hemisphere.
pub fn reciprocity(model: &dyn Reflectance, pairs: u32, seed: u64) -> Reciprocity {
    let mut rng = Rng::new(seed);
    let mut out = Reciprocity { worst: 0.0, pair: [DVec3::Z; 2], pairs };
    for _ in 0..pairs {
        let (a, b) = (random_direction(&mut rng), random_direction(&mut rng));
        let (ab, ba) = (brdf(model, a, b), brdf(model, b, a));
        // Below 1e-12 /sr both are nothing.
        let worst = ((ab - ba).abs() / ab.abs().max(ba.abs()).max(DVec3::splat(1e-12))).max_element();
        if worst > out.worst {
            (out.worst, out.pair) = (worst, [a, b]);
        }
    }
    out
}

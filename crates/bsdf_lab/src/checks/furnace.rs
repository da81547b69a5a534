//! Does more light leave than arrives?

use super::from_degrees;
use crate::albedo;
use kajo_bsdf::models::Reflectance;

/// Directional albedos over angles of the viewer.
#[derive(Clone, Debug, PartialEq)]
pub struct Furnace {
    /// (θ_r, φ_r) in degrees and the largest channel of the albedo there.
    pub albedos: Vec<(f64, f64, f64)>,
}

impl Furnace {
    /// What quadrature may be off by.
    pub const SLACK: f64 = 2e-4;

    /// The largest albedo, and where.
    pub fn worst(&self) -> (f64, f64, f64) {
        self.albedos.iter().copied().fold((0.0, 0.0, 0.0), |worst, here| if here.2 > worst.2 { here } else { worst })
    }

    /// Does the model pass?
    pub fn holds(&self) -> bool {
        self.worst().2 <= 1.0 + Self::SLACK
    }
}

/// Albedos at the angles of the specification, along and across the tangent.
pub fn furnace(model: &dyn Reflectance) -> Furnace {
    let angles = [0.0, 30.0, 60.0, 75.0, 85.0];
    let albedos = angles
        .into_iter()
        .flat_map(|theta| [0.0, 45.0, 90.0].map(|phi| (theta, phi)))
        .map(|(theta, phi)| (theta, phi, albedo(model, from_degrees(theta, phi), 1e-6).max_element()))
        .collect();
    Furnace { albedos }
}

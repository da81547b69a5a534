//! Finite, non-negative numbers for every input, in both precisions, and darkness below the horizon.

use super::{from_degrees, random_direction};
use crate::albedo::next;
use glam::DVec3;
use kajo_bsdf::models::Reflectance;
use kajo_sampling::Rng;

/// What was wrong, at most a few lines.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Robustness {
    /// Inputs looked at.
    pub inputs: u32,
    /// Inputs with a wrong answer.
    pub faults: u32,
    /// The first of them, in words.
    pub first: Option<String>,
}

impl Robustness {
    /// Does the model pass?
    pub fn holds(&self) -> bool {
        self.faults == 0
    }

    fn look(&mut self, model: &dyn Reflectance, wi: DVec3, wo: DVec3) {
        self.inputs += 1;
        let below = wi.z <= 0.0 || wo.z <= 0.0;
        let good = |v: f64| v.is_finite() && v >= 0.0 && (!below || v == 0.0);
        let double = model.value(wi, wo);
        let single = model.value_f32(wi.as_vec3(), wo.as_vec3()).as_dvec3();
        let densities = [model.pdf(wi, wo), f64::from(model.pdf_f32(wi.as_vec3(), wo.as_vec3()))];
        if !double.to_array().into_iter().chain(single.to_array()).chain(densities).all(good) {
            self.faults += 1;
            self.first.get_or_insert_with(|| format!("wi {wi}, wo {wo}: f {double}, in f32 {single}, pdf {densities:?}"));
        }
    }
}

/// Looks at `inputs` random pairs and at every degenerate one: normal, grazing, retro-reflection, mirror, below the horizon.
pub fn robustness(model: &dyn Reflectance, inputs: u32, seed: u64) -> Robustness {
    let mut rng = Rng::new(seed);
    let mut out = Robustness::default();
    for i in 0..inputs {
        let (a, b) = (random_direction(&mut rng), random_direction(&mut rng));
        match i % 5 {
            0 => out.look(model, a, a),
            1 => out.look(model, a, DVec3::new(-a.x, -a.y, a.z)),
            2 => out.look(model, -a, b),
            3 => {
                if let Some(wi) = model.sample(a, next(&mut rng)) {
                    out.look(model, wi, a);
                }
            }
            _ => out.look(model, a, b),
        }
    }
    let edges = [0.0, 1e-6, 45.0, 89.0, 89.999, 89.999_999, 90.0, 90.001, 180.0];
    let azimuths = [0.0, 1e-6, 90.0, 180.0, 270.0];
    for theta_i in edges {
        for theta_r in edges {
            for phi in azimuths {
                out.look(model, from_degrees(theta_i, 0.0), from_degrees(theta_r, phi));
            }
        }
    }
    out
}

//! Directional albedo, by quadrature and by the model's own samples.

use crate::quadrature::{Cell, integrate};
use glam::DVec3;
use kajo_bsdf::models::{Kind, Reflectance};
use kajo_sampling::Rng;
use std::f64::consts::FRAC_1_PI;

/// Samples that tell the quadrature where the model is narrow.
const PEAKS: u32 = 64;

/// ∫ f cos θ_i dω_i seen from `wo`, the mirror part included, to about `tolerance`. Of a shading function: ∫ S dω/π.
pub fn albedo(model: &dyn Reflectance, wo: DVec3, tolerance: f64) -> DVec3 {
    let mut rng = Rng::new(1);
    let peaks: Vec<DVec3> = (0..PEAKS).filter_map(|_| model.sample(wo, next(&mut rng))).collect();
    integrate(Cell::HEMISPHERE, &peaks, tolerance, |wi| model.f_cos(wi, wo)) * scale(model) + model.mirror(wo)
}

/// An albedo by sampling: E[f cos θ_i/pdf].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampledAlbedo {
    /// The mean.
    pub mean: DVec3,
    /// Its standard error.
    pub standard_error: DVec3,
    /// The largest weight f cos θ_i/pdf among the samples.
    pub largest_weight: f64,
}

/// The albedo by `samples` of the model's own sampler.
pub fn sampled_albedo(model: &dyn Reflectance, wo: DVec3, samples: u32, seed: u64) -> SampledAlbedo {
    let mut rng = Rng::new(seed);
    let (mut sum, mut squares, mut largest_weight) = (DVec3::ZERO, DVec3::ZERO, 0.0_f64);
    for _ in 0..samples {
        if let Some(wi) = model.sample(wo, next(&mut rng)) {
            let weight = model.f_cos(wi, wo) * (scale(model) / model.pdf(wi, wo));
            sum += weight;
            squares += weight * weight;
            largest_weight = largest_weight.max(weight.max_element());
        }
    }
    let n = f64::from(samples);
    let mean = sum / n;
    let variance = (squares / n - mean * mean).max(DVec3::ZERO);
    SampledAlbedo {
        mean: mean + model.mirror(wo),
        standard_error: DVec3::from(variance.to_array().map(|v| (v / n).sqrt())),
        largest_weight,
    }
}

pub(crate) fn next(rng: &mut Rng) -> [f64; 3] {
    std::array::from_fn(|_| f64::from(rng.next_1d()))
}

fn scale(model: &dyn Reflectance) -> f64 {
    match model.kind() {
        Kind::Brdf => 1.0,
        Kind::Bsf => FRAC_1_PI,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_bsdf::models::{Form, find};

    #[test]
    fn quadrature_and_samples_agree_and_lambert_is_exact() {
        let wo = DVec3::new(0.6, 0.0, 0.8);
        let lambert = find("lambert").unwrap().from_pairs(&[("kd", "0.2,0.5,0.8")], Form::Corrected).unwrap();
        assert!((albedo(&*lambert, wo, 1e-10) - DVec3::new(0.2, 0.5, 0.8)).abs().max_element() < 1e-10);
        let sharp = find("phong").unwrap().from_pairs(&[("kd", "0"), ("ks", "1"), ("n", "100000")], Form::Corrected).unwrap();
        let (exact, sampled) = (albedo(&*sharp, wo, 1e-7), sampled_albedo(&*sharp, wo, 100_000, 3));
        assert!((exact.x - 0.8).abs() < 1e-3, "a sharp Phong lobe reflects about cos θ: {exact}");
        assert!((exact - sampled.mean).abs().x < 4.0 * sampled.standard_error.x + 1e-9, "{exact} {sampled:?}");
        let bsf = find("phong-bsf").unwrap().from_pairs(&[("kd", "0.5"), ("ks", "0")], Form::Corrected).unwrap();
        assert!((albedo(&*bsf, wo, 1e-9).x - 0.5).abs() < 1e-9, "a diffuse shading function is Lambert");
    }
}

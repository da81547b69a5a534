//! Section 3.5: the survey describes He, Torrance, Sillion and Greenberg's model and does not implement it; its equations cannot be.

use super::{C, Erratum, both, geometry};
use crate::albedo;
use crate::checks::from_degrees;
use kajo_bsdf::models::htsg::{Htsg, Params, mean_level};
use kajo_bsdf::models::{Form, Geometry, Model, Real, Reflectance};
use std::f64::consts::{PI, TAU};

/// The model's defaults σ0, τ, λ, µm.
const SIGMA0: f64 = 0.28;
const CORRELATION: f64 = 1.77;
const LAMBDA: f64 = 0.5;

pub(super) fn rows() -> Vec<Erratum> {
    let g = geometry(C);
    let parts = Htsg::formula::<f64>(&Params::default(), Form::Corrected).parts(&g);
    let slopes = tan_erfc(g.cos_i()) + tan_erfc(g.cos_r());
    let z0 = SIGMA0 * mean_level(slopes / (8.0 * PI).sqrt());
    let phase = TAU / LAMBDA * (g.cos_i() + g.cos_r());
    let v = g.wi + g.wo;
    vec![
        Erratum {
            equation: "3.24",
            subject: "HTSG, G",
            printed: "|kr · ki|⁻⁴",
            implemented: "|kr × ki|⁻⁴",
            quantity: "G, set C",
            values: [parts.geometry * cross_over_dot(&g).powi(4), parts.geometry],
            consequence: "infinite where the directions are at right angles",
        },
        Erratum {
            equation: "3.25",
            subject: "HTSG, shadowing",
            printed: "σ in S",
            implemented: "σ0 in S",
            quantity: "S, set C",
            values: [parts.sigma, SIGMA0].map(|height| seen(g.cos_i(), height) * seen(g.cos_r(), height)),
            consequence: "too little of the surface is hidden",
        },
        Erratum {
            equation: "3.25",
            subject: "HTSG, Λ",
            printed: "1/(√π q)",
            implemented: "exp(−q²)/(√π q)",
            quantity: "directional-diffuse albedo at 60°, |F|² = 1",
            values: both("htsg", &[("fresnel", "none")], scattered),
            consequence: "a fifth of the light is lost",
        },
        Erratum {
            equation: "3.26",
            subject: "HTSG, v_xy",
            printed: "v_xy² = v_x + v_y",
            implemented: "v_xy² = v_x² + v_y², times 2π/λ",
            quantity: "v_xy², 1/µm², set C",
            values: [TAU / LAMBDA * (v.x + v.y), (TAU / LAMBDA).powi(2) * (v.x * v.x + v.y * v.y)],
            consequence: "depends on where x points, and may be negative",
        },
        Erratum {
            equation: "3.27",
            subject: "HTSG, g",
            printed: "[(2πσ/λ)(cos θi + cos θr)/σ]²",
            implemented: "[(2πσ/λ)(cos θi + cos θr)]²",
            quantity: "g, set C",
            values: [phase.powi(2), (phase * parts.sigma).powi(2)],
            consequence: "the mirror part does not depend on roughness",
        },
        Erratum {
            equation: "3.27",
            subject: "HTSG, effective roughness",
            printed: "1/√(1 + (z0/σ0)²)",
            implemented: "σ0/√(1 + (z0/σ0)²)",
            quantity: "σ, µm, set C",
            values: [parts.sigma / SIGMA0, parts.sigma],
            consequence: "about 1 for every surface",
        },
        Erratum {
            equation: "3.27",
            subject: "HTSG, mean level z0",
            printed: "√(π/z0) = …",
            implemented: "√(π/2) z0 = …",
            quantity: "left side over right side at z0 = 0.0475 µm, set C",
            values: {
                let right = SIGMA0 / 4.0 * slopes * (-(z0 / SIGMA0).powi(2) / 2.0).exp();
                [(PI / z0).sqrt() / right, (PI / 2.0).sqrt() * z0 / right]
            },
            consequence: "no z0 solves it",
        },
    ]
}

/// 1 − erf x.
fn erfc(x: f64) -> f64 {
    Real::erfc(x)
}

/// |kr × ki|/|kr · ki|.
fn cross_over_dot(g: &Geometry<f64>) -> f64 {
    let dot = g.wi.dot(g.wo);
    (1.0 - dot * dot).sqrt() / dot.abs()
}

/// q = τ cot θ/(2σ).
fn steepness(cos: f64, height: f64) -> f64 {
    CORRELATION * cos / (2.0 * height * (1.0 - cos * cos).sqrt())
}

/// K = tan θ erfc q.
fn tan_erfc(cos: f64) -> f64 {
    (1.0 - cos * cos).sqrt() / cos * erfc(steepness(cos, SIGMA0))
}

/// S1 = (1 − ½ erfc q)/(Λ + 1) of one direction.
fn seen(cos: f64, height: f64) -> f64 {
    let q = steepness(cos, height);
    let lambda = 0.5 * ((-q * q).exp() / (PI.sqrt() * q) - erfc(q));
    (1.0 - 0.5 * erfc(q)) / (lambda + 1.0)
}

/// The albedo without the mirror's part, seen from 60°.
fn scattered(model: &dyn Reflectance) -> f64 {
    let wo = from_degrees(60.0, 0.0);
    (albedo(model, wo, 1e-6) - model.mirror(wo)).x
}

//! Misprints of the survey \[Falski04] and what stands there in truth: both forms evaluated, so that every correction is a pair of numbers.

mod empirical;
mod htsg;
mod hybrid;
mod microfacet;

pub(crate) use microfacet::largest_gap;

use crate::albedo;
use crate::checks::from_degrees;
use kajo_bsdf::models::{Form, Geometry, Reflectance, find};
use std::sync::Arc;

/// One misprint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Erratum {
    /// The survey's number of the equation.
    pub equation: &'static str,
    /// What it is about.
    pub subject: &'static str,
    /// The part as printed.
    pub printed: &'static str,
    /// The part as implemented.
    pub implemented: &'static str,
    /// What the two values are, and the parameters and directions they are computed for.
    pub quantity: &'static str,
    /// As printed, as implemented.
    pub values: [f64; 2],
    /// What follows from the print.
    pub consequence: &'static str,
}

impl Erratum {
    /// Does the value not change, because only names are misprinted?
    pub fn is_label(&self) -> bool {
        self.values[0] == self.values[1]
    }
}

/// Every misprint, in the order of the survey.
pub fn errata() -> Vec<Erratum> {
    [empirical::rows(), microfacet::rows(), htsg::rows(), hybrid::rows()].concat()
}

/// The specification's directions (θ_i, φ_i, θ_r, φ_r), degrees.
const A: [f64; 4] = [30.0, 0.0, 40.0, 180.0];
const B: [f64; 4] = [60.0, 20.0, 45.0, 150.0];
const C: [f64; 4] = [10.0, 0.0, 75.0, 90.0];

fn geometry([theta_i, phi_i, theta_r, phi_r]: [f64; 4]) -> Geometry<f64> {
    Geometry::new(from_degrees(theta_i, phi_i).into(), from_degrees(theta_r, phi_r).into())
}

pub(crate) fn made(id: &str, pairs: &[(&str, &str)], form: Form) -> Arc<dyn Reflectance> {
    find(id).expect("a registered model").from_pairs(pairs, form).expect("parameters in range")
}

/// `measure` of the model as printed and as implemented.
fn both(id: &str, pairs: &[(&str, &str)], measure: impl Fn(&dyn Reflectance) -> f64) -> [f64; 2] {
    [Form::Printed, Form::Corrected].map(|form| measure(&*made(id, pairs, form)))
}

fn value_at(angles: [f64; 4]) -> impl Fn(&dyn Reflectance) -> f64 {
    move |model| model.value(from_degrees(angles[0], angles[1]), from_degrees(angles[2], angles[3])).x
}

pub(crate) fn albedo_at(theta_r: f64) -> impl Fn(&dyn Reflectance) -> f64 {
    move |model| albedo(model, from_degrees(theta_r, 0.0), 1e-6).x
}

#[cfg(test)]
mod tests;

//! Measured or tabulated BRDFs as sums of products of one-dimensional functions, which are evaluated and sampled as such.
//!
//! ```text
//! f(ω_i, ω_o) = k_d/π + Q(ω_o, h)/(4 (h·o) cos θ_i),    Q = Σ_l w_l(ω_o) u_l(θ_h) v_l(φ_h)             [Lawrence04]
//! dω_i = 4 (h·o) dω_h,    so that    ∫ (f − k_d/π) cos θ_i dω_i = Σ_l w_l ∫ u_l dσ ∫ v_l dφ,    σ = 1 − cos θ_h
//! ```
//!
//! Q, not f, is what is factored: its terms are densities of half vectors as they stand, and one that is drawn by them has a weight without any cosine.
//! The constant part of f is kept apart, because as a function of the half vector it is the hardest one to factor and the easiest one to sample.
//! How the weights w_l depend on the viewer tells the models apart: [`super::nmf`], [`super::tucker`].

mod file;
mod grid;
mod profile;
mod reflectance;
#[cfg(test)]
pub(crate) mod testing;

pub use file::{Contents, Format};
pub use grid::{Grid, Viewer};
pub use reflectance::{Factored, LEAST_COSINE, ViewWeights};

/// For numbers that are shares of light.
///
/// # Errors
/// The first of them below 0, in one sentence.
pub(crate) fn refuse_negative(numbers: &[f32]) -> Result<(), String> {
    match numbers.iter().position(|v| *v < 0.0) {
        Some(i) => Err(format!("number {i} is {}, and none may be negative; write the file again", numbers[i])),
        None => Ok(()),
    }
}

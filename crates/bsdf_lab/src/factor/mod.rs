//! Factors a BRDF, of a formula or measured, into sums of products of one-dimensional functions that are evaluated and sampled as such.
//!
//! The models that read the factors are `kajo_bsdf::models::{nmf, tucker}`; a renderer needs no more. What finds them is here, beside fitting: it needs a
//! library of linear algebra, threads and seconds, and looks at a model from outside as all of this crate does.

mod kullback_leibler;
mod nmf;
mod table;
mod tensor;
#[cfg(test)]
mod tests;
mod tucker;

pub use nmf::{NmfOptions, nmf};
pub use table::{Errors, Table};
pub use tucker::{TuckerOptions, tucker};

/// How far a factorisation is: after a term, or after a pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Outer terms, or passes.
    pub count: usize,
    /// Numbers to keep.
    pub numbers: usize,
    /// What is missing.
    pub errors: Errors,
}

/// A model that cannot be factored.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FactorError {
    /// Nothing to factor.
    #[error("the model is black from every direction; give one that reflects")]
    Black,
    /// A direction that no table has.
    #[error("{share:.3} of what the model reflects is a perfect mirror, which no table can hold; give a rougher one")]
    #[allow(missing_docs, reason = "the names say it")]
    Mirror { share: f64 },
    /// Values to divide by.
    #[error("the model is {value} seen from {theta:.1}° to the normal; only finite values can be factored")]
    #[allow(missing_docs, reason = "the names say it")]
    NotFinite { value: f64, theta: f64 },
}

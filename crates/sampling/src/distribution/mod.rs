//! Distributions given by tables: discrete (alias method) and piecewise constant in one and two dimensions.
//!
//! Weights that are negative or not finite count as zero. A table whose weights are all zero has nothing to prefer and samples
//! uniformly; `is_zero()` says so.

mod alias;
mod alias_2d;
mod piecewise;

pub use alias::AliasTable;
pub use alias_2d::Alias2d;
pub use piecewise::{Piecewise1d, Piecewise2d};

/// The weight as it is used: a finite number, 0 or more.
pub(crate) fn clean(weight: f32) -> f64 {
    if weight.is_finite() && weight > 0.0 { f64::from(weight) } else { 0.0 }
}

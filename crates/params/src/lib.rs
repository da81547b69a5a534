//! A technique's parameters, declared once: the struct in Rust is also what the command line, sliders, reports and documents read.
//!
//! ```
//! use kajo_params::{ParamChoice, Params};
//! use kajo_units::Meters;
//!
//! #[derive(ParamChoice, Clone, Copy, Debug, PartialEq)]
//! enum Filter { BoxFilter, Tent }
//!
//! #[derive(Params, Clone, Copy, Debug)]
//! struct Params {
//!     /// Radius of the disc searched for blockers. Larger finds wider penumbrae and costs more taps.
//!     #[param(default = 0.25, range = 0.0..=2.0, unit = "m")]
//!     search_radius: Meters,
//!     /// Weights of the taps.
//!     #[param(default = Filter::Tent)]
//!     filter: Filter,
//! }
//!
//! let params = Params::from_pairs(&[("search_radius", "0.5"), ("filter", "box-filter")])?;
//! assert_eq!((params.search_radius, params.filter), (Meters(0.5), Filter::BoxFilter));
//! let error = Params::from_pairs(&[("search_radius", "3")]).unwrap_err();
//! assert_eq!(error.to_string(), "parameter `search_radius` is 3; it must be from 0 to 2 m");
//! # Ok::<(), kajo_params::ParamError>(())
//! ```

mod error;
mod spec;
mod types;
mod values;

pub use error::ParamError;
pub use kajo_params_derive::{ParamChoice, Params};
pub use spec::{ParamKind, ParamSpec};
pub use types::{ParamSet, ParamType, Rows, ScalarType, Value};
pub use values::ParamValues;

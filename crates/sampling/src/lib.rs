//! Random streams, point sets, warps and distributions, each with its pdf and its inverse.
//!
//! Every number is a function of (seed, pixel, sample, dimension), so that a pixel can be replayed alone and the number of
//! threads cannot matter. Points lie in [0, 1); a warp maps them to a domain and says with which density; every pdf is per
//! solid angle unless its name says otherwise (`docs/conventions.md`).

mod bits;
pub mod distribution;
pub mod environment;
mod frame;
mod halton;
pub mod light_tree;
mod mis;
pub mod resampling;
mod rng;
mod sampler;
mod sobol;
mod spherical_harmonics;
pub mod statistics;
mod steps;
pub mod warp;

pub use bits::{hash_u32, hash_u64, morton_2d, nested_uniform_scramble, unit_f32};
pub use distribution::{Alias2d, AliasTable, Piecewise1d, Piecewise2d};
pub use frame::Frame;
pub use halton::{halton_2d, hammersley_2d, radical_inverse};
pub use mis::{balance_heuristic, power_heuristic};
pub use rng::Rng;
pub use sampler::{Sampler, SamplerKind};
pub use sobol::sobol_2d;
pub use spherical_harmonics::{SH_COUNT, ShRadiance, sh_basis, sh_cosine_basis};
pub use steps::Steps;

#[cfg(test)]
mod experiments;

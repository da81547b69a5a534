//! Importance sampling of latitude-longitude environments by blocks of a kd-tree.    \[Ergun15] chapter 6
//!
//! The image of luminance times sin θ is cut into blocks of little variation. Sorted by their share of the light, the blocks follow a law
//! whose cumulative distribution has a closed inverse: a direction takes one formula and one read, whatever the number of blocks. Points of
//! the image are (u, v) in [0, 1)²; a density over them is divided by 2π² sin θ to become one per steradian.

mod block;
mod density;
mod error;
mod kd;
mod law;
mod lookup;
mod sums;
#[cfg(test)]
pub(crate) mod test_maps;
mod tree;

pub use block::{Axis, Block, Split};
pub use density::DensityImage;
pub use error::EnvironmentError;
pub use kd::KdSampler;
pub use law::{ReciprocalLaw, stratum};
pub use lookup::{AlphaPlane, GridHash, PackedNode, PackedTree};
pub use tree::{BlockNode, BlockTree, Criterion};

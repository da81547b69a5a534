//! A two-level bounding volume hierarchy: build, trace, check, and export for GPUs.
//!
//! A [`Blas`] holds the triangles of one mesh in its own space, a [`Tlas`] places many of them in the world. Both are binned-SAH trees
//! collapsed to eight children a node, traced eight boxes and four triangles at a time. Which triangle is hit is decided exactly (on
//! the sheared vertices, see [`triangle`]), boxes are tested with a margin that covers every rounding on the way (see [`slab`]), and
//! equal distances are decided by index; so the answer is a property of the scene and the ray alone: a brute-force loop, a ray by itself and
//! among others, the portable, AVX2 and AVX-512 code and any number of build threads agree bit for bit. (The one exception: an instance whose
//! transform shrinks a direction, along one axis and not along another, to fewer digits than a number has, below 10⁻³⁸ m.)
//!
//! ```
//! use glam::{Affine3A, Vec3};
//! use kajo_bvh::{Blas, BuildOptions, BvhInstance, Filter, Ray, Tlas};
//! use std::sync::Arc;
//!
//! let positions = [Vec3::ZERO, Vec3::X, Vec3::Y];
//! let blas = Arc::new(Blas::build(&positions, &[[0, 1, 2]], &BuildOptions::default())?);
//! let tlas = Tlas::build(vec![blas], vec![BvhInstance::new(0, Affine3A::IDENTITY)])?;
//! let ray = Ray::new(Vec3::new(0.25, 0.25, 1.0), Vec3::NEG_Z);
//! let hit = tlas.closest_hit_opaque(&ray, Filter::ALL).expect("the ray points at the triangle");
//! assert_eq!((hit.t, hit.u, hit.v, hit.primitive), (1.0, 0.25, 0.25, 0));
//! # Ok::<(), kajo_bvh::BvhError>(())
//! ```

mod aabb;
pub mod bench;
mod blas;
mod brute_force;
mod build;
mod counters;
mod error;
mod geometry;
pub mod gpu;
mod lanes;
mod limits;
mod many;
mod offset;
mod packet;
mod pages;
mod ray;
mod refit;
pub mod slab;
mod stack;
mod stream;
mod tlas;
mod traverse;
pub mod triangle;
mod validate;
mod wide;

pub use aabb::Aabb;
pub use blas::Blas;
pub use build::{BuildFlags, BuildOptions, BuildQuality, Sah};
pub use counters::{Count, Counters, NoCounters};
pub use error::BvhError;
pub use geometry::{Geometry, Procedural};
pub use lanes::Backend;
pub use limits::{Features, Limits};
pub use offset::{SurfacePoint, offset_origin};
pub use ray::{Filter, Hit, LEAST_DIRECTION, PrimitiveRef, Ray};
pub use refit::UpdateReport;
pub use tlas::{BvhInstance, Tlas};
pub use validate::Fault;

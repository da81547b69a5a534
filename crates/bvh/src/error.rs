//! What can be wrong with the input of a build.

use crate::triangle::MAX_COORDINATE;

/// Why a hierarchy could not be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BvhError {
    /// A vertex position that is not a number, infinite or too far out.
    #[error("vertex {vertex} at {position:?} is not finite or beyond ±{max:e}; mend or drop the vertex", max = MAX_COORDINATE)]
    Position {
        /// Index into the positions.
        vertex: usize,
        /// What stands there.
        position: [f32; 3],
    },
    /// A triangle that names a vertex that does not exist.
    #[error("triangle {triangle} names vertex {vertex}, but the mesh has {vertices} vertices; mend its indices")]
    Index {
        /// Index of the triangle.
        triangle: usize,
        /// The vertex it names.
        vertex: u32,
        /// Number of vertices.
        vertices: usize,
    },
    /// More primitives than a child reference can address.
    #[error("{got} {what} exceed the limit of {max}; split the input")]
    TooMany {
        /// What there are too many of.
        what: &'static str,
        /// How many there are.
        got: usize,
        /// How many there may be.
        max: usize,
    },
    /// An instance of a mesh that does not exist.
    #[error("instance {instance} places mesh {blas}, but there are {blases} meshes; mend its index")]
    Blas {
        /// Index of the instance.
        instance: usize,
        /// The mesh it names.
        blas: usize,
        /// Number of meshes.
        blases: usize,
    },
    /// An instance transform that is not finite, or moves its mesh too far out.
    #[error("the transform of instance {instance} is not finite or moves its mesh beyond ±{max:e}; mend the transform", max = MAX_COORDINATE)]
    Transform {
        /// Index of the instance.
        instance: usize,
    },
}

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
    /// A shape without a usable box.
    #[error("the box of shape {shape}, {min:?} to {max:?}, is empty, not finite or beyond ±{max_coordinate:e}; mend or drop the shape", max_coordinate = MAX_COORDINATE)]
    Shape {
        /// Index of the shape.
        shape: usize,
        /// Least corner.
        min: [f32; 3],
        /// Greatest corner.
        max: [f32; 3],
    },
    /// A build that is asked to be fast and to make fast rays.
    #[error("`prefer_fast_trace` and `prefer_fast_build` exclude each other; give one of them or neither")]
    BothPreferences,
    /// An update of what was not built for it.
    #[error("the {what} was built without `allow_update`; build it with that option, or build it anew")]
    NotUpdatable {
        /// `mesh` or `world`.
        what: &'static str,
    },
    /// A compaction of what was not built for it.
    #[error("the mesh was built without `allow_compaction` and has its exact size already; build it with that option")]
    NotCompactable,
    /// An update to another number of things.
    #[error("an update to {got} {what} from {expected}: only a build can change their number")]
    CountChanged {
        /// What there are more or fewer of.
        what: &'static str,
        /// How many there are now.
        got: usize,
        /// How many there were.
        expected: usize,
    },
    /// An update that would let an instance appear or vanish.
    #[error("instance {instance} {change}: an update cannot do that; build the world anew")]
    Activity {
        /// Index of the instance.
        instance: usize,
        /// What would happen to it.
        change: &'static str,
    },
}

//! What can go wrong with a frame.

/// Errors of the renderer.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The graph or the device refuses.
    #[error(transparent)]
    Graph(#[from] kajo_render_graph::Error),
    /// A technique refuses.
    #[error(transparent)]
    Technique(#[from] kajo_techniques::Error),
    /// The scene's hierarchy cannot be built.
    #[error("the ray tracing hierarchy cannot be built: {0}")]
    Bvh(#[from] kajo_bvh::BvhError),
    /// The hierarchy is deeper than the shader's stack.
    #[error("the ray tracing hierarchy is {got} levels deep; the compute backend's limit is {limit}; use the ray-query backend")]
    TooDeep {
        /// Levels.
        got: u32,
        /// Levels allowed.
        limit: u32,
    },
    /// A backend that the adapter does not have.
    #[error("ray queries are asked for, but {adapter} has none; use the compute backend")]
    NoRayQuery {
        /// Name of the adapter.
        adapter: String,
    },
    /// A camera that does not exist.
    #[error("the scene has {count} cameras; got camera {got}, use 0 to {}", count - 1)]
    NoSuchCamera {
        /// Index asked for.
        got: usize,
        /// Cameras of the snapshot.
        count: usize,
    },
    /// A technique chosen for a role it does not fill.
    #[error("{technique} fills the role {its_role}, not {role}")]
    WrongRole {
        /// Id of the technique.
        technique: &'static str,
        /// Role it fills.
        its_role: kajo_techniques::Role,
        /// Role it was chosen for.
        role: kajo_techniques::Role,
    },
}

//! What can go wrong between a scene and its picture.

use std::io;
use std::path::PathBuf;

/// Why nothing was rendered. Each message is one sentence: what, got, limit, what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PathTracerError {
    /// An image without pixels, or one that no film can hold.
    #[error("image of {width}x{height} px: each side must lie in 1 ..= {max}; change the size")]
    Size {
        /// Width, px.
        width: u32,
        /// Height, px.
        height: u32,
        /// Largest side, px.
        max: u32,
    },
    /// An image that memory does not hold.
    #[error("image of {width}x{height} px: {bytes} bytes of memory cannot be had; choose a smaller size or fewer output images")]
    Memory {
        /// Width, px.
        width: u32,
        /// Height, px.
        height: u32,
        /// Bytes of the film and of the images that it is developed into.
        bytes: u64,
    },
    /// A camera that the scene does not have.
    #[error("camera `{got}` does not exist; the scene has {have}")]
    Camera {
        /// What was asked for.
        got: String,
        /// What could be asked for.
        have: String,
    },
    /// An output that does not exist, or not in this scene.
    #[error("output image `{got}` does not exist; known are {known}")]
    Aov {
        /// What was asked for.
        got: String,
        /// What could be asked for.
        known: String,
    },
    /// A word that is none of the choices.
    #[error("{what} `{got}` does not exist; choose one of {known}")]
    Choice {
        /// The kind of choice.
        what: &'static str,
        /// What was asked for.
        got: String,
        /// What could be asked for.
        known: String,
    },
    /// A number outside its range.
    #[error("{what} of {got} lies outside {range}; change it")]
    Range {
        /// The quantity.
        what: &'static str,
        /// Its value.
        got: f64,
        /// The values it may have.
        range: &'static str,
    },
    /// Neighbours that share random numbers cannot decide for each other.
    #[error(
        "adaptive sampling needs pixels whose random numbers are independent, those of blue noise are not; choose sobol or independent"
    )]
    AdaptiveBlueNoise,
    /// Rendering that would never end.
    #[error("no stop condition: give a number of samples, a time or a noise level")]
    EndlessStop,
    /// The motion image without the scene at an earlier time.
    #[error("output image `motion` needs the scene at the previous time; give the tracer a previous snapshot")]
    NoPrevious,
    /// Two snapshots that are not of one scene.
    #[error("the previous snapshot has {got} instances and the current one {expected}: they are not of one scene")]
    PreviousDiffers {
        /// Instances of the previous snapshot.
        got: usize,
        /// Instances of the current one.
        expected: usize,
    },
    /// The acceleration structure refuses the geometry.
    #[error("mesh `{mesh}`: {source}")]
    Bvh {
        /// The mesh.
        mesh: String,
        /// Why.
        source: kajo_bvh::BvhError,
    },
    /// An environment that cannot be sampled as asked.
    #[error("environment: {0}")]
    Environment(#[from] kajo_sampling::environment::EnvironmentError),
    /// A checkpoint that cannot be read.
    #[error("cannot read the checkpoint `{}`: {source}; check the path", path.display())]
    CheckpointRead {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// A checkpoint that cannot be written.
    #[error("cannot write the checkpoint: {0}")]
    CheckpointWrite(#[from] kajo_image::ImageError),
    /// A file that is no checkpoint, or a damaged one.
    #[error("checkpoint `{}`: {problem}; delete it and render anew", path.display())]
    CheckpointFormat {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        problem: String,
    },
    /// Samples of another picture.
    #[error("the checkpoint holds samples of another picture: {what}; render as it was made, or delete it")]
    CheckpointMismatch {
        /// What differs.
        what: &'static str,
    },
}

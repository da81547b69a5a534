//! What can go wrong between a path and a scene.

use kajo_names::UnknownName;
use std::io;

/// Why a scene, or a file that belongs to one, cannot be loaded. Each message is one sentence: the file, the place in it, what is wrong, and
/// what to do where that is not plain from the problem.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// The operating system does not hand out the file.
    #[error("cannot read `{file}`: {source}; check the path and its permissions")]
    Read {
        /// The file, as the user or the referring file named it.
        file: String,
        /// Why.
        source: io::Error,
    },
    /// The text of a file does not parse.
    #[error("`{file}`, line {line}, column {column}: {problem}")]
    Syntax {
        /// The file.
        file: String,
        /// Counted from 1.
        line: usize,
        /// Counted from 1.
        column: usize,
        /// What the parser says.
        problem: String,
    },
    /// A file breaks the rules of its format.
    #[error("`{file}`: {place}: {problem}")]
    Invalid {
        /// The file.
        file: String,
        /// Place inside the file, such as `accessor 3`; `file` where it is the file as a whole.
        place: String,
        /// What is wrong, with the values.
        problem: String,
    },
    /// A file asks for something that Kajo does not do, and without which its picture would be wrong.
    #[error("`{file}`: {feature} is not supported; {advice}")]
    Unsupported {
        /// The file.
        file: String,
        /// What it asks for.
        feature: String,
        /// What to do instead.
        advice: String,
    },
    /// Something is larger than this loader accepts.
    #[error("`{file}`: {place}: {quantity} of {got} exceeds the limit of {limit}; reduce it")]
    TooLarge {
        /// The file.
        file: String,
        /// Place inside the file.
        place: String,
        /// What is too large.
        quantity: &'static str,
        /// Its value.
        got: u64,
        /// The largest accepted value.
        limit: u64,
    },
    /// A reference to a built-in scene that does not exist, or with a number that it does not take.
    #[error("`{reference}`: {problem}")]
    UnknownBuiltin {
        /// What the user wrote.
        reference: String,
        /// What is wrong, and what there is.
        problem: String,
    },
    /// A camera or an animation that the scene does not have.
    #[error("{scene}: {unknown}")]
    UnknownName {
        /// The scene.
        scene: String,
        /// The name, and those there are.
        unknown: UnknownName,
    },
    /// A picture cannot be read; the image crate's sentence names the file.
    #[error(transparent)]
    Image(#[from] kajo_image::ImageError),
}

impl SceneError {
    /// A file that breaks the rules of its format.
    pub fn invalid(file: &str, place: impl Into<String>, problem: impl Into<String>) -> Self {
        Self::Invalid { file: file.into(), place: place.into(), problem: problem.into() }
    }
}

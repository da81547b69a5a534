//! Errors of linking and checking shaders.

/// Why a shader cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ShaderError {
    /// A syntax, import, type or validation error at a known place.
    #[error("{file}:{line}:{column}: {message}\n{line:5} | {text}")]
    Source {
        /// The WESL file, e.g. `shader_lib/bsdf/microfacet.wesl`.
        file: String,
        /// Line, from 1.
        line: u32,
        /// Column, from 1, in bytes.
        column: u32,
        /// What is wrong.
        message: String,
        /// The line itself.
        text: String,
    },
    /// An error of a file as a whole.
    #[error("{file}: {message}")]
    File {
        /// The WESL file.
        file: String,
        /// What is wrong.
        message: String,
    },
    /// A name that the shader does not declare.
    #[error("{file}: no {what} `{name}`; it has: {available}")]
    Missing {
        /// The WESL file.
        file: String,
        /// Kind of thing looked for.
        what: &'static str,
        /// Name looked for.
        name: String,
        /// What there is.
        available: String,
    },
    /// A struct that is written differently in Rust and in WGSL.
    #[error("{file}: struct `{name}` differs between Rust and WGSL:\n{differences}")]
    Layout {
        /// The WESL file.
        file: String,
        /// Name of the struct.
        name: String,
        /// One line a difference.
        differences: String,
    },
}

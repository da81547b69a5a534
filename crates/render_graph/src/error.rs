//! What can go wrong between a pass and the device.

/// Errors of the render graph.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// No adapter answers.
    #[error("no graphics adapter answers; run `cargo xtask setup` to install a software Vulkan driver")]
    NoAdapter,
    /// Adapters answer, but not the one that was asked for.
    #[error("no graphics adapter matches \"{wanted}\"; there are: {}", found.join(", "))]
    NoSuchAdapter {
        /// What was asked for.
        wanted: String,
        /// Names of the adapters that answer.
        found: Vec<String>,
    },
    /// The adapter gives no device.
    #[error("{adapter} gives no device: {reason}; update its driver, or choose another adapter with KAJO_ADAPTER")]
    NoDevice {
        /// Name of the adapter.
        adapter: String,
        /// What the driver says.
        reason: String,
    },
    /// The device went away while it worked.
    #[error("the graphics device was lost: {reason}; the work since the last finished frame is lost, start again")]
    DeviceLost {
        /// What the driver says.
        reason: String,
    },
    /// The device has no memory left.
    #[error("the graphics device has not enough memory; choose a smaller image, or an adapter with more memory")]
    OutOfMemory,
    /// The device refused a command: a bug here or in the driver.
    #[error("the graphics device refused a command: {reason}")]
    Refused {
        /// What the device says.
        reason: String,
    },
    /// A size that cannot be rendered.
    #[error("an image of {width}x{height} px cannot be rendered; each side must be 1 to {limit} px on this adapter")]
    Size {
        /// Width asked for, px.
        width: u32,
        /// Height asked for, px.
        height: u32,
        /// Largest side, px.
        limit: u32,
    },
    /// A buffer larger than the adapter allows.
    #[error("{what} needs {got} bytes; this adapter's limit is {limit}; use a smaller scene or an adapter with more memory")]
    TooLarge {
        /// What the buffer holds.
        what: String,
        /// Bytes needed.
        got: u64,
        /// Bytes allowed.
        limit: u64,
    },
    /// The shader does not link, or is not valid.
    #[error("shader {name}: {reason}")]
    Shader {
        /// Name of the shader.
        name: String,
        /// The whole report.
        reason: String,
    },
    /// Names bound and names declared differ.
    #[error("{pass}: the shader declares [{}], the pass binds [{}]", declared.join(", "), bound.join(", "))]
    Binding {
        /// Name of the pass.
        pass: String,
        /// Names the shader uses.
        declared: Vec<String>,
        /// Names that were bound.
        bound: Vec<String>,
    },
    /// A resource of another kind than the shader declares.
    #[error("{pass}: \"{name}\" is a {declared} in the shader, but a {bound} was bound")]
    BindingKind {
        /// Name of the pass.
        pass: String,
        /// Name of the binding.
        name: String,
        /// What the shader declares.
        declared: String,
        /// What was bound.
        bound: &'static str,
    },
    /// A slot is read that nothing writes.
    #[error("pass {pass} reads \"{slot}\", which no pass writes; written are: [{}]", written.join(", "))]
    NoProducer {
        /// The reading pass.
        pass: String,
        /// The slot.
        slot: &'static str,
        /// Every slot that is written or imported.
        written: Vec<&'static str>,
    },
    /// A slot is written twice.
    #[error("\"{slot}\" is written by both {first} and {second}; one of them must update it instead")]
    DoubleWrite {
        /// The slot.
        slot: &'static str,
        /// One writer.
        first: String,
        /// The other.
        second: String,
    },
    /// Passes wait for each other.
    #[error("these passes wait for each other: {}", passes.join(", "))]
    Cycle {
        /// The passes that cannot be ordered.
        passes: Vec<String>,
    },
    /// A pass uses a slot it did not declare.
    #[error("pass {pass} uses \"{slot}\", but declares only [{}]", declared.join(", "))]
    Undeclared {
        /// The pass.
        pass: String,
        /// The slot.
        slot: &'static str,
        /// What it declares.
        declared: Vec<&'static str>,
    },
}

//! The device, typed slots, passes ordered by what they read and write, resources bound by name, timers, memory and readback.
//!
//! A frame is a [`Graph`]: each pass says which [slots](slot) it reads, writes and updates, and what it does. The graph finds the order,
//! refuses what has none, makes the images, runs the passes and times them.

mod bind;
mod device;
mod error;
mod graph;
mod memory;
mod order;
mod pipeline;
pub mod readback;
pub mod slot;
mod timer;

pub use bind::{Bindings, Resource};
pub use device::{AdapterChoice, Device, DeviceInfo, uniform_bytes};
pub use error::Error;
pub use graph::{Graph, PassContext, Pool};
pub use memory::{Buffer, Texture};
pub use order::{Access, order};
pub use pipeline::{ComputePipeline, PipelineOptions, RenderPipeline, RenderState, Shader};
pub use slot::{Layers, Slot};
pub use timer::Timings;
pub use wgpu;

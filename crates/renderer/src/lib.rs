//! Frames: the scene on the device, the G-buffer, the roles' techniques, direct light, transparent surfaces, exposure and tone map.
//!
//! ```no_run
//! use kajo_render_graph::Device;
//! use kajo_renderer::{FrameSettings, Renderer, RendererSettings, RoleSelection};
//! use kajo_scene::{Snapshot, builtin};
//! use kajo_units::Seconds;
//!
//! let device = Device::new()?;
//! let scene = builtin::load("cornell")?;
//! let snapshot = Snapshot::new(&scene, Seconds(0.0));
//! let mut renderer = Renderer::new(&device, &scene, &snapshot, RendererSettings::new(glam::uvec2(640, 360)))?;
//! let roles = RoleSelection::new().choose("shadow/ray-traced", &[("samples", "16")])?;
//! let frame = renderer.render(&roles, &FrameSettings::default())?;
//! println!("{} ms, {} rays", frame.timings.total_ms(), frame.rays);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod effects;
mod error;
mod gpu;
mod ignored;
mod motion;
mod output;
mod passes;
mod placement;
mod progressive;
mod read;
mod renderer;
mod settings;
#[cfg(test)]
mod tests;
mod upload;

pub use error::Error;
pub use motion::nothing_moves;
pub use output::{FrameOutput, GBufferImages};
pub use progressive::{Estimate, ProgressivePathTracer, ProgressiveSettings, Radiances, not_path_traced};
pub use renderer::Renderer;
pub use settings::{FrameSettings, Read, RendererSettings, RoleSelection};

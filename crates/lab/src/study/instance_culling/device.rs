//! What rays cost in the real-time renderer, on the device's own structure and on that of the compute shaders.

use crate::LabError;
use glam::UVec2;
use kajo_render_graph::Device;
use kajo_renderer::{FrameSettings, Renderer, RendererSettings, RoleSelection};
use kajo_scene::{Culling, Scene, Snapshot};
use kajo_techniques::TraceBackend;

/// Timed frames, after one that is not.
const FRAMES: u32 = 3;

/// The technique whose rays are timed.
const TECHNIQUE: &str = "reflection/ray-traced";

/// Median time of the technique's pass, ms, for each backend of the device.
///
/// # Errors
/// When the device refuses.
pub fn pass_times(
    device: &Device,
    scene: &Scene,
    snapshot: &Snapshot,
    size: UVec2,
    ray_culling: Culling,
) -> Result<Vec<(TraceBackend, f64)>, LabError> {
    let failed = |e: kajo_renderer::Error| LabError::NotMeasured { reason: e.to_string() };
    let (technique, params) = kajo_techniques::parse(TECHNIQUE)?;
    let roles = RoleSelection::new().with(technique, params);
    let mut out = Vec::new();
    let backends = [TraceBackend::RayQuery, TraceBackend::Compute];
    for backend in backends.into_iter().filter(|b| *b == TraceBackend::Compute || device.has_ray_query()) {
        let settings = RendererSettings { backend: Some(backend), ray_culling, ..RendererSettings::new(size) };
        let mut renderer = Renderer::new(device, scene, snapshot, settings).map_err(failed)?;
        let mut times = Vec::new();
        for index in 0..=FRAMES {
            let frame = renderer.render(&roles, &FrameSettings { index, ..FrameSettings::default() }).map_err(failed)?;
            times.push(frame.timings.sum_of(TECHNIQUE));
        }
        times.remove(0);
        times.sort_by(f64::total_cmp);
        out.push((backend, times[times.len() / 2]));
    }
    Ok(out)
}

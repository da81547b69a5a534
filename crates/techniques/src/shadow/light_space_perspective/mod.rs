//! Light-space perspective shadow maps.

mod warp;

use super::depth_map::{self, FilteredMaps, Settings, reach_of};
use crate::{Needs, Role, Technique};
use kajo_params::Params;

/// The technique.
pub const TECHNIQUE: Technique = Technique {
    id: "shadow/light-space-perspective",
    role: Role::DirectVisibility,
    title: "Light-space perspective shadow maps",
    doc: include_str!("doc.md"),
    cites: &["Wimmer04", "Stamminger02"],
    reads: depth_map::READS,
    needs: Needs::NONE,
    params: Params::SPEC,
    make: |context, values| {
        let params = Params::from_values(values);
        let settings = Settings::new(params.resolution, reach_of(params.kernel));
        let fit = move |of: &depth_map::Fit| warp::fit_warped(of, params.strength);
        Ok(Box::new(FilteredMaps::new(context, TECHNIQUE.id, settings, params.kernel, Box::new(fit))?))
    },
};

/// Its parameters.
#[derive(Params, Clone, Copy, Debug)]
pub struct Params {
    /// Side of a map.
    #[param(default = 2048, range = 16..=8192, unit = "px")]
    pub resolution: u32,
    /// How strongly the map follows the view's perspective: 1 evens out the error over the view, 0 is a plain map.
    #[param(default = 1.0, range = 0.0..=8.0)]
    pub strength: f32,
    /// Half the side of the filter: 0 compares one texel, k averages (2k + 1)² comparisons.
    #[param(default = 1, range = 0..=8)]
    pub kernel: u32,
}

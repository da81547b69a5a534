//! Cascaded shadow maps.

mod split;

use super::depth_map::{self, FilteredMaps, Settings, reach_of};
use crate::{Needs, Role, Technique};
use kajo_params::Params;
use kajo_units::Meters;

/// The technique.
pub const TECHNIQUE: Technique = Technique {
    id: "shadow/cascades",
    role: Role::DirectVisibility,
    title: "Cascaded shadow maps",
    doc: include_str!("doc.md"),
    cites: &["Engel06", "Zhang06", "Valient08"],
    reads: depth_map::READS,
    needs: Needs::NONE,
    params: Params::SPEC,
    make: |context, values| {
        let params = Params::from_values(values);
        let settings = Settings::new(params.resolution, reach_of(params.kernel));
        let fit = move |of: &depth_map::Fit| split::fit_cascades(of, &params);
        Ok(Box::new(FilteredMaps::new(context, TECHNIQUE.id, settings, params.kernel, Box::new(fit))?))
    },
};

/// Its parameters.
#[derive(Params, Clone, Copy, Debug)]
pub struct Params {
    /// Side of each map.
    #[param(default = 2048, range = 16..=8192, unit = "px")]
    pub resolution: u32,
    /// Maps of a directional light, one behind the other along the view.
    #[param(default = 4, range = 1..=6)]
    pub cascades: u32,
    /// How the view is split: 0 into equal lengths, 1 into lengths that grow by one factor.
    #[param(default = 0.9, range = 0.0..=1.0)]
    pub lambda: f32,
    /// How far from the camera the last map ends; 0: at the far side of the scene.
    #[param(default = 0.0, range = 0.0..=100000.0, unit = "m")]
    pub distance: Meters,
    /// Half the side of the filter: 0 compares one texel, k averages (2k + 1)² comparisons.
    #[param(default = 1, range = 0..=8)]
    pub kernel: u32,
    /// Keeps size and texel grid of each map while the camera moves and turns, so that borders stand still.
    #[param(default = true)]
    pub stable: bool,
}

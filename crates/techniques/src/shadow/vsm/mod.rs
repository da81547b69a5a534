//! Variance shadow maps.

use super::depth_map;
use super::moments::{Method, MomentMaps};
use crate::{Needs, Role, Technique};
use kajo_params::Params;

/// The technique.
pub const TECHNIQUE: Technique = Technique {
    id: "shadow/vsm",
    role: Role::DirectVisibility,
    title: "Variance shadow maps",
    doc: include_str!("doc.md"),
    cites: &["Donnelly06", "Lauritzen08"],
    reads: depth_map::READS,
    needs: Needs::NONE,
    params: Params::SPEC,
    make: |context, values| {
        let params = Params::from_values(values);
        let method =
            Method { id: TECHNIQUE.id, source: include_str!("vsm.wesl"), constants: [params.least_variance, params.bleeding, 0.0, 0.0] };
        Ok(Box::new(MomentMaps::new(context, &method, params.resolution, params.radius)?))
    },
};

/// Its parameters.
#[derive(Params, Clone, Copy, Debug)]
pub struct Params {
    /// Side of a map; a cube has six of them.
    #[param(default = 1024, range = 16..=4096, unit = "px")]
    pub resolution: u32,
    /// Reach of the filter, in texels.
    #[param(default = 3, range = 0..=32)]
    pub radius: u32,
    /// Least variance, in squares of the greatest distance from the light: what rounding leaves of none.
    #[param(default = 0.000001, range = 0.0..=0.01)]
    pub least_variance: f32,
    /// Share of light below which a point counts as dark: takes leaks away, and the dark end of penumbrae with them.
    #[param(default = 0.0, range = 0.0..=0.95)]
    pub bleeding: f32,
}

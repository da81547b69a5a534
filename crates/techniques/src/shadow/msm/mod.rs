//! Moment shadow maps.

use super::depth_map;
use super::moments::{Method, MomentMaps};
use crate::{Needs, Role, Technique};
use kajo_params::Params;

/// The technique.
pub const TECHNIQUE: Technique = Technique {
    id: "shadow/msm",
    role: Role::DirectVisibility,
    title: "Moment shadow maps",
    doc: include_str!("doc.md"),
    cites: &["Peters15"],
    reads: depth_map::READS,
    needs: Needs::NONE,
    params: Params::SPEC,
    make: |context, values| {
        let params = Params::from_values(values);
        let method =
            Method { id: TECHNIQUE.id, source: include_str!("msm.wesl"), constants: [params.moment_bias, params.bleeding, 0.0, 0.0] };
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
    /// Share of moments that belong to any distribution, which keeps rounding from making them impossible.
    #[param(default = 0.000003, range = 0.0000001..=0.01)]
    pub moment_bias: f32,
    /// Share of light below which a point counts as dark: takes leaks away, and the dark end of penumbrae with them.
    #[param(default = 0.0, range = 0.0..=0.95)]
    pub bleeding: f32,
}

//! Shadow maps.

use super::depth_map::{self, DepthLayout, FilteredMaps, Precision, Settings, Shift, fit, reach_of};
use crate::{Needs, Role, Technique};
use kajo_params::{ParamChoice, Params};
use kajo_units::Meters;

/// The technique.
pub const TECHNIQUE: Technique = Technique {
    id: "shadow/map",
    role: Role::DirectVisibility,
    title: "Shadow maps",
    doc: include_str!("doc.md"),
    cites: &["Williams78", "Reeves87"],
    reads: depth_map::READS,
    needs: Needs::NONE,
    params: Params::SPEC,
    make: |context, values| {
        let params = Params::from_values(values);
        Ok(Box::new(FilteredMaps::new(context, TECHNIQUE.id, params.settings(), params.kernel, Box::new(fit))?))
    },
};

/// How far a point is moved before it is looked up.
#[derive(ParamChoice, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bias {
    /// Along the normal, as far as the filter needs and no further.
    Automatic,
    /// By `constant_bias`.
    Constant,
    /// By `constant_bias` and `slope_bias`.
    SlopeScaled,
    /// By `constant_bias` and `normal_offset`.
    NormalOffset,
}

/// Its parameters.
#[derive(Params, Clone, Copy, Debug)]
pub struct Params {
    /// Side of a map; a cube has six of them.
    #[param(default = 2048, range = 16..=8192, unit = "px")]
    pub resolution: u32,
    /// Half the side of the filter: 0 compares one texel, k averages (2k + 1)² comparisons.
    #[param(default = 1, range = 0..=8)]
    pub kernel: u32,
    /// Automatic: from the size of a texel, the width of the filter and the slope of the surface. The others use the numbers below.
    #[param(default = Bias::Automatic)]
    pub bias: Bias,
    /// Shift towards the light.
    #[param(default = 0.005, range = 0.0..=10.0, unit = "m")]
    pub constant_bias: Meters,
    /// Shift towards the light, in texels, times the tangent of the angle of incidence.
    #[param(default = 1.5, range = 0.0..=64.0)]
    pub slope_bias: f32,
    /// Shift along the normal, in texels, times the sine of the angle between the normal and the axis of the map.
    #[param(default = 2.0, range = 0.0..=64.0)]
    pub normal_offset: f32,
    /// What depth means in maps of points and spots; those of directional lights are linear by nature.
    #[param(default = DepthLayout::Perspective)]
    pub depth: DepthLayout,
    /// How depth is stored.
    #[param(default = Precision::Float32)]
    pub precision: Precision,
}

impl Params {
    /// What the maps are made for.
    fn settings(&self) -> Settings {
        let (constant, slope, normal) = (self.constant_bias.0, self.slope_bias, self.normal_offset);
        let shift = match self.bias {
            Bias::Automatic => Shift::Automatic,
            Bias::Constant => Shift::ByHand { constant, slope: 0.0, normal: 0.0 },
            Bias::SlopeScaled => Shift::ByHand { constant, slope, normal: 0.0 },
            Bias::NormalOffset => Shift::ByHand { constant, slope: 0.0, normal },
        };
        Settings { shift, layout: self.depth, precision: self.precision, ..Settings::new(self.resolution, reach_of(self.kernel)) }
    }
}

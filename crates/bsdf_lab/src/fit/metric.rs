//! What a fit makes small.

use super::Sample;
use glam::DVec3;

/// What is summed in squares.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Metric {
    /// (f − g) cos θ_i cos θ_r: peaks count most.    \[Lafortune97]
    #[default]
    Cos,
    /// ln((f cos θ_i cos θ_r + e)/(g cos θ_i cos θ_r + e)), e a thousandth of the target's root mean square: dark directions count as bright ones do, and noise
    /// in proportion to the value counts the same everywhere.
    Log,
}

impl Metric {
    /// The name users write.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Cos => "cos",
            Self::Log => "log",
        }
    }

    /// Residual of value `f` at a sample; `floor` is e.
    pub(super) fn residual(self, sample: &Sample, f: DVec3, floor: f64) -> DVec3 {
        let weight = sample.weight();
        match self {
            Self::Cos => (f - sample.f) * weight,
            Self::Log => {
                let ln = |v: DVec3| (v.max(DVec3::ZERO) * weight + floor).map(f64::ln);
                ln(f) - ln(sample.f)
            }
        }
    }
}

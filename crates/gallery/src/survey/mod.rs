//! The figures of the survey \[Falski04] that show spheres: rows of them in the standard scene, and what must be measured on their pixels.
//! Parameters that it does not give are chosen here and said in the captions.

mod empirical;
mod hybrid;
mod microfacet;

pub use microfacet::SETS;

use crate::GalleryError;
use crate::check::Check;
use crate::probe::{Sample, furnace};
use crate::stage::Ball;
use kajo_bsdf_lab::figures::{Curve, Figure};

/// A figure of spheres.
pub struct SphereFigure {
    /// Its number in the survey.
    pub number: &'static str,
    /// What it shows.
    pub title: &'static str,
    /// What to look at, and the parameters.
    pub caption: &'static str,
    /// Rows of spheres, each with the name at its left; the name of a single row is empty.
    pub rows: fn() -> Vec<(String, Vec<Ball>)>,
    /// Measures what the figure claims, on pixels.
    pub measure: Measure,
}

/// Measures a figure of these rows.
type Measure = fn(&[(String, Vec<Ball>)]) -> Result<Measured, GalleryError>;

/// What was found on a figure's pixels.
#[derive(Clone, Debug, Default)]
pub struct Measured {
    /// Numbers beside their expectations.
    pub checks: Vec<Check>,
    /// Curves of the lobe probe.
    pub curves: Vec<Figure>,
}

/// All of them, in the survey's order.
pub const FIGURES: [&SphereFigure; 12] = [
    &empirical::LAMBERT,
    &empirical::PHONG,
    &empirical::BLINN_PHONG,
    &microfacet::COOK_TORRANCE,
    &microfacet::ROUGHNESS,
    &microfacet::SCHLICK_COOK_TORRANCE,
    &hybrid::SMOOTHNESS,
    &hybrid::METALNESS,
    &hybrid::WARD,
    &hybrid::ROUGHNESS,
    &hybrid::ISOTROPY,
    &hybrid::ASHIKHMIN_SHIRLEY,
];

/// Curves of a value over the tilt of the normal, for some spheres.
fn probe_curves(number: &str, value_name: &str, strips: &[(String, &[Sample])], value: impl Fn(&Sample) -> f64) -> Figure {
    let curve = |(name, samples): &(String, &[Sample])| Curve {
        name: name.clone(),
        points: samples.iter().map(|sample| [sample.tilt, value(sample)]).collect(),
    };
    Figure {
        name: format!("figure_{number}_probe"),
        title: format!("Figure {number}: along the sphere's great circle, from pixels"),
        axes: ["normal, degrees from the half vector".into(), value_name.into()],
        curves: strips.iter().map(curve).collect(),
        equal_scales: false,
    }
}

/// The albedo at normal incidence beside `expected`: 4 standard errors and the digits of `expected`, four.
fn furnace_check(ball: &Ball, what: &str, expected: f64) -> Result<Check, GalleryError> {
    let (mean, error) = furnace(ball)?;
    Ok(Check::near(format!("white furnace at normal incidence, {what}"), mean, expected, 4.0 * error + 1e-4))
}

/// Mean of the channels: these figures are grey where they are measured.
fn grey(sample: &Sample) -> f64 {
    sample.f.element_sum() / 3.0
}

#[cfg(test)]
mod tests;

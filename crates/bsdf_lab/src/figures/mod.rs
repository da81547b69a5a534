//! Curves of the survey \[Falski04] and of any model, as numbers; [`crate::plot`] draws them.

mod lobe;
mod survey;

pub use lobe::{lobe, polar_lobe};

/// Curves over one axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// The stem of its files.
    pub name: String,
    /// What it shows.
    pub title: String,
    /// Names of the axes, with units.
    pub axes: [String; 2],
    /// The curves.
    pub curves: Vec<Curve>,
    /// Is a unit as long upwards as sideways?
    pub equal_scales: bool,
}

/// A named line through points.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Its name.
    pub name: String,
    /// x, y.
    pub points: Vec<[f64; 2]>,
}

/// The survey's numbers of the figures that are curves.
pub const SURVEY_FIGURES: [&str; 5] = ["2.2", "2.5", "3.4", "3.5", "3.6"];

/// The figure of that number.
pub fn survey_figure(number: &str) -> Option<Figure> {
    match number {
        "2.2" => Some(survey::powers()),
        "2.5" => Some(survey::highlights()),
        "3.4" => Some(survey::attenuations()),
        "3.5" => Some(survey::distributions()),
        "3.6" => Some(survey::reflectances()),
        _ => None,
    }
}

impl Figure {
    /// One line a point: curve, x, y; every digit that the numbers have.
    pub fn csv(&self) -> String {
        let quoted = |text: &str| format!("\"{}\"", text.replace('"', "\"\""));
        let mut out = format!("curve,{},{}\n", quoted(&self.axes[0]), quoted(&self.axes[1]));
        for curve in &self.curves {
            for [x, y] in &curve.points {
                out += &format!("{},{x},{y}\n", quoted(&curve.name));
            }
        }
        out
    }
}

#[cfg(test)]
mod tests;

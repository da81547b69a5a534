//! BRDFs factored into products of functions that are nowhere negative, sampled by the factors.

#[cfg(test)]
mod tests;

use crate::models::factored::{Contents, Factored, Format, Grid, ViewWeights, Viewer, refuse_negative};
use crate::models::{Form, Kind, Made, ModelEntry, ModelError};
use glam::DVec3;
use kajo_params::{ParamValues, Params};
use std::sync::Arc;

/// The registry's entry.
pub const MODEL: ModelEntry = ModelEntry {
    id: "nmf",
    title: "Measured, factored without negative numbers",
    kind: Kind::Brdf,
    doc: include_str!("doc.md"),
    cites: &["Lawrence04", "LeeSeung01", "Walter07"],
    claims: None,
    has_printed_form: false,
    params: Params::SPEC,
    aliases: &[("path", &["file"])],
    wesl: None,
    make,
};

/// Its parameters.
#[derive(Params, Clone, Copy, Debug)]
pub struct Params {
    /// A file that `kajo bsdf factor --method nmf` wrote.
    #[param(default = 0)]
    pub file: &'static str,
}

/// k_d by channel; F by outer term, viewer and channel; u by outer and inner term and θ_h; v by the same and φ_h.
const FORMAT: Format = Format {
    name: "kajo-nmf",
    counts: &[("outer", 256), ("inner", 64)],
    length: |grid, counts| grid.channels * (1 + counts[0] * grid.viewers()) + counts[0] * counts[1] * (grid.theta_h + grid.phi_h),
};

fn make(values: &ParamValues, _form: Form) -> Made {
    let params = Params::from_values(values);
    if params.file.is_empty() {
        return Err(ModelError::Constraint(
            "`file` is not given; give the path of a file that `kajo bsdf factor --method nmf` wrote".into(),
        ));
    }
    Ok(Arc::new(Factors::read(params.file)?.into_model()))
}

/// Q(ω_o, h) = Σ_j F_j(ω_o) Σ_k u_jk(θ_h) v_jk(φ_h), every number ≥ 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Factors {
    /// The nodes.
    pub grid: Grid,
    /// k_d of each channel.
    pub diffuse: Vec<f32>,
    /// Terms by j.
    pub outer: usize,
    /// Terms by k for each j.
    pub inner: usize,
    /// F: j, then the viewer, then the channel.
    pub views: Vec<f32>,
    /// u: j, then k, then θ_h.
    pub inclinations: Vec<f32>,
    /// v: j, then k, then φ_h.
    pub azimuths: Vec<f32>,
}

impl Factors {
    /// Reads a file.
    ///
    /// # Errors
    /// [`ModelError::File`] where it is missing, of another format or holds a negative number.
    pub fn read(path: &str) -> Result<Self, ModelError> {
        Self::of(FORMAT.read(path)?).map_err(|problem| ModelError::File { file: path.to_owned(), problem })
    }

    /// From the contents of a file.
    ///
    /// # Errors
    /// What is wrong with them, in one sentence.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, String> {
        Self::of(FORMAT.decode(bytes)?)
    }

    fn of(contents: Contents) -> Result<Self, String> {
        let Contents { grid, counts, mut numbers } = contents;
        refuse_negative(&numbers)?;
        let azimuths = numbers.split_off(numbers.len() - counts[0] * counts[1] * grid.phi_h);
        let inclinations = numbers.split_off(numbers.len() - counts[0] * counts[1] * grid.theta_h);
        let views = numbers.split_off(grid.channels);
        Ok(Self { grid, diffuse: numbers, outer: counts[0], inner: counts[1], views, inclinations, azimuths })
    }

    /// The contents of a file.
    pub fn to_bytes(&self) -> Vec<u8> {
        let numbers = [&self.diffuse[..], &self.views, &self.inclinations, &self.azimuths].concat();
        FORMAT.encode(&Contents { grid: self.grid, counts: vec![self.outer, self.inner], numbers })
    }

    /// Numbers that are kept.
    pub fn numbers(&self) -> usize {
        (FORMAT.length)(self.grid, &[self.outer, self.inner])
    }

    /// Ready to evaluate and to sample.
    pub fn into_model(self) -> Factored<Views> {
        let terms = (0..self.outer * self.inner).map(|term| (term, term)).collect();
        let (grid, diffuse) = (self.grid, colour(&self.diffuse));
        let views = Views { grid, inner: self.inner, views: self.views };
        Factored::new(grid, diffuse, views, terms, &self.inclinations, &self.azimuths)
    }
}

/// F of every term.
#[derive(Clone, Debug)]
pub struct Views {
    grid: Grid,
    inner: usize,
    views: Vec<f32>,
}

impl ViewWeights for Views {
    fn weight(&self, term: usize, viewer: &Viewer) -> DVec3 {
        let (channels, outer) = (self.grid.channels, term / self.inner);
        viewer.nodes.iter().filter(|(_, share)| *share > 0.0).fold(DVec3::ZERO, |sum, &(node, share)| {
            let at = (outer * self.grid.viewers() + node) * channels;
            sum + share * colour(&self.views[at..at + channels])
        })
    }
}

/// The colour of one number or three.
pub(crate) fn colour(channels: &[f32]) -> DVec3 {
    DVec3::from_array(std::array::from_fn(|c| f64::from(channels[c % channels.len()])))
}

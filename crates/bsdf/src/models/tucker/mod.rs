//! BRDFs factored as tensors, then their residuals, sampled by the factors.

#[cfg(test)]
mod tests;

use crate::models::factored::{Contents, Factored, Format, Grid, ViewWeights, Viewer, refuse_negative};
use crate::models::nmf::colour;
use crate::models::{Form, Kind, Made, ModelEntry, ModelError};
use glam::DVec3;
use kajo_params::{ParamValues, Params};
use std::sync::Arc;

/// The registry's entry.
pub const MODEL: ModelEntry = ModelEntry {
    id: "tucker",
    title: "Measured, factored as a tensor",
    kind: Kind::Brdf,
    doc: include_str!("doc.md"),
    cites: &["Bilgili11", "DeLathauwer00", "DeLathauwer00b", "Lawrence04", "Walter07"],
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
    /// A file that `kajo bsdf factor --method tucker` wrote.
    #[param(default = 0)]
    pub file: &'static str,
}

/// k_d by channel; then, pass by pass, the functions of [`MODES`] in this order, each by term and node, and the core, the last mode's terms fastest.
const FORMAT: Format = Format {
    name: "kajo-tucker",
    counts: &[("rank", 16), ("passes", 1024)],
    length: |grid, counts| grid.channels + counts[1] * pass_length(grid, counts[0]),
};

/// The directions of the tensor: colour, the viewer's inclination and azimuth, the half vector's inclination and azimuth.
pub const MODES: usize = 5;

/// Nodes along each mode.
pub fn nodes(grid: Grid) -> [usize; MODES] {
    [grid.channels, grid.theta_o, grid.phi_o, grid.theta_h, grid.phi_h]
}

/// Terms along each mode: never more than nodes.
pub fn ranks(grid: Grid, rank: usize) -> [usize; MODES] {
    nodes(grid).map(|n| n.min(rank))
}

fn pass_length(grid: Grid, rank: usize) -> usize {
    let ranks = ranks(grid, rank);
    ranks.iter().zip(nodes(grid)).map(|(r, n)| r * n).sum::<usize>() + ranks.iter().product::<usize>()
}

/// Weights of terms by viewer are at most this many: they are multiplied out when a file is read, and few numbers announce many.
const MOST_WEIGHTS: usize = 1 << 20;

/// Can factors of this size be read again?
///
/// # Errors
/// What is too large, in one sentence.
pub fn check_size(grid: Grid, rank: usize, passes: usize) -> Result<(), String> {
    let ranks = ranks(grid, rank);
    let weights = passes * ranks[3] * ranks[4] * grid.viewers();
    if weights <= MOST_WEIGHTS {
        return Ok(());
    }
    let (terms, viewers) = (passes * ranks[3] * ranks[4], grid.viewers());
    Err(format!("{passes} passes of rank {rank} are {terms} terms for {viewers} viewers, {weights} weights; {MOST_WEIGHTS} are the most"))
}

fn make(values: &ParamValues, _form: Form) -> Made {
    let params = Params::from_values(values);
    if params.file.is_empty() {
        return Err(ModelError::Constraint(
            "`file` is not given; give the path of a file that `kajo bsdf factor --method tucker` wrote".into(),
        ));
    }
    Ok(Arc::new(Factors::read(params.file)?.into_model()))
}

/// Q(ω_o, h) = Σ_passes Σ_abcpq G_abcpq x_a(colour) y_b(θ_o) z_c(φ_o) u_p(θ_h) v_q(φ_h), numbers of any sign.
#[derive(Clone, Debug, PartialEq)]
pub struct Factors {
    /// The nodes.
    pub grid: Grid,
    /// k_d of each channel.
    pub diffuse: Vec<f32>,
    /// Terms along each mode, at most.
    pub rank: usize,
    /// The tensor, its residual, the residual of that …
    pub passes: Vec<Pass>,
}

/// One tensor of the sum.
#[derive(Clone, Debug, PartialEq)]
pub struct Pass {
    /// Of each mode: by term, then by node.
    pub functions: [Vec<f32>; MODES],
    /// G, the last mode fastest.
    pub core: Vec<f32>,
}

impl Factors {
    /// Reads a file.
    ///
    /// # Errors
    /// [`ModelError::File`] where it is missing, of another format or too large.
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
        let Contents { grid, counts, numbers } = contents;
        check_size(grid, counts[0], counts[1])?;
        let (diffuse, rest) = numbers.split_at(grid.channels);
        refuse_negative(diffuse)?;
        let (nodes, ranks) = (nodes(grid), ranks(grid, counts[0]));
        let pass = |mut rest: &[f32]| {
            let functions = std::array::from_fn(|mode| {
                let (taken, after) = rest.split_at(ranks[mode] * nodes[mode]);
                rest = after;
                taken.to_vec()
            });
            Pass { functions, core: rest.to_vec() }
        };
        let passes = rest.chunks_exact(pass_length(grid, counts[0])).map(pass).collect();
        Ok(Self { grid, diffuse: diffuse.to_vec(), rank: counts[0], passes })
    }

    /// The contents of a file.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut numbers = self.diffuse.clone();
        for pass in &self.passes {
            pass.functions.iter().chain([&pass.core]).for_each(|part| numbers.extend(part));
        }
        FORMAT.encode(&Contents { grid: self.grid, counts: vec![self.rank, self.passes.len()], numbers })
    }

    /// Numbers that are kept.
    pub fn numbers(&self) -> usize {
        (FORMAT.length)(self.grid, &[self.rank, self.passes.len()])
    }

    /// Ready to evaluate and to sample.
    pub fn into_model(self) -> Factored<Cores> {
        let (grid, ranks) = (self.grid, ranks(self.grid, self.rank));
        let all = |mode: usize| -> Vec<f32> { self.passes.iter().flat_map(|pass| pass.functions[mode].iter().copied()).collect() };
        let terms = (0..self.passes.len())
            .flat_map(|pass| (0..ranks[3]).flat_map(move |p| (0..ranks[4]).map(move |q| (pass * ranks[3] + p, pass * ranks[4] + q))))
            .collect();
        Factored::new(grid, colour(&self.diffuse), Cores::new(&self), terms, &all(3), &all(4))
    }
}

/// The weights of the terms by viewer: the core with all but the half vector's functions multiplied out.
///
/// Multiplied out at the nodes of the viewer and then interpolated, which is the same as the functions interpolated along each angle.
#[derive(Clone, Debug)]
pub struct Cores {
    viewers: usize,
    /// By term, then by viewer.
    weights: Vec<DVec3>,
}

impl Cores {
    fn new(factors: &Factors) -> Self {
        let grid = factors.grid;
        let (nodes, ranks) = (nodes(grid), ranks(grid, factors.rank));
        let pairs = ranks[3] * ranks[4];
        let mut weights = Vec::with_capacity(factors.passes.len() * pairs * grid.viewers());
        for pass in &factors.passes {
            let function = |mode: usize, term: usize, node: usize| f64::from(pass.functions[mode][term * nodes[mode] + node]);
            for pair in 0..pairs {
                for viewer in 0..grid.viewers() {
                    let (b_node, c_node) = (viewer / grid.phi_o, viewer % grid.phi_o);
                    let channel = |channel: usize| {
                        let mut sum = 0.0;
                        for (i, g) in pass.core.iter().skip(pair).step_by(pairs).enumerate() {
                            let (a, b, c) = (i / (ranks[1] * ranks[2]), i / ranks[2] % ranks[1], i % ranks[2]);
                            sum += f64::from(*g) * function(0, a, channel) * function(1, b, b_node) * function(2, c, c_node);
                        }
                        sum
                    };
                    weights.push(DVec3::from_array(std::array::from_fn(|c| channel(c % grid.channels))));
                }
            }
        }
        Self { viewers: grid.viewers(), weights }
    }
}

impl ViewWeights for Cores {
    fn weight(&self, term: usize, viewer: &Viewer) -> DVec3 {
        viewer.nodes.iter().fold(DVec3::ZERO, |sum, &(node, share)| sum + share * self.weights[term * self.viewers + node])
    }
}

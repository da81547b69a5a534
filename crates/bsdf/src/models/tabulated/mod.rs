//! Any reflectance model as a table, for evaluators that know no more of a model than that: the GPU's side of models read from files.
//!
//! ```text
//! q(ω_i, ω_o) = f (cos θ_i + cos θ_o)                 at the nodes of a grid over [`Coordinates`], linear between them
//! f cos θ_i = q cos θ_i/(cos θ_i + cos θ_o)
//! ```
//!
//! Where both directions are near to the horizon the f of microfacets grows without limit, q does not. Models that look the same after a turn about the
//! normal, which is found out by asking them, need no azimuth of the half vector and get a finer grid. `shader_lib::models::tabulated` is the twin of
//! [`Tabulated::f_cos`].
//!
//! What is lost: lobes narrower than the nodes, edges, and what a model does within 0.02° of the horizon. More than 5° above it isotropic tables of formulas
//! are within 0.4 % of the largest f cos θ_i (2.5 % where masking has an edge or the highlight is no function of the half vector), anisotropic ones within
//! 3 %; those of files have edges at their own nodes and are within 6 % and 13 %, and 13 % where `interpolation=nearest` makes steps of a `merl` table.

mod coordinates;
#[cfg(test)]
mod tests;

pub use coordinates::Coordinates;

use super::Reflectance;
use glam::{Quat, Vec3};
use kajo_sampling::{Rng, warp};

/// Of the mean value: what a turn about the normal changes at least where a model is anisotropic. Tables that are isotropic by their coordinates change by
/// rounding only.
const LEAST_ANISOTROPY: f32 = 2e-3;
/// Pairs of directions that a model is asked about.
const PAIRS: usize = 4096;

/// Numbers of nodes; those of azimuths are spread over a turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Grid {
    /// Inclinations of the half vector, at least 2.
    pub theta_h: usize,
    /// Azimuths of the half vector, 1 for isotropic models.
    pub phi_h: usize,
    /// Azimuths of the light about the half vector.
    pub phi_d: usize,
    /// Angles between the light and the half vector, at least 2.
    pub theta_d: usize,
}

impl Grid {
    /// For models that a turn about the normal does not change: 3.5 MB.
    pub const ISOTROPIC: Self = Self { theta_h: 96, phi_h: 1, phi_d: 64, theta_d: 48 };
    /// For the others: 9.4 MB.
    pub const ANISOTROPIC: Self = Self { theta_h: 48, phi_h: 32, phi_d: 32, theta_d: 16 };

    /// The grid for a model.
    pub fn of(model: &dyn Reflectance) -> Self {
        if anisotropy(model) > LEAST_ANISOTROPY { Self::ANISOTROPIC } else { Self::ISOTROPIC }
    }

    /// Nodes.
    pub fn nodes(self) -> usize {
        self.theta_h * self.phi_h * self.phi_d * self.theta_d
    }

    /// θ_d changes fastest, then φ_d, then φ_h.
    fn index(self, [theta_h, phi_h, phi_d, theta_d]: [usize; 4]) -> usize {
        ((theta_h * self.phi_h + phi_h) * self.phi_d + phi_d) * self.theta_d + theta_d
    }

    /// Where a node is.
    fn coordinates(self, index: usize) -> Coordinates {
        let (rest, theta_d) = (index / self.theta_d, index % self.theta_d);
        let (rest, phi_d) = (rest / self.phi_d, rest % self.phi_d);
        let (theta_h, phi_h) = (rest / self.phi_h, rest % self.phi_h);
        let share = |at: usize, of: usize| at as f32 / of as f32;
        Coordinates {
            theta_h: share(theta_h, self.theta_h - 1),
            phi_h: share(phi_h, self.phi_h),
            phi_d: share(phi_d, self.phi_d),
            theta_d: share(theta_d, self.theta_d - 1),
        }
    }

    /// Nodes below and above a place along each axis, and the share of the one above.
    fn around(self, at: Coordinates) -> [([usize; 2], f32); 4] {
        let open = |x: f32, nodes: usize| {
            let place = x.clamp(0.0, 1.0) * (nodes - 1) as f32;
            let low = (place as usize).min(nodes - 2);
            ([low, low + 1], place - low as f32)
        };
        let closed = |turns: f32, nodes: usize| {
            let place = turns.clamp(0.0, 1.0) * nodes as f32;
            let low = place as usize;
            ([low % nodes, (low + 1) % nodes], place - low as f32)
        };
        [open(at.theta_h, self.theta_h), closed(at.phi_h, self.phi_h), closed(at.phi_d, self.phi_d), open(at.theta_d, self.theta_d)]
    }
}

/// q of each node of a grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Tabulated {
    /// Its nodes.
    pub grid: Grid,
    /// Colours, 1/sr, θ_d fastest, then φ_d, φ_h, θ_h.
    pub values: Vec<Vec3>,
}

impl Tabulated {
    /// Asks a model at every node, with all the processor's threads. Shading functions S count as S/(π cos θ_i), as renderers have them.
    pub fn new(model: &dyn Reflectance, grid: Grid) -> Self {
        let mut values = vec![Vec3::ZERO; grid.nodes()];
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        let part = values.len().div_ceil(threads).max(1);
        std::thread::scope(|scope| {
            for (i, values) in values.chunks_mut(part).enumerate() {
                scope.spawn(move || {
                    for (k, value) in values.iter_mut().enumerate() {
                        let (wi, wo) = grid.coordinates(i * part + k).directions();
                        let q = model.rendered_f_cos(wi, wo) * ((wi.z + wo.z) / wi.z);
                        // One node must not spoil the cells around it.
                        *value = if q.is_finite() { q } else { Vec3::ZERO };
                    }
                });
            }
        });
        Self { grid, values }
    }

    /// f cos θ_i, 1/sr; 0 unless both directions are above the surface.
    pub fn f_cos(&self, wi: Vec3, wo: Vec3) -> Vec3 {
        if wi.z <= 0.0 || wo.z <= 0.0 {
            return Vec3::ZERO;
        }
        let around = self.grid.around(Coordinates::new(wi, wo));
        let q = (0..16_usize).fold(Vec3::ZERO, |sum, corner| {
            let above = |axis: usize| corner >> axis & 1;
            let share = |axis: usize| if above(axis) == 1 { around[axis].1 } else { 1.0 - around[axis].1 };
            let node = self.grid.index(std::array::from_fn(|axis| around[axis].0[above(axis)]));
            sum + (0..4).map(share).product::<f32>() * self.values[node]
        });
        q * (wi.z / (wi.z + wo.z))
    }

    /// How far the table is from its model: the root of the mean square of the difference of f cos θ_i by that of the model's, over pairs of
    /// pseudo-random directions of which half are near to mirror each other.
    pub fn deviation(&self, model: &dyn Reflectance) -> f32 {
        // Squares of single precision may overflow.
        let (off, whole) = pairs().fold((0.0, 0.0), |(off, whole), (wi, wo)| {
            let expected = model.rendered_f_cos(wi, wo).as_dvec3();
            (off + (self.f_cos(wi, wo).as_dvec3() - expected).length_squared(), whole + expected.length_squared())
        });
        if whole > 0.0 { (off / whole).sqrt() as f32 } else { 0.0 }
    }
}

/// What a turn about the normal changes, as a share of the mean value.
fn anisotropy(model: &dyn Reflectance) -> f32 {
    let mut rng = Rng::new(2);
    let (off, whole) = pairs().fold((0.0, 0.0), |(off, whole), (wi, wo)| {
        let turn = Quat::from_rotation_z(rng.next_1d() * std::f32::consts::TAU);
        let (here, there) = (model.rendered_f_cos(wi, wo).as_dvec3(), model.rendered_f_cos(turn * wi, turn * wo).as_dvec3());
        (off + (there - here).abs().element_sum(), whole + here.abs().element_sum())
    });
    if whole > 0.0 { (off / whole) as f32 } else { 0.0 }
}

/// Pseudo-random directions above the surface; half of the pairs nearly mirror each other, where lobes are.
fn pairs() -> impl Iterator<Item = (Vec3, Vec3)> {
    let mut rng = Rng::new(1);
    (0..PAIRS)
        .map(move |i| {
            let wo = warp::uniform_hemisphere(rng.next_2d());
            let other = warp::uniform_hemisphere(rng.next_2d());
            let near = Vec3::new(-wo.x, -wo.y, wo.z) + 0.3 * rng.next_1d() * (other - Vec3::Z);
            (if i % 2 == 0 { other } else { near.normalize() }, wo)
        })
        .filter(|(wi, wo)| wi.z > 0.0 && wo.z > 0.0)
}

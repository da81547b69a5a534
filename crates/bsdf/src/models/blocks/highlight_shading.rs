//! The shading function of a diffuse part and a highlight, S = k_d cos θ_i + k_s H(t), as Phong and Blinn use it.

use super::highlight::{Highlight, HighlightKind};
use crate::models::{Form, Lobe, Mixture, Real, Rgb, Scalar};
use kajo_params::Params;
use std::f64::consts::PI;

/// Parameters of these shading functions.
#[derive(Params, Clone, Copy, Debug)]
pub struct Params {
    /// Diffuse part.
    #[param(default = 0.4, range = 0.0..=1.0)]
    pub kd: [f64; 3],
    /// Height of the highlight.
    #[param(default = 0.4, range = 0.0..=1.0)]
    pub ks: [f64; 3],
    /// Exponent: 1 is broad, several hundred sharp.
    #[param(default = 50.0, range = 0.0..=1e6)]
    pub n: f64,
    /// Function that shapes the highlight.
    #[param(default = HighlightKind::Phong)]
    pub highlight: HighlightKind,
    /// Width of `trowbridge-reitz`, in (0, 1], or steepness of `gaussian`, 1/rad; 0 chooses the one that is ½ where the power of n is.
    #[param(default = 0.0, range = 0.0..=1000.0)]
    pub c: f64,
}

impl Params {
    /// # Errors
    /// A sentence where `c` is no width.
    pub fn check(&self) -> Result<(), String> {
        if self.highlight == HighlightKind::TrowbridgeReitz && self.c > 1.0 {
            return Err(format!("c is {}; a trowbridge-reitz highlight needs c at most 1, or 0 to choose it from n", self.c));
        }
        Ok(())
    }
}

/// k_d cos θ_i + k_s H(t).
#[derive(Clone, Copy, Debug)]
pub struct HighlightShading<T> {
    diffuse: Rgb<T>,
    specular: Rgb<T>,
    highlight: Highlight<T>,
    /// ∫ S dω of the diffuse part and about that of the highlight.
    weights: [T; 2],
}

impl<T: Real> HighlightShading<T> {
    /// `spread`: how many times the solid angle of H(t) the highlight covers; 1 for the mirror direction, 4 for half vectors.
    pub fn new(params: &Params, form: Form, spread: f64) -> Self {
        let highlight = Highlight::new(params.highlight, params.n, params.c, form);
        let sum = |k: [f64; 3]| k.iter().sum::<f64>();
        Self {
            diffuse: Rgb::of(params.kd),
            specular: Rgb::of(params.ks),
            highlight,
            weights: [T::of(sum(params.kd) * PI), highlight.mass() * T::of(sum(params.ks) * spread)],
        }
    }

    /// S where the highlight's cosine is `t`.
    #[inline(always)]
    pub fn value(&self, cos_i: T, t: T) -> Rgb<T> {
        self.diffuse * cos_i + self.specular * self.highlight.value(t)
    }
}

impl<T: Scalar> HighlightShading<T> {
    /// The diffuse lobe and those that `lobes` makes of the highlight and its weight.
    pub fn mixture(&self, lobes: impl Fn(&Highlight<T>, T) -> [(T, Lobe<T>); 4]) -> Mixture<T> {
        let [core, broad, broader, rest] = lobes(&self.highlight, self.weights[1]);
        Mixture::new(&[(self.weights[0], Lobe::Cosine), core, broad, broader, rest])
    }
}

impl HighlightShading<f32> {
    /// k_d, 0, k_s, 0, then those of the highlight.
    pub fn constants(&self) -> Vec<f32> {
        let (d, s) = (self.diffuse, self.specular);
        [&[d.x, d.y, d.z, 0.0, s.x, s.y, s.z, 0.0][..], &self.highlight.constants()].concat()
    }
}

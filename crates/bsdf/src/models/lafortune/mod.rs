//! Lafortune's generalised cosine lobes: sums of diagonal ones as a model, and the general one with a matrix.

use crate::models::{Claims, Evaluate, Form, Geometry, Kind, Lobe, Mixture, Model, ModelEntry, Parameters, Real, Rgb, Scalar, V3, make};
use kajo_params::{Params, Rows};
use std::f64::consts::{FRAC_1_PI, PI, TAU};

mod matrix;
#[cfg(test)]
mod tests;

pub use matrix::{Eigen, MatrixLobe};

/// The registry's entry.
pub const MODEL: ModelEntry = ModelEntry {
    id: "lafortune",
    title: "Lafortune (cosine lobes)",
    kind: Kind::Brdf,
    doc: include_str!("doc.md"),
    cites: &["Lafortune97", "Falski04"],
    claims: Some(Claims { parameters: Parameters::Empirical, plausible: true, anisotropic: true, off_specular: true }),
    has_printed_form: false,
    params: Params::SPEC,
    aliases: &[("rho_d", &["kd"]), ("rd", &["kd"]), ("lobes", &["lobe"])],
    wesl: Some(include_str!("lafortune.wesl")),
    make: make::<Lafortune>,
};

/// Above this value of f a lobe is refused: sums and squares of it stay within f32.
const HIGHEST: f64 = 1e12;

/// The model.
pub struct Lafortune;

/// Its parameters.
#[derive(Params, Clone, Copy, Debug)]
pub struct Params {
    /// Diffuse reflectance.
    #[param(default = 0.2, range = 0.0..=1.0)]
    pub kd: [f64; 3],
    /// Factor of all lobes.
    #[param(default = 1.0, range = 0.0..=1.0)]
    pub ks: [f64; 3],
    /// Lobes: C_x, C_y, C_z and the exponent n ≥ 0. Repeat it for a sum.
    #[param(default = 0.0, range = -100000.0..=100000.0)]
    pub lobe: Rows,
}

/// max(0, C_x x_i x_r + C_y y_i y_r + C_z z_i z_r)ⁿ.    (4.30)
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CosineLobe<T> {
    /// C_x, C_y, C_z.
    pub c: V3<T>,
    /// Exponent ≥ 0; 0 is constant.
    pub n: T,
}

impl<T: Real> CosineLobe<T> {
    /// The lobe of a row (C_x, C_y, C_z, n).
    pub fn of([x, y, z, n]: [f64; 4]) -> Self {
        Self { c: V3::of([x, y, z]), n: T::of(n) }
    }

    /// The value for two directions.
    #[inline(always)]
    pub fn value(&self, wi: V3<T>, wo: V3<T>) -> T {
        self.c.times(wi).dot(wo).max(T::zero()).powf(self.n)
    }
}

/// The row of Phong's BRDF with reflectance 1 at normal incidence: −C_x = −C_y = C_z = ((n + 2)/(2π))^(1/n), n > 0.    (4.27)
pub fn phong_row(n: f64) -> [f64; 4] {
    let c = ((n + 2.0) / TAU).powf(1.0 / n);
    [-c, -c, c, n]
}

/// The equation.
#[derive(Clone, Copy, Debug)]
pub struct Formula<T> {
    diffuse: Rgb<T>,
    scale: Rgb<T>,
    lobes: [CosineLobe<T>; Rows::MOST],
    count: usize,
}

impl<T: Real> Evaluate<T> for Formula<T> {
    #[inline(always)]
    fn value(&self, g: &Geometry<T>) -> Rgb<T> {
        let mut sum = T::zero();
        for lobe in &self.lobes[..self.count] {
            sum = sum + lobe.value(g.wi, g.wo);
        }
        self.diffuse + self.scale * sum
    }
}

impl Model for Lafortune {
    type Params = Params;
    type Formula<T: Real> = Formula<T>;
    const KIND: Kind = Kind::Brdf;

    fn check(params: &Params) -> Result<(), String> {
        for [x, y, z, n] in params.lobe.as_slice() {
            if *n < 0.0 {
                return Err(format!("the exponent of lobe {x},{y},{z},{n} is negative; it must be 0 or more"));
            }
            // wiᵀ diag(C) wo is at most the largest |C|.
            let most = x.abs().max(y.abs()).max(z.abs()).powf(*n);
            if most > HIGHEST {
                return Err(format!("lobe {x},{y},{z},{n} rises to {most:e}, above {HIGHEST:e}; take coefficients nearer to 1"));
            }
        }
        Ok(())
    }

    fn formula<T: Real>(params: &Params, _form: Form) -> Formula<T> {
        let rows = params.lobe.as_slice();
        Formula {
            diffuse: Rgb::of(params.kd.map(|k| k * FRAC_1_PI)),
            scale: Rgb::of(params.ks),
            lobes: std::array::from_fn(|k| CosineLobe::of(rows.get(k).copied().unwrap_or([0.0; 4]))),
            count: rows.len(),
        }
    }

    fn lobes<T: Scalar>(formula: &Formula<T>, wo: V3<T>) -> Mixture<T> {
        let scale = formula.scale.mean();
        // Seen from `wo` a lobe is |v|ⁿ cosⁿ about v = C wo.
        let part = |lobe: &CosineLobe<T>| {
            let v = lobe.c.times(wo);
            let length = v.dot(v).sqrt();
            if lobe.n <= T::zero() {
                (scale * T::of(PI), Lobe::Cosine)
            } else if length <= T::of(1e-18) {
                (T::zero(), Lobe::Cosine)
            } else {
                (scale * length.powf(lobe.n) * T::of(TAU) / (lobe.n + T::one()), Lobe::Power { axis: v * (T::one() / length), n: lobe.n })
            }
        };
        let mut weighted = [(formula.diffuse.mean() * T::of(PI), Lobe::Cosine); Rows::MOST + 1];
        for (slot, lobe) in weighted[1..].iter_mut().zip(&formula.lobes[..formula.count]) {
            *slot = part(lobe);
        }
        Mixture::new(&weighted[..=formula.count])
    }

    fn constants(formula: &Formula<f32>) -> Vec<f32> {
        let (d, s) = (formula.diffuse, formula.scale);
        let mut out = vec![d.x, d.y, d.z, formula.count as f32, s.x, s.y, s.z, 0.0];
        out.extend(formula.lobes[..formula.count].iter().flat_map(|lobe| [lobe.c.x, lobe.c.y, lobe.c.z, lobe.n]));
        out
    }
}

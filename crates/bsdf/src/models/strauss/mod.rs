//! Strauss's shading function for animators: colour, smoothness, metalness, transparency.

use crate::models::{Claims, Evaluate, Form, Geometry, Kind, Lobe, Mixture, Model, ModelEntry, Parameters, Real, Rgb, Scalar, V3, make};
use kajo_params::Params;
use std::f64::consts::{FRAC_2_PI, PI};

#[cfg(test)]
mod tests;

/// The registry's entry.
pub const MODEL: ModelEntry = ModelEntry {
    id: "strauss",
    title: "Strauss (shading function)",
    kind: Kind::Bsf,
    doc: include_str!("doc.md"),
    cites: &["Strauss90", "Falski04"],
    claims: Some(Claims { parameters: Parameters::Empirical, plausible: false, anisotropic: false, off_specular: true }),
    has_printed_form: true,
    params: Params::SPEC,
    aliases: &[("color", &["c"]), ("colour", &["c"]), ("smoothness", &["s"]), ("metalness", &["e"]), ("transparency", &["t"])],
    wesl: Some(include_str!("strauss.wesl")),
    make: make::<Strauss>,
};

/// Strength of the highlight that grows with the angle even where nothing else reflects.
const K_B: f64 = 0.1;
/// Pole of [`fresnel`].
const K_F: f64 = 1.12;
/// Pole of [`attenuation`].
const K_G: f64 = 1.01;
/// The smoothest surface that is no mirror: h = 30 000.
const SMOOTHEST: f64 = 0.9999;

/// The model.
pub struct Strauss;

/// Its parameters.
#[derive(Params, Clone, Copy, Debug)]
pub struct Params {
    /// Colour under white light at normal incidence.
    #[param(default = 0.7, range = 0.0..=1.0)]
    pub c: [f64; 3],
    /// Smoothness: 0 diffuse, 1 mirror.
    #[param(default = 0.5, range = 0.0..=1.0)]
    pub s: f64,
    /// Metalness: 1 colours the highlight and darkens the diffuse part.
    #[param(default = 0.5, range = 0.0..=1.0)]
    pub e: f64,
    /// Transparency: the share of light that is not reflected.
    #[param(default = 0.0, range = 0.0..=1.0)]
    pub t: f64,
    /// Refractive index: bends transmitted light; reflection does not depend on it.
    #[param(default = 1.5, range = 1.0..=10.0)]
    pub eta: f64,
}

/// F(x), x = θ/(π/2): 0 at normal incidence, 1 at 90°.    (4.10)
#[inline(always)]
pub fn fresnel<T: Real>(x: T) -> T {
    let (at_0, at_1) = (1.0 / (K_F * K_F), 1.0 / ((1.0 - K_F) * (1.0 - K_F)));
    (T::one() / (x - T::of(K_F)).squared() - T::of(at_0)) * T::of(1.0 / (at_1 - at_0))
}

/// G(x), x = θ/(π/2): 1 at normal incidence, 0 at 90°.    (4.11)
#[inline(always)]
pub fn attenuation<T: Real>(x: T) -> T {
    let (at_0, at_1) = (1.0 / (K_G * K_G), 1.0 / ((1.0 - K_G) * (1.0 - K_G)));
    ((T::of(at_1) - T::one() / (x - T::of(K_G)).squared()) * T::of(1.0 / (at_1 - at_0))).clamp(0.0, 1.0)
}

/// x = θ/(π/2) of (4.9) to (4.11).
#[inline(always)]
fn share_of_right_angle<T: Real>(cos: T) -> T {
    cos.clamp(0.0, 1.0).acos() * T::of(FRAC_2_PI)
}

/// The equation with what does not depend on angles; see doc.md.
#[derive(Clone, Copy, Debug)]
pub struct Formula<T> {
    color: Rgb<T>,
    /// ρ_d d_a.
    diffuse: T,
    /// r_n.
    strength: T,
    h: T,
    metalness: T,
    printed: bool,
}

impl<T: Real> Formula<T> {
    /// The diffuse part of S.
    #[inline(always)]
    pub fn diffuse(&self, g: &Geometry<T>) -> Rgb<T> {
        if self.printed { Rgb::splat(self.diffuse) } else { self.color * (g.cos_i() * self.diffuse) }
    }

    /// The highlight of S.
    #[inline(always)]
    pub fn specular(&self, g: &Geometry<T>) -> Rgb<T> {
        let (xi, xr) = (share_of_right_angle(g.cos_i()), share_of_right_angle(g.cos_r()));
        let f = fresnel(xi);
        let b = f * attenuation(xi) * attenuation(xr);
        let s_a = (self.strength + (self.strength + T::of(K_B)) * b).min(T::one());
        let tint = self.metalness * if self.printed { T::one() + f } else { T::one() - f };
        let c_s = self.color.map(|c| T::one() + tint * (c - T::one()));
        c_s * (g.cos_alpha().max(T::zero()).powf(self.h) * s_a)
    }
}

impl<T: Real> Evaluate<T> for Formula<T> {
    #[inline(always)]
    fn value(&self, g: &Geometry<T>) -> Rgb<T> {
        self.diffuse(g) + self.specular(g)
    }
}

impl Model for Strauss {
    type Params = Params;
    type Formula<T: Real> = Formula<T>;
    const KIND: Kind = Kind::Bsf;

    fn formula<T: Real>(params: &Params, form: Form) -> Formula<T> {
        let Params { c, s, e, t, .. } = *params;
        let printed = form == Form::Printed;
        let rho_d = (1.0 - s.powi(3)) * (1.0 - t);
        let diffuse = rho_d * (1.0 - e * s);
        Formula {
            color: Rgb::of(c),
            diffuse: T::of(diffuse),
            // Rounding may leave −1e-17 of (1 − t) − ρ_d.
            strength: T::of(((1.0 - t) - if printed { diffuse } else { rho_d }).max(0.0)),
            h: T::of(3.0 / (1.0 - s.min(SMOOTHEST))),
            metalness: T::of(e),
            printed,
        }
    }

    fn lobes<T: Scalar>(formula: &Formula<T>, wo: V3<T>) -> Mixture<T> {
        let axis = V3::new(-wo.x, -wo.y, wo.z);
        let glossy = (formula.strength + T::of(K_B)) * T::of(2.0 * PI) / (formula.h + T::one());
        // Uniform for the printed diffuse part, which has no cosine.
        let (cosine, uniform) = if formula.printed {
            (T::zero(), formula.diffuse * T::of(2.0 * PI))
        } else {
            (formula.color.mean() * formula.diffuse * T::of(PI), T::zero())
        };
        let up = V3::new(T::zero(), T::zero(), T::one());
        Mixture::new(&[
            (cosine, Lobe::Cosine),
            (uniform, Lobe::Power { axis: up, n: T::zero() }),
            (glossy, Lobe::Power { axis, n: formula.h }),
        ])
    }

    fn constants(formula: &Formula<f32>) -> Vec<f32> {
        let Formula { color, diffuse, strength, h, metalness, printed } = *formula;
        vec![color.x, color.y, color.z, diffuse, strength, h, metalness, 0.0, f32::from(u8::from(printed))]
    }
}

//! One layer: its spectral factor S and its directional factor D = Z A G.

use super::{Directional, Spectral};
use crate::models::{Form, Geometry, Lobe, Real, Rgb, Scalar, V3};
use std::f64::consts::{FRAC_1_PI, PI};

/// Reflectance, roughness and isotropy, prepared.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layer<T> {
    c: Rgb<T>,
    r: T,
    p: T,
    spectral: Spectral,
    directional: Directional,
    form: Form,
}

impl<T: Real> Layer<T> {
    pub fn new(c: [f64; 3], r: f64, p: f64, spectral: Spectral, directional: Directional, form: Form) -> Self {
        // Below, the peaks 1/r and 1/√p of Z and A leave the range that squares of f32 resolve.
        Self { c: Rgb::of(c), r: T::of(r.max(1e-6)), p: T::of(p.max(1e-4)), spectral, directional, form }
    }

    /// S, at the cosine of the angle of incidence on a facet.    (4.17), (4.18)
    #[inline(always)]
    pub fn spectral(&self, cos_beta: T) -> Rgb<T> {
        match self.spectral {
            Spectral::Constant => self.c,
            Spectral::Fresnel => {
                let w = (T::one() - cos_beta).max(T::zero()).powi(5);
                self.c.map(|c| c + (T::one() - c) * w)
            }
        }
    }

    /// D in 1/sr.    (4.19), (4.22)
    #[inline(always)]
    pub fn directional(&self, g: &Geometry<T>) -> T {
        let facets = zenith(self.r, self.tilt2(g)) * azimuth(self.p, g.cos2_phi_h()) * T::of(0.25 / PI);
        match self.directional {
            // Below, mirrored grazing directions would overflow f32.
            Directional::Simple => facets / (g.cos_i() * g.cos_r()).max(T::of(1e-20)),
            Directional::Blocked => {
                // G(θ)/cos θ = 1/(r − r cos θ + cos θ): the cosines cancel.    (4.23)
                let over_cosines = T::one() / (self.blocking(g.cos_i()) * self.blocking(g.cos_r()));
                (T::one() - over_cosines * g.cos_i() * g.cos_r()) * T::of(FRAC_1_PI) + over_cosines * facets
            }
        }
    }

    /// sin² of the angle that Z takes.
    #[inline(always)]
    fn tilt2(&self, g: &Geometry<T>) -> T {
        match self.form {
            Form::Corrected => g.h.x.squared() + g.h.y.squared(),
            // Printed: β instead of δ, which puts the peak where the viewer is.
            Form::Printed => (T::one() - g.cos_beta.squared()).max(T::zero()),
        }
    }

    #[inline(always)]
    fn blocking(&self, cos: T) -> T {
        self.r * (T::one() - cos) + cos
    }

    /// What this layer, of weight `weight`, is sampled from.
    pub fn lobes(&self, wo: V3<T>, weight: T) -> [(T, Lobe<T>); 2]
    where
        T: Scalar,
    {
        // The mirror direction stands for all: what G(θ)² lets through is glossy.
        let through = match self.directional {
            Directional::Simple => T::one(),
            Directional::Blocked => (wo.z / self.blocking(wo.z)).squared(),
        };
        // The printed lobe lies elsewhere.
        let glossy = if self.form == Form::Printed { T::of(0.5) * through } else { through };
        [(weight * (T::one() - glossy), Lobe::Cosine), (weight * glossy, Lobe::Rational { r: self.r, p: self.p })]
    }
}

impl Layer<f32> {
    pub fn constants(&self) -> [f32; 8] {
        let flag = |set: bool| if set { 1.0 } else { 0.0 };
        let (fresnel, blocked) = (flag(self.spectral == Spectral::Fresnel), flag(self.directional == Directional::Blocked));
        [self.c.x, self.c.y, self.c.z, self.r, self.p, fresnel, blocked, flag(self.form == Form::Printed)]
    }
}

/// Z = r/(1 + r cos²δ − cos²δ)² for sin²δ; ∫ Z cos δ dω = π.    (4.20)
#[inline(always)]
pub(super) fn zenith<T: Real>(r: T, sin2_delta: T) -> T {
    r / (sin2_delta + r * (T::one() - sin2_delta)).squared()
}

/// A = √(p/(p² − p² cos²φ_h + cos²φ_h)).    (4.21)
#[inline(always)]
pub(super) fn azimuth<T: Real>(p: T, cos2_phi_h: T) -> T {
    let p2 = p.squared();
    (p / (p2 + (T::one() - p2) * cos2_phi_h)).sqrt()
}

//! He, Torrance, Sillion and Greenberg's wave-optical model: mirror, directional-diffuse and uniform-diffuse reflection of one rough surface.

mod series;

use crate::models::blocks::fresnel::{Fresnel, FresnelForm, normal_reflectance};
use crate::models::blocks::metals::Metal;
use crate::models::{Claims, Evaluate, Form, Geometry, Kind, Lobe, Mixture, Model, ModelEntry, Parameters, Real, Rgb, Scalar, V3, make};
use kajo_params::Params;
use series::diffraction_sum;
use std::f64::consts::{FRAC_1_PI, PI, TAU};

#[cfg(test)]
mod tests;

/// The registry's entry.
pub const MODEL: ModelEntry = ModelEntry {
    id: "htsg",
    title: "He-Torrance-Sillion-Greenberg",
    kind: Kind::Brdf,
    doc: include_str!("doc.md"),
    cites: &["He91", "He92", "Beckmann63", "Johnson72", "Johnson74", "Rakic95"],
    claims: Some(Claims { parameters: Parameters::Physical, plausible: true, anisotropic: false, off_specular: true }),
    has_printed_form: true,
    params: Params::SPEC,
    aliases: &[("sigma", &["sigma0"]), ("wavelength", &["lambda"]), ("rd", &["kd"]), ("n", &["eta"]), ("k", &["kappa"])],
    wesl: Some(include_str!("htsg.wesl")),
    make: make::<Htsg>,
};

/// The model.
pub struct Htsg;

/// Its parameters.
#[derive(Params, Clone, Copy, Debug)]
pub struct Params {
    /// Root mean square height of the surface.
    #[param(default = 0.28, range = 0.0001..=100.0, unit = "µm")]
    pub sigma0: f64,
    /// Distance over which heights are correlated.
    #[param(default = 1.77, range = 0.01..=10000.0, unit = "µm")]
    pub tau: f64,
    /// Wavelength, one for all channels or one for each (0.6114,0.5491,0.4642 are those of the sRGB primaries).
    #[param(default = 0.5, range = 0.1..=100.0, unit = "µm")]
    pub lambda: [f64; 3],
    /// Index of refraction, below over above.
    #[param(default = 0.77, range = 0.001..=100.0)]
    pub eta: [f64; 3],
    /// Extinction coefficient.
    #[param(default = 6.08, range = 0.0..=1e6)]
    pub kappa: [f64; 3],
    /// A measured metal at the wavelengths of lambda, in place of eta and kappa.
    #[param(default = Metal::None)]
    pub metal: Metal,
    /// Uniform diffuse reflectance: light scattered more than once or below the surface.
    #[param(default = 0.0, range = 0.0..=1.0)]
    pub kd: [f64; 3],
    /// Fresnel's term.
    #[param(default = FresnelForm::Exact)]
    pub fresnel: FresnelForm,
}

/// f = a + |F|²/π G S D/(cos θ_i cos θ_r), and the mirror's |F|² e^{−g} S.
#[derive(Clone, Copy, Debug)]
pub struct Formula<T> {
    uniform: Rgb<T>,
    sigma0: T,
    tau: T,
    /// Wave numbers 2π/λ, 1/µm.
    wave: [T; 3],
    /// All channels have one wavelength.
    grey: bool,
    printed: bool,
    fresnel: Fresnel<T>,
}

/// What the equation is made of, for one wave number.
#[derive(Clone, Copy, Debug)]
pub struct Parts<T> {
    /// Shadowing and masking over the cosines, S/(cos θ_i cos θ_r).
    pub visibility: T,
    /// Effective roughness σ, µm.
    pub sigma: T,
    /// Geometrical factor G.
    pub geometry: T,
}

/// S1(θ)/cos θ and tan θ erfc(q), q = τ cot θ/(2σ0), of one direction.
struct Side<T> {
    seen_over_cos: T,
    k: T,
}

impl<T: Real> Formula<T> {
    #[inline(always)]
    fn side(&self, w: V3<T>) -> Side<T> {
        let sin = (w.x.squared() + w.y.squared()).sqrt().max(T::of(1e-6));
        let rho = self.tau / (T::of(2.0) * self.sigma0 * sin);
        // Beyond 100 the exponential and erfc are 0 in every precision.
        let q = (rho * w.z).min(T::of(100.0));
        let erfc = q.erfc();
        let share = T::one() - T::of(0.5) * erfc;
        let gauss = if self.printed { T::one() } else { (-q.squared()).exp() };
        // (1 − ½ erfc q)/(Λ + 1)/cos θ, multiplied through by q: finite at the horizon, where S1 and cos θ vanish together.
        let seen_over_cos = share * rho / (rho * w.z * share + T::of(0.5 / PI.sqrt()) * gauss);
        Side { seen_over_cos, k: sin / w.z.max(T::of(1e-6)) * erfc }
    }

    /// The parts for a light and a viewer.
    #[inline(always)]
    pub fn parts(&self, g: &Geometry<T>) -> Parts<T> {
        let (light, viewer) = (self.side(g.wi), self.side(g.wo));
        let x = mean_level((light.k + viewer.k) * T::of(1.0 / (8.0 * PI).sqrt()));
        let v2 = T::of(4.0) * g.cos_beta.squared();
        Parts {
            visibility: light.seen_over_cos * viewer.seen_over_cos,
            sigma: self.sigma0 / (T::one() + x.squared()).sqrt(),
            geometry: (v2 / (g.cos_i() + g.cos_r()).max(T::of(1e-9))).squared(),
        }
    }

    /// g = ((2πσ/λ)(cos θ_i + cos θ_r))² for the cosines' sum.
    #[inline(always)]
    fn phase(&self, wave: T, sigma: T, cosines: T) -> T {
        (wave * sigma * cosines).squared()
    }

    /// D of (3.26) for one wave number.
    #[inline(always)]
    pub fn distribution(&self, g: &Geometry<T>, wave: T, sigma: T) -> T {
        let (x, y) = (g.wi.x + g.wo.x, g.wi.y + g.wo.y);
        let scale = (wave * self.tau).squared();
        let b = T::of(0.25) * scale * (x.squared() + y.squared());
        scale * T::of(1.0 / 16.0) * diffraction_sum(self.phase(wave, sigma, g.cos_i() + g.cos_r()), b)
    }

    #[inline]
    fn per_wavelength(&self, f: impl Fn(T) -> T) -> Rgb<T> {
        let [r, g, b] = self.wave;
        if self.grey { Rgb::splat(f(r)) } else { Rgb::new(f(r), f(g), f(b)) }
    }
}

/// x = z0/σ0, the mean level of the surface that is seen: x exp(x²/2) = `f`, by Newton's method.
#[inline(always)]
pub fn mean_level<T: Real>(f: T) -> T {
    let low = f.le(T::one());
    let start = (T::of(2.0) * T::select(low, T::one(), f).ln()).sqrt();
    let mut x = T::select(low, f, start);
    for _ in 0..8 {
        let bump = f * (T::of(-0.5) * x.squared()).exp();
        x = x - (x - bump) / (T::one() + x * bump);
    }
    x
}

impl<T: Real> Evaluate<T> for Formula<T> {
    #[inline(always)]
    fn value(&self, g: &Geometry<T>) -> Rgb<T> {
        let parts = self.parts(g);
        let scale = T::of(FRAC_1_PI) * parts.visibility;
        let mut scattered = [T::zero(); 3];
        for (scattered, wave) in scattered.iter_mut().zip(self.wave) {
            *scattered = self.distribution(g, wave, parts.sigma) * parts.geometry * scale;
            if self.grey {
                break;
            }
        }
        let [red, green, blue] = if self.grey { [scattered[0]; 3] } else { scattered };
        self.uniform + self.fresnel.at(g.cos_beta).times(Rgb::new(red, green, blue))
    }
}

impl Model for Htsg {
    type Params = Params;
    type Formula<T: Real> = Formula<T>;
    const KIND: Kind = Kind::Brdf;

    fn formula<T: Real>(p: &Params, form: Form) -> Formula<T> {
        let optics = [0, 1, 2].map(|c| p.metal.at(1000.0 * p.lambda[c]).unwrap_or([p.eta[c], p.kappa[c]]));
        let (eta, kappa) = (optics.map(|[eta, _]| eta), optics.map(|[_, kappa]| kappa));
        let normal = optics.map(|[eta, kappa]| normal_reflectance(eta, kappa));
        Formula {
            uniform: Rgb::of(p.kd.map(|k| k * FRAC_1_PI)),
            sigma0: T::of(p.sigma0),
            tau: T::of(p.tau),
            wave: p.lambda.map(|lambda| T::of(TAU / lambda)),
            grey: p.lambda == [p.lambda[0]; 3],
            printed: form == Form::Printed,
            fresnel: Fresnel::new(p.fresnel, Metal::None, eta, kappa, normal),
        }
    }

    /// Lobes of the first orders of diffraction, Beckmann's lobe for the high ones, each with the energy it has about the mirror direction; a cosine
    /// lobe for the uniform part and for what is far from the mirror direction.
    fn lobes<T: Scalar>(formula: &Formula<T>, wo: V3<T>) -> Mixture<T> {
        let [r, g, b] = formula.wave;
        let longest = r.min(g).min(b);
        let phase = formula.phase(longest, formula.sigma0, T::of(2.0) * wo.z);
        let rough = T::one() - (-phase).exp();
        let reflectance = formula.fresnel.at(wo.z).mean();
        let first = T::of(2.0) / (longest * formula.tau);
        let mut lobes = [(T::zero(), Lobe::Cosine); 8];
        lobes[0] = (formula.uniform.mean() * T::of(PI) + T::of(0.05) * reflectance * rough, Lobe::Cosine);
        // Poisson's probabilities of orders 1 … 15, in groups of like width.
        let groups = [(1, 1), (2, 2), (3, 4), (5, 7), (8, 11), (12, 15)];
        // Above 80 no low order is left, and their products would overflow.
        let capped = phase.min(T::of(80.0));
        let (mut poisson, mut low) = ((-capped).exp(), T::zero());
        for (slot, (from, to)) in lobes[1..].iter_mut().zip(groups) {
            let mut mass = T::zero();
            for order in from..=to {
                poisson = poisson * capped / T::of(f64::from(order));
                mass = mass + poisson;
            }
            *slot = (reflectance * mass, Lobe::Diffracted { width: first * T::of(f64::from(to).sqrt()) });
            low = low + mass;
        }
        let slope = T::of(2.0) * formula.sigma0 / formula.tau;
        // A tenth of it always: order by order the tails are narrower than their sum.
        let high = (rough - low).max(T::zero()) + T::of(0.1) * rough;
        lobes[7] = (reflectance * high, Lobe::Gauss { mx: slope, my: slope });
        Mixture::new(&lobes)
    }

    fn constants(formula: &Formula<f32>) -> Vec<f32> {
        let (u, [r, g, b]) = (formula.uniform, formula.wave);
        let mut out = vec![u.x, u.y, u.z, formula.sigma0, r, g, b, formula.tau];
        out.extend(formula.fresnel.constants().into_iter().flatten());
        out.push(f32::from(u8::from(formula.printed)));
        out
    }

    /// p_s = |F|² e^{−g} S at θ_i = θ_r (3.22).
    fn mirror<T: Scalar>(formula: &Formula<T>, wo: V3<T>) -> Rgb<T> {
        if wo.z <= T::zero() {
            return Rgb::splat(T::zero());
        }
        let wi = V3::new(-wo.x, -wo.y, wo.z);
        let parts = formula.parts(&Geometry { wi, wo, h: V3::new(T::zero(), T::zero(), T::one()), cos_beta: wo.z });
        let seen = parts.visibility * wo.z.squared();
        let coherent = formula.per_wavelength(|wave| (-formula.phase(wave, parts.sigma, T::of(2.0) * wo.z)).exp() * seen);
        formula.fresnel.at(wo.z).times(coherent)
    }
}

//! Diffuse reflection and one specular reflection by facets, with distribution, attenuation and reflectance of one's choice.
//!
//! ```text
//! f = k_d/π + k_s F D G/(4π cos θ_i cos θ_r)
//! ```

use super::distribution::Facets;
use super::fresnel::Fresnel;
use super::masking::Attenuation;
use crate::models::{Evaluate, Geometry, Lobe, Mixture, Real, Rgb, Scalar, V3};
use std::f64::consts::FRAC_1_PI;

/// The equation, prepared.
#[derive(Clone, Copy, Debug)]
pub struct Microfacets<T> {
    diffuse: Rgb<T>,
    /// k_s/(4π), or k_s/π as printed.
    specular: Rgb<T>,
    facets: Facets<T>,
    attenuation: Attenuation<T>,
    fresnel: Fresnel<T>,
    /// Mean k_d and k_s, for the sampler.
    weights: [T; 2],
}

impl<T: Real> Microfacets<T> {
    /// `prefactor` is 1/(4π), or what the print has.
    pub fn new(kd: [f64; 3], ks: [f64; 3], prefactor: f64, facets: Facets<T>, attenuation: Attenuation<T>, fresnel: Fresnel<T>) -> Self {
        Self {
            diffuse: Rgb::of(kd.map(|k| k * FRAC_1_PI)),
            specular: Rgb::of(ks.map(|k| k * prefactor)),
            facets,
            attenuation,
            fresnel,
            weights: [kd, ks].map(|k| T::of(k.iter().sum::<f64>() / 3.0)),
        }
    }

    /// The constants that `shader_lib::models::microfacet` reads: seven rows of four.
    pub fn constants(&self) -> Vec<T> {
        let (kind, [first, second]) = self.facets.constants();
        let [masking, mx2, my2] = self.attenuation.constants();
        let (d, s) = (self.diffuse, self.specular);
        let fresnel = self.fresnel.constants();
        let mut out = vec![d.x, d.y, d.z, kind, s.x, s.y, s.z, masking];
        out.extend(fresnel.into_iter().flatten());
        out.extend(first.into_iter().chain([mx2]).chain(second).chain([my2]));
        out
    }
}

impl<T: Real> Evaluate<T> for Microfacets<T> {
    #[inline(always)]
    fn value(&self, g: &Geometry<T>) -> Rgb<T> {
        let specular = self.facets.d(g) * self.attenuation.visibility(g);
        self.diffuse + self.specular.times(self.fresnel.at(g.cos_beta)) * specular
    }
}

impl<T: Scalar> Microfacets<T> {
    /// A cosine lobe and a lobe for each scale, weighted by reflectances; with D cos δ sampled, f cos θ_i/p is F G cos β/(cos θ_r cos δ).
    pub fn lobes(&self, wo: V3<T>) -> Mixture<T> {
        let glossy = self.weights[1] * self.fresnel.at(wo.z).mean();
        let mut lobes = [(self.weights[0], Lobe::Cosine); 3];
        let mut count = 1;
        for (weight, lobe) in self.facets.lobes() {
            lobes[count] = (weight * glossy, lobe);
            count += 1;
        }
        Mixture::new(&lobes[..count])
    }
}

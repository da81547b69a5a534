//! The survey's figures, with parameters chosen where it gives none.

use super::{Curve, Figure};
use kajo_bsdf::models::blocks::distribution::{Distribution, Facets};
use kajo_bsdf::models::blocks::fresnel::{conductor, normal_reflectance, schlick as schlick_fresnel};
use kajo_bsdf::models::blocks::highlight::schlick as schlick_highlight;
use kajo_bsdf::models::blocks::masking::{schlick as schlick_masking, schlick_k, smith};
use kajo_bsdf::models::{Geometry, V3};

fn figure(number: &str, title: &str, axes: [&str; 2], curves: Vec<Curve>) -> Figure {
    let axes = axes.map(str::to_owned);
    Figure { name: format!("figure_{number}"), title: title.into(), axes, curves, equal_scales: false }
}

/// Over 0 to 90° by tenths.
fn over_angles(name: String, f: impl Fn(f64) -> f64) -> Curve {
    let points = (0..=900).map(|k| f64::from(k) / 10.0).map(|degrees| [degrees, f(degrees.to_radians())]).collect();
    Curve { name, points }
}

/// Figure 2.2: cosⁿ α.
pub(super) fn powers() -> Figure {
    let curve = |n: i32| over_angles(format!("n = {n}"), move |alpha| alpha.cos().max(0.0).powi(n));
    figure("2.2", "Powers of the cosine", ["angle from the mirror direction, degrees", "cos^n"], [1, 3, 5, 10, 50, 200].map(curve).into())
}

/// Figure 2.5: tⁿ and Schlick's quotient (2.13).
pub(super) fn highlights() -> Figure {
    let curve = |name: String, f: &dyn Fn(f64) -> f64| {
        let points = (0..=1000).map(|k| f64::from(k) / 1000.0).map(|t| [t, f(t)]).collect();
        Curve { name, points }
    };
    let curves = [5, 10, 50, 100].into_iter().flat_map(|n| {
        [curve(format!("power, n = {n}"), &|t| t.powi(n)), curve(format!("Schlick, n = {n}"), &|t| schlick_highlight(t, f64::from(n)))]
    });
    figure("2.5", "Phong's power and Schlick's quotient", ["t", "H(t)"], curves.collect())
}

/// Figure 3.4: Smith's G(θ), printed and corrected, and Schlick's.
pub(super) fn attenuations() -> Figure {
    let curves = [0.2, 0.6].into_iter().flat_map(|m| {
        let k = schlick_k(m);
        [
            over_angles(format!("Smith printed, m = {m}"), |theta| smith(theta.cos(), m, true)),
            over_angles(format!("Smith, m = {m}"), |theta| smith(theta.cos(), m, false)),
            over_angles(format!("Schlick, m = {m}"), |theta| schlick_masking(theta.cos(), k, 1.0 - k)),
        ]
    });
    figure("3.4", "Attenuation by Smith and by Schlick", ["angle from the normal, degrees", "G"], curves.collect())
}

/// Figure 3.5: D(δ)/D(0) by Beckmann and by Schlick.
pub(super) fn distributions() -> Figure {
    let curve = |kind, name: String, m: f64| {
        let facets = Facets::<f64>::new(kind, &[[1.0, m, m]]);
        over_angles(name, move |delta| {
            let h = V3::from_angles(delta, 0.0);
            facets.d(&Geometry { wi: h, wo: h, h, cos_beta: 1.0 }) * m * m
        })
    };
    let curves = [0.05, 0.1, 0.2, 0.4, 0.6].into_iter().flat_map(|m| {
        [curve(Distribution::Beckmann, format!("Beckmann, m = {m}"), m), curve(Distribution::Schlick, format!("Schlick, m = {m}"), m)]
    });
    figure("3.5", "Facet slopes by Beckmann and by Schlick", ["angle of the facet, degrees", "D/D(0)"], curves.collect())
}

/// Figure 3.6: Fresnel's reflectance and Schlick's approximation.
pub(super) fn reflectances() -> Figure {
    let materials = [("plastic", 1.49, 0.0), ("diamond", 2.417, 0.0), ("silver", 0.135, 3.985), ("copper", 1.0, 2.39)];
    let curves = materials.into_iter().flat_map(|(name, eta, kappa)| {
        let f0 = normal_reflectance(eta, kappa);
        [
            over_angles(format!("Fresnel, {name}"), |beta| conductor(beta.cos(), eta, kappa)),
            over_angles(format!("Schlick, {name}"), |beta| schlick_fresnel(beta.cos(), f0, 1.0 - f0)),
        ]
    });
    figure("3.6", "Reflectance by Fresnel and by Schlick", ["angle of incidence, degrees", "F"], curves.collect())
}

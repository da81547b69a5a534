//! Chapter 4: Strauss, Ward, Schlick, Ashikhmin and Shirley, Lafortune; and the survey's citations.

use super::{A, B, Erratum, both, geometry, value_at};
use crate::checks::reciprocity;
use kajo_bsdf::models::strauss::{self, Strauss, attenuation, fresnel};
use kajo_bsdf::models::{Form, Geometry, Model};
use std::f64::consts::PI;

/// What the Strauss rows are computed for: C = 0.7, s = e = 0.5, t = 0.
const STRAUSS: strauss::Params = strauss::Params { c: [0.7; 3], s: 0.5, e: 0.5, t: 0.0, eta: 1.5 };

pub(super) fn rows() -> Vec<Erratum> {
    let g = geometry(A);
    let ward = |pairs: &[(&str, &str)]| both("ward", &[&[("kd", "0"), ("ks", "0.4")], pairs].concat(), value_at(A));
    let black = fresnel(70.0 / 90.0);
    vec![
        Erratum {
            equation: "4.2",
            subject: "Strauss, diffuse part",
            printed: "ρd da",
            implemented: "C cos θi ρd da",
            quantity: "diffuse S, set A, C = 0.7, s = e = 0.5",
            values: [Form::Printed, Form::Corrected].map(|form| Strauss::formula::<f64>(&STRAUSS, form).diffuse(&g).x),
            consequence: "flat and without colour",
        },
        Erratum {
            equation: "4.8",
            subject: "Strauss, highlight",
            printed: "(1 − t) − fd",
            implemented: "(1 − t) − ρd",
            quantity: "specular S, set A, C = 0.7, s = e = 0.5",
            values: strauss_highlight(&g),
            consequence: "2.7 times too strong",
        },
        Erratum {
            equation: "4.12",
            subject: "Strauss, highlight's colour",
            printed: "1 + F",
            implemented: "1 − F",
            quantity: "cs at θi = 70°, C = 0, e = 1",
            values: [1.0 + (1.0 + black) * (0.0 - 1.0), 1.0 + (1.0 - black) * (0.0 - 1.0)],
            consequence: "negative colours",
        },
        Erratum {
            equation: "4.13",
            subject: "Ward, isotropic",
            printed: "exp(−tan²δ/m)",
            implemented: "exp(−tan²δ/m²)",
            quantity: "f, 1/sr, set A, ks = 0.4, m = 0.15",
            values: ward(&[("m", "0.15")]),
            consequence: "another width",
        },
        Erratum {
            equation: "4.15",
            subject: "Ward, approximate",
            printed: "4π mx my inside exp",
            implemented: "4π mx my outside",
            quantity: "f, 1/sr, set A, ks = 0.4, mx = 0.1, my = 0.4",
            values: ward(&[("mx", "0.1"), ("my", "0.4"), ("exponent", "approximate")]),
            consequence: "another scale and width",
        },
        Erratum {
            equation: "4.16",
            subject: "Schlick, two layers",
            printed: "S'(θi)",
            implemented: "S'(β)",
            quantity: "worst asymmetry of 20 000 pairs, C = 0.04, r = 0.1, C' = 0.6, r' = 0.8",
            values: both("schlick-double", &[], |model| reciprocity(model, 20_000, 0).worst),
            consequence: "not reciprocal",
        },
        Erratum {
            equation: "4.19, 4.20, 4.22",
            subject: "Schlick, argument of Z",
            printed: "Z(β)",
            implemented: "Z(δ)",
            quantity: "f towards the light over f towards the mirror, θ = 45°, r = 0.1",
            values: both("schlick-single", &[("c", "0.6"), ("r", "0.1"), ("p", "1")], |model| {
                value_at([45.0, 0.0, 45.0, 0.0])(model) / value_at([45.0, 0.0, 45.0, 180.0])(model)
            }),
            consequence: "the peak is where the light is",
        },
        Erratum {
            equation: "4.25",
            subject: "Ashikhmin-Shirley, azimuth",
            printed: "φ",
            implemented: "φh, of the half vector",
            quantity: "specular f, 1/sr, set B, φ = φi = 20°, Rs = 0.4, nx = 10, ny = 100",
            values: [20_f64.to_radians().cos().powi(2), geometry(B).cos2_phi_h()].map(ashikhmin_shirley),
            consequence: "the highlight's axes are not the surface's; not reciprocal",
        },
        Erratum {
            equation: "4.31",
            subject: "Minnaert",
            printed: "Θi,x Θr,x",
            implemented: "Θi,z Θr,z",
            quantity: "f, 1/sr, set A, kd = 0.5, n = 0.7",
            values: both("minnaert", &[("kd", "0.5"), ("n", "0.7")], value_at(A)),
            consequence: "not a diffuse lobe: nothing away from the light",
        },
        citation("Torrance and Sparrow's year, chapter 3", "1976", "1967", [1976.0, 1967.0]),
        citation("HTSG's number in the bibliography", "[9]", "[10]", [9.0, 10.0]),
        citation("Lafortune's number in the bibliography", "[13]", "[14]", [13.0, 14.0]),
        citation("Torrance and Sparrow, volume of J. Opt. Soc. Am.", "27", "57", [27.0, 57.0]),
    ]
}

fn citation(subject: &'static str, printed: &'static str, implemented: &'static str, values: [f64; 2]) -> Erratum {
    Erratum { equation: "text", subject, printed, implemented, quantity: "the number", values, consequence: "citations only" }
}

/// The corrected highlight, and what it is with the print's r_n in its strength min(1, r_n + (r_n + 0.1) b).    (4.7)
fn strauss_highlight(g: &Geometry<f64>) -> [f64; 2] {
    let share = |cos: f64| cos.acos() / (0.5 * PI);
    let (xi, xr) = (share(g.cos_i()), share(g.cos_r()));
    let b = fresnel(xi) * attenuation(xi) * attenuation(xr);
    let strength = |r_n: f64| (r_n + (r_n + 0.1) * b).min(1.0);
    let rho_d = 1.0 - STRAUSS.s.powi(3);
    let printed = 1.0 - rho_d * (1.0 - STRAUSS.e * STRAUSS.s);
    let corrected = Strauss::formula::<f64>(&STRAUSS, Form::Corrected).specular(g).x;
    [corrected * strength(printed) / strength(1.0 - rho_d), corrected]
}

/// (4.25) at set B for cos² of its azimuth.
fn ashikhmin_shirley(cos2_phi: f64) -> f64 {
    let (g, rs, nx, ny) = (geometry(B), 0.4, 10.0, 100.0);
    let exponent: f64 = nx * cos2_phi + ny * (1.0 - cos2_phi);
    let fresnel = rs + (1.0 - rs) * (1.0 - g.cos_beta).powi(5);
    ((nx + 1.0) * (ny + 1.0)).sqrt() / (8.0 * PI) * g.cos_delta().powf(exponent) / (g.cos_beta * g.cos_i().max(g.cos_r())) * fresnel
}

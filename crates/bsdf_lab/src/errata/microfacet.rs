//! Chapter 3 up to Cook and Torrance: attenuation, Fresnel's reflectance, the prefactor.

use super::{C, Erratum, albedo_at, both, geometry};
use kajo_bsdf::models::Geometry;
use kajo_bsdf::models::blocks::fresnel::{normal_reflectance, normal_reflectance_printed};
use kajo_bsdf::models::blocks::masking::{smith, v_groove};

pub(super) fn rows() -> Vec<Erratum> {
    let g = geometry(C);
    vec![
        Erratum {
            equation: "3.1",
            subject: "V-grooves, names",
            printed: "cos θr: shadowing, cos θi: masking",
            implemented: "cos θr: masking, cos θi: shadowing",
            quantity: "G, set C",
            values: [v_groove(&Geometry::new(g.wo, g.wi)), v_groove(&g)],
            consequence: "none, the minimum is symmetric",
        },
        Erratum {
            equation: "3.3",
            subject: "Smith's attenuation",
            printed: "g = √(hπ)(2 − erfc √h)",
            implemented: "g = √(hπ) e^h (2 − erfc √h)",
            quantity: "G(θ) where both differ most, m = 0.2",
            values: largest_gap(|cos| [smith(cos, 0.2, true), smith(cos, 0.2, false)]),
            consequence: "G is low by up to 0.144",
        },
        Erratum {
            equation: "3.11",
            subject: "Fresnel, normal incidence",
            printed: "(η − 1)/(η + 1)",
            implemented: "((η − 1)/(η + 1))²",
            quantity: "F(0), η = 1.49",
            values: [normal_reflectance_printed(1.49), normal_reflectance(1.49, 0.0)],
            consequence: "five times the reflectance of plastic",
        },
        Erratum {
            equation: "3.17",
            subject: "Cook-Torrance, prefactor",
            printed: "1/π",
            implemented: "1/4π",
            quantity: "albedo at 0°, F = 1, ks = 1, m = 0.2",
            values: both("cook-torrance", &[("kd", "0"), ("ks", "1"), ("m", "0.2"), ("fresnel", "none")], albedo_at(0.0)),
            consequence: "4 times the energy",
        },
    ]
}

/// The pair of values with the largest difference, over cosines of 0 to 90° by hundredths of a degree.
pub(crate) fn largest_gap(pair: impl Fn(f64) -> [f64; 2]) -> [f64; 2] {
    let gap = |[a, b]: [f64; 2]| (a - b).abs();
    (0..=9000)
        .map(|k| pair((f64::from(k) * 0.01).to_radians().cos()))
        .fold([0.0; 2], |most, here| if gap(here) > gap(most) { here } else { most })
}

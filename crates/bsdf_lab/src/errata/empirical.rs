//! Chapters 1 and 2: geometry, Phong, Blinn-Phong, highlight functions.

use super::{A, Erratum, albedo_at, both, geometry};
use kajo_bsdf::models::Form;
use kajo_bsdf::models::blocks::highlight::{Highlight, HighlightKind};

pub(super) fn rows() -> Vec<Erratum> {
    let g = geometry(A);
    let highlight =
        |kind, n, c, cosine: f64| [Form::Printed, Form::Corrected].map(|form| Highlight::<f64>::new(kind, n, c, form).value(cosine));
    vec![
        Erratum {
            equation: "1.11",
            subject: "half vector",
            printed: "(Θi + Θr)/2",
            implemented: "(Θi + Θr)/|Θi + Θr|",
            quantity: "cos δ, set A",
            // The mean of two unit vectors has length cos β.
            values: [g.cos_delta() * g.cos_beta, g.cos_delta()],
            consequence: "cos δ is scaled by cos β",
        },
        Erratum {
            equation: "2.8",
            subject: "Phong, energy",
            printed: "kd + ks ≤ 0",
            implemented: "kd + ks ≤ 1",
            quantity: "largest kd + ks allowed",
            values: [0.0, 1.0],
            consequence: "no material is valid",
        },
        Erratum {
            equation: "2.10",
            subject: "Blinn-Phong, norm",
            printed: "(n + 2)/2π",
            implemented: "(n + 2)(n + 4)/(8π(n + 2^(−n/2)))",
            quantity: "albedo at 0°, ks = 1, n = 200",
            values: both("blinn-phong", &[("kd", "0"), ("ks", "1"), ("n", "200")], albedo_at(0.0)),
            consequence: "up to 4 times the energy",
        },
        Erratum {
            equation: "2.11",
            subject: "Trowbridge-Reitz highlight",
            printed: "[c³/(t²(c² − 1) + 1)]²",
            implemented: "[c²/(t²(c² − 1) + 1)]²",
            quantity: "H(1), c = 0.35",
            values: highlight(HighlightKind::TrowbridgeReitz, 50.0, 0.35, 1.0),
            consequence: "the peak is c², not 1",
        },
        Erratum {
            equation: "2.12",
            subject: "Gaussian highlight",
            printed: "exp((αc)²)",
            implemented: "exp(−(αc)²)",
            quantity: "H at α = 30°, c = 2",
            values: highlight(HighlightKind::Gaussian, 50.0, 2.0, 30_f64.to_radians().cos()),
            consequence: "it grows with the angle",
        },
    ]
}

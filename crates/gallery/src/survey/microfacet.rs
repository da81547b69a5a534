//! Chapter 3: Cook-Torrance, exact and by Schlick's rational functions.

use super::{Measured, SphereFigure, furnace_check, grey, probe_curves};
use crate::GalleryError;
use crate::check::{Check, largest};
use crate::probe::{Sample, disc, half_widths, pixel, strip};
use crate::stage::Ball;
use kajo_bsdf::models::blocks::fresnel::{dielectric, schlick as schlick_fresnel};
use kajo_bsdf::models::blocks::masking::{schlick as schlick_masking, schlick_k, v_groove};
use kajo_bsdf::models::{Geometry, V3};
use std::f64::consts::{FRAC_1_PI, PI};

type Rows = [(String, Vec<Ball>)];

/// θ_i, φ_i, θ_r, φ_r of the survey's golden values, degrees.
pub const SETS: [(&str, [f64; 4]); 5] = [
    ("A", [30.0, 0.0, 40.0, 180.0]),
    ("B", [60.0, 20.0, 45.0, 150.0]),
    ("C", [10.0, 0.0, 75.0, 90.0]),
    ("D", [50.0, 0.0, 50.0, 0.0]),
    ("E", [70.0, 0.0, 70.0, 180.0]),
];

pub const COOK_TORRANCE: SphereFigure = SphereFigure {
    number: "3.7",
    title: "Cook-Torrance: plastic and copper",
    caption: "Plastic: k_d = 0.8, k_s = 0.2, m = 0.15, η = 1.49, its highlight white. Copper: k_d = 0, k_s = 0.8, m = 0.25, η = 1.0, κ = 2.39, scalar as in the survey, \
              then with the reflectance 0.955, 0.638, 0.538 at normal incidence and (3.13): its highlight coloured, towards the outline white.",
    rows: || {
        let copper = "kd=0 ks=0.8 m=0.25 eta=1 kappa=2.39";
        vec![(
            String::new(),
            vec![
                Ball::new("cook-torrance", "kd=0.8 ks=0.2 m=0.15 eta=1.49", "plastic"),
                Ball::new("cook-torrance", copper, "copper, grey"),
                Ball::new("cook-torrance", format!("{copper} fresnel=interpolated f0=0.955,0.638,0.538"), "copper, colour"),
            ],
        )]
    },
    measure: cook_torrance,
};

fn cook_torrance(rows: &Rows) -> Result<Measured, GalleryError> {
    let balls = &rows[0].1;
    let mut measured = Measured::default();
    let golden = [
        (&balls[0], "plastic", [0.286_807_142_9, 0.254_648_038_3, 0.254_647_908_9, 0.254_647_908_9, 1.277_505_997]),
        (&balls[1], "copper", [0.811_157_516_8, 0.018_296_426_3, 1.494_114_244e-4, 9.487_459_857e-10, 5.446_411_467]),
    ];
    for (ball, name, values) in golden {
        for ((set, angles), expected) in SETS.into_iter().zip(values) {
            let found = pixel(ball, angles)?.x;
            measured.checks.push(Check::near(format!("{name}, f at set {set}, 1/sr"), found, expected, 2e-4 * expected));
        }
    }
    for (ball, name, printed, corrected) in [(&balls[0], "plastic", 0.831, 0.808), (&balls[1], "copper", 1.88, 0.470)] {
        for (ball, form, expected, digits) in [(ball.clone().printed(), ", as printed", printed, 5e-3), (ball.clone(), "", corrected, 6e-4)]
        {
            let check = furnace_check(&ball, &format!("{name}{form}"), expected)?;
            measured.checks.push(Check::near(check.what, check.measured, expected, digits));
        }
    }
    // Towards the outline the highlight takes the light's colour.
    let chroma = |theta: f64| -> Result<f64, GalleryError> {
        let f = pixel(&balls[2], [theta, 0.0, theta, 180.0])?;
        Ok((f / f.element_sum() - 1.0 / 3.0).length())
    };
    let series = [60.0, 65.0, 70.0, 75.0, 80.0, 85.0, 88.0].map(chroma).into_iter().collect::<Result<Vec<_>, _>>()?;
    let largest_step = largest(series.windows(2).map(|pair| pair[1] - pair[0]));
    measured.checks.push(Check::at_most("copper's distance from white, largest step from β = 60° to 88°", largest_step, -1e-3));
    measured.checks.push(Check::at_most("copper's distance from white at β = 88° over that at 60°", series[6] / series[0], 0.2));
    let strips = balls.iter().map(|ball| strip(ball, 0.0)).collect::<Result<Vec<_>, _>>()?;
    let named: Vec<(String, &[Sample])> = balls.iter().zip(&strips).map(|(ball, samples)| (ball.label.clone(), &samples[..])).collect();
    measured.curves.push(probe_curves("3.7", "f, 1/sr", &named, grey));
    Ok(measured)
}

const SLOPES: [f64; 5] = [0.6, 0.4, 0.2, 0.1, 0.05];

pub const ROUGHNESS: SphereFigure = SphereFigure {
    number: "3.8",
    title: "Cook-Torrance: the highlight shrinks with m",
    caption: "k_d = k_s = 0.4, η = 1.5; m = 0.6, 0.4, 0.2, 0.1, 0.05.",
    rows: || {
        let ball = |m: f64| Ball::new("cook-torrance", format!("kd=0.4 ks=0.4 eta=1.5 m={m}"), format!("m = {m}"));
        vec![(String::new(), SLOPES.map(ball).into())]
    },
    measure: roughness,
};

fn roughness(rows: &Rows) -> Result<Measured, GalleryError> {
    let balls = &rows[0].1;
    let mut measured = Measured::default();
    let albedos = [(0.4524, 0.4131), (0.4624, 0.4156), (0.4641, 0.4160), (0.4640, 0.4160), (0.4640, 0.4160)];
    for (ball, (printed, corrected)) in balls.iter().zip(albedos) {
        measured.checks.push(furnace_check(&ball.clone().printed(), &format!("{}, as printed", ball.label), printed)?);
        measured.checks.push(furnace_check(ball, &ball.label, corrected)?);
    }
    let strips = balls.iter().map(|ball| strip(ball, 0.0)).collect::<Result<Vec<_>, _>>()?;
    let widths: Vec<f64> = strips
        .iter()
        .map(|samples| {
            half_widths(samples, |sample| grey(sample) - 0.4 * FRAC_1_PI).into_iter().flatten().reduce(f64::min).unwrap_or(f64::NAN)
        })
        .collect();
    let shrinks = largest(widths.windows(2).map(|pair| pair[1] / pair[0]));
    measured.checks.push(Check::at_most("half width over that of the next larger m, largest", shrinks, 0.7));
    let named: Vec<(String, &[Sample])> = balls.iter().zip(&strips).map(|(ball, samples)| (ball.label.clone(), &samples[..])).collect();
    measured.curves.push(probe_curves("3.8", "f, 1/sr", &named, grey));
    Ok(measured)
}

pub const SCHLICK_COOK_TORRANCE: SphereFigure = SphereFigure {
    number: "3.9",
    title: "Cook-Torrance by rational functions: larger highlights",
    caption: "k_d = k_s = 0.4, f = 0.04; m = 0.6, 0.4, 0.2, 0.1, 0.05. Schlick's distribution of facets has a longer tail than Beckmann's of figure 3.8.",
    rows: || {
        let ball = |m: f64| Ball::new("schlick-cook-torrance", format!("kd=0.4 ks=0.4 f0=0.04 m={m}"), format!("m = {m}"));
        vec![(String::new(), SLOPES.map(ball).into())]
    },
    measure: schlick_cook_torrance,
};

fn schlick_cook_torrance(rows: &Rows) -> Result<Measured, GalleryError> {
    let mut measured = Measured::default();
    let cos_beta = 15_f64.to_radians().cos();
    let fresnel = [dielectric(cos_beta, 1.5), schlick_fresnel(cos_beta, 0.04, 0.96)];
    let expected = [[58.07, 82.02], [44.27, 71.91], [24.03, 37.47], [12.23, 17.58], [6.14, 8.64]];
    for ((ball, m), expected) in rows[0].1.iter().zip(SLOPES).zip(expected) {
        let k = schlick_k(m);
        let exact = Ball::new("cook-torrance", format!("kd=0 ks=0.4 eta=1.5 m={m}"), "");
        // D, from a pixel with everything else taken off.
        let d = |kind: usize, sample: &Sample| {
            let [ci, cr] = sample.cosines();
            let g = match kind {
                0 => v_groove(&Geometry::new(vector(sample.wi), vector(sample.wo))),
                _ => schlick_masking(ci, k, 1.0 - k) * schlick_masking(cr, k, 1.0 - k),
            };
            sample.f.x * 4.0 * PI * ci * cr / (0.4 * fresnel[kind] * g)
        };
        for (kind, (name, ball)) in [("Cook-Torrance", &exact), ("Schlick", &ball.with("kd=0"))].into_iter().enumerate() {
            let found = contour(&disc(ball)?, 0.01, |sample| d(kind, sample));
            measured.checks.push(Check::near(format!("{name}, m = {m}: D falls to 1 % at δ, degrees"), found, expected[kind], 0.25));
        }
    }
    let strips = rows[0].1.iter().map(|ball| strip(ball, 0.0)).collect::<Result<Vec<_>, _>>()?;
    let named: Vec<(String, &[Sample])> = rows[0].1.iter().zip(&strips).map(|(ball, samples)| (ball.label.clone(), &samples[..])).collect();
    measured.curves.push(probe_curves("3.9", "f, 1/sr", &named, grey));
    Ok(measured)
}

fn vector(w: glam::DVec3) -> V3<f64> {
    V3::new(w.x, w.y, w.z)
}

/// Where a value that falls with δ alone passes `share` of its largest: between the last pixel above and the first below, degrees.
fn contour(samples: &[Sample], share: f64, value: impl Fn(&Sample) -> f64) -> f64 {
    let points: Vec<(f64, f64)> = samples.iter().map(|sample| (sample.tilt, value(sample))).collect();
    let level = share * points.iter().map(|point| point.1).fold(0.0, f64::max);
    let above = points.iter().filter(|point| point.1 >= level).map(|point| point.0).fold(0.0, f64::max);
    let below = points.iter().filter(|point| point.1 < level).map(|point| point.0).fold(f64::INFINITY, f64::min);
    (above + below) / 2.0
}

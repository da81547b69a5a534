//! Where the lobe's peak goes, and how much of the light is reflected: series over the angle, computed from the models.

use crate::GalleryError;
use crate::check::Check;
use crate::plates::Plate;
use crate::stage::Ball;
use crate::studio::Studio;
use glam::DVec3;
use kajo_bsdf::models::{Kind, Reflectance, V3};
use kajo_bsdf_lab::albedo;
use kajo_bsdf_lab::figures::{Curve, Figure};
use kajo_bsdf_lab::plot::Map;
use rayon::prelude::*;

fn direction(theta: f64, phi: f64) -> DVec3 {
    V3::from_angles(theta.to_radians(), phi.to_radians()).into()
}

/// The inclination of the viewer in the plane of incidence for which f is largest, up to 85°, to a thousandth of a degree.
fn peak(model: &dyn Reflectance, theta_i: f64) -> f64 {
    let wi = direction(theta_i, 0.0);
    let f = |theta: f64| {
        let value = model.value(wi, direction(theta, 180.0)).element_sum();
        if model.kind() == Kind::Bsf { value / wi.z } else { value }
    };
    let best = |from: f64, step: f64, count: u32| {
        let angles = (0..=count).map(|k| (from + step * f64::from(k)).clamp(0.0, 85.0));
        angles.map(|theta| (theta, f(theta))).fold((0.0, 0.0), |most, point| if point.1 > most.1 { point } else { most }).0
    };
    let coarse = best(0.0, 0.1, 850);
    best(coarse - 0.1, 0.001, 200)
}

/// Highlights alone.
fn glossy() -> Vec<Ball> {
    [
        ("phong", "kd=0 ks=1 n=50", "Phong, n = 50"),
        ("ward", "kd=0 ks=1 m=0.2", "Ward, m = 0.2"),
        ("cook-torrance", "kd=0 ks=1 m=0.1 eta=1.5", "Cook-Torrance, m = 0.1"),
        ("cook-torrance", "kd=0 ks=1 m=0.2 eta=1.5", "Cook-Torrance, m = 0.2"),
        ("ashikhmin-shirley", "rs=0.05 rd=0 nx=50 ny=50", "Ashikhmin-Sh., n = 50"),
        ("schlick-single", "c=0.6 r=0.1 directional=simple", "Schlick, r = 0.1"),
        ("ggx", "alpha=0.2 f0=0.04", "GGX, alpha = 0.2"),
        ("lafortune", "kd=0 ks=1 lobe=-1,-1,0.8,20", "Lafortune (-1,-1,0.8), n = 20"),
    ]
    .map(|(model, params, label)| Ball::new(model, params, label))
    .into()
}

/// What the survey's digest knows of peaks: model, inclination of the light, inclination of the peak, tolerance.
const PEAKS: [(&str, f64, f64, f64); 14] = [
    ("Phong, n = 50", 30.0, 30.0, 2e-3),
    ("Phong, n = 50", 60.0, 60.0, 2e-3),
    ("Ward, m = 0.2", 30.0, 31.4, 0.06),
    ("Ward, m = 0.2", 45.0, 47.5, 0.06),
    ("Cook-Torrance, m = 0.1", 30.0, 30.89, 0.02),
    ("Cook-Torrance, m = 0.1", 45.0, 47.09, 0.02),
    ("Cook-Torrance, m = 0.1", 60.0, 64.43, 0.02),
    ("Cook-Torrance, m = 0.1", 75.0, 85.0, 0.02),
    ("Cook-Torrance, m = 0.2", 30.0, 34.39, 0.02),
    ("Cook-Torrance, m = 0.2", 45.0, 57.73, 0.02),
    ("Lafortune (-1,-1,0.8), n = 20", 30.0, 35.82, 0.02),
    ("Lafortune (-1,-1,0.8), n = 20", 45.0, 51.34, 0.02),
    ("Lafortune (-1,-1,0.8), n = 20", 60.0, 65.21, 0.02),
    ("Lafortune (-1,-1,0.8), n = 20", 75.0, 77.90, 0.02),
];

fn peak_checks() -> Vec<Check> {
    let balls = glossy();
    let model = |label: &str| balls.iter().find(|ball| ball.label == label).expect("a model of the list").prepare().reflectance;
    PEAKS
        .iter()
        .map(|(label, theta_i, expected, within)| {
            Check::near(format!("{label}: peak for light from {theta_i}°, degrees"), peak(&*model(label), *theta_i), *expected, *within)
        })
        .collect()
}

/// Off-specular peaks.
pub fn off_specular(studio: &mut Studio) -> Result<Plate, GalleryError> {
    let curve = |ball: &Ball| {
        let model = ball.prepare().reflectance;
        let points = (0..=32).map(|k| f64::from(k) * 2.5).map(|theta| [theta, peak(&*model, theta) - theta]);
        Curve { name: ball.label.clone(), points: points.collect() }
    };
    let figure = Figure {
        name: "off_specular".into(),
        title: "The lobe's peak past the mirror direction".into(),
        axes: ["inclination of the light, degrees".into(), "peak of f past the mirror direction, degrees".into()],
        curves: glossy().par_iter().map(curve).collect(),
        equal_scales: false,
    };
    let shown = vec![studio.curves(&figure)?];
    let parameters = glossy().iter().map(|ball| format!("{}: {} {}", ball.label, ball.model, ball.params)).collect();
    Ok(Plate { shown, parameters, checks: peak_checks(), ..Plate::new("off_specular", "Off-specular peaks", OFF_SPECULAR) })
}

const OFF_SPECULAR: &str = "On rough surfaces f is largest not in the mirror direction but beyond it: facets that are turned away reflect at a larger angle, and fewer of them are in the way. \
    Phong's model knows nothing of it. Sought up to 85°, where some peaks stay; the largest possible shift falls from there.";

/// A model over one of its numbers.
struct Study {
    name: &'static str,
    title: &'static str,
    ball: fn(f64) -> Ball,
    parameter: &'static str,
    values: &'static [f64],
}

const STUDIES: [Study; 6] = [
    Study {
        name: "phong",
        title: "Phong, k_s = 1",
        ball: |n| Ball::new("phong", format!("kd=0 ks=1 n={n}"), ""),
        parameter: "exponent n",
        values: &[1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0],
    },
    Study {
        name: "cook-torrance",
        title: "Cook-Torrance, k_s = 1, F = 1",
        ball: |m| Ball::new("cook-torrance", format!("kd=0 ks=1 fresnel=none m={m}"), ""),
        parameter: "slope m",
        values: &[0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8],
    },
    Study {
        name: "ward",
        title: "Ward, rho_s = 1",
        ball: |m| Ball::new("ward", format!("kd=0 ks=1 m={m}"), ""),
        parameter: "slope m",
        values: &[0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8],
    },
    Study {
        name: "schlick-single",
        title: "Schlick, one layer, C = 1",
        ball: |r| Ball::new("schlick-single", format!("c=1 r={r}"), ""),
        parameter: "roughness r",
        values: &[0.05, 0.1, 0.2, 0.3, 0.4, 0.6, 0.8, 1.0],
    },
    Study {
        name: "ashikhmin-shirley",
        title: "Ashikhmin-Shirley, R_s = 0.05, R_d = 1",
        ball: |n| Ball::new("ashikhmin-shirley", format!("rs=0.05 rd=1 nx={n} ny={n}"), ""),
        parameter: "exponent n",
        values: &[1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0],
    },
    Study {
        name: "ggx",
        title: "GGX, f0 = 1",
        ball: |alpha| Ball::new("ggx", format!("f0=1 alpha={alpha}"), ""),
        parameter: "alpha",
        values: &[0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0],
    },
];

fn map(study: &Study) -> Map {
    let angles: Vec<f64> = (0..18).map(|k| f64::from(k) * 5.0).collect();
    let row = |value: &f64| {
        let model = (study.ball)(*value).prepare().reflectance;
        angles.iter().map(|&theta| albedo(&*model, direction(theta, 0.0), 3e-4).x).collect::<Vec<_>>()
    };
    Map {
        name: format!("albedo_{}", study.name),
        title: format!("{}: directional albedo", study.title),
        axes: ["view from the normal, degrees".into(), study.parameter.into(), "albedo".into()],
        values: study.values.par_iter().map(row).collect::<Vec<_>>().concat(),
        x: angles,
        y: study.values.into(),
    }
}

/// Directional albedo over the angle and a parameter.
pub fn albedo_maps(studio: &mut Studio) -> Result<Plate, GalleryError> {
    let mut shown = Vec::new();
    for (k, study) in STUDIES.iter().enumerate() {
        shown.push(studio.map(&map(study))?);
        studio.advance((k + 1) as f64 / STUDIES.len() as f64)?;
    }
    Ok(Plate { shown, ..Plate::new("albedo_maps", "Albedo over the angle and a parameter", MAPS) })
}

const MAPS: &str = "How much of the light from everywhere leaves towards a viewer, by quadrature, for the whitest parameters: yellow is all of it, red more than all.";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn peaks_are_where_they_are_known_to_be() {
        let checks = peak_checks();
        assert!(checks.iter().all(|check| check.holds), "{:#?}", checks.iter().filter(|check| !check.holds).collect::<Vec<_>>());
        let other = Ball::new("cook-torrance", "kd=0 ks=1 m=0.21 eta=1.5", "").prepare().reflectance;
        assert!((peak(&*other, 30.0) - 34.39).abs() > 0.02, "planted fault");
    }

    /// The table of section 3.3: Phong's specular albedo for n = 50.
    #[test]
    fn maps_hold_albedos() {
        let map = map(&STUDIES[0]);
        let row = map.y.iter().position(|n| *n == 50.0).unwrap();
        for (theta, expected) in [(0.0, 1.0), (30.0, 0.8660), (60.0, 0.5), (75.0, 0.2605), (85.0, 0.1101)] {
            let column = map.x.iter().position(|x| *x == theta).unwrap();
            let found = map.values[row * map.x.len() + column];
            assert!((found - expected).abs() < 1e-3, "{theta}: {found}");
        }
    }
}

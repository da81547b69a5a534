//! Chapter 2: Lambert, Phong, Blinn-Phong.

use super::{Measured, SphereFigure, furnace_check, grey, probe_curves};
use crate::GalleryError;
use crate::check::{Check, largest};
use crate::probe::{Sample, half_widths, strip};
use crate::stage::{Ball, SPACING, Stage, Sun};
use glam::{UVec2, Vec3};
use std::f64::consts::FRAC_1_PI;

type Rows = [(String, Vec<Ball>)];

/// The exponents of figures 2.3 and 2.4, with the half width of cosⁿ in degrees.
const EXPONENTS: [(u32, f64); 5] = [(3, 37.47), (5, 29.48), (10, 21.09), (50, 9.52), (200, 4.77)];

pub const LAMBERT: SphereFigure = SphereFigure {
    number: "2.1",
    title: "Lambert: brightness is linear in k_d",
    caption: "k_d = 0.2, 0.4, 0.6, 0.8, 1.0. Under the light alone, pixels at the same place of the spheres are as 1 : 2 : 3 : 4 : 5.",
    rows: || {
        let ball = |k: u32| Ball::new("lambert", format!("kd={}", f64::from(k) / 5.0), format!("k_d = {:.1}", f64::from(k) / 5.0));
        vec![(String::new(), (1..=5).map(ball).collect())]
    },
    measure: lambert,
};

/// The whole row in one level picture of 64 pixels a metre: spheres are 160 pixels apart.
fn lambert(rows: &Rows) -> Result<Measured, GalleryError> {
    const PITCH: f32 = 1.0 / 64.0;
    let balls = &rows[0].1;
    let middle = Vec3::new(2.0 * SPACING, 1.0, 0.0);
    let size = UVec2::new(1024, 256);
    let stage = Stage::row(balls).sun(Sun { off_axis: 30.0, azimuth: 135.0 });
    let image = stage.orthographic(middle + Vec3::Z * 5.0, middle, Vec3::Y, size.y as f32 * PITCH).direct(size)?;
    let apart = (SPACING / PITCH) as u32;
    let left = 512 - 2 * apart - 64;
    let mut checks = Vec::new();
    for k in 1..5 {
        let mut deviations = Vec::new();
        for (x, y) in (0..128).flat_map(|y| (0..128).map(move |x| (left + x, 64 + y))) {
            let [one, other] = [0, k].map(|k| f64::from(image.get(x + k * apart, y).0.x));
            // The disc, where the light reaches.
            let inside = (f64::from(x - left) - 63.5).hypot(f64::from(y) - 127.5) < 63.0;
            if inside && one > 0.01 {
                deviations.push((other / one / f64::from(k + 1) - 1.0).abs());
            }
        }
        // Spheres in different places have differently rounded corners, which tells most where the light grazes.
        checks.push(Check::at_most(format!("pixels against 1 : {}, largest relative deviation", k + 1), largest(deviations), 1e-4));
    }
    let strips: Vec<(String, Vec<Sample>)> =
        balls.iter().map(|ball| Ok((ball.label.clone(), strip(ball, 0.0)?))).collect::<Result<_, GalleryError>>()?;
    let named: Vec<(String, &[Sample])> = strips.iter().map(|(name, samples)| (name.clone(), &samples[..])).collect();
    let curves = vec![probe_curves("2.1", "radiance under the light alone", &named, |sample| sample.radiance.x)];
    Ok(Measured { checks, curves })
}

pub const PHONG: SphereFigure = SphereFigure {
    number: "2.3",
    title: "Phong: k_s makes the highlight strong, n makes it small",
    caption: "k_d = 0.4; rows k_s = 0.2, 0.4, 0.6; columns n = 3, 5, 10, 50, 200. The ground's reflection grows downwards, the highlight shrinks to the right.",
    rows: || {
        let ball = |ks: f64, n: u32| Ball::new("phong", format!("kd=0.4 ks={ks} n={n}"), format!("n = {n}"));
        [0.2, 0.4, 0.6].map(|ks| (format!("k_s = {ks}"), EXPONENTS.map(|(n, _)| ball(ks, n)).into())).into()
    },
    measure: phong,
};

fn phong(rows: &Rows) -> Result<Measured, GalleryError> {
    let mut measured = Measured::default();
    for ((name, balls), total) in rows.iter().zip([0.6, 0.8, 1.0]) {
        let mut strips = Vec::new();
        for (ball, (n, expected)) in balls.iter().zip(EXPONENTS) {
            let samples = strip(ball, 0.0)?;
            // Turning the normal by x turns the mirror direction by 2x.
            let found = 2.0 * mean_half_width(&samples);
            measured.checks.push(Check::near(
                format!("{name}, n = {n}: half of the highlight's peak at α, degrees"),
                found,
                expected,
                0.02,
            ));
            measured.checks.push(furnace_check(ball, &format!("{name}, n = {n}"), total)?);
            strips.push((ball.label.clone(), samples));
        }
        let named: Vec<(String, &[Sample])> = strips.iter().map(|(name, samples)| (name.clone(), &samples[..])).collect();
        let mut figure = probe_curves("2.3", "f, 1/sr", &named, grey);
        figure.name += &format!("_{}", name.replace(['_', ' ', '='], ""));
        figure.title += &format!(", {name}");
        measured.curves.push(figure);
    }
    Ok(measured)
}

/// Of the highlight over a diffuse 0.4/π.
fn mean_half_width(samples: &[Sample]) -> f64 {
    let [left, right] = half_widths(samples, |sample| grey(sample) - 0.4 * FRAC_1_PI).map(|width| width.unwrap_or(f64::NAN));
    (left + right) / 2.0
}

pub const BLINN_PHONG: SphereFigure = SphereFigure {
    number: "2.4",
    title: "Blinn-Phong: another size for the same n",
    caption: "k_d = k_s = 0.4; n = 3, 5, 10, 50, 200. The highlight is twice as wide as Phong's for the same n. Shown normalised; the survey's factor reflects up to 1.97 times the light at normal incidence.",
    rows: || {
        let ball = |n: u32| Ball::new("blinn-phong", format!("kd=0.4 ks=0.4 n={n}"), format!("n = {n}"));
        vec![(String::new(), EXPONENTS.map(|(n, _)| ball(n)).into())]
    },
    measure: blinn_phong,
};

fn blinn_phong(rows: &Rows) -> Result<Measured, GalleryError> {
    let mut measured = Measured::default();
    let mut strips = Vec::new();
    let printed = [1.167, 1.320, 1.546, 1.882, 1.969];
    for ((ball, (n, _)), printed) in rows[0].1.iter().zip(EXPONENTS).zip(printed) {
        let samples = strip(ball, 0.0)?;
        let phongs = strip(&Ball { model: "phong", ..ball.clone() }, 0.0)?;
        let ratio = mean_half_width(&samples) / mean_half_width(&phongs);
        measured.checks.push(Check::near(format!("n = {n}: half width over Phong's"), ratio, 2.0, 0.01));
        let mut as_printed = furnace_check(&ball.clone().printed(), &format!("n = {n}, as printed"), printed)?;
        // Three digits are given.
        if let crate::check::Expected::Near { value, within } = as_printed.expected {
            as_printed = Check::near(as_printed.what, as_printed.measured, value, within + 5e-4);
        }
        measured.checks.push(as_printed);
        measured.checks.push(furnace_check(ball, &format!("n = {n}"), 0.8)?);
        strips.push((ball.label.clone(), samples));
    }
    let named: Vec<(String, &[Sample])> = strips.iter().map(|(name, samples)| (name.clone(), &samples[..])).collect();
    measured.curves.push(probe_curves("2.4", "f, 1/sr", &named, grey));
    Ok(measured)
}

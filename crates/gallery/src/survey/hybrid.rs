//! Chapter 4: Strauss, Ward, Schlick, Ashikhmin-Shirley.

use super::{Measured, SphereFigure, grey, probe_curves};
use crate::GalleryError;
use crate::check::{Check, largest};
use crate::probe::{Sample, half_widths, pixel, strip};
use crate::stage::Ball;
use glam::DVec3;
use kajo_sampling::Rng;
use std::f64::consts::{FRAC_1_PI, FRAC_PI_2, PI};

type Rows = [(String, Vec<Ball>)];

const SHARES: [f64; 5] = [0.1, 0.3, 0.5, 0.7, 0.9];

pub const SMOOTHNESS: SphereFigure = SphereFigure {
    number: "4.1",
    title: "Strauss: one smoothness for share and size of the highlight",
    caption: "s = 0.1, 0.3, 0.5, 0.7, 0.9. The survey gives no more; here the colour is 0.75, 0.25, 0.15, the metalness e = 0.5, nothing is transmitted.",
    rows: || {
        let ball = |s: f64| Ball::new("strauss", format!("c=0.75,0.25,0.15 e=0.5 t=0 s={s}"), format!("s = {s}"));
        vec![(String::new(), SHARES.map(ball).into())]
    },
    measure: smoothness,
};

/// Strauss's F (4.10) and G (4.11) of an angle in rad.
fn strauss_terms(theta: f64) -> [f64; 2] {
    let x = theta / FRAC_PI_2;
    let inverse = |x: f64, k: f64| (x - k).powi(-2);
    [
        (inverse(x, 1.12) - inverse(0.0, 1.12)) / (inverse(1.0, 1.12) - inverse(0.0, 1.12)),
        (inverse(1.0, 1.01) - inverse(x, 1.01)) / (inverse(1.0, 1.01) - inverse(0.0, 1.01)),
    ]
}

fn smoothness(rows: &Rows) -> Result<Measured, GalleryError> {
    let mut measured = Measured::default();
    let (colour, e) = (0.75, 0.5);
    let expected = [(10.0 / 3.0, 0.999), (30.0 / 7.0, 0.973), (6.0, 0.875), (10.0, 0.657), (30.0, 0.271)];
    let mut strips = Vec::new();
    for ((ball, s), (h, rho_d)) in rows[0].1.iter().zip(SHARES).zip(expected) {
        // S of the red channel; the highlight ends 90° from the mirror direction, and is at 0.4 of its peak at the second pair.
        let bsf = |angles: [f64; 4]| Ok::<_, GalleryError>(pixel(ball, angles)?.x * PI * angles[0].to_radians().cos());
        let (theta_i, alpha) = (30_f64.to_radians(), 0.4_f64.powf(1.0 / h).acos());
        let diffuse = bsf([30.0, 0.0, 70.0, 0.0])?;
        let found_rho = diffuse / (colour * theta_i.cos() * (1.0 - e * s));
        measured.checks.push(Check::near(format!("s = {s}: ρ_d where the highlight does not reach"), found_rho, rho_d, 1e-4));
        let ([f, g_i], [_, g_r]) = (strauss_terms(theta_i), strauss_terms(theta_i + alpha));
        let r_n = s.powi(3);
        let strength = (r_n + (r_n + 0.1) * f * g_i * g_r).min(1.0) * (1.0 + e * (1.0 - f) * (colour - 1.0));
        let specular = bsf([30.0, 0.0, 30.0 + alpha.to_degrees(), 180.0])? - diffuse;
        let found_h = (specular / strength).ln() / alpha.cos().ln();
        measured.checks.push(Check::near(format!("s = {s}: exponent h of the highlight"), found_h, h, 5e-3 * h));
        strips.push((ball.label.clone(), strip(ball, 0.0)?));
    }
    let named: Vec<(String, &[Sample])> = strips.iter().map(|(name, samples)| (name.clone(), &samples[..])).collect();
    measured.curves.push(probe_curves("4.1", "S of the red channel", &named, |sample| sample.radiance.x));
    Ok(measured)
}

pub const METALNESS: SphereFigure = SphereFigure {
    number: "4.2",
    title: "Strauss: metalness colours the highlight",
    caption: "e = 0.1, 0.3, 0.5, 0.7, 0.9. The survey gives no more; here the colour is 1, 0.7, 0.25 and s = 0.6.",
    rows: || {
        let ball = |e: f64| Ball::new("strauss", format!("c=1,0.7,0.25 s=0.6 t=0 e={e}"), format!("e = {e}"));
        vec![(String::new(), SHARES.map(ball).into())]
    },
    measure: metalness,
};

fn metalness(rows: &Rows) -> Result<Measured, GalleryError> {
    let mut measured = Measured::default();
    let s: f64 = 0.6;
    let expected = [[0.97, 0.983_83], [0.91, 0.951_49], [0.85, 0.919_16], [0.79, 0.886_82], [0.73, 0.854_48]];
    for ((ball, e), expected) in rows[0].1.iter().zip(SHARES).zip(expected) {
        for (theta, expected) in [0.0, 85.0].into_iter().zip(expected) {
            // S from f = S/(π cos θ_i), then the highlight of the channels with C = 1, whose colour is 1, and C = 0.7.
            let bsf = pixel(ball, [theta, 0.0, theta, 180.0])? * (PI * theta.to_radians().cos());
            let diffuse = theta.to_radians().cos() * (1.0 - s.powi(3)) * (1.0 - e * s);
            let found = (bsf.y - 0.7 * diffuse) / (bsf.x - diffuse);
            measured.checks.push(Check::near(
                format!("e = {e}: colour c_s of the highlight for C = 0.7 at {theta}°"),
                found,
                expected,
                1e-4,
            ));
        }
    }
    let strips = rows[0].1.iter().map(|ball| strip(ball, 0.0)).collect::<Result<Vec<_>, _>>()?;
    let named: Vec<(String, &[Sample])> = rows[0].1.iter().zip(&strips).map(|(ball, samples)| (ball.label.clone(), &samples[..])).collect();
    measured.curves.push(probe_curves("4.2", "S, blue over red", &named, |sample| sample.radiance.z / sample.radiance.x));
    Ok(measured)
}

/// A grid over two numbers of a model, `by` down and `across`.
fn grid(values: [f64; 4], ball: impl Fn(f64, f64) -> Ball, names: [&str; 2]) -> Vec<(String, Vec<Ball>)> {
    values
        .map(|y| {
            let row = values.map(|x| Ball { label: format!("{} = {x}", names[0]), ..ball(x, y) });
            (format!("{} = {y}", names[1]), row.into())
        })
        .into()
}

const WARD_SLOPES: [f64; 4] = [0.05, 0.1, 0.2, 0.4];

pub const WARD: SphereFigure = SphereFigure {
    number: "4.3",
    title: "Ward: elliptic highlights",
    caption: "ρ_d = ρ_s = 0.4; m_x along the parallels grows to the right, m_y along the meridians downwards: 0.05, 0.1, 0.2, 0.4 (the survey gives no values).",
    rows: || grid(WARD_SLOPES, |mx, my| Ball::new("ward", format!("kd=0.4 ks=0.4 mx={mx} my={my}"), ""), ["m_x", "m_y"]),
    measure: ward,
};

/// Half widths along the parallel and along the meridian, rad: `value` is the highlight without what is not its shape.
fn axes(ball: &Ball, value: impl Fn(&Sample) -> f64) -> Result<[f64; 2], GalleryError> {
    let axis = |azimuth| -> Result<f64, GalleryError> {
        let widths = half_widths(&strip(ball, azimuth)?, &value).map(|width| width.unwrap_or(f64::NAN));
        Ok((widths[0] + widths[1]).to_radians() / 2.0)
    };
    Ok([axis(0.0)?, axis(90.0)?])
}

fn ward(rows: &Rows) -> Result<Measured, GalleryError> {
    let mut measured = Measured::default();
    let mut deviations = Vec::new();
    for (my, (_, balls)) in WARD_SLOPES.into_iter().zip(rows) {
        for (mx, ball) in WARD_SLOPES.into_iter().zip(balls) {
            let widths = axes(ball, |sample| (grey(sample) - 0.4 * FRAC_1_PI) * (sample.wi.z * sample.wo.z).sqrt())?;
            let ratio = widths[1].tan() / widths[0].tan();
            deviations.push((ratio / (my / mx) - 1.0).abs());
            if my >= mx {
                measured.checks.push(Check::near(
                    format!("m_x = {mx}, m_y = {my}: highlight along y over along x"),
                    ratio,
                    my / mx,
                    0.01 * my / mx,
                ));
            }
        }
    }
    measured.checks.push(Check::at_most("axis ratio against m_y/m_x, largest relative deviation of 16", largest(deviations), 0.01));
    measured.checks.push(Check::at_most(
        "m_x and m_y exchanged against a quarter turn, largest relative difference",
        exchange(&rows[1].1[3], &rows[3].1[1]),
        1e-12,
    ));
    let (one, other) = (strip(&rows[1].1[3], 0.0)?, strip(&rows[3].1[1], 90.0)?);
    let apart = largest(one.iter().zip(&other).map(|(a, b)| (a.f.x / b.f.x - 1.0).abs()));
    measured.checks.push(Check::at_most("the same on the pixels of two spheres, single precision", apart, 2e-3));
    let named = [("m_x = 0.4, m_y = 0.1, along x".to_owned(), &one[..])];
    let across = strip(&rows[1].1[3], 90.0)?;
    let named: Vec<(String, &[Sample])> = named.into_iter().chain([("along y".to_owned(), &across[..])]).collect();
    measured.curves.push(probe_curves("4.3", "f, 1/sr", &named, grey));
    Ok(measured)
}

/// Two models over random pairs of directions, the second turned by 90°: the largest relative difference.
fn exchange(one: &Ball, other: &Ball) -> f64 {
    let mut rng = Rng::new(1);
    let (one, other) = (one.prepare().reflectance, other.prepare().reflectance);
    let turned = |w: DVec3| DVec3::new(-w.y, w.x, w.z);
    let mut direction = || {
        let (z, phi) = (0.05 + 0.95 * f64::from(rng.next_1d()), 2.0 * PI * f64::from(rng.next_1d()));
        let r = (1.0 - z * z).sqrt();
        DVec3::new(r * phi.cos(), r * phi.sin(), z)
    };
    let pairs: Vec<[DVec3; 2]> = (0..20_000).map(|_| [direction(), direction()]).collect();
    let difference = |[wi, wo]: &[DVec3; 2]| (one.value(*wi, *wo).x / other.value(turned(*wi), turned(*wo)).x - 1.0).abs();
    largest(pairs.iter().map(difference))
}

/// Schlick's reflectance of the layer at normal incidence, which the survey does not give.
const SCHLICK_C: f64 = 0.6;

pub const ROUGHNESS: SphereFigure = SphereFigure {
    number: "4.5",
    title: "Schlick: from diffuse to mirror",
    caption: "One layer, C = 0.6 (not given by the survey), isotropic; r = 0.8, 0.4, 0.2, 0.1, 0.01, 0.001.",
    rows: || {
        let ball = |r: f64| Ball::new("schlick-single", format!("c={SCHLICK_C} p=1 r={r}"), format!("r = {r}"));
        vec![(String::new(), [0.8, 0.4, 0.2, 0.1, 0.01, 0.001].map(ball).into())]
    },
    measure: schlick_roughness,
};

/// Z·A of one layer's pixel: the spectral factor and the blocked light taken off.
fn zenith_azimuth(sample: &Sample, r: f64) -> f64 {
    let spectral = SCHLICK_C + (1.0 - SCHLICK_C) * (1.0 - 15_f64.to_radians().cos()).powi(5);
    let [ci, cr] = sample.cosines();
    let g = [ci, cr].map(|cos| cos / (r - r * cos + cos)).into_iter().product::<f64>();
    (sample.f.x / spectral - (1.0 - g) * FRAC_1_PI) * 4.0 * PI * ci * cr / g
}

fn schlick_roughness(rows: &Rows) -> Result<Measured, GalleryError> {
    let mut measured = Measured::default();
    let mut strips = Vec::new();
    let expected = [(0.8, None), (0.4, Some(31.70)), (0.2, Some(18.77)), (0.1, Some(12.39)), (0.01, Some(3.709)), (0.001, Some(1.167))];
    for (ball, (r, half)) in rows[0].1.iter().zip(expected) {
        let samples = strip(ball, 0.0)?;
        let widths = half_widths(&samples, |sample| zenith_azimuth(sample, r));
        if let Some(half) = half {
            let found = widths.into_iter().flatten().sum::<f64>() / 2.0;
            measured.checks.push(Check::near(format!("r = {r}: half of Z's peak at δ, degrees"), found, half, 0.005 * half));
        } else {
            let at = |tilt: f64| samples.iter().min_by(|a, b| (a.tilt - tilt).abs().total_cmp(&(b.tilt - tilt).abs()));
            let (Some(peak), Some(last)) = (at(0.0), at(-60.0)) else { continue };
            // Z(δ)/Z(0) = r²/(1 − (1 − r) cos²δ)², r² at the horizon.
            let to_horizon = (1.0 - (1.0 - r) * last.delta().cos().powi(2)).powi(2);
            let found = zenith_azimuth(last, r) / zenith_azimuth(peak, r) * to_horizon;
            measured.checks.push(Check::at_most(
                "r = 0.8: places where Z is below half of its peak",
                widths.into_iter().flatten().count() as f64,
                0.0,
            ));
            measured.checks.push(Check::near("r = 0.8: Z at the horizon over Z at the normal, from a pixel at 60°", found, 0.64, 2e-3));
        }
        strips.push((ball.label.clone(), samples));
    }
    let named: Vec<(String, &[Sample])> = strips.iter().take(5).map(|(name, samples)| (name.clone(), &samples[..])).collect();
    measured.curves.push(probe_curves("4.5", "f, 1/sr", &named, grey));
    Ok(measured)
}

pub const ISOTROPY: SphereFigure = SphereFigure {
    number: "4.6",
    title: "Schlick: from isotropic to brushed",
    caption: "One layer, C = 0.6 (not given by the survey), r = 0.4; p = 1, 0.6, 0.3, 0.1, 0.05, 0.001: the highlight becomes a line along the meridian.",
    rows: || {
        let ball = |p: f64| Ball::new("schlick-single", format!("c={SCHLICK_C} r=0.4 p={p}"), format!("p = {p}"));
        vec![(String::new(), [1.0, 0.6, 0.3, 0.1, 0.05, 0.001].map(ball).into())]
    },
    measure: schlick_isotropy,
};

fn schlick_isotropy(rows: &Rows) -> Result<Measured, GalleryError> {
    let mut measured = Measured::default();
    let mut strips = Vec::new();
    for (ball, p) in rows[0].1.iter().zip([1.0, 0.6, 0.3, 0.1, 0.05, 0.001]) {
        let (along_x, along_y) = (strip(ball, 0.0)?, strip(ball, 90.0)?);
        let value = |samples: &[Sample]| {
            let at = samples.iter().min_by(|a, b| (a.tilt + 20.0).abs().total_cmp(&(b.tilt + 20.0).abs()));
            at.map_or(f64::NAN, |sample| zenith_azimuth(sample, 0.4))
        };
        let found = value(&along_y) / value(&along_x);
        measured.checks.push(Check::near(format!("p = {p}: largest over smallest A, at δ = 20°"), found, 1.0 / p, 0.01 / p));
        strips.push((ball.label.clone(), along_y));
    }
    let named: Vec<(String, &[Sample])> = strips.iter().map(|(name, samples)| (name.clone(), &samples[..])).collect();
    measured.curves.push(probe_curves("4.6", "f along the meridian, 1/sr", &named[..5], grey));
    Ok(measured)
}

const EXPONENTS: [f64; 4] = [10.0, 100.0, 1000.0, 10_000.0];

pub const ASHIKHMIN_SHIRLEY: SphereFigure = SphereFigure {
    number: "4.7",
    title: "Ashikhmin-Shirley: an anisotropic Phong",
    caption: "R_s = R_d = 0.4; n_x grows to the right, n_y downwards: 10, 100, 1000, 10 000 (the survey gives no values).",
    rows: || grid(EXPONENTS, |nx, ny| Ball::new("ashikhmin-shirley", format!("rs=0.4 rd=0.4 nx={nx} ny={ny}"), ""), ["n_x", "n_y"]),
    measure: ashikhmin_shirley,
};

fn ashikhmin_shirley(rows: &Rows) -> Result<Measured, GalleryError> {
    let mut measured = Measured::default();
    // cosⁿδ = ½ at δ √n → √(2 ln 2).
    let limit = (2.0 * 2_f64.ln()).sqrt();
    let mut deviations = Vec::new();
    for (ny, (_, balls)) in EXPONENTS.into_iter().zip(rows) {
        for (nx, ball) in EXPONENTS.into_iter().zip(balls) {
            let widths = axes(&ball.with("rd=0"), |sample| sample.f.x * sample.wi.z.max(sample.wo.z))?;
            for (width, n) in widths.into_iter().zip([nx, ny]) {
                deviations.push((width * n.sqrt() / limit - 1.0).abs());
            }
            if nx == ny {
                for (width, axis) in widths.into_iter().zip(["x", "y"]) {
                    measured.checks.push(Check::near(
                        format!("n = {nx}: half width along {axis} times √n"),
                        width * nx.sqrt(),
                        limit,
                        0.015 * limit,
                    ));
                }
            }
        }
    }
    measured.checks.push(Check::at_most(
        "half width times √n against √(2 ln 2), largest relative deviation of 32",
        largest(deviations),
        0.015,
    ));
    let strips = [0.0, 90.0].map(|azimuth| strip(&rows[1].1[0], azimuth)).into_iter().collect::<Result<Vec<_>, _>>()?;
    let names = ["n_x = 10, n_y = 100, along x", "along y"];
    let named: Vec<(String, &[Sample])> = names.iter().zip(&strips).map(|(name, samples)| ((*name).to_owned(), &samples[..])).collect();
    measured.curves.push(probe_curves("4.7", "f, 1/sr", &named, grey));
    Ok(measured)
}

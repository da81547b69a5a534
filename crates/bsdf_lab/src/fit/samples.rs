//! Values to fit to: of a model over a grid of directions, or of a table.

use super::FitError;
use crate::checks::from_degrees;
use glam::DVec3;
use kajo_bsdf::models::{Kind, Reflectance};
use kajo_sampling::Rng;
use std::f64::consts::{FRAC_1_PI, TAU};

/// f for one pair of directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// To the light.
    pub wi: DVec3,
    /// To the viewer.
    pub wo: DVec3,
    /// f, 1/sr.
    pub f: DVec3,
    /// Inclination of the light, degrees: what reports are sorted by.
    pub theta_i: f64,
}

impl Sample {
    /// cos θ_i cos θ_r.
    pub fn weight(&self) -> f64 {
        self.wi.z.max(0.0) * self.wo.z.max(0.0)
    }
}

/// Directions of light and viewer, degrees. Azimuths of the viewer count from the forward direction, φ_i + 180°.
#[derive(Clone, Debug)]
pub struct Grid {
    /// Inclinations of the light.
    pub theta_i: Vec<f64>,
    /// Azimuths of the light.
    pub phi_i: Vec<f64>,
    /// Inclinations of the viewer.
    pub theta_r: Vec<f64>,
    /// Azimuths of the viewer from the forward direction.
    pub offset: Vec<f64>,
}

impl Default for Grid {
    /// Light at 0°, 15° … 75°, viewer at 0°, 10° … 80°, azimuths dense about the forward direction; light along x, along y and between.
    fn default() -> Self {
        let steps = |count: u32, step: f64| (0..count).map(|i| f64::from(i) * step).collect();
        Self {
            theta_i: steps(6, 15.0),
            phi_i: vec![0.0, 45.0, 90.0],
            theta_r: steps(9, 10.0),
            offset: vec![0.0, 10.0, 20.0, 30.0, 45.0, 60.0, 90.0, 120.0, 150.0, 180.0],
        }
    }
}

/// f as a renderer uses it: a shading function S is S/(π cos θ_i).
pub(super) fn reflected(model: &dyn Reflectance, wi: DVec3, wo: DVec3) -> DVec3 {
    let value = model.value(wi, wo);
    match model.kind() {
        Kind::Brdf => value,
        Kind::Bsf => value * (FRAC_1_PI / wi.z.max(1e-9)),
    }
}

/// A target.
#[derive(Clone, Debug)]
pub struct Samples {
    samples: Vec<Sample>,
}

impl Samples {
    /// A model over a grid.
    pub fn of_model(model: &dyn Reflectance, grid: &Grid) -> Self {
        let mut samples = Vec::new();
        for &theta_i in &grid.theta_i {
            for &phi_i in &grid.phi_i {
                let wi = from_degrees(theta_i, phi_i);
                for &theta_r in &grid.theta_r {
                    samples.extend(grid.offset.iter().map(|offset| {
                        let wo = from_degrees(theta_r, phi_i + 180.0 + offset);
                        Sample { wi, wo, f: reflected(model, wi, wo), theta_i }
                    }));
                }
            }
        }
        Self { samples }
    }

    /// A table with a line of names, `theta_i,phi_i,theta_r,phi_r,f` in any order, degrees and 1/sr; `f_r,f_g,f_b` in place of `f` for colours. Empty lines
    /// and lines after `#` are skipped.
    ///
    /// # Errors
    /// [`FitError::Table`]: a missing column, a word that is no number, a direction that is not above the surface, a negative value.
    pub fn from_csv(text: &str) -> Result<Self, FitError> {
        let mut lines = text
            .lines()
            .enumerate()
            .map(|(index, line)| (index + 1, line.trim_start_matches('\u{feff}').trim()))
            .filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
        let Some((line, head)) = lines.next() else {
            return Err(FitError::Table { line: 1, problem: "there is nothing; give theta_i,phi_i,theta_r,phi_r,f".into() });
        };
        let names: Vec<&str> = head.split(',').map(str::trim).collect();
        let column = |name: &str| {
            names.iter().position(|n| *n == name).ok_or_else(|| FitError::Table {
                line,
                problem: format!("no column `{name}` in `{head}`; name the columns theta_i,phi_i,theta_r,phi_r,f"),
            })
        };
        let angles = [column("theta_i")?, column("phi_i")?, column("theta_r")?, column("phi_r")?];
        let values = match column("f") {
            Ok(grey) => [grey; 3],
            Err(missing) => match (column("f_r"), column("f_g"), column("f_b")) {
                (Ok(r), Ok(g), Ok(b)) => [r, g, b],
                _ => return Err(missing),
            },
        };
        let samples = lines
            .map(|(line, text)| {
                let wrong = |problem: String| FitError::Table { line, problem };
                let words: Vec<&str> = text.split(',').map(str::trim).collect();
                let number = |column: usize| match words.get(column).map(|word| (word, word.parse::<f64>())) {
                    Some((_, Ok(number))) if number.is_finite() => Ok(number),
                    Some((word, _)) => Err(wrong(format!("`{word}` is no number in column `{}`", names[column]))),
                    None => Err(wrong(format!("{} values; the first line names {} columns", words.len(), names.len()))),
                };
                let [theta_i, phi_i, theta_r, phi_r] = [number(angles[0])?, number(angles[1])?, number(angles[2])?, number(angles[3])?];
                let f = DVec3::new(number(values[0])?, number(values[1])?, number(values[2])?);
                for theta in [theta_i, theta_r] {
                    if !(0.0..90.0).contains(&theta) {
                        return Err(wrong(format!("an inclination is {theta}°; it must be from 0 to below 90, above the surface")));
                    }
                }
                if f.min_element() < 0.0 {
                    return Err(wrong(format!("f is {}; it must be 0 or more", f.min_element())));
                }
                Ok(Sample { wi: from_degrees(theta_i, phi_i), wo: from_degrees(theta_r, phi_r), f, theta_i })
            })
            .collect::<Result<Vec<_>, _>>()?;
        Ok(Self { samples })
    }

    /// Every value times 1 + `amount`·N(0, 1), no less than 0; what a measurement of this relative error gives.
    pub fn with_noise(mut self, amount: f64, seed: u64) -> Self {
        let grey = self.is_grey();
        let mut rng = Rng::new(seed);
        let mut factor = || {
            let radius = (-2.0 * (1.0 - rng.next_f64()).ln()).sqrt();
            (1.0 + amount * radius * (TAU * rng.next_f64()).cos()).max(0.0)
        };
        for sample in &mut self.samples {
            sample.f *= if grey { DVec3::splat(factor()) } else { DVec3::new(factor(), factor(), factor()) };
        }
        self
    }

    /// All of them.
    pub fn as_slice(&self) -> &[Sample] {
        &self.samples
    }

    /// All channels are the same.
    pub fn is_grey(&self) -> bool {
        self.samples.iter().all(|s| s.f.x == s.f.y && s.f.y == s.f.z)
    }

    /// Root mean square of f cos θ_i cos θ_r over samples and channels.
    pub fn rms(&self) -> f64 {
        let sum: f64 = self.samples.iter().map(|s| (s.f * s.weight()).length_squared()).sum();
        (sum / (3.0 * self.samples.len().max(1) as f64)).sqrt()
    }
}

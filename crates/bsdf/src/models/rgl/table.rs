//! The table of a measured BRDF in the adaptive parameterisation: for each viewer a square whose points are half vectors, dense where the material's facets
//! are seen.
//!
//! ```text
//! u = √(2θ/π), v = (φ + π)/(2π)      normals on the unit square, φ of an isotropic material from that of the viewer
//! (x, y) ↦ (u, v)                    by the density of visible normals of ω_o, D(m) ⟨m·ω_o⟩/σ(ω_o)
//! f cos θ_i = s(x, y | ω_o) D(h)/(4 σ(ω_o))                                                              [Dupuy18] eq. 18
//! p(ω_i)    = p_l(x, y | ω_o) p_v(u, v | ω_o)/(2π² u sin θ_h · 4 (h·ω_o))
//! ```

use super::warp::{Blend, Patches, Warp};
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Where θ_h is next to nothing the density over normals has a pole, the square's pole: below this its steepness is cut.
const LEAST_JACOBIAN: f64 = 1e-12;
/// What is reflected just above the horizon is not divided by less: in f32 it would be infinite.
const LEAST_COSINE: f64 = 1e-9;
/// More than this is no material; a file of absurd numbers would be infinite in f32.
const MOST_REFLECTED: f64 = 1e30;

/// How a material looks when it is turned, so that a part of the azimuths says everything.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Symmetry {
    /// Every azimuth of the viewer was measured, or none matters.
    None,
    /// The same after half a turn.
    HalfTurn,
    /// The same in a mirror along x, and along y.
    Mirrors,
}

impl Symmetry {
    /// How many times the measured azimuths make a turn.
    pub fn parts(self) -> usize {
        match self {
            Self::None => 1,
            Self::HalfTurn => 2,
            Self::Mirrors => 4,
        }
    }
}

/// What a file holds.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Data {
    /// Azimuths of tabulated viewers, rising, rad.
    pub phi_i: Vec<f64>,
    /// Inclinations, rising, rad.
    pub theta_i: Vec<f64>,
    /// D over (u, v).
    pub ndf: Patches<1>,
    /// σ over (u, v) of the viewer.
    pub sigma: Patches<1>,
    /// Density of visible normals over (u, v) for each viewer.
    pub vndf: Warp,
    /// Density of light over (x, y).
    pub luminance: Warp,
    /// s over (x, y), linear Rec. 709; negative outside the gamut.
    pub color: Patches<3>,
    /// Is s to be multiplied by D/(4σ)?
    pub jacobian: bool,
}

/// A measured BRDF.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    data: Data,
    isotropic: bool,
    symmetry: Symmetry,
    /// Signs of x and y in the middle of the measured azimuths, and the direction there.
    middle: [f64; 2],
}

/// A viewer, folded into the measured azimuths.
struct Viewer {
    wo: DVec3,
    /// Signs that fold, and unfold.
    signs: DVec3,
    blend: Blend,
    /// (u, v) of the viewer.
    at: [f64; 2],
    /// Azimuth from which those of normals count.
    azimuth: f64,
}

/// A half vector in the square.
struct Half {
    /// (u, v).
    at: [f64; 2],
    /// dω_h/(du dv).
    jacobian: f64,
}

impl Table {
    /// From angles that rise; one or two azimuths are those of an isotropic material.
    ///
    /// # Errors
    /// Azimuths that make no known part of a turn.
    pub(super) fn new(data: Data) -> Result<Self, String> {
        let (first, last) = (data.phi_i[0], data.phi_i[data.phi_i.len() - 1]);
        let isotropic = data.phi_i.len() <= 2;
        let parts = TAU / (last - first);
        let symmetry = match parts.round() {
            _ if isotropic => Symmetry::None,
            1.0 => Symmetry::None,
            2.0 => Symmetry::HalfTurn,
            4.0 => Symmetry::Mirrors,
            _ => {
                let degrees = (last - first).to_degrees();
                return Err(format!("its field `phi_i` spans {degrees:.1}°, not a whole turn, a half or a quarter; fetch the file again"));
            }
        };
        let quarters = first / FRAC_PI_2;
        if symmetry == Symmetry::Mirrors && (quarters - quarters.round()).abs() > 1e-3 {
            let degrees = first.to_degrees();
            return Err(format!(
                "its field `phi_i` spans a quarter from {degrees:.1}° on, which no mirror at an axis completes; fetch the file again"
            ));
        }
        let (sin, cos) = (0.5 * (first + last)).sin_cos();
        Ok(Self { data, isotropic, symmetry, middle: [cos, sin] })
    }

    pub(super) fn data(&self) -> &Data {
        &self.data
    }

    /// How far the measured azimuths reach.
    #[cfg(test)]
    pub(super) fn symmetry(&self) -> Symmetry {
        self.symmetry
    }

    /// Does it stay the same when light and viewer turn about the normal?
    #[cfg(test)]
    pub(super) fn is_isotropic(&self) -> bool {
        self.isotropic
    }

    /// f in 1/sr for directions above the surface.
    pub fn value(&self, wi: DVec3, wo: DVec3) -> DVec3 {
        let viewer = self.viewer(wo);
        let half = self.half(&viewer, wi * viewer.signs);
        let (at, _) = self.data.vndf.invert(&viewer.blend, half.at);
        let color = DVec3::from_array(self.data.color.value(&viewer.blend, at)).max(DVec3::ZERO);
        let scale = if self.data.jacobian { self.scale(viewer.at, half.at) } else { 1.0 };
        (color * (scale / wi.z.max(LEAST_COSINE))).min(DVec3::splat(MOST_REFLECTED))
    }

    /// D/(4σ); 0 where the viewer sees nothing.
    pub(super) fn scale(&self, viewer: [f64; 2], half: [f64; 2]) -> f64 {
        let one = Blend::one(0);
        let [sigma] = self.data.sigma.value(&one, viewer);
        if sigma > 0.0 { self.data.ndf.value(&one, half)[0] / (4.0 * sigma) } else { 0.0 }
    }

    /// A direction to the light for two random numbers in [0, 1); `None` below the horizon.
    pub fn sample(&self, wo: DVec3, u: [f64; 2]) -> Option<DVec3> {
        let viewer = self.viewer(wo);
        let at = self.data.luminance.sample(&viewer.blend, u);
        let h = self.normal(&viewer, self.data.vndf.sample(&viewer.blend, at));
        let cos_beta = h.dot(viewer.wo);
        (cos_beta > 0.0).then(|| (2.0 * cos_beta * h - viewer.wo) * viewer.signs).filter(|wi| wi.z > 0.0)
    }

    /// The density of [`Table::sample`] for directions above the surface, 1/sr.
    pub fn pdf(&self, wi: DVec3, wo: DVec3) -> f64 {
        let viewer = self.viewer(wo);
        let wi = wi * viewer.signs;
        let half = self.half(&viewer, wi);
        let (at, visible) = self.data.vndf.invert(&viewer.blend, half.at);
        let [light] = self.data.luminance.density().value(&viewer.blend, at);
        let cos_beta = (0.5 + 0.5 * wi.dot(viewer.wo)).max(0.0).sqrt();
        visible * light / (half.jacobian.max(LEAST_JACOBIAN) * 4.0 * cos_beta.max(LEAST_COSINE))
    }

    fn viewer(&self, wo: DVec3) -> Viewer {
        let [x, y] = self.middle;
        let sign = |along: f64| if along < 0.0 { -1.0 } else { 1.0 };
        let signs = match self.symmetry {
            Symmetry::None => DVec3::ONE,
            Symmetry::HalfTurn => {
                let sign = sign(wo.x * x + wo.y * y);
                DVec3::new(sign, sign, 1.0)
            }
            Symmetry::Mirrors => DVec3::new(sign(wo.x * x), sign(wo.y * y), 1.0),
        };
        let wo = wo * signs;
        let (theta, phi) = (inclination(wo), self.measured(wo.y.atan2(wo.x)));
        let azimuth = if self.isotropic { phi } else { 0.0 };
        Viewer { wo, signs, blend: Blend::around(&self.data.phi_i, phi, &self.data.theta_i, theta), at: [to_u(theta), to_v(phi)], azimuth }
    }

    /// The azimuth, turned by whole turns into the measured ones where it is not among them.
    fn measured(&self, phi: f64) -> f64 {
        let middle = 0.5 * (self.data.phi_i[0] + self.data.phi_i[self.data.phi_i.len() - 1]);
        if self.isotropic { phi } else { phi - TAU * ((phi - middle) / TAU).round() }
    }

    fn half(&self, viewer: &Viewer, wi: DVec3) -> Half {
        let h = (wi + viewer.wo).normalize();
        let u = to_u(inclination(h));
        let at = [u, to_v(h.y.atan2(h.x) - viewer.azimuth)];
        Half { at, jacobian: solid_angle(u, h.truncate().length()) }
    }

    fn normal(&self, viewer: &Viewer, at: [f64; 2]) -> DVec3 {
        normal(at, viewer.azimuth)
    }
}

/// The direction at a place of the square.
pub(super) fn normal([u, v]: [f64; 2], azimuth: f64) -> DVec3 {
    let (sin, cos) = (u * u * FRAC_PI_2).sin_cos();
    let (sin_phi, cos_phi) = ((2.0 * v - 1.0) * PI + azimuth).sin_cos();
    DVec3::new(sin * cos_phi, sin * sin_phi, cos)
}

/// dω/(du dv) = 2π² u sin θ.
pub(super) fn solid_angle(u: f64, sin_theta: f64) -> f64 {
    2.0 * PI * PI * u * sin_theta
}

fn inclination(w: DVec3) -> f64 {
    w.truncate().length().atan2(w.z)
}

pub(super) fn to_u(theta: f64) -> f64 {
    (theta / FRAC_PI_2).sqrt()
}

pub(super) fn to_v(phi: f64) -> f64 {
    ((phi + PI) / TAU).rem_euclid(1.0)
}

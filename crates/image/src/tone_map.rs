//! From scene-referred radiance to what a display shows.
//!
//! Every curve takes linear BT.709 light in which 1 is the exposed white of a diffuse reflector, and gives linear display light in
//! [0, 1]; the sRGB encoding comes after. The shader module `shader_lib::tone_map` holds the twins of these functions.

use crate::Image;
use glam::{Mat3, Vec3};
use kajo_units::{LinearRgb, Srgb8};
use std::fmt;
use std::str::FromStr;

/// Every curve is within half an 8-bit step of its end here; larger inputs would overflow squares and divide infinities.
const MAX_INPUT: f32 = 1e6;

/// A tone curve.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ToneMap {
    /// [`linear`]: no curve, clipped.
    Linear,
    /// [`aces`].
    Aces,
    /// [`agx`].
    #[default]
    Agx,
    /// [`pbr_neutral`].
    PbrNeutral,
}

impl ToneMap {
    /// Every curve; the rank is the number that shaders use.
    pub const ALL: [Self; 4] = [Self::Linear, Self::Aces, Self::Agx, Self::PbrNeutral];

    /// The name users write.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::Aces => "aces",
            Self::Agx => "agx",
            Self::PbrNeutral => "pbr-neutral",
        }
    }

    /// Display light, linear, each channel in [0, 1]. Negative channels and NaN count as 0.
    pub fn map(self, scene: LinearRgb) -> LinearRgb {
        let rgb = scene.0.to_array().map(|c| if c > 0.0 { c.min(MAX_INPUT) } else { 0.0 }).into();
        let display = match self {
            Self::Linear => linear(rgb),
            Self::Aces => aces(rgb),
            Self::Agx => agx(rgb),
            Self::PbrNeutral => pbr_neutral(rgb),
        };
        LinearRgb(display)
    }
}

impl fmt::Display for ToneMap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for ToneMap {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let names = || Self::ALL.map(Self::name).join(", ");
        Self::ALL.into_iter().find(|curve| curve.name() == name).ok_or_else(|| format!("no tone map `{name}`; there are: {}", names()))
    }
}

/// Scales radiance by 2^stops, applies the curve, encodes as 8-bit sRGB.
pub fn tone_map(image: &Image<LinearRgb>, stops: f32, curve: ToneMap) -> Image<Srgb8> {
    let scale = stops.exp2();
    image.map(|&radiance| curve.map(radiance * scale).to_srgb8())
}

/// No curve: clips at 1, as a display does that is given too much.
pub fn linear(rgb: Vec3) -> Vec3 {
    rgb.min(Vec3::ONE)
}

/// The ACES reference rendering and sRGB output transforms as fitted by S. Hill: matrix, rational curve per channel, matrix.
///
/// ```text
/// c(v) = (v (v + 0.0245786) − 0.000090537) / (v (0.983729 v + 0.4329510) + 0.238081)            [Hill16]
/// ```
///
/// A fit of the curve only: it lacks the glow and red modifiers of the full transform. Middle grey 0.18 comes out at 0.106.
pub fn aces(rgb: Vec3) -> Vec3 {
    const CURVE_FROM_BT709: Mat3 = rows([0.59719, 0.35458, 0.04823], [0.07600, 0.90834, 0.01566], [0.02840, 0.13383, 0.83777]);
    const BT709_FROM_CURVE: Mat3 = rows([1.60475, -0.53108, -0.07367], [-0.10208, 1.10813, -0.00605], [-0.00327, -0.07276, 1.07602]);
    let v = CURVE_FROM_BT709 * rgb;
    let fitted = (v * (v + 0.024_578_6) - 0.000_090_537) / (v * (0.983_729 * v + 0.432_951) + 0.238_081);
    (BT709_FROM_CURVE * fitted).clamp(Vec3::ZERO, Vec3::ONE)
}

/// AgX, base look, in the version of 2022: inset matrix, sigmoid over 16.5 stops, the inverse of the inset, display power 2.2.
///
/// ```text
/// x = (log₂ c + 12.474) / 16.5    in [0, 1]
/// s(x) = ½ + 2 (x − x₀) / (1 + a |x − x₀|^p)^(1/p),   x₀ = 20/33,   p = 3 below x₀ and 13/4 above            [Sobotka22]
/// ```
///
/// The published transform tabulates s; here it is evaluated in closed form. Its coefficients a follow from s(0) = 0 and s(1) = 1.
/// Middle grey 0.18 is sent to ½ by the sigmoid, and so to ½^2.2 = 0.218 of the display's light.
pub fn agx(rgb: Vec3) -> Vec3 {
    const INSET: Mat3 = rows(
        [0.842_479_06, 0.078_433_6, 0.079_223_745],
        [0.042_328_242, 0.878_468_64, 0.079_166_13],
        [0.042_375_656, 0.078_433_6, 0.879_143],
    );
    const OUTSET: Mat3 = rows(
        [1.196_879, -0.098_020_88, -0.099_029_74],
        [-0.052_896_852, 1.151_903_1, -0.098_961_177],
        [-0.052_971_636, -0.098_043_45, 1.151_073_7],
    );
    let inset = INSET * rgb;
    let encoded = OUTSET * Vec3::from_array(inset.to_array().map(agx_sigmoid));
    Vec3::from_array(encoded.to_array().map(|c| c.clamp(0.0, 1.0).powf(2.2)))
}

/// log₂ of the darkest value AgX keeps: 10 stops below 0.18.
const AGX_MIN_STOPS: f32 = -12.473_931;
/// Stops from the darkest to the brightest value AgX keeps.
const AGX_STOPS: f32 = 16.5;

/// The log-encoded sigmoid s of [`agx`], one channel; 0 and below give 0.
fn agx_sigmoid(linear: f32) -> f32 {
    const PIVOT: f32 = 20.0 / 33.0;
    let x = ((linear.max(f32::MIN_POSITIVE).log2() - AGX_MIN_STOPS) / AGX_STOPS).clamp(0.0, 1.0);
    let d = x - PIVOT;
    let (a, p) = if d < 0.0 { (59.507_875, 3.0) } else { (69.862_79, 3.25) };
    0.5 + 2.0 * d * (1.0 + a * d.abs().powf(p)).powf(-1.0 / p)
}

/// The Khronos PBR neutral tone map: colours stay what they are up to 0.8, highlights fade to white.    \[KhronosNeutral]
///
/// ```text
/// f = m − m²/(4 F₉₀) where the smallest channel m ≤ 2 F₉₀, else F₉₀ = 0.04
/// p = max(c − f),   p' = 1 − (1 − k)²/(p + 1 − 2k),   k = 0.8 − F₉₀
/// c' = c − f where p ≤ k, else mix((c − f) p'/p, p', 1 − 1/(0.15 (p − p') + 1))
/// ```
pub fn pbr_neutral(rgb: Vec3) -> Vec3 {
    const F90: f32 = 0.04;
    const START: f32 = 0.8 - F90;
    const DESATURATION: f32 = 0.15;
    let darkest = rgb.min_element();
    let offset = if darkest <= 2.0 * F90 { darkest - darkest * darkest / (4.0 * F90) } else { F90 };
    let shifted = rgb - offset;
    let peak = shifted.max_element();
    if peak <= START {
        return shifted;
    }
    let new_peak = 1.0 - (1.0 - START) * (1.0 - START) / (peak + 1.0 - 2.0 * START);
    let whiteness = 1.0 - 1.0 / (DESATURATION * (peak - new_peak) + 1.0);
    (shifted * (new_peak / peak)).lerp(Vec3::splat(new_peak), whiteness)
}

/// A matrix from its rows.
const fn rows(x: [f32; 3], y: [f32; 3], z: [f32; 3]) -> Mat3 {
    Mat3::from_cols_array(&[x[0], y[0], z[0], x[1], y[1], z[1], x[2], y[2], z[2]])
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::UVec2;

    fn ramp() -> impl Iterator<Item = f32> {
        (0..400).map(|i| (-16.0 + i as f32 * 0.08f32).exp2())
    }

    #[test]
    fn output_lies_in_the_display_range_for_every_input() {
        let extremes = [0.0, -1.0, 1e-40, 1e-10, 1.0, 7.0, 1e9, f32::MAX, f32::INFINITY, f32::NAN];
        for curve in ToneMap::ALL {
            for r in extremes {
                for g in extremes {
                    let out = curve.map(LinearRgb::new(r, g, 0.3)).0;
                    assert!(out.cmpge(Vec3::ZERO).all() && out.cmple(Vec3::ONE).all(), "{curve} of ({r}, {g}, 0.3) is {out}");
                }
            }
        }
    }

    #[test]
    fn grey_stays_grey_and_grows_with_exposure() {
        for curve in ToneMap::ALL {
            let mut last = -1.0;
            for grey in ramp() {
                let out = curve.map(LinearRgb::splat(grey)).0;
                assert!(out.max_element() - out.min_element() < 2e-3, "{curve} tints {grey}: {out}");
                assert!(out.x >= last, "{curve} falls at {grey}");
                last = out.x;
            }
        }
    }

    #[test]
    fn agx_sigmoid_passes_through_its_three_points() {
        assert!(agx_sigmoid(0.0).abs() < 1e-6);
        assert!((agx_sigmoid(0.18) - 0.5).abs() < 1e-4);
        assert!((agx_sigmoid(1e4) - 1.0).abs() < 1e-6);
        // Slope 2 at the pivot: one stop is 1/16.5 of the axis.
        let slope = (agx_sigmoid(0.18 * 1.01) - agx_sigmoid(0.18 / 1.01)) / (2.0 * 1.01f32.log2() / AGX_STOPS);
        assert!((slope - 2.0).abs() < 0.01, "{slope}");
    }

    #[test]
    fn pbr_neutral_leaves_colours_below_the_knee_alone() {
        let base = Vec3::new(0.6, 0.3, 0.1);
        assert_eq!(pbr_neutral(base), base - 0.04);
        // Continuous with slope 1 at the knee.
        let knee = 0.8;
        let (below, above) = (pbr_neutral(Vec3::splat(knee - 1e-3)).x, pbr_neutral(Vec3::splat(knee + 1e-3)).x);
        assert!((above - below - 2e-3).abs() < 2e-5);
    }

    #[test]
    fn aces_of_middle_grey_is_as_published() {
        assert!((aces(Vec3::splat(0.18)).x - 0.1056).abs() < 2e-3, "{}", aces(Vec3::splat(0.18)));
    }

    #[test]
    fn bright_saturated_light_turns_white_except_where_it_clips() {
        let laser = LinearRgb::new(300.0, 0.0, 0.0);
        assert!(ToneMap::Agx.map(laser).0.min_element() > 0.3);
        assert!(ToneMap::PbrNeutral.map(laser).0.min_element() > 0.9);
        assert_eq!(ToneMap::Linear.map(laser).0, Vec3::X);
    }

    #[test]
    fn stops_double_the_light() {
        let image = Image::from_fn(UVec2::ONE, |_, _| LinearRgb::splat(0.25));
        let twice = Image::from_fn(UVec2::ONE, |_, _| LinearRgb::splat(0.5));
        assert_eq!(tone_map(&image, 1.0, ToneMap::Linear), tone_map(&twice, 0.0, ToneMap::Linear));
    }

    #[test]
    fn names_round_trip() {
        for curve in ToneMap::ALL {
            assert_eq!(curve.name().parse(), Ok(curve));
        }
        assert!("filmic".parse::<ToneMap>().unwrap_err().contains("agx"));
    }
}

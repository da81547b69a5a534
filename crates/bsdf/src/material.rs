//! The glTF material at one surface point: plain numbers, textures already looked up.

use glam::Vec3;
use kajo_units::{LinearRgb, PerceptualRoughness, Radians};

/// Parameters of the layered glTF material at one point.    glTF 2.0 appendix B and the KHR_materials_* extensions
///
/// Names and ranges are those of the extensions; the default is a white dielectric with every optional layer off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaterialParams {
    /// Diffuse albedo of a dielectric, F0 of a metal, tint of transmission; each channel in [0, 1].
    pub base_color: LinearRgb,
    /// 0 dielectric … 1 conductor.
    pub metallic: f32,
    /// Roughness of the base layer, [0, 1].
    pub roughness: PerceptualRoughness,
    /// Index of refraction of the dielectric base, 1 or more (0: the special value of KHR_materials_ior, F = 1).
    pub ior: f32,
    /// Strength of the dielectric's specular reflection, [0, 1].
    pub specular: f32,
    /// Colour of the dielectric's F0; may exceed 1, the product with F0 is clamped.
    pub specular_color: LinearRgb,
    /// Coverage of the clear coat, [0, 1].
    pub clearcoat: f32,
    /// Roughness of the clear coat, [0, 1].
    pub clearcoat_roughness: PerceptualRoughness,
    /// Normal of the clear coat in the base shading frame, unit length.
    pub clearcoat_normal: Vec3,
    /// Colour of the sheen layer; black switches it off.
    pub sheen_color: LinearRgb,
    /// Roughness of the sheen layer, [0, 1].
    pub sheen_roughness: PerceptualRoughness,
    /// Strength of the anisotropy, [0, 1].
    pub anisotropy: f32,
    /// Direction of larger roughness, counter-clockwise from the tangent.
    pub anisotropy_rotation: Radians,
    /// Share of light that is transmitted instead of diffusely reflected, [0, 1].
    pub transmission: f32,
    /// True for a surface without volume (thickness 0): transmission does not refract.
    pub thin: bool,
    /// Strength of the thin-film interference layer, [0, 1].
    pub iridescence: f32,
    /// Index of refraction of the film.
    pub iridescence_ior: f32,
    /// Thickness of the film, nm.
    pub iridescence_thickness: f32,
    /// 20 / Abbe number; 0 switches dispersion off.    KHR_materials_dispersion
    pub dispersion: f32,
}

impl Default for MaterialParams {
    fn default() -> Self {
        Self {
            base_color: LinearRgb::WHITE,
            metallic: 0.0,
            roughness: PerceptualRoughness(1.0),
            ior: 1.5,
            specular: 1.0,
            specular_color: LinearRgb::WHITE,
            clearcoat: 0.0,
            clearcoat_roughness: PerceptualRoughness(0.0),
            clearcoat_normal: Vec3::Z,
            sheen_color: LinearRgb::BLACK,
            sheen_roughness: PerceptualRoughness(0.0),
            anisotropy: 0.0,
            anisotropy_rotation: Radians(0.0),
            transmission: 0.0,
            thin: true,
            iridescence: 0.0,
            iridescence_ior: 1.3,
            iridescence_thickness: 400.0,
            dispersion: 0.0,
        }
    }
}

impl MaterialParams {
    /// Index of refraction of each channel.    KHR_materials_dispersion
    ///
    /// Half of the spread between red and blue is (n − 1) · 0.025 · dispersion; no spread for a thin surface.
    pub fn channel_iors(&self) -> Vec3 {
        let ior = if self.ior.is_finite() { self.ior.max(0.0) } else { 1.5 };
        let dispersion = if self.dispersion.is_finite() { self.dispersion.max(0.0) } else { 0.0 };
        let spread = if ior > 1.0 && !self.thin { (ior - 1.0) * 0.025 * dispersion } else { 0.0 };
        if spread > 0.0 { Vec3::new((ior - spread).max(1.0), ior, ior + spread) } else { Vec3::splat(ior) }
    }

    /// The same material for light of one channel (0, 1, 2), without dispersion: `f` of that channel is unchanged.
    ///
    /// A path whose throughput is left with one channel should go on with this, else two of three refracted samples carry nothing.
    pub fn for_channel(&self, channel: usize) -> Self {
        Self { ior: self.channel_iors()[channel], dispersion: 0.0, ..*self }
    }
}

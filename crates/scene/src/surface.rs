//! A material at one surface point: factors times textures, channel by channel as glTF 2.0 and its extensions define them.

use crate::{AlphaMode, Material, Scene, TextureRef};
use glam::{Vec2, Vec3, Vec4};
use kajo_bsdf::MaterialParams;
use kajo_units::{LinearRgb, PerceptualRoughness, Radians};

/// What a material needs to know of a surface point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceUv {
    /// Texture coordinates, set 0 and set 1.
    pub uvs: [Vec2; 2],
    /// Vertex colour, linear RGBA; white where a mesh has none.
    pub color: Vec4,
}

impl Default for SurfaceUv {
    fn default() -> Self {
        Self { uvs: [Vec2::ZERO; 2], color: Vec4::ONE }
    }
}

/// A material evaluated at one surface point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceMaterial {
    /// What the BSDF is made of.
    pub params: MaterialParams,
    /// Probability that the surface is there, [0, 1]: 1 for opaque materials, 0 or 1 for masks, alpha for blends.
    pub coverage: f32,
    /// Emitted radiance, W/(m² sr), on the front face, and on both of a double-sided material.
    pub emission: LinearRgb,
    /// Shading normal in the frame (tangent, bitangent, vertex normal), unit length.
    pub normal: Vec3,
    /// Absorption coefficient σ_a of the volume behind the surface, 1/m; zero where the surface bounds none.
    pub absorption: LinearRgb,
    /// Ambient occlusion baked into the file, [0, 1]; for real-time techniques only.
    pub occlusion: f32,
}

/// Keeps ln 0 of a black attenuation colour finite: an infinite coefficient times a distance of 0 would be NaN.
const DARKEST_ATTENUATION: f32 = f32::MIN_POSITIVE;

impl Material {
    /// Evaluates everything at a surface point.    glTF 2.0 section 3.9 and appendix B; KHR_materials_*
    pub fn at(&self, scene: &Scene, surface: &SurfaceUv) -> SurfaceMaterial {
        let look = |texture: &Option<TextureRef>| texture.as_ref().map(|t| t.lookup(scene, &surface.uvs));
        let rgb = |factor: LinearRgb, texture| look(texture).map_or(factor, |t| LinearRgb(factor.0 * t.truncate()));
        let channel = |factor: f32, texture, c: usize| look(texture).map_or(factor, |t| factor * t[c]);
        const R: usize = 0;
        const G: usize = 1;
        const A: usize = 3;

        let base = look(&self.base_color_texture).unwrap_or(Vec4::ONE) * self.base_color.0.extend(self.alpha) * surface.color;
        let base_color = LinearRgb(base.truncate().clamp(Vec3::ZERO, Vec3::ONE));
        let coverage = self.coverage_of(base.w);
        let normal = tangent_space_normal(look(&self.normal_texture), self.normal_scale);
        let occlusion = look(&self.occlusion_texture).map_or(1.0, |t| 1.0 + self.occlusion_strength * (t.x - 1.0));
        if self.unlit {
            return SurfaceMaterial {
                params: MaterialParams { base_color: LinearRgb::BLACK, specular: 0.0, ..Default::default() },
                coverage,
                emission: base_color,
                normal: Vec3::Z,
                absorption: LinearRgb::BLACK,
                occlusion,
            };
        }

        let (metallic, roughness) = match look(&self.metallic_roughness_texture) {
            Some(t) => (self.metallic * t.z, self.roughness * t.y),
            None => (self.metallic, self.roughness),
        };
        let mut params = MaterialParams {
            base_color,
            metallic: metallic.clamp(0.0, 1.0),
            roughness: PerceptualRoughness(roughness.clamp(0.0, 1.0)),
            ior: self.ior,
            specular: channel(self.specular, &self.specular_texture, A),
            specular_color: rgb(self.specular_color, &self.specular_color_texture),
            ..Default::default()
        };
        if self.clearcoat > 0.0 {
            params.clearcoat = channel(self.clearcoat, &self.clearcoat_texture, R);
            params.clearcoat_roughness = PerceptualRoughness(channel(self.clearcoat_roughness, &self.clearcoat_roughness_texture, G));
            params.clearcoat_normal = tangent_space_normal(look(&self.clearcoat_normal_texture), self.clearcoat_normal_scale);
        }
        if !self.sheen_color.is_black() {
            params.sheen_color = rgb(self.sheen_color, &self.sheen_color_texture);
            params.sheen_roughness = PerceptualRoughness(channel(self.sheen_roughness, &self.sheen_roughness_texture, A));
        }
        if self.anisotropy > 0.0 {
            let (direction, strength) = match look(&self.anisotropy_texture) {
                Some(t) => (Vec2::new(t.x, t.y) * 2.0 - 1.0, t.z),
                None => (Vec2::X, 1.0),
            };
            params.anisotropy = self.anisotropy * strength;
            params.anisotropy_rotation = Radians(self.anisotropy_rotation.0 + direction.y.atan2(direction.x));
        }
        if self.transmission > 0.0 {
            params.transmission = channel(self.transmission, &self.transmission_texture, R);
            params.dispersion = self.dispersion;
        }
        params.thin = self.thickness <= 0.0;
        if self.iridescence > 0.0 {
            let [at_zero, at_one] = self.iridescence_thickness;
            params.iridescence = channel(self.iridescence, &self.iridescence_texture, R);
            params.iridescence_ior = self.iridescence_ior;
            params.iridescence_thickness = look(&self.iridescence_thickness_texture).map_or(at_one, |t| at_zero + (at_one - at_zero) * t.y);
        }
        SurfaceMaterial {
            params,
            coverage,
            emission: rgb(self.emission, &self.emission_texture),
            normal,
            absorption: self.absorption(),
            occlusion,
        }
    }

    /// [`SurfaceMaterial::coverage`] alone: the test that decides whether a ray sees the surface. Opaque materials touch no texture.
    #[inline]
    pub fn coverage_at(&self, scene: &Scene, surface: &SurfaceUv) -> f32 {
        if self.alpha_mode == AlphaMode::Opaque {
            return 1.0;
        }
        let texture = self.base_color_texture.as_ref().map_or(1.0, |t| t.lookup_alpha(scene, &surface.uvs));
        self.coverage_of(self.alpha * surface.color.w * texture)
    }

    /// [`SurfaceMaterial::emission`] alone, W/(m² sr).
    #[inline]
    pub fn emission_at(&self, scene: &Scene, surface: &SurfaceUv) -> LinearRgb {
        let look = |texture: &Option<TextureRef>| texture.as_ref().map_or(Vec4::ONE, |t| t.lookup(scene, &surface.uvs));
        if self.unlit {
            let base = look(&self.base_color_texture) * self.base_color.0.extend(self.alpha) * surface.color;
            return LinearRgb(base.truncate().clamp(Vec3::ZERO, Vec3::ONE));
        }
        LinearRgb(self.emission.0 * look(&self.emission_texture).truncate())
    }

    /// True when the surface may emit: its emission is not black, or it is unlit and shows its base colour as radiance.
    pub fn is_emissive(&self) -> bool {
        self.unlit || !self.emission.is_black()
    }

    /// True when rays may pass the surface by chance or by mask, so that [`Material::coverage_at`] must be asked at each hit.
    pub fn needs_alpha_test(&self) -> bool {
        self.alpha_mode != AlphaMode::Opaque
    }

    /// Absorption coefficient of the volume that the surface bounds, 1/m.    KHR_materials_volume, "Attenuation"
    ///
    ///     σ_a = −ln(attenuation colour) / attenuation distance,   so that T(d) = exp(−σ_a d) is the colour at that distance
    ///
    /// Zero without volume (thickness 0) and for clear volumes.
    pub fn absorption(&self) -> LinearRgb {
        if self.thickness <= 0.0 || !self.attenuation_distance.is_finite() || self.attenuation_distance <= 0.0 {
            return LinearRgb::BLACK;
        }
        let color = self.attenuation_color.0.clamp(Vec3::splat(DARKEST_ATTENUATION), Vec3::ONE);
        LinearRgb((-color.map(f32::ln) / self.attenuation_distance).min(Vec3::splat(f32::MAX)))
    }

    fn coverage_of(&self, alpha: f32) -> f32 {
        match self.alpha_mode {
            AlphaMode::Opaque => 1.0,
            AlphaMode::Mask(cutoff) => f32::from(u8::from(alpha >= cutoff)),
            AlphaMode::Blend => alpha.clamp(0.0, 1.0),
        }
    }
}

/// Decodes a normal map: (2t − 1) with x and y scaled, then normalised.    glTF 2.0, 3.9.3
///
/// A texel that decodes to the zero vector leaves the vertex normal.
fn tangent_space_normal(texel: Option<Vec4>, scale: f32) -> Vec3 {
    match texel {
        None => Vec3::Z,
        Some(t) => ((t.truncate() * 2.0 - 1.0) * Vec3::new(scale, scale, 1.0)).normalize_or(Vec3::Z),
    }
}

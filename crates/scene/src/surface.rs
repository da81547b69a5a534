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
        if self.model.is_some() {
            params.anisotropy_rotation = self.anisotropy_rotation;
        } else if self.anisotropy > 0.0 {
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
    /// ```text
    /// σ_a = −ln(attenuation colour) / attenuation distance,   so that T(d) = exp(−σ_a d) is the colour at that distance
    /// ```
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ColorSpace, Filter, Texels, Texture, TextureImage, Wrap};
    use glam::Affine2;
    use std::sync::Arc;

    /// A scene with one linear texel, and the reference to it.
    fn with_texel(texel: [f32; 4]) -> (Scene, Option<TextureRef>) {
        let image = TextureImage { name: String::new(), width: 1, height: 1, texels: Texels::Rgba32F(vec![texel]) };
        let texture = Texture { image: 0, wrap: [Wrap::Repeat; 2], filter: Filter::Linear, color_space: ColorSpace::Linear };
        let scene = Scene { images: vec![Arc::new(image)], textures: vec![texture], ..Scene::default() };
        (scene, Some(TextureRef { texture: 0, uv_set: 0, transform: Affine2::IDENTITY }))
    }

    const TEXEL: [f32; 4] = [0.5, 0.25, 0.125, 0.75];

    fn close(a: f32, b: f32) -> bool {
        (a - b).abs() < 1e-6
    }

    #[test]
    fn base_colour_is_factor_times_texture_times_vertex_colour() {
        let (scene, texture) = with_texel(TEXEL);
        let material = Material {
            base_color: LinearRgb::new(0.5, 1.0, 1.0),
            alpha: 0.5,
            base_color_texture: texture,
            alpha_mode: AlphaMode::Blend,
            ..Material::default()
        };
        let surface = SurfaceUv { color: Vec4::new(1.0, 0.5, 4.0, 0.5), ..SurfaceUv::default() };
        let at = material.at(&scene, &surface);
        assert!((at.params.base_color.0 - Vec3::new(0.25, 0.125, 0.5)).length() < 1e-6);
        assert!(close(at.coverage, 0.75 * 0.5 * 0.5));
        assert_eq!(material.coverage_at(&scene, &surface), at.coverage);
    }

    #[test]
    fn each_texture_is_read_from_the_channel_its_extension_names() {
        let (scene, t) = with_texel(TEXEL);
        let white = LinearRgb::WHITE;
        let material = Material {
            metallic_roughness_texture: t,
            emission: LinearRgb::splat(2.0),
            emission_texture: t,
            occlusion_texture: t,
            occlusion_strength: 0.5,
            specular_texture: t,
            specular_color_texture: t,
            clearcoat: 1.0,
            clearcoat_texture: t,
            clearcoat_roughness: 1.0,
            clearcoat_roughness_texture: t,
            sheen_color: white,
            sheen_color_texture: t,
            sheen_roughness: 1.0,
            sheen_roughness_texture: t,
            transmission: 1.0,
            transmission_texture: t,
            iridescence: 1.0,
            iridescence_texture: t,
            iridescence_thickness_texture: t,
            ..Material::default()
        };
        let at = material.at(&scene, &SurfaceUv::default());
        let p = at.params;
        let rgb = Vec3::new(0.5, 0.25, 0.125);
        assert!(close(p.roughness.0, 0.25) && close(p.metallic, 0.125), "roughness is green, metal is blue");
        assert_eq!(at.emission.0, 2.0 * rgb);
        assert_eq!(material.emission_at(&scene, &SurfaceUv::default()), at.emission);
        assert!(close(at.occlusion, 1.0 + 0.5 * (0.5 - 1.0)));
        assert!(close(p.specular, 0.75) && p.specular_color.0 == rgb);
        assert!(close(p.clearcoat, 0.5) && close(p.clearcoat_roughness.0, 0.25));
        assert!(p.sheen_color.0 == rgb && close(p.sheen_roughness.0, 0.75));
        assert!(close(p.transmission, 0.5));
        assert!(close(p.iridescence, 0.5) && close(p.iridescence_thickness, 100.0 + 300.0 * 0.25));
    }

    #[test]
    fn without_textures_the_factors_stand() {
        let scene = Scene::default();
        let material = Material { iridescence: 1.0, anisotropy: 0.3, anisotropy_rotation: Radians(0.4), ..Material::default() };
        let at = material.at(&scene, &SurfaceUv::default());
        assert_eq!(at.params.iridescence_thickness, 400.0, "no texture takes the maximum");
        assert!(close(at.params.anisotropy, 0.3) && close(at.params.anisotropy_rotation.0, 0.4));
        assert_eq!(at.normal, Vec3::Z);
        assert_eq!((at.params.metallic, at.params.roughness.0, at.coverage), (1.0, 1.0, 1.0));
    }

    #[test]
    fn normal_map_decodes_scales_and_stays_unit() {
        let (scene, texture) = with_texel([0.75, 0.25, 1.0, 1.0]);
        let at = |normal_scale| {
            Material { normal_texture: texture, normal_scale, ..Material::default() }.at(&scene, &SurfaceUv::default()).normal
        };
        assert!((at(1.0) - Vec3::new(0.5, -0.5, 1.0).normalize()).length() < 1e-6);
        assert!((at(0.5) - Vec3::new(0.25, -0.25, 1.0).normalize()).length() < 1e-6);
        let (scene, zero) = with_texel([0.5, 0.5, 0.5, 1.0]);
        let material = Material { normal_texture: zero, ..Material::default() };
        assert_eq!(material.at(&scene, &SurfaceUv::default()).normal, Vec3::Z);
    }

    #[test]
    fn anisotropy_texture_turns_and_scales() {
        // Direction (0, 1) in red and green, strength 0.5 in blue.
        let (scene, texture) = with_texel([0.5, 1.0, 0.5, 1.0]);
        let material = Material { anisotropy: 0.8, anisotropy_texture: texture, anisotropy_rotation: Radians(0.25), ..Material::default() };
        let p = material.at(&scene, &SurfaceUv::default()).params;
        assert!(close(p.anisotropy, 0.4));
        assert!(close(p.anisotropy_rotation.0, 0.25 + std::f32::consts::FRAC_PI_2));
    }

    #[test]
    fn masks_are_all_or_nothing_and_opaque_ignores_alpha() {
        let scene = Scene::default();
        let coverage = |alpha, alpha_mode| Material { alpha, alpha_mode, ..Material::default() }.coverage_at(&scene, &SurfaceUv::default());
        assert_eq!(coverage(0.5, AlphaMode::Mask(0.5)), 1.0);
        assert_eq!(coverage(0.49, AlphaMode::Mask(0.5)), 0.0);
        assert_eq!(coverage(0.49, AlphaMode::Blend), 0.49);
        assert_eq!(coverage(0.0, AlphaMode::Opaque), 1.0);
    }

    #[test]
    fn texture_transform_and_second_uv_set_are_applied() {
        let image = TextureImage {
            name: String::new(),
            width: 2,
            height: 1,
            texels: Texels::Rgba32F(vec![[0.0, 0.0, 0.0, 1.0], [1.0, 1.0, 1.0, 1.0]]),
        };
        let texture = Texture { image: 0, wrap: [Wrap::Repeat; 2], filter: Filter::Nearest, color_space: ColorSpace::Linear };
        let scene = Scene { images: vec![Arc::new(image)], textures: vec![texture], ..Scene::default() };
        let transform = Affine2::from_translation(Vec2::new(0.5, 0.0));
        let material = Material { base_color_texture: Some(TextureRef { texture: 0, uv_set: 1, transform }), ..Material::default() };
        let red = |u| {
            let surface = SurfaceUv { uvs: [Vec2::splat(99.0), Vec2::new(u, 0.5)], ..SurfaceUv::default() };
            material.at(&scene, &surface).params.base_color[0]
        };
        assert_eq!((red(0.25), red(0.75)), (1.0, 0.0));
    }

    #[test]
    fn absorption_reaches_the_attenuation_colour_at_its_distance() {
        let material = Material {
            thickness: 0.1,
            attenuation_distance: 2.0,
            attenuation_color: LinearRgb::new(0.25, 1.0, 0.0),
            ..Material::default()
        };
        let sigma = material.absorption();
        let transmitted = (-sigma.0 * 2.0).map(f32::exp);
        assert!((transmitted - Vec3::new(0.25, 1.0, 0.0)).length() < 1e-6, "{transmitted}");
        assert!(sigma.is_finite());
        assert!(!material.at(&Scene::default(), &SurfaceUv::default()).params.thin);
        assert_eq!(Material { thickness: 0.0, ..material.clone() }.absorption(), LinearRgb::BLACK);
        assert_eq!(Material { attenuation_distance: f32::INFINITY, ..material.clone() }.absorption(), LinearRgb::BLACK);
        assert!(Material { attenuation_distance: 1e-44, ..material }.absorption().is_finite());
    }

    #[test]
    fn unlit_shows_its_base_colour_as_radiance_and_reflects_nothing() {
        let material = Material { unlit: true, base_color: LinearRgb::new(0.2, 0.4, 0.6), ..Material::default() };
        let at = material.at(&Scene::default(), &SurfaceUv::default());
        assert_eq!(at.emission, material.base_color);
        assert_eq!(material.emission_at(&Scene::default(), &SurfaceUv::default()), material.base_color);
        assert!(at.params.base_color.is_black() && at.params.specular == 0.0 && material.is_emissive());
    }
}

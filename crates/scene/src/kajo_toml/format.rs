//! The tables and keys of a `.kajo.toml` file, as serde reads them. The meaning of each stands in docs/scene-format.md.

use serde::Deserialize;
use serde::de::{self, Deserializer, MapAccess, SeqAccess, Visitor, value::MapAccessDeserializer, value::SeqAccessDeserializer};
use std::fmt;
use toml::Spanned;

/// The whole file.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct File {
    pub exposure: Option<f32>,
    pub asset: Vec<Spanned<Asset>>,
    pub environment: Option<Spanned<EnvironmentTable>>,
    pub light: Vec<Spanned<LightTable>>,
    pub camera: Vec<Spanned<CameraTable>>,
    pub material: Vec<Spanned<MaterialTable>>,
}

/// `[[asset]]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Asset {
    pub file: String,
    pub name: Option<String>,
    pub translate: Option<[f32; 3]>,
    pub rotate_deg: Option<[f32; 3]>,
    pub scale: Option<Scale>,
    pub animation: Option<Choice>,
    pub time_offset: Option<f32>,
}

/// `[environment]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EnvironmentTable {
    pub file: Option<String>,
    pub radiance: Option<Color>,
    pub scale: Option<Color>,
    pub rotation_deg: Option<f32>,
}

/// `[[light]]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LightTable {
    #[serde(rename = "type")]
    pub kind: LightKind,
    pub name: Option<String>,
    pub color: Option<Color>,
    pub lumens: Option<f32>,
    pub candela: Option<f32>,
    pub lux: Option<f32>,
    pub nits: Option<f32>,
    pub watts: Option<f32>,
    pub intensity: Option<f32>,
    pub irradiance: Option<f32>,
    pub radiance: Option<f32>,
    pub width: Option<f32>,
    pub height: Option<f32>,
    pub radius: Option<f32>,
    pub inner_deg: Option<f32>,
    pub outer_deg: Option<f32>,
    pub half_angle_deg: Option<f32>,
    pub position: Option<[f32; 3]>,
    pub target: Option<[f32; 3]>,
    pub direction: Option<[f32; 3]>,
    pub rotate_deg: Option<[f32; 3]>,
    pub node: Option<String>,
}

/// `type` of a light.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum LightKind {
    Point,
    Spot,
    Directional,
    Rectangle,
    Disk,
    Sphere,
}

/// `[[camera]]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CameraTable {
    pub name: Option<String>,
    pub position: Option<[f32; 3]>,
    pub target: Option<[f32; 3]>,
    pub rotate_deg: Option<[f32; 3]>,
    pub node: Option<String>,
    pub yfov_deg: Option<f32>,
    pub aspect: Option<f32>,
    pub orthographic_height: Option<f32>,
    pub lens_radius: Option<f32>,
    pub f_number: Option<f32>,
    pub sensor_height_mm: Option<f32>,
    pub focus_distance: Option<f32>,
    pub focus_on: Option<[f32; 3]>,
    pub near: Option<f32>,
}

/// `[[material]]`: every field of the glTF material and its extensions.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MaterialTable {
    pub name: String,
    pub asset: Option<String>,
    pub model: Option<String>,
    pub params: Option<toml::Table>,
    pub form: Option<FormName>,
    pub base_color: Option<Color>,
    pub alpha: Option<f32>,
    pub base_color_texture: Option<TextureValue>,
    pub metallic: Option<f32>,
    pub roughness: Option<f32>,
    pub metallic_roughness_texture: Option<TextureValue>,
    pub normal_texture: Option<TextureValue>,
    pub normal_scale: Option<f32>,
    pub occlusion_texture: Option<TextureValue>,
    pub occlusion_strength: Option<f32>,
    pub emission: Option<Color>,
    pub emission_texture: Option<TextureValue>,
    pub alpha_mode: Option<AlphaModeName>,
    pub alpha_cutoff: Option<f32>,
    pub double_sided: Option<bool>,
    pub unlit: Option<bool>,
    pub ior: Option<f32>,
    pub specular: Option<f32>,
    pub specular_texture: Option<TextureValue>,
    pub specular_color: Option<Color>,
    pub specular_color_texture: Option<TextureValue>,
    pub clearcoat: Option<f32>,
    pub clearcoat_texture: Option<TextureValue>,
    pub clearcoat_roughness: Option<f32>,
    pub clearcoat_roughness_texture: Option<TextureValue>,
    pub clearcoat_normal_texture: Option<TextureValue>,
    pub clearcoat_normal_scale: Option<f32>,
    pub sheen_color: Option<Color>,
    pub sheen_color_texture: Option<TextureValue>,
    pub sheen_roughness: Option<f32>,
    pub sheen_roughness_texture: Option<TextureValue>,
    pub anisotropy: Option<f32>,
    pub anisotropy_rotation_deg: Option<f32>,
    pub anisotropy_texture: Option<TextureValue>,
    pub transmission: Option<f32>,
    pub transmission_texture: Option<TextureValue>,
    pub thickness: Option<f32>,
    pub thickness_texture: Option<TextureValue>,
    pub attenuation_distance: Option<f32>,
    pub attenuation_color: Option<Color>,
    pub iridescence: Option<f32>,
    pub iridescence_texture: Option<TextureValue>,
    pub iridescence_ior: Option<f32>,
    pub iridescence_thickness: Option<[f32; 2]>,
    pub iridescence_thickness_texture: Option<TextureValue>,
    pub dispersion: Option<f32>,
}

/// `form` of a material's model.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum FormName {
    Corrected,
    Printed,
}

/// `alpha_mode` of a material.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum AlphaModeName {
    Opaque,
    Mask,
    Blend,
}

/// A texture with its options.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct TextureTable {
    pub file: String,
    #[serde(default)]
    pub uv_set: usize,
    #[serde(default)]
    pub offset: [f32; 2],
    #[serde(default = "ones")]
    pub scale: [f32; 2],
    #[serde(default)]
    pub rotation_deg: f32,
    #[serde(default)]
    pub wrap: WrapName,
    #[serde(default)]
    pub filter: FilterName,
}

fn ones() -> [f32; 2] {
    [1.0; 2]
}

/// `wrap` of a texture.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum WrapName {
    #[default]
    Repeat,
    Mirror,
    Clamp,
}

/// `filter` of a texture.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum FilterName {
    Nearest,
    #[default]
    Linear,
}

/// A file name, a table, or `false` for no texture.
#[derive(Clone, Debug, PartialEq)]
pub enum TextureValue {
    Off,
    On(TextureTable),
}

impl<'de> Deserialize<'de> for TextureValue {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Value;
        impl<'de> Visitor<'de> for Value {
            type Value = TextureValue;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a file name, a table { file = … } or false")
            }

            fn visit_bool<E: de::Error>(self, on: bool) -> Result<TextureValue, E> {
                if on { Err(E::invalid_value(de::Unexpected::Bool(true), &self)) } else { Ok(TextureValue::Off) }
            }

            fn visit_str<E: de::Error>(self, file: &str) -> Result<TextureValue, E> {
                Ok(TextureValue::On(TextureTable {
                    file: file.into(),
                    uv_set: 0,
                    offset: [0.0; 2],
                    scale: ones(),
                    rotation_deg: 0.0,
                    wrap: WrapName::default(),
                    filter: FilterName::default(),
                }))
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<TextureValue, A::Error> {
                TextureTable::deserialize(MapAccessDeserializer::new(map)).map(TextureValue::On)
            }
        }
        deserializer.deserialize_any(Value)
    }
}

/// Linear RGB: three numbers, or one for grey.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Color(pub [f32; 3]);

impl<'de> Deserialize<'de> for Color {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        one_or_three(deserializer, "a colour: one number or [r, g, b]").map(Self)
    }
}

/// Scale along the axes: three numbers, or one for all.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale(pub [f32; 3]);

impl<'de> Deserialize<'de> for Scale {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        one_or_three(deserializer, "a scale: one number or [x, y, z]").map(Self)
    }
}

fn one_or_three<'de, D: Deserializer<'de>>(deserializer: D, expected: &'static str) -> Result<[f32; 3], D::Error> {
    struct OneOrThree(&'static str);
    impl<'de> Visitor<'de> for OneOrThree {
        type Value = [f32; 3];

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str(self.0)
        }

        fn visit_f64<E: de::Error>(self, value: f64) -> Result<[f32; 3], E> {
            Ok([value as f32; 3])
        }

        fn visit_i64<E: de::Error>(self, value: i64) -> Result<[f32; 3], E> {
            Ok([value as f32; 3])
        }

        fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<[f32; 3], A::Error> {
            let list = Vec::<f32>::deserialize(SeqAccessDeserializer::new(list))?;
            list.as_slice().try_into().map_err(|_| de::Error::invalid_length(list.len(), &self))
        }
    }
    deserializer.deserialize_any(OneOrThree(expected))
}

/// An animation: its name or number, or `false` for none.
#[derive(Clone, Debug, PartialEq)]
pub enum Choice {
    None,
    Number(usize),
    Name(String),
}

impl<'de> Deserialize<'de> for Choice {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Value;
        impl Visitor<'_> for Value {
            type Value = Choice;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("the name or number of an animation, or false")
            }

            fn visit_bool<E: de::Error>(self, on: bool) -> Result<Choice, E> {
                if on { Err(E::invalid_value(de::Unexpected::Bool(true), &self)) } else { Ok(Choice::None) }
            }

            fn visit_i64<E: de::Error>(self, number: i64) -> Result<Choice, E> {
                usize::try_from(number).map(Choice::Number).map_err(|_| E::invalid_value(de::Unexpected::Signed(number), &self))
            }

            fn visit_str<E: de::Error>(self, name: &str) -> Result<Choice, E> {
                Ok(Choice::Name(name.into()))
            }
        }
        deserializer.deserialize_any(Value)
    }
}

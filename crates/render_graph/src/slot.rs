//! Slots: the named images that passes hand to each other, each with its format, unit and meaning.
//!
//! A pass names the slots it reads and writes; nothing else connects passes. What a technique needs to know about its input is a
//! property of the slot, never a parameter of the technique that made it.

use wgpu::TextureFormat;

/// A named image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Slot {
    /// Name in messages and timers.
    pub name: &'static str,
    /// Texel format.
    pub format: TextureFormat,
    /// Layers.
    pub layers: Layers,
    /// Unit of a texel.
    pub unit: &'static str,
    /// What a texel means.
    pub doc: &'static str,
}

/// Layers of a slot's image; all of them have the size of the frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layers {
    /// A plain image.
    One,
    /// An array with a layer for each light of the group that is worked on.
    PerLight,
}

macro_rules! slots {
    ($($(#[doc = $doc:literal])+ $name:ident = $text:literal, $format:ident, $layers:ident, $unit:literal;)*) => {$(
        $(#[doc = $doc])+
        pub const $name: Slot =
            Slot { name: $text, format: TextureFormat::$format, layers: Layers::$layers, unit: $unit, doc: concat!($($doc),+) };
    )*
        /// Every slot that is declared here.
        pub const ALL: &[Slot] = &[$($name),*];
    };
}

slots! {
    /// Reversed depth: near / distance along the view axis, 0 where nothing is seen. Parallel cameras: 1 − distance / far.
    DEPTH = "depth", Depth32Float, One, "1";
    /// Shading and geometric normal in world axes, both towards the viewer, octahedral: each packed as two 16-bit signed numbers.
    NORMAL = "normal", Rg32Uint, One, "1";
    /// Base colour and metalness: diffuse albedo is rgb · (1 − a).
    ALBEDO = "albedo", Rgba16Float, One, "1";
    /// Reflectance at normal incidence of the base layer, and perceptual roughness.
    F0_ROUGHNESS = "f0_roughness", Rgba16Float, One, "1";
    /// The other layers of the material, packed: clear coat, sheen, anisotropy, transmission, film.
    LAYERS = "layers", Rgba32Uint, One, "1";
    /// Emitted radiance of the surface; in the fourth channel the point's distance along the viewing axis one frame ago over that of now.
    EMISSION = "emission", Rgba16Float, One, "W/(m² sr)";
    /// Radiance of the environment where no surface is seen, and of lights with an extent in front of what is seen.
    BACKGROUND = "background", Rgba32Float, One, "W/(m² sr)";
    /// Where the surface point is now minus where it was one frame ago, x right and y down; −1e9 where it was behind the camera.
    MOTION = "motion", Rg32Float, One, "px";
    /// Instance + 1; material + 1, with the highest bit set for unlit surfaces. Zeros where nothing is seen.
    IDS = "ids", Rg32Uint, One, "1";
    /// V: the share of each light that the point sees.
    SHADOW_VISIBILITY = "shadow_visibility", R32Float, PerLight, "1";
    /// V while it is being filtered.
    SHADOW_FILTERED = "shadow_filtered", R32Float, PerLight, "1";
    /// The share of the hemisphere, weighted with the cosine, in which nothing is met within the distance that the frame asks for.
    AMBIENT_VISIBILITY = "ambient_visibility", R32Float, One, "1";
    /// The same while it is being filtered.
    AMBIENT_FILTERED = "ambient_filtered", R32Float, One, "1";
    /// Reflected light that arrives straight from lights.
    DIRECT = "direct", Rgba32Float, One, "W/(m² sr)";
    /// Copy of `direct` while another group of lights is added to it.
    DIRECT_BEFORE = "direct_before", Rgba32Float, One, "W/(m² sr)";
    /// Irradiance by light that bounced at least once before it arrives.
    DIFFUSE_INDIRECT = "diffuse_indirect", Rgba32Float, One, "W/m²";
    /// The linear picture without reflections: emission, light straight from lights, indirect light and the environment's by diffuse lobes, background.
    LIT = "lit", Rgba32Float, One, "W/(m² sr)";
    /// What specular lobes reflect of everything but analytic lights: other surfaces, emissive meshes, the environment.
    SPECULAR_INDIRECT = "specular_indirect", Rgba32Float, One, "W/(m² sr)";
    /// The linear picture before exposure.
    COLOR = "color", Rgba32Float, One, "W/(m² sr)";
    /// The same after anti-aliasing.
    RESOLVED = "resolved", Rgba32Float, One, "W/(m² sr)";
    /// The picture after exposure and tone map, encoded for sRGB displays.
    DISPLAY = "display", Rgba8Unorm, One, "sRGB";
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique() {
        for (i, a) in ALL.iter().enumerate() {
            assert!(ALL[..i].iter().all(|b| b.name != a.name), "{} twice", a.name);
        }
    }
}

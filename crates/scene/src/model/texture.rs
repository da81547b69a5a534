//! Images, how they are sampled, and where a material uses them.

use glam::Affine2;

/// A decoded image.
#[derive(Clone, Debug)]
pub struct TextureImage {
    /// For messages.
    pub name: String,
    /// Width, px.
    pub width: u32,
    /// Height, px.
    pub height: u32,
    /// Row-major, top row first, `width × height` texels.
    pub texels: Texels,
}

/// Texels in the precision the file had.
#[derive(Clone, Debug)]
pub enum Texels {
    /// 8 bits a channel, encoded as [`Texture::color_space`] says.
    Rgba8(Vec<[u8; 4]>),
    /// 16 bits a channel, encoded as [`Texture::color_space`] says.
    Rgba16(Vec<[u16; 4]>),
    /// Linear floats.
    Rgba32F(Vec<[f32; 4]>),
    /// Linear floats without alpha: environments, whose texels are many.
    Rgb32F(Vec<[f32; 3]>),
}

/// An image with its sampler and encoding.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Texture {
    /// Index into [`Scene::images`](crate::Scene::images).
    pub image: usize,
    /// Addressing along u and v.
    pub wrap: [Wrap; 2],
    /// Magnification filter; minification is the renderer's choice.
    pub filter: Filter,
    /// How 8- and 16-bit colour channels are encoded. Alpha is always linear.
    pub color_space: ColorSpace,
}

/// Addressing outside [0, 1].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Wrap {
    /// Periodic.
    #[default]
    Repeat,
    /// Mirrored at every integer.
    Mirror,
    /// The border texel goes on.
    Clamp,
}

/// Magnification filter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Filter {
    /// Nearest texel.
    Nearest,
    /// Bilinear.
    #[default]
    Linear,
}

/// Encoding of the colour channels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ColorSpace {
    /// sRGB, decoded before filtering.
    Srgb,
    /// Linear data.
    Linear,
}

/// A use of a texture by a material.    KHR_texture_transform
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextureRef {
    /// Index into [`Scene::textures`](crate::Scene::textures).
    pub texture: usize,
    /// Which set of [`Mesh::uvs`](crate::Mesh::uvs), 0 or 1.
    pub uv_set: usize,
    /// Applied to the texture coordinates.
    pub transform: Affine2,
}

//! Textures with their mip levels: a list that shaders choose from, or one buffer of texels where shaders cannot choose.

use crate::Error;
use kajo_render_graph::wgpu;
use kajo_render_graph::{Bindings, Buffer, Device, Resource, Texture};
use kajo_scene::{ColorSpace, Filter, Scene, Texels, TextureImage, Wrap};
use kajo_units::{linear_from_srgb, srgb_from_linear};

/// The scene's textures on the device.
#[derive(Debug)]
pub(crate) enum Textures {
    /// One texture each; the first entry stands in where a scene has none.
    List { _textures: Vec<Texture>, views: Vec<wgpu::TextureView>, samplers: Vec<wgpu::Sampler> },
    /// All texels in one buffer.
    Buffer { table: Buffer, texels: Buffer },
}

/// Place of a texture's sampler in the list: filter fastest, then wrap of u, then of v.
pub(crate) fn sampler_index(texture: &kajo_scene::Texture) -> u32 {
    let wrap = |wrap: Wrap| match wrap {
        Wrap::Repeat => 0,
        Wrap::Mirror => 1,
        Wrap::Clamp => 2,
    };
    let filter = match texture.filter {
        Filter::Nearest => 0,
        Filter::Linear => 1,
    };
    filter + 2 * (wrap(texture.wrap[0]) + 3 * wrap(texture.wrap[1]))
}

/// Texels of one level in the format of the device.
struct Level {
    width: u32,
    height: u32,
    bytes: Vec<u8>,
}

/// How texels are stored.
#[derive(Clone, Copy, PartialEq)]
enum Format {
    Unorm,
    Srgb,
    Half,
}

impl Textures {
    pub fn new(device: &Device, scene: &Scene, bindless: bool) -> Result<Self, Error> {
        if bindless { Ok(Self::list(device, scene)) } else { Self::buffer(device, scene) }
    }

    /// Length of the list of textures.
    pub fn count(&self) -> u32 {
        match self {
            Self::List { views, .. } => views.len() as u32,
            Self::Buffer { .. } => 0,
        }
    }

    /// True when shaders choose from a list.
    pub fn is_list(&self) -> bool {
        matches!(self, Self::List { .. })
    }

    pub fn bind<'a>(&'a self, bindings: Bindings<'a>) -> Bindings<'a> {
        match self {
            Self::List { views, samplers, .. } => {
                bindings.with("textures", Resource::Views(views)).with("samplers", Resource::Samplers(samplers))
            }
            Self::Buffer { table, texels } => bindings.with("texture_table", table).with("texels", texels),
        }
    }

    fn list(device: &Device, scene: &Scene) -> Self {
        let mut textures: Vec<Texture> = scene.textures.iter().map(|texture| upload(device, scene, texture)).collect();
        if textures.is_empty() {
            let white = Level { width: 1, height: 1, bytes: vec![255; 4] };
            textures.push(upload_levels(device, "white", Format::Unorm, &[white]));
        }
        let views = textures.iter().map(|texture| texture.view.clone()).collect();
        Self::List { views, _textures: textures, samplers: samplers(device) }
    }

    fn buffer(device: &Device, scene: &Scene) -> Result<Self, Error> {
        let mut table: Vec<[u32; 8]> = Vec::new();
        let mut texels: Vec<u8> = Vec::new();
        for texture in &scene.textures {
            let image = &scene.images[texture.image];
            let format = format_of(image, texture.color_space);
            let levels = levels(image, texture.color_space);
            let code = match format {
                Format::Unorm => 0,
                Format::Srgb => 1,
                Format::Half => 2,
            };
            table.push([(texels.len() / 4) as u32, image.width, image.height, levels.len() as u32, code, 0, 0, 0]);
            levels.iter().for_each(|level| texels.extend(&level.bytes));
        }
        if table.is_empty() {
            // Shaders are bound to at least one entry, which nothing refers to.
            table.push([0; 8]);
        }
        let storage = wgpu::BufferUsages::STORAGE;
        Ok(Self::Buffer {
            table: device.buffer_with("texture table", &table, storage)?,
            texels: device.buffer_with("texels", &texels, storage)?,
        })
    }
}

fn upload(device: &Device, scene: &Scene, texture: &kajo_scene::Texture) -> Texture {
    let image = &scene.images[texture.image];
    let format = format_of(image, texture.color_space);
    upload_levels(device, &image.name, format, &levels(image, texture.color_space))
}

fn upload_levels(device: &Device, label: &str, format: Format, levels: &[Level]) -> Texture {
    let (device_format, texel) = match format {
        Format::Unorm => (wgpu::TextureFormat::Rgba8Unorm, 4),
        Format::Srgb => (wgpu::TextureFormat::Rgba8UnormSrgb, 4),
        Format::Half => (wgpu::TextureFormat::Rgba16Float, 8),
    };
    let size = |level: &Level| wgpu::Extent3d { width: level.width, height: level.height, depth_or_array_layers: 1 };
    let out = device.texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: size(&levels[0]),
        mip_level_count: levels.len() as u32,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: device_format,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    for (index, level) in levels.iter().enumerate() {
        let target = wgpu::TexelCopyTextureInfo {
            texture: &out.wgpu,
            mip_level: index as u32,
            origin: wgpu::Origin3d::ZERO,
            aspect: wgpu::TextureAspect::All,
        };
        let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(level.width * texel), rows_per_image: None };
        device.queue.write_texture(target, &level.bytes, layout, size(level));
    }
    out
}

fn samplers(device: &Device) -> Vec<wgpu::Sampler> {
    let wraps = [wgpu::AddressMode::Repeat, wgpu::AddressMode::MirrorRepeat, wgpu::AddressMode::ClampToEdge];
    let filters = [wgpu::FilterMode::Nearest, wgpu::FilterMode::Linear];
    (0..18)
        .map(|index| {
            let filter = filters[index % 2];
            device.wgpu.create_sampler(&wgpu::SamplerDescriptor {
                label: Some("material"),
                address_mode_u: wraps[index / 2 % 3],
                address_mode_v: wraps[index / 6],
                mag_filter: filter,
                min_filter: filter,
                mipmap_filter: wgpu::MipmapFilterMode::Linear,
                ..Default::default()
            })
        })
        .collect()
}

fn format_of(image: &TextureImage, space: ColorSpace) -> Format {
    match (&image.texels, space) {
        (Texels::Rgba8(_), ColorSpace::Srgb) => Format::Srgb,
        (Texels::Rgba8(_), ColorSpace::Linear) => Format::Unorm,
        (Texels::Rgba16(_) | Texels::Rgba32F(_) | Texels::Rgb32F(_), _) => Format::Half,
    }
}

/// All levels down to one texel: each the mean of 2×2 texels of the level above, in linear light. An odd last row or column is dropped,
/// as the samplers of the device place the texels.
fn levels(image: &TextureImage, space: ColorSpace) -> Vec<Level> {
    let format = format_of(image, space);
    let decode = |c: f32| if space == ColorSpace::Srgb { linear_from_srgb(c) } else { c };
    let mut linear: Vec<[f32; 4]> = match &image.texels {
        Texels::Rgba8(texels) => {
            let table: Vec<f32> = (0..=255u8).map(|c| decode(f32::from(c) / 255.0)).collect();
            let look = |c: u8| table[usize::from(c)];
            texels.iter().map(|&[r, g, b, a]| [look(r), look(g), look(b), f32::from(a) / 255.0]).collect()
        }
        Texels::Rgba16(texels) => {
            let unit = |c: u16| f32::from(c) / 65535.0;
            texels.iter().map(|&[r, g, b, a]| [decode(unit(r)), decode(unit(g)), decode(unit(b)), unit(a)]).collect()
        }
        Texels::Rgba32F(texels) => texels.clone(),
        Texels::Rgb32F(texels) => texels.iter().map(|&[r, g, b]| [r, g, b, 1.0]).collect(),
    };
    let (mut width, mut height) = (image.width, image.height);
    let first = match &image.texels {
        Texels::Rgba8(texels) => bytemuck::cast_slice(texels).to_vec(),
        _ => encode(&linear, format),
    };
    let mut out = vec![Level { width, height, bytes: first }];
    while width > 1 || height > 1 {
        let (w, h) = ((width / 2).max(1), (height / 2).max(1));
        let at = |x: u32, y: u32| linear[(y.min(height - 1) * width + x.min(width - 1)) as usize];
        let mean = |x: u32, y: u32| {
            let four = [at(2 * x, 2 * y), at(2 * x + 1, 2 * y), at(2 * x, 2 * y + 1), at(2 * x + 1, 2 * y + 1)];
            std::array::from_fn(|c| four.iter().map(|texel| texel[c]).sum::<f32>() * 0.25)
        };
        let next: Vec<[f32; 4]> = (0..h).flat_map(|y| (0..w).map(move |x| (x, y))).map(|(x, y)| mean(x, y)).collect();
        (linear, width, height) = (next, w, h);
        out.push(Level { width, height, bytes: encode(&linear, format) });
    }
    out
}

fn encode(texels: &[[f32; 4]], format: Format) -> Vec<u8> {
    let unorm = |c: f32| (c.clamp(0.0, 1.0) * 255.0 + 0.5) as u8;
    match format {
        Format::Unorm => texels.iter().flat_map(|texel| texel.map(unorm)).collect(),
        Format::Srgb => {
            texels.iter().flat_map(|t| [srgb_from_linear(t[0]), srgb_from_linear(t[1]), srgb_from_linear(t[2]), t[3]].map(unorm)).collect()
        }
        Format::Half => {
            texels.iter().flat_map(|texel| texel.map(|c| half::f16::from_f32(c.clamp(-65504.0, 65504.0)).to_le_bytes())).flatten().collect()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_are_means_in_linear_light() {
        let texels = vec![[0, 0, 0, 255], [255, 255, 255, 255], [255, 255, 255, 255], [0, 0, 0, 255]];
        let image = TextureImage { name: String::new(), width: 2, height: 2, texels: Texels::Rgba8(texels) };
        let srgb = levels(&image, ColorSpace::Srgb);
        assert_eq!((srgb.len(), srgb[1].bytes.as_slice()), (2, &[188, 188, 188, 255][..]));
        let linear = levels(&image, ColorSpace::Linear);
        assert_eq!(linear[1].bytes, [128, 128, 128, 255]);
    }

    #[test]
    fn odd_sizes_end_at_one_texel() {
        let image = TextureImage { name: String::new(), width: 5, height: 3, texels: Texels::Rgba32F(vec![[0.5; 4]; 15]) };
        let sizes: Vec<_> = levels(&image, ColorSpace::Linear).iter().map(|level| (level.width, level.height)).collect();
        assert_eq!(sizes, [(5, 3), (2, 1), (1, 1)]);
    }
}

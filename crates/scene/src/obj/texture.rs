//! Textures of MTL materials: options before the file name, channels gathered as glTF packs them.

use super::{Notes, portable};
use crate::decode::{self, Decoded, Encoded};
use crate::gltf::ResourceReader;
use crate::limits::{Budget, ImportLimits};
use crate::{ColorSpace, Filter, Scene, SceneError, Texels, Texture, TextureImage, TextureRef, Wrap};
use glam::{Affine2, Vec2, Vec4};
use std::collections::HashMap;
use std::sync::Arc;

/// A texture statement, parsed.
#[derive(Clone, Debug, PartialEq)]
pub struct Statement {
    /// The file name; may contain spaces.
    pub name: String,
    scale: Vec2,
    offset: Vec2,
    clamp: bool,
    /// `-bm`, the strength of bumps and normal maps.
    pub multiplier: f32,
    /// Options that have no effect here.
    pub ignored: Vec<String>,
}

impl Statement {
    /// Parses `-option values… name`.
    pub fn parse(text: &str) -> Self {
        let mut statement =
            Self { name: String::new(), scale: Vec2::ONE, offset: Vec2::ZERO, clamp: false, multiplier: 1.0, ignored: Vec::new() };
        let mut words = text.split_whitespace().peekable();
        while let Some(option) = words.next_if(|word| word.starts_with('-') && word.len() > 1) {
            let mut numbers = |most: usize| {
                let mut list = Vec::new();
                while list.len() < most {
                    match words.peek().and_then(|word| word.parse::<f32>().ok()).filter(|n| n.is_finite()) {
                        Some(number) => list.push(number),
                        None => break,
                    }
                    words.next();
                }
                list
            };
            match option {
                "-s" | "-o" | "-t" => {
                    let list = numbers(3);
                    let default = if option == "-s" { 1.0 } else { 0.0 };
                    let pair = Vec2::new(list.first().copied().unwrap_or(default), list.get(1).copied().unwrap_or(default));
                    match option {
                        "-s" => statement.scale = pair,
                        "-o" => statement.offset = pair,
                        _ => statement.ignored.push(option.into()),
                    }
                }
                "-bm" => statement.multiplier = numbers(1).first().copied().unwrap_or(1.0),
                "-mm" => {
                    numbers(2);
                    statement.ignored.push(option.into());
                }
                "-boost" | "-texres" => {
                    numbers(1);
                    statement.ignored.push(option.into());
                }
                "-clamp" => statement.clamp = words.next() == Some("on"),
                "-blendu" | "-blendv" | "-cc" => {
                    words.next();
                }
                "-imfchan" | "-type" => {
                    words.next();
                    statement.ignored.push(option.into());
                }
                unknown => statement.ignored.push(unknown.into()),
            }
        }
        statement.name = words.collect::<Vec<_>>().join(" ");
        statement
    }

    /// From texture coordinates (v down) to those of the image: OBJ scales and moves with v up.
    fn transform(&self) -> Affine2 {
        let flip = Affine2::from_scale_angle_translation(Vec2::new(1.0, -1.0), 0.0, Vec2::new(0.0, 1.0));
        flip * Affine2::from_scale_angle_translation(self.scale, 0.0, self.offset) * flip
    }
}

/// Images by file, each decoded once.
pub struct Images<'a> {
    reader: &'a dyn ResourceReader,
    decoded: HashMap<String, Option<Arc<TextureImage>>>,
    budget: Budget,
}

impl<'a> Images<'a> {
    /// Images that `reader` hands out, within `limits`.
    pub fn new(reader: &'a dyn ResourceReader, limits: ImportLimits) -> Self {
        Self { reader, decoded: HashMap::new(), budget: Budget::new(limits) }
    }

    /// The image that `statement` names; a note and `None` where the file cannot be read.
    ///
    /// # Errors
    /// A file that is there and cannot be decoded.
    pub fn get(&mut self, statement: &Statement, place: &str, notes: &mut Notes) -> Result<Option<Arc<TextureImage>>, SceneError> {
        let path = portable(&statement.name);
        if let Some(known) = self.decoded.get(&path) {
            return Ok(known.clone());
        }
        let image = match self.reader.read(&path) {
            Ok(bytes) => {
                let name = path.rsplit('/').next().unwrap_or(&path).to_owned();
                let encoded = Encoded { file: &path, place: "image".into(), name, bytes: &bytes };
                let Decoded { image, note } = decode::decode(&encoded, &self.budget)?;
                note.into_iter().for_each(|(feature, consequence)| notes.add(format!("texture `{path}`"), feature, consequence));
                Some(Arc::new(image))
            }
            Err(reason) => {
                notes.add(place, format!("texture `{}`", statement.name), format!("cannot be read ({reason}); its factor stands alone"));
                None
            }
        };
        self.decoded.insert(path, image.clone());
        Ok(image)
    }
}

/// Adds an image to the scene and returns its use; equal images and samplers are shared.
pub fn use_image(scene: &mut Scene, image: Arc<TextureImage>, color_space: ColorSpace, statement: &Statement) -> TextureRef {
    let index = scene.images.iter().position(|i| Arc::ptr_eq(i, &image)).unwrap_or_else(|| {
        scene.images.push(image);
        scene.images.len() - 1
    });
    let wrap = if statement.clamp { Wrap::Clamp } else { Wrap::Repeat };
    let texture = Texture { image: index, wrap: [wrap; 2], filter: Filter::Linear, color_space };
    let texture = scene.textures.iter().position(|t| *t == texture).unwrap_or_else(|| {
        scene.textures.push(texture);
        scene.textures.len() - 1
    });
    TextureRef { texture, uv_set: 0, transform: statement.transform() }
}

/// A new image whose texels come from those of up to two others at the same place, encoded values in [0, 1]; the larger one gives the size. An
/// absent image is white.
pub fn combine(name: String, [first, second]: [Option<&TextureImage>; 2], texel: impl Fn(Vec4, Vec4) -> Vec4) -> Arc<TextureImage> {
    let size = |image: Option<&TextureImage>| image.map_or((1, 1), |i| (i.width, i.height));
    let (a, b) = (size(first), size(second));
    let (width, height) = (a.0.max(b.0), a.1.max(b.1));
    let sampler = Texture { image: 0, wrap: [Wrap::Repeat; 2], filter: Filter::Linear, color_space: ColorSpace::Linear };
    let mut texels = Vec::with_capacity(width as usize * height as usize);
    for y in 0..height {
        for x in 0..width {
            let uv = (Vec2::new(x as f32, y as f32) + 0.5) / Vec2::new(width as f32, height as f32);
            let look = |image: Option<&TextureImage>| image.map_or(Vec4::ONE, |i| sampler.lookup(i, uv));
            let value = texel(look(first), look(second)).clamp(Vec4::ZERO, Vec4::ONE) * 255.0 + 0.5;
            texels.push(value.to_array().map(|c| c as u8));
        }
    }
    Arc::new(TextureImage { name, width, height, texels: Texels::Rgba8(texels) })
}

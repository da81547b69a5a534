//! Textures: an image once for each way it is encoded and sampled, decoded in parallel when all are known.

use super::json::{Image, Texture as TextureJson, TextureInfo};
use super::notes::Notes;
use super::resources::{Resources, label};
use crate::decode::{self, Decoded, Encoded};
use crate::{ColorSpace, Filter, SceneError, Texels, Texture, TextureImage, TextureRef, Wrap};
use glam::{Affine2, Vec2};
use rayon::prelude::*;
use std::borrow::Cow;
use std::collections::HashMap;
use std::hash::Hash;
use std::sync::Arc;

/// Where an image of the scene comes from.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
enum Source {
    /// An image of the file.
    File(usize),
    /// The roughness 1 − glossiness · A of a specular-glossiness image, in the channel G of a metallic-roughness image.
    RoughnessOf {
        image: usize,
        /// The bits of the number.
        glossiness: u32,
    },
}

/// Distinct values in the order in which they first came.
struct Distinct<T> {
    values: Vec<T>,
    index: HashMap<T, usize>,
}

impl<T: Copy + Eq + Hash> Distinct<T> {
    fn new() -> Self {
        Self { values: Vec::new(), index: HashMap::new() }
    }

    /// The index of a value, which is added where it is new.
    fn add(&mut self, value: T) -> usize {
        let next = self.values.len();
        let index = *self.index.entry(value).or_insert(next);
        if index == next {
            self.values.push(value);
        }
        index
    }
}

/// The textures in the making.
pub struct Textures<'r, 'a> {
    resources: &'r Resources<'a>,
    textures: Distinct<Texture>,
    sources: Distinct<Source>,
}

/// Which `TEXCOORD_n` of a mesh the two slots of texture coordinates hold, for one material.
#[derive(Default)]
pub struct UvSlots([Option<usize>; 2]);

impl UvSlots {
    /// The slot of a set: its own where it can have it, else the other; `None` when both are taken.
    fn slot(&mut self, set: usize) -> Option<usize> {
        if let Some(slot) = self.0.iter().position(|&taken| taken == Some(set)) {
            return Some(slot);
        }
        let slot = [set.min(1), 1 - set.min(1)].into_iter().find(|&slot| self.0[slot].is_none())?;
        self.0[slot] = Some(set);
        Some(slot)
    }

    /// The sets in the slots; a free slot holds the set of its own number, which cannot stand in the other one.
    pub fn sets(&self) -> [usize; 2] {
        [self.0[0].unwrap_or(0), self.0[1].unwrap_or(1)]
    }

    /// Which slots a texture reads.
    pub fn used(&self) -> [bool; 2] {
        self.0.map(|set| set.is_some())
    }
}

impl<'r, 'a> Textures<'r, 'a> {
    pub fn new(resources: &'r Resources<'a>) -> Self {
        Self { resources, textures: Distinct::new(), sources: Distinct::new() }
    }

    /// The use of a texture by a material, or `None` with a note where the file has no image for it that Kajo reads.
    pub fn reference(
        &mut self,
        info: &TextureInfo,
        color_space: ColorSpace,
        slots: &mut UvSlots,
        place: &str,
        notes: &mut Notes,
    ) -> Result<Option<TextureRef>, SceneError> {
        let Some((image, texture)) = self.image_of(info, place, notes)? else { return Ok(None) };
        self.add(Source::File(image), texture, info, color_space, slots, place, notes).map(Some)
    }

    /// The roughness behind a specular-glossiness texture, as the channel G of a metallic-roughness texture.
    pub fn roughness_of(
        &mut self,
        info: &TextureInfo,
        glossiness: f32,
        slots: &mut UvSlots,
        place: &str,
        notes: &mut Notes,
    ) -> Result<Option<TextureRef>, SceneError> {
        let Some((image, texture)) = self.image_of(info, place, notes)? else { return Ok(None) };
        self.add(Source::RoughnessOf { image, glossiness: glossiness.to_bits() }, texture, info, ColorSpace::Linear, slots, place, notes)
            .map(Some)
    }

    /// Index of the image that a texture shows, and the texture.
    fn image_of(&self, info: &TextureInfo, place: &str, notes: &mut Notes) -> Result<Option<(usize, &'a TextureJson)>, SceneError> {
        let document = self.resources.document;
        let texture = self.resources.get(&document.textures, "texture", info.index, place)?;
        let place = label("texture", info.index, &texture.name);
        notes.unknown_extensions(&place, texture.extensions.other.keys());
        let extended = [&texture.extensions.basisu, &texture.extensions.webp];
        let image = extended.into_iter().flatten().find_map(|extension| extension.source).or(texture.source);
        let Some(image) = image else {
            notes.add(&place, "a texture without an image", "its material is shown without it");
            return Ok(None);
        };
        self.resources.get(&document.images, "image", image, &place)?;
        Ok(Some((image, texture)))
    }

    #[expect(clippy::too_many_arguments, reason = "one call each for the two kinds of source")]
    fn add(
        &mut self,
        source: Source,
        texture: &TextureJson,
        info: &TextureInfo,
        color_space: ColorSpace,
        slots: &mut UvSlots,
        place: &str,
        notes: &mut Notes,
    ) -> Result<TextureRef, SceneError> {
        let image = self.sources.add(source);
        let (wrap, filter) = self.sampler(texture.sampler, info.index)?;
        let texture = self.textures.add(Texture { image, wrap, filter, color_space });

        notes.unknown_extensions(place, info.extensions.other.keys());
        let transform = info.extensions.transform.as_ref();
        let set = transform.and_then(|transform| transform.tex_coord).unwrap_or(info.tex_coord);
        let slot = slots.slot(set).unwrap_or_else(|| {
            notes.add(place, format!("TEXCOORD_{set}"), "a material uses at most two sets of texture coordinates, another one is taken");
            0
        });
        // The rotation is counter-clockwise as seen with v up; here v is down.    KHR_texture_transform, "Overview" and its example
        let transform = transform.map_or(Affine2::IDENTITY, |t| {
            let vec2 = |[u, v]: [super::json::Num; 2]| Vec2::new(u.0, v.0);
            Affine2::from_scale_angle_translation(vec2(t.scale), -t.rotation.0, vec2(t.offset))
        });
        Ok(TextureRef { texture, uv_set: slot, transform })
    }

    fn sampler(&self, sampler: Option<usize>, texture: usize) -> Result<([Wrap; 2], Filter), SceneError> {
        let Some(index) = sampler else { return Ok(Default::default()) };
        let sampler = self.resources.get(&self.resources.document.samplers, "sampler", index, &format!("texture {texture}"))?;
        let place = format!("sampler {index}");
        let wrap = |code: Option<u32>| match code {
            None | Some(10497) => Ok(Wrap::Repeat),
            Some(33648) => Ok(Wrap::Mirror),
            Some(33071) => Ok(Wrap::Clamp),
            Some(code) => Err(self.resources.invalid(&place, format!("its wrapping mode {code} is none of 10497, 33071 and 33648"))),
        };
        let filter = match sampler.mag_filter {
            None | Some(9729) => Filter::Linear,
            Some(9728) => Filter::Nearest,
            Some(code) => return Err(self.resources.invalid(&place, format!("its magFilter {code} is neither 9728 nor 9729"))),
        };
        Ok(([wrap(sampler.wrap_s)?, wrap(sampler.wrap_t)?], filter))
    }

    /// Decodes the images.
    pub fn finish(self, notes: &mut Notes) -> Result<(Vec<Texture>, Vec<Arc<TextureImage>>), SceneError> {
        let mut used = Distinct::new();
        for source in &self.sources.values {
            used.add(source.image());
        }
        let resources = self.resources;
        let files: Vec<(Cow<'_, [u8]>, String, String)> = used.values.iter().map(|&index| self.file(index)).collect::<Result<_, _>>()?;
        let budget = resources.budget;
        let file = resources.file;
        let results: Vec<Result<Decoded, SceneError>> = files
            .par_iter()
            .map(|(bytes, place, name)| decode::decode(&Encoded { file, place: place.clone(), name: name.clone(), bytes }, budget))
            .collect();
        let mut decoded = Vec::with_capacity(results.len());
        for (result, (_, place, _)) in results.into_iter().zip(files) {
            let Decoded { image, note } = result?;
            note.into_iter().for_each(|(feature, consequence)| notes.add(&place, feature, consequence));
            decoded.push(Arc::new(image));
        }
        let image_of = |index| &decoded[used.index[&index]];
        let images = self.sources.values.iter().map(|source| match *source {
            Source::File(index) => Ok(image_of(index).clone()),
            Source::RoughnessOf { image, glossiness } => {
                let image = image_of(image);
                budget.claim(file, &image.name, u64::from(image.width) * u64::from(image.height), 8)?;
                Ok(Arc::new(roughness(image, f32::from_bits(glossiness))))
            }
        });
        let images = images.collect::<Result<_, SceneError>>()?;
        Ok((self.textures.values, images))
    }

    /// The bytes of an image file, its place and its name.
    fn file(&self, index: usize) -> Result<(Cow<'r, [u8]>, String, String), SceneError> {
        let image: &Image = &self.resources.document.images[index];
        let mut name = image.name.clone();
        if name.is_empty() {
            name = image.uri.as_deref().filter(|uri| !uri.starts_with("data:")).map_or_else(|| format!("image {index}"), super::uri::short);
        }
        let place = label("image", index, if name.starts_with("image ") { "" } else { &name });
        let bytes = match (&image.uri, image.buffer_view) {
            (_, Some(view)) => self.resources.view(view, &place)?.0.into(),
            (Some(uri), None) => self.resources.fetch(uri, &place)?.into(),
            (None, None) => return Err(self.resources.invalid(place, "it has neither a URI nor a buffer view")),
        };
        Ok((bytes, place, name))
    }
}

impl Source {
    fn image(self) -> usize {
        match self {
            Self::File(image) | Self::RoughnessOf { image, .. } => image,
        }
    }
}

/// The image whose channel G is 1 − glossiness · A; R and B are 1.
fn roughness(image: &TextureImage, glossiness: f32) -> TextureImage {
    let alpha: Vec<f32> = match &image.texels {
        Texels::Rgba8(texels) => texels.iter().map(|t| f32::from(t[3]) / 255.0).collect(),
        Texels::Rgba16(texels) => texels.iter().map(|t| f32::from(t[3]) / 65535.0).collect(),
        Texels::Rgba32F(texels) => texels.iter().map(|t| t[3]).collect(),
        Texels::Rgb32F(texels) => vec![1.0; texels.len()],
    };
    let texels = alpha.into_iter().map(|a| [65535, ((1.0 - glossiness * a).clamp(0.0, 1.0) * 65535.0).round() as u16, 65535, 65535]);
    TextureImage { name: format!("{} (roughness)", image.name), texels: Texels::Rgba16(texels.collect()), ..*image }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_two_sets_find_a_slot() {
        for (sets, slots, result) in [
            (vec![0, 1], vec![Some(0), Some(1)], [0, 1]),
            (vec![1], vec![Some(1)], [0, 1]),
            (vec![3], vec![Some(1)], [0, 3]),
            (vec![3, 1], vec![Some(1), Some(0)], [1, 3]),
            (vec![2, 0, 5], vec![Some(1), Some(0), None], [0, 2]),
            (vec![0, 0], vec![Some(0), Some(0)], [0, 1]),
        ] {
            let mut uv = UvSlots::default();
            assert_eq!(sets.iter().map(|&set| uv.slot(set)).collect::<Vec<_>>(), slots, "{sets:?}");
            assert_eq!(uv.sets(), result, "{sets:?}");
        }
    }

    #[test]
    fn roughness_is_one_minus_glossiness() {
        let image = TextureImage { name: "sg".into(), width: 2, height: 1, texels: Texels::Rgba8(vec![[9, 9, 9, 255], [9, 9, 9, 0]]) };
        let Texels::Rgba16(texels) = roughness(&image, 0.5).texels else { panic!("16 bits") };
        assert_eq!(texels.iter().map(|t| t[1]).collect::<Vec<_>>(), [32768, 65535]);
    }
}

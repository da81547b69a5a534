//! Image files to texels: PNG, JPEG and WebP ([`raster`]), KTX 2 with and without Basis Universal ([`ktx2`]).
//!
//! The kind of file is told by its first bytes, never by its name or declared type. Sizes are checked against the limits before anything
//! is decoded.

mod bits;
mod etc1s;
mod ktx2;
mod ktx2_container;
mod ktx2_metadata;
mod raster;
mod uastc;

use crate::limits::{Budget, ImportLimits, MAX_IMAGE_PIXELS};
use crate::{SceneError, TextureImage};

/// An encoded image and what messages call it.
pub(crate) struct Encoded<'a> {
    /// The file that refers to it.
    pub file: &'a str,
    /// Place inside that file.
    pub place: String,
    /// Name of the decoded image.
    pub name: String,
    /// The bytes of the image file.
    pub bytes: &'a [u8],
}

/// An image, and what its file holds that is not used.
#[derive(Debug)]
pub(crate) struct Decoded {
    pub image: TextureImage,
    /// Feature and consequence, for [`Scene::ignored`](crate::Scene::ignored).
    pub note: Option<(&'static str, &'static str)>,
}

/// Smaller copies of the image in its file.
const MIP_LEVELS: (&str, &str) = ("mip levels", "made anew from the first one");

impl Encoded<'_> {
    fn invalid(&self, problem: impl std::fmt::Display) -> SceneError {
        SceneError::invalid(self.file, &self.place, problem.to_string())
    }

    /// Checks the size of an image and claims its memory, `texel_bytes` for each texel.
    fn claim(&self, budget: &Budget, width: u32, height: u32, texel_bytes: u64) -> Result<(), SceneError> {
        if width == 0 || height == 0 {
            return Err(self.invalid(format!("the image has {width} × {height} px")));
        }
        let pixels = u64::from(width) * u64::from(height);
        let bounds = [
            ("an image side", width.max(height).into(), budget.limits.image_side.into()),
            ("a number of pixels", pixels, MAX_IMAGE_PIXELS),
        ];
        if let Some((quantity, got, limit)) = bounds.into_iter().find(|(_, got, limit)| got > limit) {
            return Err(SceneError::TooLarge { file: self.file.into(), place: self.place.clone(), quantity, got, limit });
        }
        budget.claim(self.file, &self.place, pixels, texel_bytes)
    }
}

/// Decodes an image.
///
/// # Errors
/// [`SceneError`] when it is none of the known formats, is damaged, or exceeds the limits.
pub(crate) fn decode(encoded: &Encoded<'_>, budget: &Budget) -> Result<Decoded, SceneError> {
    let ((width, height, texels), levels) = if encoded.bytes.starts_with(&ktx2_container::MAGIC) {
        ktx2::decode(encoded, budget)?
    } else {
        (raster::decode(encoded, budget)?, 1)
    };
    let image = TextureImage { name: encoded.name.clone(), width, height, texels };
    Ok(Decoded { image, note: (levels > 1).then_some(MIP_LEVELS) })
}

/// Decodes the bytes of an image file of any known format; `file` is its name in messages.
///
/// # Errors
/// Those of a texture of a scene: [`SceneError`] when it is none of the known formats, is damaged, or exceeds the limits.
pub fn decode_texture(file: &str, bytes: &[u8], limits: ImportLimits) -> Result<TextureImage, SceneError> {
    let encoded = Encoded { file, place: "image".into(), name: file.into(), bytes };
    decode(&encoded, &Budget::new(limits)).map(|decoded| decoded.image)
}

#[cfg(test)]
mod tests;

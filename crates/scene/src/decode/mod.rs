//! Image files to texels: PNG, JPEG and WebP ([`raster`]), KTX 2 with and without Basis Universal ([`ktx2`]).
//!
//! The kind of file is told by its first bytes, never by its name or declared type. Sizes are checked against the limits before anything
//! is decoded.

mod bits;
mod etc1s;
mod ktx2;
mod ktx2_container;
mod raster;
mod uastc;

use crate::limits::Budget;
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

impl Encoded<'_> {
    fn invalid(&self, problem: impl std::fmt::Display) -> SceneError {
        SceneError::invalid(self.file, &self.place, problem.to_string())
    }

    /// Checks the size of an image and claims its memory, `texel_bytes` for each texel.
    fn claim(&self, budget: &Budget, width: u32, height: u32, texel_bytes: u64) -> Result<(), SceneError> {
        if width == 0 || height == 0 {
            return Err(self.invalid(format!("the image has {width} × {height} px")));
        }
        let side = width.max(height);
        if side > budget.limits.image_side {
            return Err(SceneError::TooLarge {
                file: self.file.into(),
                place: self.place.clone(),
                quantity: "an image side",
                got: side.into(),
                limit: budget.limits.image_side.into(),
            });
        }
        budget.claim(self.file, &self.place, u64::from(width) * u64::from(height), texel_bytes)
    }
}

/// Decodes an image.
///
/// # Errors
/// [`SceneError`] when it is none of the known formats, is damaged, or exceeds the limits.
pub(crate) fn decode(encoded: &Encoded<'_>, budget: &Budget) -> Result<TextureImage, SceneError> {
    let (width, height, texels) =
        if encoded.bytes.starts_with(&ktx2_container::MAGIC) { ktx2::decode(encoded, budget)? } else { raster::decode(encoded, budget)? };
    Ok(TextureImage { name: encoded.name.clone(), width, height, texels })
}

#[cfg(test)]
mod tests;

//! How much a file may ask for.

use crate::SceneError;
use std::sync::atomic::{AtomicU64, Ordering};

/// Most pixels of one image: an environment of 16384 × 8192, which takes 3.2 GB with the table that it is sampled by.
pub const MAX_IMAGE_PIXELS: u64 = 1 << 27;

/// Bounds on what an importer makes of a file, so that a few bytes cannot ask for all memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ImportLimits {
    /// Bytes of geometry, key frames and texels that one scene may hold.
    pub bytes: u64,
    /// Width and height of an image, px; there is also [`MAX_IMAGE_PIXELS`].
    pub image_side: u32,
}

impl Default for ImportLimits {
    /// 16 GiB, and images of up to 32768 px a side.
    fn default() -> Self {
        Self { bytes: 16 << 30, image_side: 32768 }
    }
}

/// The bytes that are left of a limit.
#[derive(Debug)]
pub(crate) struct Budget {
    pub limits: ImportLimits,
    used: AtomicU64,
}

impl Budget {
    pub fn new(limits: ImportLimits) -> Self {
        Self { limits, used: AtomicU64::new(0) }
    }

    /// Takes `count` elements of `size` bytes from the budget; to be called before they are allocated.
    ///
    /// # Errors
    /// [`SceneError::TooLarge`] with the total that would be needed.
    pub fn claim(&self, file: &str, place: &str, count: u64, size: u64) -> Result<(), SceneError> {
        let bytes = count.saturating_mul(size);
        let total = self.used.fetch_add(bytes.min(self.limits.bytes.saturating_add(1)), Ordering::Relaxed).saturating_add(bytes);
        if total <= self.limits.bytes {
            return Ok(());
        }
        Err(SceneError::TooLarge {
            file: file.into(),
            place: place.into(),
            quantity: "a total of decoded bytes",
            got: total,
            limit: self.limits.bytes,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn claims_add_up_and_never_overflow() {
        let budget = Budget::new(ImportLimits { bytes: 100, image_side: 1 });
        assert!(budget.claim("f", "p", 10, 5).is_ok());
        assert!(budget.claim("f", "p", 50, 1).is_ok());
        let message = budget.claim("f", "p", 1, 1).unwrap_err().to_string();
        assert_eq!(message, "`f`: p: a total of decoded bytes of 101 exceeds the limit of 100; reduce it");
        for _ in 0..3 {
            assert!(budget.claim("f", "p", u64::MAX, u64::MAX).is_err());
        }
    }
}

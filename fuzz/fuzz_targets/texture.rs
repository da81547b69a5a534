//! Texture images: PNG, JPEG, WebP and KTX 2 with everything inside. Whatever the bytes are, an image with all its texels or one error.
#![no_main]

use kajo_scene::{ColorSpace, ImportLimits, decode_texture};
use libfuzzer_sys::fuzz_target;

/// Small enough for a run with limited memory.
const LIMITS: ImportLimits = ImportLimits { bytes: 64 << 20, image_side: 4096 };

fuzz_target!(|data: &[u8]| {
    if let Ok(image) = decode_texture("fuzz.ktx2", data, LIMITS) {
        assert!(image.bytes() >= 4 * image.width as usize * image.height as usize);
        assert!(image.texel(image.width - 1, image.height - 1, ColorSpace::Srgb).is_finite());
    }
});

//! Environments in every picture format: whatever the bytes are, finite radiance or one error.
#![no_main]

use kajo_scene::{ImportLimits, decode_environment};
use libfuzzer_sys::fuzz_target;
use std::path::Path;

/// Small enough for a run with limited memory.
const LIMITS: ImportLimits = ImportLimits { bytes: 64 << 20, image_side: 4096 };

fuzz_target!(|data: &[u8]| {
    if let Ok((environment, _)) = decode_environment(Path::new("fuzz.hdr"), data, LIMITS) {
        let grid = environment.importance().expect("a file has an image");
        assert!(grid.pixels().iter().all(|weight| weight.is_finite() && *weight >= 0.0));
    }
});

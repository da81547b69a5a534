//! glTF documents with embedded data: whatever the bytes are, a scene that can be evaluated or one error.
#![no_main]

use kajo_scene::gltf::{NoResources, load_gltf_bytes};
use kajo_scene::{ImportLimits, Snapshot};
use libfuzzer_sys::fuzz_target;

/// Small enough for a run with limited memory.
const LIMITS: ImportLimits = ImportLimits { bytes: 64 << 20, image_side: 4096 };

fuzz_target!(|data: &[u8]| {
    if let Ok(scene) = load_gltf_bytes("fuzz.gltf", data, &NoResources, LIMITS) {
        for time in [0.0, 0.4] {
            Snapshot::new(&scene, kajo_units::Seconds(time));
        }
    }
});

//! OBJ and MTL. The input is the OBJ text, and after a zero byte the material library that any `mtllib` in it names.
#![no_main]

use kajo_scene::gltf::ResourceReader;
use kajo_scene::obj::parse_obj;
use kajo_scene::{ImportLimits, SurfaceUv};
use libfuzzer_sys::fuzz_target;
use std::io;

/// Small enough for a run with limited memory.
const LIMITS: ImportLimits = ImportLimits { bytes: 64 << 20, image_side: 4096 };

/// Hands out the library under every name.
struct Library<'a>(&'a [u8]);

impl ResourceReader for Library<'_> {
    fn read(&self, _: &str) -> io::Result<Vec<u8>> {
        Ok(self.0.to_vec())
    }
}

fuzz_target!(|data: &[u8]| {
    let middle = data.iter().position(|&byte| byte == 0).unwrap_or(data.len());
    let library = Library(data.get(middle + 1..).unwrap_or_default());
    if let Ok(scene) = parse_obj("fuzz.obj", &data[..middle], &library, LIMITS) {
        for material in &scene.materials {
            let at = material.at(&scene, &SurfaceUv::default());
            assert!(at.emission.is_finite() && at.params.base_color.is_finite() && at.absorption.is_finite());
        }
    }
});

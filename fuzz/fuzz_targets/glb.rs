//! Binary glTF. The input is the JSON and the binary chunk, divided by a zero byte; the container is put around them, so that changes reach beyond its
//! lengths. An input that starts with the container's own magic is taken as it is.
#![no_main]

use kajo_scene::gltf::{NoResources, load_gltf_bytes};
use kajo_scene::{ImportLimits, Snapshot};
use libfuzzer_sys::fuzz_target;

/// Small enough for a run with limited memory.
const LIMITS: ImportLimits = ImportLimits { bytes: 64 << 20, image_side: 4096 };

fuzz_target!(|data: &[u8]| {
    let container;
    let bytes = if data.starts_with(b"glTF") {
        data
    } else {
        let middle = data.iter().position(|&byte| byte == 0).unwrap_or(data.len());
        container = wrap(&data[..middle], data.get(middle + 1..).unwrap_or_default());
        &container
    };
    if let Ok(scene) = load_gltf_bytes("fuzz.glb", bytes, &NoResources, LIMITS) {
        Snapshot::new(&scene, kajo_units::Seconds(0.4));
    }
});

/// A GLB container of two chunks.
fn wrap(json: &[u8], binary: &[u8]) -> Vec<u8> {
    let padded = |chunk: &[u8]| chunk.len().next_multiple_of(4);
    let length = 12 + 8 + padded(json) + 8 + padded(binary);
    let mut bytes = b"glTF\x02\0\0\0".to_vec();
    bytes.extend((length as u32).to_le_bytes());
    for (chunk, kind, fill) in [(json, b"JSON", b' '), (binary, b"BIN\0", 0)] {
        bytes.extend((padded(chunk) as u32).to_le_bytes());
        bytes.extend(kind);
        bytes.extend(chunk);
        bytes.resize(bytes.len() + padded(chunk) - chunk.len(), fill);
    }
    bytes
}

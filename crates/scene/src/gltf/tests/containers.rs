//! Where the bytes come from: binary files, data URIs, files beside, compressed views.

use super::{F32, File, ignored};
use crate::gltf::{NoResources, ResourceReader, load_gltf_bytes};
use crate::{ImportLimits, load_gltf};
use serde_json::json;
use std::io;

fn load_error(bytes: &[u8]) -> String {
    load_gltf_bytes("test.glb", bytes, &NoResources, ImportLimits::default()).expect_err("the file is wrong").to_string()
}

/// One file beside the document.
struct Beside(&'static str, Vec<u8>);

impl ResourceReader for Beside {
    fn read(&self, path: &str) -> io::Result<Vec<u8>> {
        if path == self.0 { Ok(self.1.clone()) } else { Err(io::ErrorKind::NotFound.into()) }
    }
}

#[test]
fn binary_and_text_give_the_same_mesh() {
    let file = File::triangle();
    let binary = load_gltf_bytes("a.glb", &file.glb(), &NoResources, ImportLimits::default()).unwrap();
    assert_eq!(binary.meshes[0].positions, file.mesh().positions);
}

#[test]
fn buffers_lie_beside_under_percent_encoded_names() {
    let mut file = File::triangle();
    file.json["buffers"] = json!([{ "byteLength": 36, "uri": "my%20data/a.bin" }]);
    let beside = Beside("my data/a.bin", file.binary.clone());
    let scene = load_gltf_bytes("a.gltf", &file.gltf(), &beside, ImportLimits::default()).unwrap();
    assert_eq!(scene.meshes[0].positions.len(), 3);
}

#[test]
fn a_missing_buffer_is_named() {
    let mut file = File::triangle();
    file.json["buffers"] = json!([{ "byteLength": 36, "uri": "a.bin" }]);
    let message = file.error();
    assert!(message.starts_with("cannot read `a.bin, buffer 0 of test.gltf`: "), "{message}");
}

#[test]
fn a_short_buffer_is_named() {
    let mut file = File::triangle();
    file.json["buffers"] = json!([{ "byteLength": 36, "uri": "data:;base64,AAAA" }]);
    assert_eq!(file.error(), "`test.gltf`: buffer 0: truncated: byteLength says 36, but there are 3 bytes");
}

#[test]
fn files_on_disk_load_and_folders_do_not() {
    let folder = std::env::temp_dir().join(format!("kajo-gltf-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let mut file = File::triangle();
    std::fs::write(folder.join("t.bin"), &file.binary).unwrap();
    file.json["buffers"] = json!([{ "byteLength": 36, "uri": "t.bin" }]);
    std::fs::write(folder.join("t.gltf"), file.gltf()).unwrap();
    let scene = load_gltf(&folder.join("t.gltf"));
    let absent = load_gltf(&folder.join("absent.gltf")).unwrap_err().to_string();
    let not_a_file = load_gltf(&folder).unwrap_err().to_string();
    std::fs::remove_dir_all(&folder).unwrap();
    assert_eq!(scene.unwrap().meshes[0].indices, [[0, 1, 2]]);
    assert!(absent.contains("absent.gltf`: ") && absent.contains("check the path"), "{absent}");
    assert!(not_a_file.contains("not a regular file"), "{not_a_file}");
}

/// Every prefix of a binary file is refused with a sentence that names the file.
#[test]
fn every_truncation_of_a_binary_file_is_an_error() {
    let file = File::triangle().glb();
    for length in 0..file.len() {
        let message = load_error(&file[..length]);
        assert!(message.starts_with("`test.glb`"), "cut to {length}: {message}");
    }
}

#[test]
fn json_errors_have_a_position() {
    let message = load_error(b"{\n  \"asset\": { \"version\": \"2.0\" },\n  \"nodes\": [{ \"mesh\": \"zero\" }]\n}");
    assert!(message.starts_with("`test.glb`, line 3, column "), "{message}");
    assert!(message.contains("expected usize"), "{message}");
    let message = load_error(b"{\n  \"asset\": { \"version\": \"2.0\" },\n");
    assert!(message.contains("line 3, column 0: EOF"), "{message}");
    let message = load_error(b"{ \"asset\": { \"version\": \"2.0\" }, \"nodes\": [{ \"translation\": [1e39, 0, 0] }] }");
    assert!(message.contains("32-bit floats"), "{message}");
}

#[test]
fn other_versions_are_refused() {
    for (asset, version) in [
        (json!({ "version": "1.0" }), "1.0"),
        (json!({ "version": "3.0" }), "3.0"),
        (json!({ "version": "2.1", "minVersion": "2.1" }), "2.1"),
    ] {
        let mut file = File::triangle();
        file.json["asset"] = asset;
        assert_eq!(file.error(), format!("`test.gltf`: glTF {version} is not supported; convert it to glTF 2.0"));
    }
    let mut newer = File::triangle();
    newer.json["asset"] = json!({ "version": "2.7", "minVersion": "2.0" });
    assert_eq!(newer.mesh().positions.len(), 3);
}

/// The triangle's positions as a meshopt stream of raw deltas, in a view whose own buffer is a placeholder.
#[test]
fn meshopt_views_are_decompressed() {
    let mut file = File::new();
    let floats = [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let elements: &[u8] = bytemuck::cast_slice(&floats);
    let mut stream = vec![0xa0];
    for byte in 0..12 {
        stream.push(3);
        let mut previous = elements[byte];
        for index in 0..16 {
            let value = elements.get(12 * index + byte).copied().unwrap_or(previous);
            let delta = value.wrapping_sub(previous) as i8;
            stream.push(((delta << 1) ^ (delta >> 7)) as u8);
            previous = value;
        }
    }
    stream.extend([0; 20]);
    stream.extend(&elements[..12]);
    file.json["buffers"] = json!([
        { "byteLength": stream.len(), "uri": format!("data:;base64,{}", base64::Engine::encode(&base64::engine::general_purpose::STANDARD, &stream)) },
        { "byteLength": 36, "extensions": { "EXT_meshopt_compression": { "fallback": true } } }
    ]);
    file.json["extensionsUsed"] = json!(["EXT_meshopt_compression"]);
    file.json["extensionsRequired"] = json!(["EXT_meshopt_compression"]);
    let compression = json!({ "buffer": 0, "byteLength": stream.len(), "byteStride": 12, "count": 3, "mode": "ATTRIBUTES" });
    file.json["bufferViews"] =
        json!([{ "buffer": 1, "byteLength": 36, "byteStride": 12, "extensions": { "EXT_meshopt_compression": compression } }]);
    file.push("accessors", json!({ "bufferView": 0, "componentType": F32, "count": 3, "type": "VEC3" }));
    file.push("meshes", json!({ "primitives": [{ "attributes": { "POSITION": 0 } }] }));
    file.push("nodes", json!({ "mesh": 0 }));
    file.push("scenes", json!({ "nodes": [0] }));
    let scene = file.load();
    assert_eq!(scene.meshes[0].positions, [glam::Vec3::ZERO, glam::Vec3::X, glam::Vec3::Y]);
    assert_eq!(ignored(&scene), [""; 0]);

    for (key, value, problem) in [
        ("mode", json!("TRIANGLES"), "EXT_meshopt_compression: "),
        ("mode", json!("POINTS"), "has no mode `POINTS`"),
        ("filter", json!("SHARP"), "has no filter `SHARP`"),
        ("count", json!(4), "4 compressed elements of 12 bytes do not fill its 36 bytes"),
        ("byteOffset", json!(1), "spans "),
        ("buffer", json!(1), "a placeholder without data"),
    ] {
        let mut broken = File { json: file.json.clone(), binary: Vec::new() };
        broken.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"][key] = value;
        let message = broken.error();
        assert!(message.contains(problem), "{key}: {message}");
    }
}

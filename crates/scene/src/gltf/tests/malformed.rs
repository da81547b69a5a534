//! Files that break the rules: each is refused with one sentence that names the place, and none panics or asks for much memory.

use super::{F32, File};
use crate::gltf::{NoResources, load_gltf_bytes};
use crate::{ImportLimits, SceneError};
use serde_json::{Value, json};

/// Sets the value at a path of object keys and list indices.
fn set(json: &mut Value, path: &str, value: Value) {
    let mut at = json;
    for key in path.split('.') {
        at = match key.parse::<usize>() {
            Ok(index) if at.is_array() => &mut at[index],
            _ => &mut at[key],
        };
    }
    *at = value;
}

/// A triangle with an animation, a skin, a camera, a light and a texture: something of everything.
fn everything() -> File {
    let mut file = File::triangle();
    let times = file.floats("SCALAR", &[0.0, 1.0]);
    let values = file.floats("VEC3", &[0.0; 6]);
    let indices = file.indices(&[0, 1, 2]);
    file.primitive()["indices"] = indices.into();
    file.primitive()["material"] = 0.into();
    let uv = file.floats("VEC2", &[0.0; 6]);
    file.primitive()["attributes"]["TEXCOORD_0"] = uv.into();
    file.push("materials", json!({ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }));
    file.push("textures", json!({ "source": 0, "sampler": 0 }));
    file.push("samplers", json!({}));
    let mut png = std::io::Cursor::new(Vec::new());
    image::RgbaImage::new(1, 1).write_to(&mut png, image::ImageFormat::Png).unwrap();
    let view = file.view(png.get_ref());
    file.push("images", json!({ "bufferView": view }));
    file.push(
        "animations",
        json!({
            "channels": [{ "sampler": 0, "target": { "node": 0, "path": "translation" } }],
            "samplers": [{ "input": times, "output": values }]
        }),
    );
    file.push("skins", json!({ "joints": [1] }));
    file.push("cameras", json!({ "perspective": { "yfov": 1.0, "znear": 0.1 } }));
    file.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [{ "type": "spot", "spot": {} }] } });
    file.push("nodes", json!({ "camera": 0, "extensions": { "KHR_lights_punctual": { "light": 0 } } }));
    file.json["scenes"][0]["nodes"] = json!([0, 1]);
    file
}

#[test]
fn the_unbroken_file_loads() {
    let scene = everything().load();
    assert_eq!((scene.meshes.len(), scene.cameras.len(), scene.lights.len(), scene.images.len()), (1, 1, 1, 1));
}

#[test]
fn each_broken_rule_is_named() {
    let cases: &[(&str, Value, &str)] = &[
        // references to what is not there
        ("scene", json!(3), "file: it refers to scene 3, but the file has 1"),
        ("scenes.0.nodes", json!([9]), "scene 0: it refers to node 9, but the file has 2"),
        ("nodes.0.mesh", json!(5), "node 0: it refers to mesh 5"),
        ("nodes.0.skin", json!(5), "node 0: it refers to skin 5"),
        ("nodes.1.camera", json!(5), "it refers to camera 5"),
        ("nodes.1.extensions.KHR_lights_punctual.light", json!(5), "it refers to light 5"),
        ("nodes.0.children", json!([5]), "node 0: it refers to node 5"),
        ("meshes.0.primitives.0.material", json!(5), "mesh 0: it refers to material 5"),
        ("meshes.0.primitives.0.indices", json!(50), "it refers to accessor 50"),
        ("meshes.0.primitives.0.attributes.POSITION", json!(50), "mesh 0, primitive 0: it refers to accessor 50"),
        ("materials.0.pbrMetallicRoughness.baseColorTexture.index", json!(5), "material 0: it refers to texture 5"),
        ("textures.0.source", json!(5), "texture 0: it refers to image 5"),
        ("textures.0.sampler", json!(5), "texture 0: it refers to sampler 5"),
        ("images.0.bufferView", json!(50), "image 0: it refers to buffer view 50"),
        ("accessors.0.bufferView", json!(50), "it refers to buffer view 50"),
        ("bufferViews.0.buffer", json!(5), "buffer view 0: it refers to buffer 5"),
        ("skins.0.joints", json!([7]), "skin 0: it refers to node 7"),
        ("skins.0.inverseBindMatrices", json!(0), "its type is `VEC3`, but MAT4 is needed"),
        ("animations.0.channels.0.sampler", json!(5), "animation 0, channel 0: it refers to sampler 5"),
        ("animations.0.channels.0.target.node", json!(5), "animation 0, channel 0: it refers to node 5"),
        // the node hierarchy
        ("nodes.0.children", json!([0]), "node 0: it is its own ancestor"),
        ("nodes.0.children", json!([1]), "scene 0: it lists node 1 as a root, but that is a child of node 0"),
        ("nodes.0.children", json!([1, 1]), "node 1: it has two parents, 0 and 0"),
        ("nodes.0.rotation", json!([0, 0, 0, 0]), "node 0: its rotation is not a unit quaternion"),
        ("nodes.0.matrix", json!([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 2]), "node 0: the last row of its matrix"),
        // accessors and views
        ("accessors.0.count", json!(4), "4 elements of 12 bytes from byte 0 reach beyond buffer view 0, which has 36 bytes"),
        ("accessors.0.count", json!(u64::MAX), "reach beyond buffer view 0"),
        ("accessors.0.byteOffset", json!(u64::MAX), "reach beyond buffer view 0"),
        ("accessors.0.byteOffset", json!(4), "reach beyond buffer view 0"),
        ("accessors.0.componentType", json!(1), "it has no valid component type (1)"),
        ("accessors.0.type", json!("VEC2"), "accessor 0 (POSITION of mesh 0, primitive 0): its type is `VEC2`, but VEC3 is needed"),
        ("accessors.3.componentType", json!(F32), "reach beyond"),
        ("bufferViews.0.byteStride", json!(4), "its elements of 12 bytes do not fit the byteStride 4 of buffer view 0"),
        ("bufferViews.0.byteStride", json!(u64::MAX), "reach beyond buffer view 0"),
        ("bufferViews.0.byteLength", json!(u64::MAX), "buffer view 0: it spans 18446744073709551615 bytes from byte 0 of buffer 0"),
        ("bufferViews.0.byteOffset", json!(u64::MAX), "buffer view 0: it spans 36 bytes from byte 18446744073709551615"),
        ("accessors.4.count", json!(2), "accessor 4 (TEXCOORD_0 of mesh 0, primitive 0): it has 2 elements, but POSITION has 3"),
        ("meshes.0.primitives.0.mode", json!(7), "mesh 0, primitive 0: its mode 7 is none of 0 to 6"),
        // values
        ("materials.0.alphaMode", json!("GLOW"), "material 0: its alphaMode \"GLOW\" is none of"),
        ("samplers.0.wrapS", json!(1), "sampler 0: its wrapping mode 1"),
        ("samplers.0.magFilter", json!(1), "sampler 0: its magFilter 1"),
        ("cameras.0.perspective.yfov", json!(4.0), "camera 0: yfov must be between 0 and π"),
        ("cameras.0.perspective.znear", json!(0), "znear greater than 0"),
        ("cameras.0", json!({}), "camera 0: it is neither perspective nor orthographic"),
        ("extensions.KHR_lights_punctual.lights.0.type", json!("laser"), "light 0: its type \"laser\""),
        ("extensions.KHR_lights_punctual.lights.0.spot", json!({ "innerConeAngle": 1, "outerConeAngle": 0.5 }), "light 0: its cone angles"),
        ("animations.0.channels.0.target.path", json!("color"), "its path \"color\" is not known"),
        ("animations.0.samplers.0.interpolation", json!("BEZIER"), "its interpolation \"BEZIER\" is not known"),
        ("animations.0.samplers.0.interpolation", json!("CUBICSPLINE"), "its 2 key times need 9 numbers each, but there are 6"),
        ("animations.0.samplers.0.output", json!(0), "its 2 key times need 3 numbers each, but there are 9"),
        ("images.0", json!({}), "image 0: it has neither a URI nor a buffer view"),
        (
            "images.0",
            json!({ "uri": "http://example.org/a.png" }),
            "the URI has the scheme `http`, but only relative paths and `data:` are read",
        ),
    ];
    for (path, value, problem) in cases {
        let mut file = everything();
        set(&mut file.json, path, value.clone());
        let message = file.error();
        assert!(message.starts_with("`test.gltf`: ") && message.contains(problem), "{path} = {value}: {message}");
        assert!(!message.contains('\n'), "{message}");
    }
}

#[test]
fn vertices_that_are_not_numbers_are_refused() {
    for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let mut file = File::triangle();
        file.binary[16..20].copy_from_slice(&value.to_le_bytes());
        let message = file.error();
        assert!(message.contains("accessor 0 (POSITION of mesh 0, primitive 0): element 1 is ["), "{message}");
        assert!(message.ends_with("but numbers must be finite"), "{message}");
    }
}

#[test]
fn indices_beyond_the_vertices_are_refused() {
    let mut file = File::triangle();
    let indices = file.indices(&[0, 1, 65535]);
    file.primitive()["indices"] = indices.into();
    assert_eq!(file.error(), "`test.gltf`: mesh 0, primitive 0: its indices name vertex 65535, but it has 3 vertices");
}

#[test]
fn key_times_must_increase() {
    let mut file = everything();
    let times = file.floats("SCALAR", &[1.0, 1.0]);
    file.json["animations"][0]["samplers"][0]["input"] = times.into();
    assert!(file.error().contains("its key times are not strictly increasing"));
}

#[test]
fn longer_cycles_of_nodes_are_refused() {
    let mut file = File::triangle();
    file.json["nodes"] = json!([{ "children": [1] }, { "children": [2] }, { "children": [0] }, {}]);
    file.json["scenes"][0]["nodes"] = json!([3]);
    assert!(file.error().contains("it is its own ancestor"));
}

#[test]
fn deep_hierarchies_neither_overflow_nor_take_long() {
    let mut file = File::triangle();
    let count = 100_000;
    file.json["nodes"] = (0..count).map(|i| if i + 1 < count { json!({ "children": [i + 1] }) } else { json!({ "mesh": 0 }) }).collect();
    assert_eq!(file.load().nodes[count - 1].parent, Some(count - 2));
}

#[test]
fn sparse_indices_must_ascend_within_the_accessor() {
    for indices in [[1, 1], [2, 1], [1, 3]] {
        let mut file = File::triangle();
        let stored = file.view(&indices);
        let values = file.view(&[0; 24]);
        file.json["accessors"][0]["sparse"] =
            json!({ "count": 2, "indices": { "bufferView": stored, "componentType": 5121 }, "values": { "bufferView": values } });
        assert!(file.error().contains("its sparse indices do not ascend within its 3 elements"), "{indices:?}");
    }
}

/// An accessor without a buffer view may say any count: memory is claimed before it is used.
#[test]
fn counts_without_bytes_are_limited() {
    let limits = ImportLimits { bytes: 1 << 20, image_side: 64 };
    for count in [1u64 << 20, 1 << 40, u64::MAX] {
        let mut file = File::triangle();
        file.json["accessors"][0] = json!({ "componentType": F32, "count": count, "type": "VEC3" });
        let error = load_gltf_bytes("a.gltf", &file.gltf(), &NoResources, limits).unwrap_err();
        assert!(matches!(error, SceneError::TooLarge { .. }), "{count}: {error}");
    }
}

#[test]
fn image_sizes_are_limited_before_decoding() {
    let limits = ImportLimits { bytes: 1 << 20, image_side: 64 };
    for (width, height) in [(65, 1), (1, 65)] {
        let mut file = everything();
        let mut png = std::io::Cursor::new(Vec::new());
        image::RgbaImage::new(width, height).write_to(&mut png, image::ImageFormat::Png).unwrap();
        let view = file.view(png.get_ref());
        file.json["images"][0]["bufferView"] = view.into();
        let error = load_gltf_bytes("a.gltf", &file.gltf(), &NoResources, limits).unwrap_err().to_string();
        assert_eq!(error, "`a.gltf`: image 0: an image side of 65 exceeds the limit of 64; reduce it");
    }
}

/// A PNG whose header says 100000 × 100000 and that has no data.
#[test]
fn lying_image_headers_are_refused() {
    let mut file = everything();
    let mut header = b"IHDR\0\x01\x86\xa0\0\x01\x86\xa0\x08\x06\0\0\0".to_vec();
    let crc = header.iter().fold(!0u32, |crc, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| if crc & 1 == 1 { (crc >> 1) ^ 0xedb8_8320 } else { crc >> 1 })
    });
    header.extend((!crc).to_be_bytes());
    let png = [b"\x89PNG\r\n\x1a\n\0\0\0\x0d".as_slice(), &header, b"\0\0\0\0IDAT\x35\xaf\x06\x1e"].concat();
    let view = file.view(&png);
    file.json["images"][0]["bufferView"] = view.into();
    let message = file.error();
    assert!(message.contains("an image side of 100000 exceeds the limit of 32768"), "{message}");
}

/// Random changes of single bytes, runs and numbers: the answer is a scene or a sentence, whatever comes.
#[test]
fn mutated_files_never_panic() {
    let limits = ImportLimits { bytes: 1 << 24, image_side: 256 };
    let original = everything().glb();
    let mut state = 0x9e37_79b9_7f4a_7c15u64;
    let mut random = |below: usize| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state % below as u64) as usize
    };
    let (mut loaded, mut refused) = (0, 0);
    for _ in 0..3000 {
        let mut file = original.clone();
        for _ in 0..=random(4) {
            let at = 20 + random(file.len() - 20);
            match random(4) {
                0 => file[at] ^= 1 << random(8),
                1 => file[at] = b"0123456789-.[]{}\",:enull"[random(24)],
                2 => file[at] = random(256) as u8,
                _ => {
                    let digit = (at..file.len()).find(|&i| file[i].is_ascii_digit());
                    digit.into_iter().for_each(|i| file[i] = b'0' + random(10) as u8);
                }
            }
        }
        match load_gltf_bytes("a.glb", &file, &NoResources, limits) {
            Ok(scene) => {
                crate::Snapshot::new(&scene, kajo_units::Seconds(0.5));
                loaded += 1;
            }
            Err(error) => {
                assert!(!error.to_string().is_empty());
                refused += 1;
            }
        }
    }
    assert!(loaded > 100 && refused > 100, "{loaded} loaded, {refused} refused: the mutations should give both");
}

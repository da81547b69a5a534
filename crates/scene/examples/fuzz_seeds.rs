//! Writes the seeds of the fuzz targets: small files of every importer, made here.
//!
//! `cargo run --example fuzz_seeds -- DIRECTORY` fills DIRECTORY/{gltf,glb,obj,hdr,texture,kajo_toml,rgl}.

use base64::{Engine, prelude::BASE64_STANDARD};
use kajo_bsdf::models::rgl::{Resolution, Symmetry, Table};
use kajo_bsdf::models::{Form, find};
use kajo_image::{ExrFile, Image, Layer, write_hdr};
use kajo_scene::ImportLimits;
use kajo_scene::gltf::{NoResources, load_gltf_bytes};
use kajo_units::LinearRgb;
use serde_json::{Value, json};
use std::fs;
use std::io::Cursor;
use std::path::Path;

type Outcome = Result<(), Box<dyn std::error::Error>>;

fn main() -> Outcome {
    let directory = std::env::args().nth(1).ok_or("usage: fuzz_seeds DIRECTORY")?;
    let directory = Path::new(&directory);
    for target in ["gltf", "glb", "obj", "hdr", "texture", "kajo_toml", "rgl"] {
        fs::create_dir_all(directory.join(target))?;
    }
    gltf(directory)?;
    meshopt(directory)?;
    basis(directory)?;
    obj(directory)?;
    pictures(directory)?;
    scene_files(directory)?;
    measured(directory)
}

fn write(directory: &Path, target: &str, name: &str, bytes: impl AsRef<[u8]>) -> Outcome {
    Ok(fs::write(directory.join(target).join(name), bytes)?)
}

/// One buffer and the views and accessors into it.
#[derive(Default)]
struct Buffer {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Buffer {
    fn view(&mut self, bytes: &[u8]) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.views.push(json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len() }));
        self.bytes.extend(bytes);
        self.views.len() - 1
    }

    fn floats(&mut self, kind: &str, width: usize, values: &[f32]) -> usize {
        let view = self.view(&values.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<_>>());
        let bound = |pick: fn(f32, f32) -> f32| -> Vec<f32> {
            (0..width).map(|c| values.iter().skip(c).step_by(width).copied().reduce(pick).unwrap_or(0.0)).collect()
        };
        self.accessors.push(json!({
            "bufferView": view, "componentType": 5126, "count": values.len() / width, "type": kind, "min": bound(f32::min), "max": bound(f32::max),
        }));
        self.accessors.len() - 1
    }

    fn integers(&mut self, kind: &str, width: usize, component: u32, values: &[u16]) -> usize {
        let bytes: Vec<u8> = match component {
            5121 => values.iter().map(|&v| v as u8).collect(),
            5123 => values.iter().flat_map(|v| v.to_le_bytes()).collect(),
            _ => values.iter().flat_map(|&v| u32::from(v).to_le_bytes()).collect(),
        };
        let view = self.view(&bytes);
        self.accessors.push(json!({ "bufferView": view, "componentType": component, "count": values.len() / width, "type": kind }));
        self.accessors.len() - 1
    }
}

fn gltf(directory: &Path) -> Outcome {
    let mut buffer = Buffer::default();
    let png = picture(image::ImageFormat::Png)?;
    let positions = buffer.floats("VEC3", 3, &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0]);
    let normals = buffer.floats("VEC3", 3, &[0.0, 0.0, 1.0].repeat(4));
    let uvs = buffer.floats("VEC2", 2, &[0.0, 1.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0]);
    let indices = buffer.integers("SCALAR", 1, 5123, &[0, 1, 2, 2, 1, 3]);
    let joints = buffer.integers("VEC4", 4, 5121, &[0, 1, 0, 0].repeat(4));
    let weights = buffer.floats("VEC4", 4, &[0.5, 0.5, 0.0, 0.0].repeat(4));
    let colors = buffer.integers("VEC4", 4, 5121, &[255, 128, 0, 255].repeat(4));
    let target = buffer.floats("VEC3", 3, &[0.0, 0.0, 0.5].repeat(4));
    let times = buffer.floats("SCALAR", 1, &[0.0, 0.5, 1.0]);
    let moves = buffer.floats("VEC3", 3, &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    let turns = buffer.floats("VEC4", 4, &[0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
    let cubic = buffer.floats("VEC3", 3, &[1.0; 27]);
    let morphs = buffer.floats("SCALAR", 1, &[0.0, 1.0, 0.5]);
    let identity = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    let inverse_bind = buffer.floats("MAT4", 16, &identity.repeat(2));
    let sparse_indices = buffer.view(&[1, 0, 3, 0]);
    let sparse_values = buffer.view(&[0; 24]);
    buffer.accessors.push(json!({
        "componentType": 5126, "count": 4, "type": "VEC3",
        "sparse": { "count": 2, "indices": { "bufferView": sparse_indices, "componentType": 5123 }, "values": { "bufferView": sparse_values } },
    }));
    let sparse = buffer.accessors.len() - 1;
    let embedded = buffer.view(&png);

    let texture = json!({ "index": 0, "texCoord": 0, "extensions": { "KHR_texture_transform": { "offset": [0.1, 0.2], "rotation": 0.3, "scale": [2, 2] } } });
    let plain = json!({ "index": 0 });
    let mut document = json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": [0, 3, 4, 5] }],
        "nodes": [
            { "name": "skinned", "mesh": 0, "skin": 0, "children": [1] },
            { "name": "joint", "translation": [0, 1, 0], "children": [2] },
            { "name": "tip", "rotation": [0, 0, 0, 1], "scale": [1, 2, 1] },
            { "name": "camera", "camera": 0, "matrix": identity },
            { "name": "light", "extensions": { "KHR_lights_punctual": { "light": 0 } } },
            { "name": "second", "mesh": 1, "weights": [0.5], "camera": 1, "extensions": { "KHR_lights_punctual": { "light": 1 } } },
        ],
        "meshes": [
            { "primitives": [{
                "attributes": { "POSITION": positions, "NORMAL": normals, "TEXCOORD_0": uvs, "COLOR_0": colors, "JOINTS_0": joints, "WEIGHTS_0": weights },
                "indices": indices, "material": 0,
            }] },
            { "primitives": [
                { "attributes": { "POSITION": positions }, "mode": 5, "targets": [{ "POSITION": target }], "material": 1 },
                { "attributes": { "POSITION": sparse }, "mode": 6, "targets": [{ "POSITION": target }] },
            ], "weights": [0.25] },
        ],
        "skins": [{ "joints": [1, 2], "inverseBindMatrices": inverse_bind }],
        "animations": [{ "name": "all",
            "samplers": [
                { "input": times, "output": moves },
                { "input": times, "output": turns, "interpolation": "STEP" },
                { "input": times, "output": cubic, "interpolation": "CUBICSPLINE" },
                { "input": times, "output": morphs },
            ],
            "channels": [
                { "sampler": 0, "target": { "node": 1, "path": "translation" } },
                { "sampler": 1, "target": { "node": 2, "path": "rotation" } },
                { "sampler": 2, "target": { "node": 2, "path": "scale" } },
                { "sampler": 3, "target": { "node": 5, "path": "weights" } },
            ],
        }],
        "cameras": [
            { "type": "perspective", "perspective": { "yfov": 0.7, "znear": 0.1, "aspectRatio": 1.5 } },
            { "type": "orthographic", "orthographic": { "xmag": 1, "ymag": 1, "znear": 0, "zfar": 10 } },
        ],
        "images": [{ "bufferView": embedded, "mimeType": "image/png" }, { "uri": format!("data:image/png;base64,{}", BASE64_STANDARD.encode(&png)) }],
        "samplers": [{ "magFilter": 9728, "wrapS": 33071, "wrapT": 33648 }],
        "textures": [{ "source": 0, "sampler": 0 }, { "source": 1 }],
        "materials": [
            { "name": "all", "pbrMetallicRoughness": {
                    "baseColorFactor": [1, 0.5, 0.2, 0.8], "baseColorTexture": texture, "metallicFactor": 0.5, "roughnessFactor": 0.4, "metallicRoughnessTexture": plain },
              "normalTexture": { "index": 1, "scale": 0.5 }, "occlusionTexture": { "index": 1, "strength": 0.5 }, "emissiveTexture": plain,
              "emissiveFactor": [1, 1, 1], "alphaMode": "MASK", "alphaCutoff": 0.3, "doubleSided": true,
              "extensions": {
                "KHR_materials_emissive_strength": { "emissiveStrength": 3 }, "KHR_materials_ior": { "ior": 1.4 },
                "KHR_materials_specular": { "specularFactor": 0.5, "specularColorFactor": [1, 0.5, 0.5], "specularTexture": plain },
                "KHR_materials_clearcoat": { "clearcoatFactor": 1, "clearcoatRoughnessFactor": 0.1, "clearcoatNormalTexture": plain },
                "KHR_materials_sheen": { "sheenColorFactor": [0.2, 0.2, 0.2], "sheenRoughnessFactor": 0.5 },
                "KHR_materials_anisotropy": { "anisotropyStrength": 0.5, "anisotropyRotation": 1, "anisotropyTexture": plain },
                "KHR_materials_transmission": { "transmissionFactor": 1 },
                "KHR_materials_volume": { "thicknessFactor": 1, "attenuationDistance": 0.5, "attenuationColor": [1, 0, 0] },
                "KHR_materials_iridescence": { "iridescenceFactor": 1, "iridescenceThicknessTexture": plain },
                "KHR_materials_dispersion": { "dispersion": 0.1 } } },
            { "name": "flat", "extensions": { "KHR_materials_unlit": {} } },
        ],
        "extensionsUsed": ["KHR_lights_punctual", "KHR_texture_transform", "KHR_materials_unlit", "KHR_materials_volume"],
        "extensions": { "KHR_lights_punctual": { "lights": [
            { "type": "point", "intensity": 10, "range": 5 },
            { "type": "spot", "color": [1, 0.5, 0], "spot": { "innerConeAngle": 0.1, "outerConeAngle": 0.5 } },
        ] } },
        "bufferViews": buffer.views,
        "accessors": buffer.accessors,
        "buffers": [{ "byteLength": buffer.bytes.len() }],
    });
    parts(directory, "parts", &document, &buffer.bytes)?;
    let container = container(&document, &buffer.bytes);
    write(directory, "glb", "whole", &container)?;
    write(directory, "glb", "truncated", &container[..container.len() / 2])?;
    write(directory, "glb", "small", b"{\"asset\":{\"version\":\"2.0\"}}")?;

    document["buffers"][0]["uri"] = format!("data:application/octet-stream;base64,{}", BASE64_STANDARD.encode(&buffer.bytes)).into();
    document["buffers"][0]["byteLength"] = buffer.bytes.len().into();
    write(directory, "gltf", "everything", document.to_string())?;
    write(directory, "gltf", "cycle", r#"{"asset":{"version":"2.0"},"nodes":[{"children":[1]},{"children":[0]}]}"#)?;
    write(directory, "gltf", "required", r#"{"asset":{"version":"2.0"},"extensionsRequired":["KHR_draco_mesh_compression"]}"#)?;
    write(directory, "gltf", "empty", r#"{"asset":{"version":"2.0"}}"#)
}

/// A binary glTF file.
fn container(document: &Value, binary: &[u8]) -> Vec<u8> {
    let json = document.to_string();
    let length = |n: usize| (n as u32).to_le_bytes();
    let padded = |bytes: &[u8], with: u8| {
        let mut bytes = bytes.to_vec();
        bytes.resize(bytes.len().next_multiple_of(4), with);
        bytes
    };
    let (json, binary) = (padded(json.as_bytes(), b' '), padded(binary, 0));
    let total = length(12 + 8 + json.len() + 8 + binary.len());
    [b"glTF\x02\0\0\0".as_slice(), &total, &length(json.len()), b"JSON", &json, &length(binary.len()), b"BIN\0", &binary].concat()
}

/// The parts of a container, divided by a zero byte as the target wants them.
///
/// # Errors
/// A file that the importer refuses: such a seed would lead to its refusal alone.
fn parts(directory: &Path, name: &str, document: &Value, binary: &[u8]) -> Outcome {
    load_gltf_bytes(name, &container(document, binary), &NoResources, ImportLimits::default())?;
    write(directory, "glb", name, [document.to_string().as_bytes(), b"\0", binary].concat())
}

/// A mesh whose every part is compressed with meshopt, each mode and each filter once.
fn meshopt(directory: &Path) -> Outcome {
    let mut buffer = Buffer::default();
    let halves = |values: &[i16]| -> Vec<u8> { values.iter().flat_map(|v| v.to_le_bytes()).collect() };
    let words = |values: &[u32]| -> Vec<u8> { values.iter().flat_map(|v| v.to_le_bytes()).collect() };
    // Exponents in the upper byte, mantissas below: (0, 0, 0), (1, 0, 0), (0, 1, 0), (0.5, 0.5, 0).
    let (half, one) = (0xff00_0001, 1);
    let corners = attributes(&words(&[0, 0, 0, one, 0, 0, 0, one, 0, half, half, 0]), 12);
    let up = attributes(&[0, 0, 127, 0].repeat(4), 4);
    let turns = attributes(&halves(&[0, 2047, 0, 2047, 0, 0, 0, 2047]), 8);
    let times = attributes(&[0f32, 1.0].map(f32::to_le_bytes).concat(), 4);
    let strip = indices(&[0, 1, 2, 2, 1, 3]);
    // Triangles of the reference encoder (meshoptimizer 0.25, codec 1), whose largest index is 1000.
    let triangles = b"\xe1\xf0\x10\x0f\xff\xff\xff\xc8\x01\xf3\xc7\x01\x0a\xf4\xc0\x01\xbb\x01\xf8\x03\xc6\x0f\
                      \x00\x76\x87\x56\x67\x78\xa9\x86\x65\x89\x68\x98\x01\x69\x00\x00";
    let streams: [(&[u8], &str, &str, usize, usize); 6] = [
        (&corners, "ATTRIBUTES", "EXPONENTIAL", 4, 12),
        (&up, "ATTRIBUTES", "OCTAHEDRAL", 4, 4),
        (&turns, "ATTRIBUTES", "QUATERNION", 2, 8),
        (&times, "ATTRIBUTES", "NONE", 2, 4),
        (&strip, "INDICES", "NONE", 6, 2),
        (triangles, "TRIANGLES", "NONE", 18, 2),
    ];
    for (stream, mode, filter, count, stride) in streams {
        let view = buffer.view(stream);
        let compressed = json!({
            "buffer": 0, "byteOffset": buffer.views[view]["byteOffset"], "byteLength": stream.len(),
            "mode": mode, "filter": filter, "count": count, "byteStride": stride,
        });
        buffer.views[view] = json!({ "buffer": 1, "byteLength": count * stride, "extensions": { "EXT_meshopt_compression": compressed } });
    }
    let document = json!({
        "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": [0, 1] }],
        "nodes": [{ "mesh": 0 }, { "mesh": 1 }],
        "meshes": [
            { "primitives": [{ "attributes": { "POSITION": 0, "NORMAL": 1 }, "indices": 4 }] },
            { "primitives": [{ "attributes": { "POSITION": 6 }, "indices": 5 }] },
        ],
        "animations": [{ "samplers": [{ "input": 3, "output": 2 }], "channels": [{ "sampler": 0, "target": { "node": 0, "path": "rotation" } }] }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3" },
            { "bufferView": 1, "componentType": 5120, "count": 4, "type": "VEC3", "normalized": true },
            { "bufferView": 2, "componentType": 5122, "count": 2, "type": "VEC4", "normalized": true },
            { "bufferView": 3, "componentType": 5126, "count": 2, "type": "SCALAR" },
            { "bufferView": 4, "componentType": 5123, "count": 6, "type": "SCALAR" },
            { "bufferView": 5, "componentType": 5123, "count": 18, "type": "SCALAR" },
            { "componentType": 5126, "count": 1001, "type": "VEC3" },
        ],
        "bufferViews": buffer.views,
        "buffers": [{ "byteLength": buffer.bytes.len() }, { "byteLength": 500, "extensions": { "EXT_meshopt_compression": { "fallback": true } } }],
        "extensionsUsed": ["EXT_meshopt_compression"], "extensionsRequired": ["EXT_meshopt_compression"],
    });
    parts(directory, "meshopt", &document, &buffer.bytes)
}

/// Up to 16 elements of `stride` bytes as the simplest encoder would store them: raw deltas, the first element behind.
fn attributes(elements: &[u8], stride: usize) -> Vec<u8> {
    let mut stream = vec![0xa0];
    for byte in 0..stride {
        stream.push(3);
        let mut previous = elements[byte];
        for index in 0..16 {
            let value = elements.get(index * stride + byte).copied().unwrap_or(previous);
            let delta = value.wrapping_sub(previous);
            stream.push((delta << 1) ^ (((delta as i8) >> 7) as u8));
            previous = value;
        }
    }
    stream.resize(stream.len() + 32usize.saturating_sub(stride), 0);
    stream.extend(&elements[..stride]);
    stream
}

/// Indices below 32 as deltas to the one before, and the empty tail.
fn indices(values: &[i8]) -> Vec<u8> {
    let deltas = std::iter::once(&0).chain(values).zip(values).map(|(previous, value)| value - previous);
    let zigzag = deltas.map(|delta| ((delta << 1) ^ (delta >> 7)) as u8);
    [0xd1].into_iter().chain(zigzag.map(|code| code << 1)).chain([0; 4]).collect()
}

/// KTX 2 files as they are and inside a container.
fn basis(directory: &Path) -> Outcome {
    let files: [(&str, &[u8]); 3] = [
        ("etc1s", include_bytes!("../src/decode/fixtures/etc1s.ktx2")),
        ("uastc", include_bytes!("../src/decode/fixtures/uastc.ktx2")),
        ("uastc_zstandard", include_bytes!("../src/decode/fixtures/uastc_zstandard.ktx2")),
    ];
    for (name, bytes) in files {
        write(directory, "texture", name, bytes)?;
        let mut buffer = Buffer::default();
        let image = buffer.view(bytes);
        let document = json!({
            "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": [0] }], "nodes": [{ "mesh": 0 }],
            "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0, "TEXCOORD_0": 1 }, "material": 0 }] }],
            "materials": [{ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }],
            "textures": [{ "extensions": { "KHR_texture_basisu": { "source": 0 } } }],
            "images": [{ "bufferView": image, "mimeType": "image/ktx2" }],
            "accessors": [{ "componentType": 5126, "count": 3, "type": "VEC3" }, { "componentType": 5126, "count": 3, "type": "VEC2" }],
            "bufferViews": buffer.views,
            "buffers": [{ "byteLength": buffer.bytes.len() }],
            "extensionsUsed": ["KHR_texture_basisu"], "extensionsRequired": ["KHR_texture_basisu"],
        });
        parts(directory, name, &document, &buffer.bytes)?;
    }
    write(directory, "texture", "plain", plain_ktx2())
}

/// Two texels of 8 bits a channel, with metadata that turn and exchange them.
fn plain_ktx2() -> Vec<u8> {
    let pairs = b"\x12\0\0\0KTXorientation\0ru\0\0\0\x10\0\0\0KTXswizzle\0grb1\0";
    let (descriptor, level) = (104u32, 132u32);
    let mut file = b"\xabKTX 20\xbb\r\n\x1a\n".to_vec();
    for word in [37, 1, 1, 2, 0, 0, 1, 1, 0, descriptor, 28, level + 8, pairs.len() as u32, 0, 0, 0, 0, level, 0, 8, 0, 8, 0] {
        file.extend(word.to_le_bytes());
    }
    for word in [28u32, 0, 2 | 24 << 16, 1 | 1 << 8 | 1 << 16, 0, 0, 0] {
        file.extend(word.to_le_bytes());
    }
    file.extend([1, 2, 3, 4, 5, 6, 7, 8]);
    file.extend(pairs);
    file
}

fn obj(directory: &Path) -> Outcome {
    let square = "mtllib m.mtl\no a\nv 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 1 1 0 0 1 0\nv 0 1 0 0 0 1\nvt 0 0\nvt 1 1\nvn 0 0 1\nusemtl a\n\
                  f 1/1/1 2/2/1 3/1/1 4/2/1\ng b\nusemtl c\nf -4 -3 -2\nf 1//1 2//1 3//1\ns 1\nl 1 2\np 1\n";
    let library = "newmtl a\nKa 1 1 1\nKd 0.5 0.5 0.5\nKs 0.2\nKe 1 1 1\nNs 50\nNi 1.4\nd 0.5\nillum 7\nmap_Kd -s 2 2 2 -o 0.5 a.png\nmap_d b.png\nbump -bm 0.1 c.png\n\
                   newmtl c\nPr 0.3\nPm 1\nPc 0.5\nPcr 0.1\nPs 0.2\naniso 0.1\nanisor 0.2\nmap_Pr r.png\nmap_Pm m.png\nnorm n.png\nTr 0.1\n";
    write(directory, "obj", "square", format!("{square}\0{library}"))?;
    write(directory, "obj", "triangle", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")?;
    let mut textured = b"mtllib m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl a\nf 1/1 2/1 3/1\n\0".to_vec();
    textured.extend(picture(image::ImageFormat::Png)?);
    write(directory, "obj", "picture", textured)
}

/// A picture of 3 × 2 px.
fn picture(format: image::ImageFormat) -> Result<Vec<u8>, image::ImageError> {
    let mut bytes = Cursor::new(Vec::new());
    image::RgbImage::from_fn(3, 2, |x, y| image::Rgb([x as u8 * 80, y as u8 * 200, 40])).write_to(&mut bytes, format)?;
    Ok(bytes.into_inner())
}

fn pictures(directory: &Path) -> Outcome {
    use image::ImageFormat::{Jpeg, Png, WebP};
    for (format, name) in [(Png, "png"), (Jpeg, "jpg"), (WebP, "webp")] {
        write(directory, "hdr", name, picture(format)?)?;
        write(directory, "texture", name, picture(format)?)?;
    }
    // Wide enough for run-length coding, and too narrow for it.
    for width in [16, 4] {
        let image = Image::from_fn((width, 4).into(), |x, y| LinearRgb::new(x as f32 * 10.0, y as f32, 0.25));
        write_hdr(&directory.join("hdr").join(format!("radiance{width}.hdr")), &image)?;
        let mut file = ExrFile::new((width, 4).into());
        file.layers.push(Layer::color("", &image));
        file.write(&directory.join("hdr").join(format!("open{width}.exr")))?;
    }
    write(directory, "hdr", "huge", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 100000 +X 100000\n")?;
    write(directory, "hdr", "empty", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 0 +X 0\n")
}

fn scene_files(directory: &Path) -> Outcome {
    let document = include_str!("../../../docs/scene-format.md");
    for (index, example) in document.split("```toml\n").skip(1).filter_map(|rest| rest.split_once("```")).enumerate() {
        write(directory, "kajo_toml", &format!("document{index}"), example.0)?;
    }
    let lights = "exposure = 1\n[environment]\nradiance = [1, 2, 3]\nscale = 0.5\nrotation_deg = 30\n\
                  [[light]]\ntype = \"point\"\nlumens = 5\n[[light]]\ntype = \"spot\"\ncandela = 5\nouter_deg = 40\ninner_deg = 10\nposition = [0, 2, 0]\ntarget = [0, 0, 0]\n\
                  [[light]]\ntype = \"directional\"\nlux = 1\ndirection = [0, -1, 0]\nhalf_angle_deg = 0.3\n[[light]]\ntype = \"rectangle\"\nwidth = 1\nheight = 2\nnits = 3\nrotate_deg = [10, 20, 30]\n\
                  [[light]]\ntype = \"disk\"\nradius = 1\nwatts = 3\ndirection = [1, 0, 0]\n[[light]]\ntype = \"sphere\"\nradius = 0.1\nradiance = 3\n";
    write(directory, "kajo_toml", "lights", lights)?;
    let cameras = "[[camera]]\nname = \"a\"\nposition = [0, 0, 1]\ntarget = [0, 0, 0]\nyfov_deg = 50\naspect = 1.5\nf_number = 2.8\nsensor_height_mm = 24\nfocus_on = [0, 0, 0]\nnear = 0.1\n\
                   [[camera]]\nposition = [0, 0, 1]\nrotate_deg = [1, 2, 3]\northographic_height = 2\nlens_radius = 0.1\nfocus_distance = 3\n";
    write(directory, "kajo_toml", "cameras", cameras)
}

fn measured(directory: &Path) -> Outcome {
    let ggx = find("ggx").ok_or("no GGX")?.from_pairs(&[("alpha_x", "0.3"), ("alpha_y", "0.6")], Form::Corrected)?;
    for (name, phi_i, symmetry) in
        [("isotropic", 1, Symmetry::None), ("turn", 4, Symmetry::None), ("half", 3, Symmetry::HalfTurn), ("quarter", 3, Symmetry::Mirrors)]
    {
        let resolution = Resolution { phi_i, theta_i: 2, normals: [4, 5], samples: 3, symmetry };
        write(directory, "rgl", name, Table::of_model(&*ggx, resolution).to_bytes())?;
    }
    Ok(())
}

//! Materials, textures and images.

use super::{File, ignored};
use crate::{AlphaMode, ColorSpace, Filter, Material, Scene, Texels, Wrap};
use glam::Vec2;
use image::{ImageFormat, RgbaImage};
use kajo_units::{LinearRgb, Radians};
use serde_json::{Value, json};
use std::io::Cursor;

/// A triangle with both sets of texture coordinates and this material.
fn with_material(material: Value) -> File {
    let mut file = File::triangle();
    let uv = file.floats("VEC2", &[0.0, 1.0, 1.0, 1.0, 0.0, 0.0]);
    let attributes = &mut file.primitive()["attributes"];
    attributes["TEXCOORD_0"] = uv.into();
    attributes["TEXCOORD_1"] = uv.into();
    file.primitive()["material"] = 0.into();
    file.push("materials", material);
    file
}

/// Adds a 2 × 1 image in the given format, and a texture on it.
fn add_image(file: &mut File, format: ImageFormat) -> usize {
    let mut bytes = Cursor::new(Vec::new());
    let image = RgbaImage::from_raw(2, 1, vec![255, 0, 0, 255, 0, 255, 0, 128]).unwrap();
    match format {
        ImageFormat::Jpeg => image::DynamicImage::from(image).into_rgb8().write_to(&mut bytes, format).unwrap(),
        _ => image.write_to(&mut bytes, format).unwrap(),
    }
    let view = file.view(bytes.get_ref());
    let image = file.push("images", json!({ "bufferView": view, "mimeType": "image/png" }));
    file.push("textures", json!({ "source": image }))
}

fn material(json: Value) -> Material {
    with_material(json).load().materials[0].clone()
}

#[test]
fn an_empty_material_is_the_default_material() {
    assert_eq!(material(json!({})), Material::default());
    assert_eq!(File::triangle().load().materials, [Material::default()], "which is made where a primitive names none");
}

#[test]
fn factors_of_the_core_and_of_every_extension_are_read() {
    let read = material(json!({
        "name": "all",
        "pbrMetallicRoughness": { "baseColorFactor": [0.1, 0.2, 0.3, 0.4], "metallicFactor": 0.5, "roughnessFactor": 0.6 },
        "emissiveFactor": [1, 0.5, 0.25], "alphaMode": "MASK", "alphaCutoff": 0.7, "doubleSided": true,
        "extensions": {
            "KHR_materials_emissive_strength": { "emissiveStrength": 4 },
            "KHR_materials_ior": { "ior": 1.33 },
            "KHR_materials_specular": { "specularFactor": 0.8, "specularColorFactor": [1, 2, 3] },
            "KHR_materials_clearcoat": { "clearcoatFactor": 0.11, "clearcoatRoughnessFactor": 0.12 },
            "KHR_materials_sheen": { "sheenColorFactor": [0.13, 0.14, 0.15], "sheenRoughnessFactor": 0.16 },
            "KHR_materials_anisotropy": { "anisotropyStrength": 0.17, "anisotropyRotation": 0.18 },
            "KHR_materials_transmission": { "transmissionFactor": 0.19 },
            "KHR_materials_volume": { "thicknessFactor": 0.21, "attenuationDistance": 0.22, "attenuationColor": [0.23, 0.24, 0.25] },
            "KHR_materials_iridescence": {
                "iridescenceFactor": 0.26, "iridescenceIor": 1.27, "iridescenceThicknessMinimum": 280, "iridescenceThicknessMaximum": 290
            },
            "KHR_materials_dispersion": { "dispersion": 0.31 },
            "KHR_materials_unlit": {}
        }
    }));
    let want = Material {
        name: "all".into(),
        base_color: LinearRgb::new(0.1, 0.2, 0.3),
        alpha: 0.4,
        metallic: 0.5,
        roughness: 0.6,
        emission: LinearRgb::new(4.0, 2.0, 1.0),
        alpha_mode: AlphaMode::Mask(0.7),
        double_sided: true,
        unlit: true,
        ior: 1.33,
        specular: 0.8,
        specular_color: LinearRgb::new(1.0, 2.0, 3.0),
        clearcoat: 0.11,
        clearcoat_roughness: 0.12,
        sheen_color: LinearRgb::new(0.13, 0.14, 0.15),
        sheen_roughness: 0.16,
        anisotropy: 0.17,
        anisotropy_rotation: Radians(0.18),
        transmission: 0.19,
        thickness: 0.21,
        attenuation_distance: 0.22,
        attenuation_color: LinearRgb::new(0.23, 0.24, 0.25),
        iridescence: 0.26,
        iridescence_ior: 1.27,
        iridescence_thickness: [280.0, 290.0],
        dispersion: 0.31,
        ..Material::default()
    };
    assert_eq!(read, want);
}

#[test]
fn extensions_without_values_have_their_own_defaults() {
    let read = material(json!({ "extensions": {
        "KHR_materials_clearcoat": {}, "KHR_materials_sheen": {}, "KHR_materials_transmission": {}, "KHR_materials_volume": {},
        "KHR_materials_iridescence": {}, "KHR_materials_specular": {}, "KHR_materials_ior": {}, "KHR_materials_anisotropy": {},
        "KHR_materials_dispersion": {}, "KHR_materials_emissive_strength": {}
    } }));
    assert_eq!(read, Material::default());
}

#[test]
fn values_out_of_range_are_clamped_and_noted() {
    let file = with_material(json!({ "name": "Wild", "pbrMetallicRoughness": { "metallicFactor": 1.5, "roughnessFactor": -1 },
        "extensions": { "KHR_materials_ior": { "ior": 0.5 }, "KHR_materials_volume": { "attenuationDistance": 0 } } }));
    let scene = file.load();
    assert_eq!([scene.materials[0].metallic, scene.materials[0].roughness, scene.materials[0].ior], [1.0, 0.0, 1.0]);
    assert_eq!(scene.materials[0].attenuation_distance, f32::INFINITY);
    assert_eq!(
        ignored(&scene),
        [
            "material 0 \"Wild\": metallicFactor 1.5",
            "material 0 \"Wild\": roughnessFactor -1",
            "material 0 \"Wild\": ior 0.5",
            "material 0 \"Wild\": attenuationDistance of 0 or less"
        ]
    );
    let special = material(json!({ "extensions": { "KHR_materials_ior": { "ior": 0 } } }));
    assert_eq!(special.ior, 0.0, "0 is a value of its own");
}

/// Every texture slot of a material, its colour space by its use.
#[test]
fn every_texture_is_read_in_its_colour_space() {
    let info = json!({ "index": 0 });
    let mut file = with_material(json!({
        "pbrMetallicRoughness": { "baseColorTexture": info, "metallicRoughnessTexture": info },
        "normalTexture": { "index": 0, "scale": 0.5 }, "occlusionTexture": { "index": 0, "strength": 0.25 }, "emissiveTexture": info,
        "extensions": {
            "KHR_materials_specular": { "specularTexture": info, "specularColorTexture": info },
            "KHR_materials_clearcoat": { "clearcoatTexture": info, "clearcoatRoughnessTexture": info, "clearcoatNormalTexture": { "index": 0, "scale": 0.75 } },
            "KHR_materials_sheen": { "sheenColorTexture": info, "sheenRoughnessTexture": info },
            "KHR_materials_anisotropy": { "anisotropyTexture": info },
            "KHR_materials_transmission": { "transmissionTexture": info },
            "KHR_materials_volume": { "thicknessTexture": info },
            "KHR_materials_iridescence": { "iridescenceTexture": info, "iridescenceThicknessTexture": info }
        }
    }));
    add_image(&mut file, ImageFormat::Png);
    let scene = file.load();
    assert_eq!((scene.images.len(), scene.textures.len()), (1, 2), "one image, used in two colour spaces");
    let m = &scene.materials[0];
    let space = |texture: &Option<crate::TextureRef>| scene.textures[texture.expect("read").texture].color_space;
    for texture in [&m.base_color_texture, &m.emission_texture, &m.specular_color_texture, &m.sheen_color_texture] {
        assert_eq!(space(texture), ColorSpace::Srgb);
    }
    for texture in [
        &m.metallic_roughness_texture,
        &m.normal_texture,
        &m.occlusion_texture,
        &m.specular_texture,
        &m.clearcoat_texture,
        &m.clearcoat_roughness_texture,
        &m.clearcoat_normal_texture,
        &m.sheen_roughness_texture,
        &m.anisotropy_texture,
        &m.transmission_texture,
        &m.thickness_texture,
        &m.iridescence_texture,
        &m.iridescence_thickness_texture,
    ] {
        assert_eq!(space(texture), ColorSpace::Linear);
    }
    assert_eq!([m.normal_scale, m.occlusion_strength, m.clearcoat_normal_scale], [0.5, 0.25, 0.75]);
}

fn base_color_scene(texture: Value, change: impl FnOnce(&mut File)) -> Scene {
    let mut file = with_material(json!({ "pbrMetallicRoughness": { "baseColorTexture": texture } }));
    add_image(&mut file, ImageFormat::Png);
    change(&mut file);
    file.load()
}

/// The example of KHR_texture_transform: the lower left quadrant of the image, turned clockwise by 90°.
#[test]
fn texture_transforms_are_those_of_the_example() {
    let transform = json!({ "offset": [0, 1], "rotation": std::f64::consts::FRAC_PI_2, "scale": [0.5, 0.5] });
    let scene = base_color_scene(json!({ "index": 0, "extensions": { "KHR_texture_transform": transform } }), |_| {});
    let map = scene.materials[0].base_color_texture.unwrap().transform;
    for ([u, v], want) in [([0.0, 0.0], [0.0, 1.0]), ([1.0, 0.0], [0.0, 0.5]), ([0.0, 1.0], [0.5, 1.0]), ([1.0, 1.0], [0.5, 0.5])] {
        let got = map.transform_point2(Vec2::new(u, v));
        assert!(got.distance(Vec2::from(want)) < 1e-6, "({u}, {v}) to {got} instead of {want:?}");
    }
}

#[test]
fn texture_coordinates_are_chosen_by_the_transform_first() {
    let transform = json!({ "texCoord": 1 });
    let scene = base_color_scene(json!({ "index": 0, "texCoord": 0, "extensions": { "KHR_texture_transform": transform } }), |_| {});
    assert_eq!(scene.materials[0].base_color_texture.unwrap().uv_set, 1);
    let scene = base_color_scene(json!({ "index": 0, "texCoord": 3 }), |file| {
        let uv = file.floats("VEC2", &[0.5; 6]);
        file.primitive()["attributes"]["TEXCOORD_3"] = uv.into();
    });
    let slot = scene.materials[0].base_color_texture.unwrap().uv_set;
    assert_eq!(scene.meshes[0].uvs[slot], [Vec2::splat(0.5); 3], "a higher set stands in a free slot");
    let scene = base_color_scene(json!({ "index": 0, "texCoord": 7 }), |_| {});
    assert_eq!(ignored(&scene), ["mesh 0, primitive 0: a texture on TEXCOORD_7, which the mesh lacks"]);
}

#[test]
fn samplers_wrap_and_filter() {
    let scene = base_color_scene(json!({ "index": 0 }), |file| {
        file.json["textures"][0]["sampler"] = 0.into();
        file.push("samplers", json!({ "magFilter": 9728, "minFilter": 9987, "wrapS": 33071, "wrapT": 33648 }));
    });
    assert_eq!((scene.textures[0].wrap, scene.textures[0].filter), ([Wrap::Clamp, Wrap::Mirror], Filter::Nearest));
    let plain = base_color_scene(json!({ "index": 0 }), |_| {});
    assert_eq!((plain.textures[0].wrap, plain.textures[0].filter), ([Wrap::Repeat; 2], Filter::Linear));
}

#[test]
fn png_jpeg_and_webp_are_told_by_their_bytes() {
    for format in [ImageFormat::Png, ImageFormat::Jpeg, ImageFormat::WebP] {
        let mut file = with_material(json!({ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }));
        add_image(&mut file, format);
        if format == ImageFormat::WebP {
            file.json["textures"][0] = json!({ "extensions": { "EXT_texture_webp": { "source": 0 } } });
        }
        let scene = file.load();
        let Texels::Rgba8(texels) = &scene.images[0].texels else { panic!("8 bits") };
        assert_eq!((scene.images[0].width, scene.images[0].height), (2, 1));
        match format {
            ImageFormat::Jpeg => assert_eq!(texels[1][3], 255),
            _ => assert_eq!(texels[..], [[255, 0, 0, 255], [0, 255, 0, 128]]),
        }
    }
}

#[test]
fn a_texture_without_a_known_image_is_noted() {
    let scene = base_color_scene(json!({ "index": 0 }), |file| {
        file.json["textures"][0] = json!({ "name": "sky", "extensions": { "EXT_texture_avif": { "source": 0 } } });
    });
    assert_eq!(scene.materials[0].base_color_texture, None);
    assert_eq!(ignored(&scene), ["texture 0 \"sky\": EXT_texture_avif", "texture 0 \"sky\": a texture without an image"]);
}

#[test]
fn specular_glossiness_becomes_a_dielectric_with_a_specular_colour() {
    let mut file = with_material(json!({ "extensions": { "KHR_materials_pbrSpecularGlossiness": {
        "diffuseFactor": [0.1, 0.2, 0.3, 1], "specularFactor": [0.4, 0.5, 0.6], "glossinessFactor": 0.5,
        "specularGlossinessTexture": { "index": 0 }
    } } }));
    add_image(&mut file, ImageFormat::Png);
    let scene = file.load();
    let m = &scene.materials[0];
    assert_eq!((m.metallic, m.ior, m.roughness), (0.0, 0.0, 1.0));
    assert_eq!((m.base_color, m.specular_color), (LinearRgb::new(0.1, 0.2, 0.3), LinearRgb::new(0.4, 0.5, 0.6)));
    let roughness = &scene.images[scene.textures[m.metallic_roughness_texture.unwrap().texture].image];
    let Texels::Rgba16(texels) = &roughness.texels else { panic!("16 bits") };
    assert_eq!(texels[0][1], 32768, "1 − 0.5 · 1");
    assert_eq!(scene.textures[m.specular_color_texture.unwrap().texture].color_space, ColorSpace::Srgb);
    assert_eq!(ignored(&scene), ["material 0: KHR_materials_pbrSpecularGlossiness"]);
}

#[test]
fn broken_images_are_one_sentence() {
    let error_of = |bytes: &[u8]| {
        let mut file = with_material(json!({ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }));
        let view = file.view(bytes);
        file.push("images", json!({ "bufferView": view, "name": "sky" }));
        file.push("textures", json!({ "source": 0 }));
        file.error()
    };
    assert_eq!(error_of(b"GIF89a...."), "`test.gltf`: image 0 \"sky\": the image is none of PNG, JPEG, WebP and KTX 2");
    assert_eq!(error_of(b""), "`test.gltf`: image 0 \"sky\": the image is empty");
    let mut png = Cursor::new(Vec::new());
    RgbaImage::new(8, 8).write_to(&mut png, ImageFormat::Png).unwrap();
    let png = png.into_inner();
    assert!(error_of(&png[..png.len() / 2]).starts_with("`test.gltf`: image 0 \"sky\": "));
}

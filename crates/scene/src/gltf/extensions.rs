//! Which extensions Kajo reads, and what happens to the others.

use super::json::Document;
use super::notes::Notes;
use crate::SceneError;

/// Extensions that are honoured.
const SUPPORTED: &[&str] = &[
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "EXT_texture_webp",
    "KHR_lights_punctual",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_dispersion",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_node_visibility",
    "KHR_texture_basisu",
    "KHR_texture_transform",
];

/// Extensions whose absence changes nothing in a picture, or of which a default is shown: a file may require them.
const HARMLESS: &[&str] = &["KHR_materials_variants", "KHR_xmp", "KHR_xmp_json_ld"];

/// What it means for the picture that an extension is not honoured.
pub fn consequence(name: &str) -> &'static str {
    match name {
        "KHR_animation_pointer" => "only translation, rotation, scale and weights are animated",
        "KHR_draco_mesh_compression" => "the uncompressed fallback is used",
        "KHR_materials_diffuse_transmission" => "the surface lets no diffuse light through",
        "KHR_materials_variants" => "the default materials are shown",
        "KHR_xmp" | "KHR_xmp_json_ld" => "metadata is not shown",
        "EXT_lights_image_based" | "EXT_lights_ies" => "this light is missing",
        "EXT_texture_avif" | "MSFT_texture_dds" => "the fallback image is used",
        "MSFT_lod" => "the finest level is shown",
        _ => "not known to Kajo, the file is shown as if it were not there",
    }
}

/// Refuses a file that cannot be shown without an extension that Kajo does not have.
///
/// # Errors
/// [`SceneError::Unsupported`].
pub fn check_required(file: &str, document: &Document) -> Result<(), SceneError> {
    let missing = |name: &&String| !SUPPORTED.contains(&name.as_str()) && !HARMLESS.contains(&name.as_str());
    match document.extensions_required.iter().find(missing) {
        None => Ok(()),
        Some(name) => Err(SceneError::Unsupported {
            file: file.into(),
            feature: format!("the extension {name}, which the file requires,"),
            advice: match name.as_str() {
                "KHR_draco_mesh_compression" => "export it without Draco compression (EXT_meshopt_compression is supported)".into(),
                "KHR_meshopt_compression" => "compress it with EXT_meshopt_compression".into(),
                _ => "export it without this extension".into(),
            },
        }),
    }
}

/// Notes the extensions that the file says it uses, that Kajo does not honour, and that no note names yet.
pub fn note_unused(document: &Document, notes: &mut Notes) {
    for name in &document.extensions_used {
        if !SUPPORTED.contains(&name.as_str()) && !notes.mentions(name) {
            notes.add("", name, consequence(name));
        }
    }
}

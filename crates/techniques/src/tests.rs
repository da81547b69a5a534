//! The registry: folders and list agree, every entry is whole.

use crate::*;
use std::collections::BTreeSet;
use std::path::Path;

/// Folders of `src` that hold a technique: those with a `doc.md`, as ids.
fn folders() -> BTreeSet<String> {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let folders = |path: &Path| -> Vec<_> {
        std::fs::read_dir(path).unwrap().map(|entry| entry.unwrap().path()).filter(|path| path.is_dir()).collect()
    };
    let name = |path: &Path| path.file_name().unwrap().to_str().unwrap().replace('_', "-");
    folders(&source)
        .iter()
        .flat_map(|group| folders(group).into_iter().map(move |folder| (name(group), folder)))
        .filter(|(_, folder)| folder.join("doc.md").exists())
        .map(|(group, folder)| format!("{group}/{}", name(&folder)))
        .collect()
}

#[test]
fn folders_and_list_agree() {
    let listed: BTreeSet<String> = all().map(|technique| technique.id.to_owned()).collect();
    assert_eq!(folders(), listed);
    assert_eq!(listed.len(), all().count(), "an id twice");
}

#[test]
fn every_technique_is_documented_and_its_defaults_are_valid() {
    for technique in all() {
        assert!(technique.doc.trim().len() > 40, "{}", technique.id);
        assert!(!technique.title.is_empty(), "{}", technique.id);
        assert!(technique.role.output().is_some(), "{} fills a role without output", technique.id);
        technique.parse_params(&[]).unwrap();
    }
}

#[test]
fn every_citation_is_in_the_bibliography() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/references.bib");
    let bibliography = std::fs::read_to_string(path).unwrap();
    for technique in all() {
        for key in technique.cites {
            assert!(bibliography.contains(&format!("{{{key},")), "{}: {key}", technique.id);
        }
    }
}

#[test]
fn lists_are_parted_where_an_id_begins() {
    assert_eq!(split_list("shadow/map"), ["shadow/map"]);
    assert_eq!(split_list("shadow/map,shadow/none"), ["shadow/map", "shadow/none"]);
    assert_eq!(
        split_list("shadow/map:resolution=512,kernel=3,shadow/none,aa/taa:blend=0.2"),
        ["shadow/map:resolution=512,kernel=3", "shadow/none", "aa/taa:blend=0.2"]
    );
    assert_eq!(split_list("shadow/x:file=a/b,c=d/e"), ["shadow/x:file=a/b,c=d/e"]);
    assert_eq!(split_list(""), [""]);
}

#[test]
fn every_module_and_its_structs_fit() {
    for backend in [TraceBackend::RayQuery, TraceBackend::Compute] {
        for bindless in [true, false] {
            for file in shaders::FILES {
                let root = format!("import package::{0}; @compute @workgroup_size(1) fn main() {{}}", file.name);
                shaders::link("test", &root, shaders::Variant::without_models(backend, bindless))
                    .unwrap_or_else(|error| panic!("{}: {error}", file.name));
            }
        }
    }
}

#[test]
fn every_technique_can_be_made_on_every_backend() {
    let device = kajo_render_graph::Device::new().unwrap();
    for technique in all() {
        for backend in [TraceBackend::RayQuery, TraceBackend::Compute] {
            if backend == TraceBackend::RayQuery && !device.has_ray_query() {
                continue;
            }
            let context = MakeContext { device: &device, variant: shaders::Variant::without_models(backend, true), textures: 1 };
            let params = technique.parse_params(&[]).unwrap();
            if let Err(error) = technique.build(&context, &params) {
                panic!("{} on {}: {error}", technique.id, backend.id());
            }
        }
    }
}

#[test]
fn an_unknown_id_names_the_nearest() {
    let text = find("shadow/raytraced").unwrap_err().to_string();
    assert!(text.contains("did you mean \"shadow/ray-traced\"?"), "{text}");
}

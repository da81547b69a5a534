//! Nodes and what stands at them.

use super::{File, ignored};
use crate::{LightShape, Projection, Snapshot, Transform};
use glam::{Mat4, Vec3};
use kajo_units::{LinearRgb, Meters, Radians, Seconds};
use serde_json::json;

#[test]
fn matrices_and_parts_place_nodes() {
    let mut file = File::triangle();
    file.json["nodes"] = json!([
        { "mesh": 0, "translation": [1, 0, 0], "rotation": [0, 0, 1, 1], "scale": [2, 2, 2] },
        { "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 5, 1], "children": [0] }
    ]);
    file.json["scenes"][0]["nodes"] = json!([1]);
    let scene = file.load();
    assert!(matches!(scene.nodes[1].transform, Transform::Matrix(m) if m == Mat4::from_translation(Vec3::Z * 5.0)));
    let placed = Snapshot::new(&scene, Seconds(0.0)).instances[0].world_from_object;
    let corner = placed.transform_point3(Vec3::X);
    assert!(corner.distance(Vec3::new(1.0, 2.0, 5.0)) < 1e-6, "{corner}");
}

#[test]
fn only_the_default_scene_is_shown_and_nodes_keep_their_indices() {
    let mut file = File::triangle();
    file.json["nodes"] = json!([{ "mesh": 0, "name": "a" }, { "mesh": 0, "name": "b" }]);
    file.json["scenes"] = json!([{ "nodes": [0] }, { "nodes": [1] }]);
    file.json["scene"] = 1.into();
    let scene = file.load();
    assert_eq!(scene.nodes.iter().map(|node| (node.name.as_str(), node.meshes.len())).collect::<Vec<_>>(), [("a", 0), ("b", 1)]);
    assert_eq!(ignored(&scene), ["scene 0: another scene"]);
    file.json.as_object_mut().unwrap().remove("scene");
    assert_eq!(file.load().nodes[0].meshes.len(), 1, "else the first");
    file.json.as_object_mut().unwrap().remove("scenes");
    assert!(file.load().nodes.iter().all(|node| node.meshes.len() == 1), "without scenes, all roots");
}

#[test]
fn invisible_subtrees_are_left_out() {
    let mut file = File::triangle();
    file.json["nodes"] = json!([
        { "children": [1], "extensions": { "KHR_node_visibility": { "visible": false } } }, { "mesh": 0 }, { "mesh": 0 }
    ]);
    file.json["scenes"][0]["nodes"] = json!([0, 2]);
    assert_eq!(file.load().nodes.iter().map(|node| node.meshes.len()).collect::<Vec<_>>(), [0, 0, 1]);
}

#[test]
fn instances_become_nodes() {
    let mut file = File::triangle();
    let translation = file.floats("VEC3", &[0.0, 0.0, 0.0, 3.0, 0.0, 0.0]);
    let scale = file.floats("VEC3", &[1.0, 1.0, 1.0, 2.0, 2.0, 2.0]);
    file.json["nodes"][0]["translation"] = json!([0, 1, 0]);
    file.json["nodes"][0]["extensions"] =
        json!({ "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": translation, "SCALE": scale } } });
    let snapshot = Snapshot::new(&file.load(), Seconds(0.0));
    let corners: Vec<Vec3> = snapshot.instances.iter().map(|instance| instance.world_from_object.transform_point3(Vec3::X)).collect();
    assert_eq!(corners, [Vec3::new(1.0, 1.0, 0.0), Vec3::new(5.0, 1.0, 0.0)]);
}

#[test]
fn cameras_keep_their_projection() {
    let mut file = File::triangle();
    file.json["cameras"] = json!([
        { "type": "perspective", "name": "eye", "perspective": { "yfov": 0.5, "aspectRatio": 1.5, "znear": 0.1, "zfar": 100 } },
        { "type": "perspective", "perspective": { "yfov": 1.0, "znear": 0.01 } },
        { "type": "orthographic", "orthographic": { "xmag": 2, "ymag": 3, "znear": 0, "zfar": 10 } }
    ]);
    file.json["nodes"] = json!([{ "camera": 0 }, { "camera": 1, "name": "door" }, { "camera": 2 }]);
    file.json["scenes"][0]["nodes"] = json!([0, 1, 2]);
    let scene = file.load();
    let [eye, door, plan] = &scene.cameras[..] else { panic!("three cameras") };
    assert_eq!(eye.projection, Projection::Perspective { yfov: Radians(0.5), aspect: Some(1.5) });
    assert_eq!(door.projection, Projection::Perspective { yfov: Radians(1.0), aspect: None });
    assert_eq!(plan.projection, Projection::Orthographic { xmag: Meters(2.0), ymag: Meters(3.0) });
    assert_eq!([&eye.name, &door.name, &plan.name], ["eye", "door", "camera 2"]);
    assert_eq!([eye.near, door.near, plan.near], [0.1, 0.01, 0.0].map(Meters));
    assert_eq!(ignored(&scene), ["camera 0 \"eye\", camera 2: zfar"]);
}

#[test]
fn punctual_lights_keep_their_units() {
    let mut file = File::triangle();
    file.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [
        { "type": "point", "color": [1, 0.5, 0], "intensity": 8, "range": 10, "name": "bulb" },
        { "type": "directional" },
        { "type": "spot", "intensity": 2, "spot": { "innerConeAngle": 0.2, "outerConeAngle": 0.4 } },
        { "type": "spot", "spot": {} }
    ] } });
    file.json["nodes"] = (0..4).map(|light| json!({ "extensions": { "KHR_lights_punctual": { "light": light } } })).collect();
    file.json["scenes"][0]["nodes"] = json!([0, 1, 2, 3]);
    let scene = file.load();
    let shapes: Vec<_> = scene.lights.iter().map(|light| light.shape).collect();
    let spot = |inner, outer| LightShape::Spot { inner: Radians(inner), outer: Radians(outer) };
    let directional = LightShape::Directional { half_angle: Radians(0.0) };
    assert_eq!(shapes, [LightShape::Point, directional, spot(0.2, 0.4), spot(0.0, std::f32::consts::FRAC_PI_4)]);
    assert_eq!(scene.lights[0].emission, LinearRgb::new(8.0, 4.0, 0.0), "candela");
    assert_eq!(scene.lights[1].emission, LinearRgb::WHITE, "lux, 1 unless given");
    assert_eq!(scene.lights[0].name, "bulb");
    assert_eq!(ignored(&scene), ["light 0 \"bulb\": KHR_lights_punctual.range"]);
}

#[test]
fn unknown_optional_extensions_are_noted_with_their_places() {
    let mut file = File::triangle();
    file.json["extensionsUsed"] = json!(["ACME_fur", "ACME_wind", "KHR_materials_variants", "KHR_mesh_quantization"]);
    file.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    file.json["nodes"][0]["name"] = "Cat".into();
    file.json["nodes"][0]["extensions"] = json!({ "ACME_fur": {} });
    file.json["extensions"] = json!({ "KHR_materials_variants": { "variants": [] } });
    assert_eq!(ignored(&file.load()), [": KHR_materials_variants", "node 0 \"Cat\": ACME_fur", ": ACME_wind"]);
    file.json["extensionsRequired"] = json!(["ACME_fur"]);
    assert!(file.error().contains("the extension ACME_fur, which the file requires, is not supported"));
}

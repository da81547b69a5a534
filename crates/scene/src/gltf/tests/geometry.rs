//! Meshes: types of accessors, sparse ones, primitive modes, and what is made where it is absent.

use super::{F32, File, I8, I16, U8, U16, U32, ignored};
use glam::{Vec2, Vec3, Vec4};
use serde_json::json;

#[test]
fn quantized_positions_are_read_in_every_type() {
    for (component, normalized, bytes, scale) in [
        (I8, false, vec![0u8, 0, 0, 0, 10, 0, 0, 0, 0, 246, 0, 0], [10.0, -10.0]),
        (U8, false, vec![0, 0, 0, 0, 10, 0, 0, 0, 0, 246, 0, 0], [10.0, 246.0]),
        (I8, true, vec![0, 0, 0, 0, 127, 0, 0, 0, 0, 128, 0, 0], [1.0, -1.0]),
        (U8, true, vec![0, 0, 0, 0, 255, 0, 0, 0, 0, 51, 0, 0], [1.0, 0.2]),
    ] {
        let mut file = File::triangle();
        let accessor = file.accessor("VEC3", component, 3, &bytes);
        file.json["bufferViews"][1]["byteStride"] = 4.into();
        file.json["accessors"][accessor]["normalized"] = normalized.into();
        file.primitive()["attributes"]["POSITION"] = accessor.into();
        let positions = file.mesh().positions;
        assert_eq!(positions, [Vec3::ZERO, Vec3::X * scale[0], Vec3::Y * scale[1]], "component {component}, normalized {normalized}");
    }
    for (component, values, want) in [(I16, [0x8000u16, 0x7fff], [-1.0, 1.0]), (U16, [0xffff, 0x3333], [1.0, 0.2])] {
        let mut file = File::triangle();
        let words = [0, 0, 0, 0, values[0], 0, 0, 0, 0, values[1], 0, 0];
        let accessor = file.accessor("VEC3", component, 3, bytemuck::cast_slice(&words));
        file.json["bufferViews"][1]["byteStride"] = 8.into();
        file.json["accessors"][accessor]["normalized"] = true.into();
        file.primitive()["attributes"]["POSITION"] = accessor.into();
        assert_eq!(file.mesh().positions, [Vec3::ZERO, Vec3::X * want[0], Vec3::Y * want[1]]);
    }
}

#[test]
fn interleaved_attributes_are_read_at_their_stride() {
    let mut file = File::triangle();
    // position, texture coordinate; five floats a vertex
    let vertices = [[0.0, 0.0, 0.0, 0.1, 0.2], [2.0, 0.0, 0.0, 0.3, 0.4], [0.0, 2.0, 0.0, 0.5, 0.6f32]].concat();
    let view = file.view(bytemuck::cast_slice(&vertices));
    file.json["bufferViews"][view]["byteStride"] = 20.into();
    let position = file.push("accessors", json!({ "bufferView": view, "componentType": F32, "count": 3, "type": "VEC3" }));
    let uv = file.push("accessors", json!({ "bufferView": view, "byteOffset": 12, "componentType": F32, "count": 3, "type": "VEC2" }));
    file.primitive()["attributes"] = json!({ "POSITION": position, "TEXCOORD_0": uv });
    let mesh = file.mesh();
    assert_eq!(mesh.positions[1], Vec3::X * 2.0);
    assert_eq!(mesh.uvs[0], [Vec2::new(0.1, 0.2), Vec2::new(0.3, 0.4), Vec2::new(0.5, 0.6)]);
}

#[test]
fn sparse_accessors_replace_elements_of_their_base_or_of_zeros() {
    for with_base in [true, false] {
        let mut file = File::triangle();
        let indices = file.view(&[1, 2]);
        let values = file.view(bytemuck::cast_slice(&[5.0f32, 5.0, 5.0, 7.0, 7.0, 7.0]));
        file.json["accessors"][0]["sparse"] = json!({
            "count": 2,
            "indices": { "bufferView": indices, "componentType": U8 },
            "values": { "bufferView": values }
        });
        if !with_base {
            file.json["accessors"][0].as_object_mut().unwrap().remove("bufferView");
        }
        assert_eq!(file.mesh().positions, [Vec3::ZERO, Vec3::splat(5.0), Vec3::splat(7.0)]);
    }
}

/// A strip and a fan around (0, 0) over the same five points; both keep the winding of their first triangle.
#[test]
fn strips_and_fans_become_triangles() {
    let points = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [-1.0, 1.0]];
    for (mode, want, of_repeated) in [
        (5, vec![[0, 1, 2], [1, 3, 2], [2, 3, 4]], vec![[0, 1, 2]]),
        (6, vec![[1, 2, 0], [2, 3, 0], [3, 4, 0]], vec![[1, 2, 0], [2, 3, 0]]),
    ] {
        let mut file = File::triangle();
        let position = file.floats("VEC3", &points.map(|[x, y]| [x, y, 0.0f32]).concat());
        let normal = file.floats("VEC3", &[[0.0, 0.0, 1.0f32]; 5].concat());
        *file.primitive() = json!({ "attributes": { "POSITION": position, "NORMAL": normal }, "mode": mode });
        assert_eq!(file.mesh().indices, want);
        let indices = file.indices(&[0, 1, 2, 2, 4]);
        file.primitive()["indices"] = indices.into();
        // vertex 4 is number 3 of those that are left: 0, 1, 2, 4
        assert_eq!(file.mesh().indices, of_repeated, "repeated vertices make no triangle");
    }
}

#[test]
fn absent_normals_become_those_of_the_faces() {
    let mut file = File::triangle();
    let indices = file.indices(&[0, 1, 2, 0, 2, 1]);
    file.primitive()["indices"] = indices.into();
    let mesh = file.mesh();
    assert!(mesh.faceted);
    assert_eq!(mesh.positions.len(), 6, "faces share no vertex");
    assert_eq!(mesh.indices, [[0, 1, 2], [3, 4, 5]]);
    assert_eq!(mesh.normals, [[Vec3::Z; 3], [Vec3::NEG_Z; 3]].concat());
}

#[test]
fn normals_are_made_unit_and_zeros_replaced() {
    let mut file = File::triangle();
    let normal = file.floats("VEC3", &[0.0, 3.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0]);
    file.primitive()["attributes"]["NORMAL"] = normal.into();
    assert_eq!(file.mesh().normals, [Vec3::Y, Vec3::Z, Vec3::Z]);
}

#[test]
fn vertices_that_no_triangle_uses_are_left_out() {
    let mut file = File::triangle();
    let position = file.floats("VEC3", &(0..30).map(|i| i as f32).collect::<Vec<_>>());
    let normal = file.floats("VEC3", &[[0.0, 0.0, 1.0f32]; 10].concat());
    let indices = file.accessor("SCALAR", U32, 3, bytemuck::cast_slice(&[7u32, 2, 5]));
    *file.primitive() = json!({ "attributes": { "POSITION": position, "NORMAL": normal }, "indices": indices });
    let mesh = file.mesh();
    assert_eq!(mesh.positions.iter().map(|p| p.x).collect::<Vec<_>>(), [6.0, 15.0, 21.0]);
    assert_eq!(mesh.indices, [[2, 0, 1]]);
}

#[test]
fn colours_of_every_type_are_linear_rgba() {
    for (kind, component, bytes) in [
        ("VEC3", U8, vec![255u8, 0, 51, 0, 255, 0, 51, 0, 255, 0, 51, 0]),
        ("VEC4", U8, [255, 0, 51, 255].repeat(3)),
        ("VEC4", U16, bytemuck::cast_slice(&[0xffffu16, 0, 0x3333, 0xffff].repeat(3)).to_vec()),
        ("VEC3", F32, bytemuck::cast_slice(&[1.0f32, 0.0, 0.2].repeat(3)).to_vec()),
    ] {
        let mut file = File::triangle();
        let color = file.accessor(kind, component, 3, &bytes);
        file.json["accessors"][color]["normalized"] = (component != F32).into();
        if (kind, component) == ("VEC3", U8) {
            file.json["bufferViews"][color]["byteStride"] = 4.into();
        }
        file.primitive()["attributes"]["COLOR_0"] = color.into();
        assert_eq!(file.mesh().colors, [Vec4::new(1.0, 0.0, 0.2, 1.0); 3], "{kind} of {component}");
    }
}

#[test]
fn points_lines_and_empty_primitives_are_noted() {
    let mut file = File::triangle();
    let empty = file.accessor("SCALAR", U16, 0, &[]);
    file.json["meshes"][0]["name"] = "Cage".into();
    file.json["meshes"][0]["primitives"] = json!([
        { "attributes": { "POSITION": 0 } },
        { "attributes": { "POSITION": 0 }, "mode": 0 },
        { "attributes": { "POSITION": 0 }, "mode": 3 },
        { "attributes": {} },
        { "attributes": { "POSITION": 0 }, "indices": empty },
    ]);
    let scene = file.load();
    assert_eq!(scene.meshes.len(), 1);
    assert_eq!(
        ignored(&scene),
        [
            "mesh 0 \"Cage\", primitive 1: points",
            "mesh 0 \"Cage\", primitive 2: lines",
            "mesh 0 \"Cage\", primitive 3: no POSITION",
            "mesh 0 \"Cage\", primitive 4: no triangles"
        ]
    );
}

#[test]
fn tangents_are_made_only_where_a_material_needs_them() {
    let mut file = File::triangle();
    let normal = file.floats("VEC3", &[[0.0, 0.0, 1.0f32]; 3].concat());
    let uv = file.floats("VEC2", &[0.0, 1.0, 1.0, 1.0, 0.0, 0.0]);
    *file.primitive() = json!({ "attributes": { "POSITION": 0, "NORMAL": normal, "TEXCOORD_0": uv }, "material": 0 });
    file.push("materials", json!({}));
    assert!(file.mesh().tangents.is_empty());
    file.json["materials"][0] = json!({ "extensions": { "KHR_materials_anisotropy": { "anisotropyStrength": 0.5 } } });
    let tangents = file.mesh().tangents;
    assert_eq!(tangents.len(), 3);
    assert!(tangents.iter().all(|t| t.distance(Vec4::new(1.0, 0.0, 0.0, 1.0)) < 1e-6), "{tangents:?}");
    let given = file.floats("VEC4", &[[0.0, 2.0, 0.0, -1.0f32]; 3].concat());
    file.primitive()["attributes"]["TANGENT"] = given.into();
    assert_eq!(file.mesh().tangents, [Vec4::new(0.0, 1.0, 0.0, -1.0); 3], "those of the file are kept, made unit");
}

#[test]
fn draco_is_refused_without_fallback_and_noted_with_it() {
    let mut file = File::triangle();
    file.primitive()["extensions"] = json!({ "KHR_draco_mesh_compression": { "bufferView": 0, "attributes": { "POSITION": 0 } } });
    file.json["extensionsUsed"] = json!(["KHR_draco_mesh_compression"]);
    assert_eq!(ignored(&file.load()), ["mesh 0, primitive 0: KHR_draco_mesh_compression"]);
    file.json["accessors"][0].as_object_mut().unwrap().remove("bufferView");
    assert!(file.error().contains("KHR_draco_mesh_compression (mesh 0, primitive 0) is not supported; export it without Draco"));
    file.json["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
    let message = file.error();
    assert!(message.contains("the extension KHR_draco_mesh_compression, which the file requires, is not supported"), "{message}");
}

//! Animations, skins and morph targets, from the file to the snapshot.

use super::{File, U8, U16, ignored};
use crate::{Interpolation, Property, Snapshot};
use glam::Vec3;
use kajo_units::Seconds;
use serde_json::json;

/// A file whose node 0 moves from 0 to (4, 0, 0) in two seconds.
fn moving() -> File {
    let mut file = File::triangle();
    let times = file.floats("SCALAR", &[0.0, 2.0]);
    let values = file.floats("VEC3", &[0.0, 0.0, 0.0, 4.0, 0.0, 0.0]);
    file.push(
        "animations",
        json!({
            "name": "slide",
            "channels": [{ "sampler": 0, "target": { "node": 0, "path": "translation" } }],
            "samplers": [{ "input": times, "output": values }]
        }),
    );
    file
}

fn x_at(file: &File, time: f32) -> f32 {
    Snapshot::new(&file.load(), Seconds(time)).instances[0].world_from_object.translation.x
}

#[test]
fn translations_play_and_hold() {
    let file = moving();
    for (time, x) in [(-1.0, 0.0), (0.5, 1.0), (2.0, 4.0), (7.0, 4.0)] {
        assert_eq!(x_at(&file, time), x, "at {time}");
    }
}

#[test]
fn every_interpolation_and_path_is_read() {
    let mut file = moving();
    let rotations = file.accessor("VEC4", 5122, 2, bytemuck::cast_slice(&[0i16, 0, 0, 32767, 0, 32767, 0, 0]));
    file.json["accessors"][rotations]["normalized"] = true.into();
    let spline = file.floats("VEC3", &[[0.0f32; 9], [0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0]].concat());
    let step = json!({ "input": 1, "output": 2, "interpolation": "STEP" });
    let samplers = file.json["animations"][0]["samplers"].as_array_mut().unwrap();
    samplers.extend([
        step,
        json!({ "input": 1, "output": rotations }),
        json!({ "input": 1, "output": spline, "interpolation": "CUBICSPLINE" }),
    ]);
    file.json["animations"][0]["channels"] = json!([
        { "sampler": 1, "target": { "node": 0, "path": "translation" } },
        { "sampler": 2, "target": { "node": 0, "path": "rotation" } },
        { "sampler": 3, "target": { "node": 0, "path": "scale" } }
    ]);
    let scene = file.load();
    let kinds: Vec<_> = scene.animations[0].channels.iter().map(|channel| (channel.property, channel.interpolation)).collect();
    assert_eq!(
        kinds,
        [
            (Property::Translation, Interpolation::Step),
            (Property::Rotation, Interpolation::Linear),
            (Property::Scale, Interpolation::CubicSpline)
        ]
    );
    let half_way = Snapshot::new(&scene, Seconds(1.0)).instances[0].world_from_object;
    // turned by 90° about y, scaled by ½, not yet moved
    assert!(half_way.transform_point3(Vec3::X).distance(Vec3::NEG_Z * 0.5) < 1e-4, "{half_way:?}");
}

#[test]
fn what_cannot_move_is_noted() {
    let mut file = moving();
    let sampler = 0;
    file.json["nodes"] = json!([{ "mesh": 0 }, { "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1] }]);
    file.json["animations"][0]["channels"] = json!([
        { "sampler": sampler, "target": { "path": "pointer", "extensions": { "KHR_animation_pointer": { "pointer": "/nodes/0/scale" } } } },
        { "sampler": sampler, "target": { "path": "translation" } },
        { "sampler": sampler, "target": { "node": 0, "path": "weights" } },
        { "sampler": sampler, "target": { "node": 1, "path": "translation" } }
    ]);
    let scene = file.load();
    assert!(scene.animations[0].channels.is_empty());
    assert_eq!(
        ignored(&scene),
        [
            "animation 0 \"slide\", channel 0: KHR_animation_pointer",
            "animation 0 \"slide\", channel 1: a target without a node",
            "animation 0 \"slide\", channel 2: weights of a node without morph targets",
            "animation 0 \"slide\", channel 3: a channel of a node with a matrix"
        ]
    );
}

#[test]
fn morph_targets_come_with_their_weights() {
    let mut file = File::triangle();
    let lift = file.floats("VEC3", &[[0.0, 0.0, 1.0f32]; 3].concat());
    let times = file.floats("SCALAR", &[0.0, 1.0]);
    let weights = file.floats("SCALAR", &[0.25, 0.0, 0.75, 0.0]);
    file.primitive()["targets"] = json!([{ "POSITION": lift }, {}]);
    file.json["meshes"][0]["weights"] = json!([0.5, 0.0]);
    let z = |file: &File, time: f32| {
        let snapshot = Snapshot::new(&file.load(), Seconds(time));
        snapshot.meshes[snapshot.instances[0].mesh].positions[0].z
    };
    assert_eq!(z(&file, 0.0), 0.5, "the weights of the mesh");
    file.json["nodes"][0]["weights"] = json!([0.125, 0.0]);
    assert_eq!(z(&file, 0.0), 0.125, "those of the node replace them");
    file.push(
        "animations",
        json!({
            "channels": [{ "sampler": 0, "target": { "node": 0, "path": "weights" } }],
            "samplers": [{ "input": times, "output": weights }]
        }),
    );
    assert_eq!(z(&file, 0.5), 0.5, "and those of the animation, those");
    assert_eq!(z(&file, 9.0), 0.75);
}

/// Two sets of joints; the weights need not sum to 1 in the file.
#[test]
fn skins_deform_with_up_to_eight_joints() {
    let mut file = File::triangle();
    let zeros = file.accessor("VEC4", U8, 3, &[0; 12]);
    let ones = file.accessor("VEC4", U16, 3, bytemuck::cast_slice(&[1u16, 0, 0, 0].repeat(3)));
    let halves = file.floats("VEC4", &[[2.0, 0.0, 0.0, 0.0f32]; 3].concat());
    let attributes = &mut file.primitive()["attributes"];
    attributes["JOINTS_0"] = zeros.into();
    attributes["WEIGHTS_0"] = halves.into();
    attributes["JOINTS_1"] = ones.into();
    attributes["WEIGHTS_1"] = halves.into();
    file.json["nodes"] = json!([
        { "mesh": 0, "skin": 0, "translation": [100, 0, 0] }, { "translation": [0, 2, 0] }, { "translation": [0, 0, 6] }
    ]);
    file.json["scenes"][0]["nodes"] = json!([0, 1, 2]);
    file.push("skins", json!({ "joints": [1, 2] }));
    let snapshot = Snapshot::new(&file.load(), Seconds(0.0));
    assert_eq!(snapshot.meshes[0].positions[1], Vec3::new(1.0, 1.0, 3.0), "the mean of both joints, without the node's own place");

    let shift: Vec<f32> = [glam::Mat4::from_translation(Vec3::X), glam::Mat4::IDENTITY].iter().flat_map(|m| m.to_cols_array()).collect();
    let inverse_bind = file.floats("MAT4", &shift);
    file.json["skins"][0]["inverseBindMatrices"] = inverse_bind.into();
    assert_eq!(Snapshot::new(&file.load(), Seconds(0.0)).meshes[0].positions[1], Vec3::new(1.5, 1.0, 3.0));
    file.json["skins"][0]["joints"] = json!([1]);
    assert!(file.error().contains("its mesh names joint 1, but skin 0 has 1"), "{}", file.error());
}

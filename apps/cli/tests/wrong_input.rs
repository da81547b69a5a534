//! Wrong input of every kind: one clear sentence, the right exit code, nothing written.

mod common;

use common::{kajo, run};
use std::fs;
use std::path::Path;

/// Runs and checks exit code, message and that no file was made.
fn refuses(folder: &Path, words: &[&str], code: i32, says: &[&str]) {
    let before = fs::read_dir(folder).unwrap().count();
    let output = run(folder, words);
    let stderr = String::from_utf8_lossy(&output.stderr);
    let line = words.join(" ");
    assert_eq!(output.status.code(), Some(code), "kajo {line}\n{stderr}");
    assert!(stderr.starts_with("error: "), "kajo {line}\n{stderr}");
    for word in says {
        assert!(stderr.contains(word), "kajo {line}: no `{word}` in\n{stderr}");
    }
    assert!(!stderr.contains("panicked"), "kajo {line}\n{stderr}");
    assert_eq!(fs::read_dir(folder).unwrap().count(), before, "kajo {line} left a file behind");
}

/// A triangle whose positions, index and nodes can be spoilt.
fn gltf(position: f32, index: u16, nodes: &str) -> String {
    use base64::Engine;
    let mut bytes: Vec<u8> = Vec::new();
    for value in [position, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0] {
        bytes.extend(f32::to_le_bytes(value));
    }
    for index in [0, 1, index] {
        bytes.extend(u16::to_le_bytes(index));
    }
    let data = base64::engine::general_purpose::STANDARD.encode(&bytes);
    format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":{nodes},
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}},
                     {{"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}}],
        "bufferViews":[{{"buffer":0,"byteLength":36}},{{"buffer":0,"byteOffset":36,"byteLength":6}}],
        "buffers":[{{"byteLength":42,"uri":"data:application/octet-stream;base64,{data}"}}]}}"#
    )
}

#[test]
fn wrong_words_exit_with_2() {
    let folder = tempfile::tempdir().unwrap();
    let refuses = |words: &[&str], says: &[&str]| refuses(folder.path(), words, 2, says);
    refuses(&["render", "builtin:cornell", "-o", "x.png", "--size", "0x0"], &["16384"]);
    refuses(&["render", "builtin:cornell", "-o", "x.png", "--size", "100000x100000"], &["16384"]);
    refuses(&["render", "builtin:cornell", "-o", "x.jpg"], &[".png, .exr or .hdr"]);
    refuses(&["render", "builtin:cornel", "-o", "x.png"], &["did you mean `builtin:cornell`"]);
    refuses(&["render", "builtin:cornell", "-o", "x.png", "--integrator", "pth"], &["'path'"]);
    refuses(&["render", "builtin:cornell", "-o", "x.png", "--spp", "0"], &["--spp"]);
    refuses(&["render", "builtin:cornell", "-o", "x.png", "--noise", "nan"], &["finite"]);
    refuses(&["render", "builtin:cornell", "-o", "x.exr", "--aov", "diret"], &["direct"]);
    refuses(&["render", "builtin:cornell", "-o", "x.png", "--aov", "direct"], &[".exr"]);
    refuses(&["render", "builtin:cornell", "-o", "x.png", "--camera", "camra"], &["did you mean \"camera\"?"]);
    refuses(&["render", "builtin:cornell", "-o", "x.png", "--technique", "direct-visibility=shadow/map"], &["--renderer realtime"]);
    refuses(&["techniques", "shadow/mpa"], &["shadow/map"]);
    refuses(&["rendr"], &["render"]);
}

#[test]
fn wrong_technique_parameters_exit_with_2() {
    let folder = tempfile::tempdir().unwrap();
    for (technique, says) in [
        ("direct-visibility=shadow/mpa", "shadow/map"),
        ("direct-visibilty=shadow/map", "direct-visibility"),
        ("shadow/map", "ROLE=ID"),
        ("direct-visibility=shadow/map:resoluton=512", "did you mean `resolution`?"),
        ("direct-visibility=shadow/map:resolution=1", "from 16 to 8192"),
        ("direct-visibility=shadow/map:resolution=nan", "resolution"),
    ] {
        refuses(
            folder.path(),
            &["render", "builtin:cornell", "-o", "x.png", "--renderer", "realtime", "--technique", technique],
            2,
            &[says],
        );
    }
    for (technique, says) in [("shadow/mpa", "shadow/map"), ("shadow/map:resoluton=512", "did you mean `resolution`?")] {
        refuses(folder.path(), &["compare", "builtin:cornell", "-o", "report", "--technique", technique], 2, &[says]);
    }
}

#[test]
fn files_that_are_not_there_exit_with_1() {
    let folder = tempfile::tempdir().unwrap();
    let refuses = |words: &[&str], says: &[&str]| refuses(folder.path(), words, 1, says);
    refuses(&["render", "none.glb", "-o", "x.png"], &["none.glb"]);
    refuses(&["info", "none.gltf"], &["none.gltf"]);
    refuses(&["render", "builtin:cornell", "-o", "x.png", "--env", "none.hdr"], &["none.hdr"]);
    refuses(&["render", "builtin:cornell", "-o", "none/x.png"], &["none"]);
    refuses(&["render", "builtin:cornell", "-o", "x.png", "--stats", "none/s.json"], &["none"]);
    refuses(&["metrics", "a.exr", "b.exr"], &["a.exr"]);
    refuses(&["compare", "none.glb", "-o", "report"], &["none.glb"]);
}

#[test]
fn broken_files_exit_with_1() {
    let folder = tempfile::tempdir().unwrap();
    let node = r#"[{"mesh":0}]"#;
    let cases: [(&str, Vec<u8>, &str); 9] = [
        ("nan.gltf", gltf(f32::NAN, 2, node).into(), "accessor"),
        ("infinite.gltf", gltf(f32::INFINITY, 2, node).into(), "accessor"),
        ("index.gltf", gltf(0.0, 7, node).into(), "7"),
        ("cycle.gltf", gltf(0.0, 2, r#"[{"children":[1],"mesh":0},{"children":[0]}]"#).into(), "node"),
        ("text.gltf", b"hello".to_vec(), "neither glTF"),
        ("empty.glb", Vec::new(), "empty.glb"),
        ("short.glb", b"glTF\x02\0\0\0\xff\0\0\0\x10\0\0\0JSON{\"asset\"".to_vec(), "short.glb"),
        ("wrong.kajo.toml", b"[[asset]]\nfil = \"a.glb\"".to_vec(), "fil"),
        ("bad.obj", b"v 0 0 0\nf 1 2 3\n".to_vec(), "bad.obj"),
    ];
    for (name, bytes, _) in &cases {
        fs::write(folder.path().join(name), bytes).unwrap();
    }
    for (name, _, says) in &cases {
        refuses(folder.path(), &["render", name, "-o", "x.png", "--size", "8x8", "--spp", "1"], 1, &[name, says]);
        refuses(folder.path(), &["info", name], 1, &[name, says]);
    }
    fs::write(folder.path().join("sound.gltf"), gltf(0.0, 2, node)).unwrap();
    assert!(run(folder.path(), &["info", "sound.gltf"]).status.success(), "the file before it is spoilt is sound");
}

#[test]
fn without_an_adapter_the_real_time_side_says_what_to_run() {
    let folder = tempfile::tempdir().unwrap();
    for words in [
        &["render", "builtin:cornell", "-o", "x.png", "--renderer", "realtime"][..],
        &["compare", "builtin:cornell", "-o", "report", "--role", "direct-visibility", "--size", "16x16", "--reference-spp", "1"],
        &["devices"],
    ] {
        let nowhere = folder.path().join("none.json");
        let output = kajo(folder.path()).args(words).env("VK_DRIVER_FILES", &nowhere).env("VK_ICD_FILENAMES", &nowhere).output().unwrap();
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{words:?}\n{stderr}");
        assert!(stderr.contains("cargo xtask setup"), "{words:?}\n{stderr}");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}

#[test]
fn a_scene_without_a_light_to_judge_is_a_failure_and_not_wrong_usage() {
    let folder = tempfile::tempdir().unwrap();
    let words = ["compare", "builtin:furnace", "-o", "report", "--role", "direct-visibility", "--size", "16x16", "--reference-spp", "1"];
    refuses(folder.path(), &words, 1, &["builtin:furnace", "light to judge direct-visibility"]);
}

#[test]
fn a_checkpoint_is_never_overwritten_by_accident() {
    let folder = tempfile::tempdir().unwrap();
    let words = ["render", "builtin:cornell", "-o", "x.png", "--size", "8x8", "--spp", "2", "--checkpoint", "c.ckpt"];
    assert!(run(folder.path(), &words).status.success());
    refuses(folder.path(), &words, 1, &["--resume"]);
    let other = ["render", "builtin:cornell", "-o", "x.png", "--size", "9x9", "--spp", "2", "--checkpoint", "c.ckpt", "--resume"];
    refuses(folder.path(), &other, 1, &["another picture"]);
}

//! Wrong input of every kind: one clear sentence, the right exit code, nothing written.

mod common;

use common::{kajo, run};
use std::fs;
use std::path::Path;
use std::process::Stdio;

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
    refuses(&["render", "builtin:cornell", "-o", "x.exr", "--aov", "visibility.nobody", "--size", "8x8"], &["visibility.light"]);
    refuses(&["render", "builtin:cornell", "-o", "x.png", "--denoise", "--integrator", "normal"], &["--denoise is for light"]);
    refuses(&["render", "builtin:cornell", "-o", "x.png", "--denoise", "--renderer", "realtime"], &["--denoise is for the path tracer"]);
    refuses(&["render", "builtin:cornell", "-o", "x.png", "--adaptive", "--sampler", "blue-noise"], &["blue noise"]);
    refuses(&["render", "builtin:cornell", "-o", "x.png", "--stats", "x.png"], &["x.png is to be written twice"]);
    refuses(&["render", "builtin:cornell", "-o", "x.png", "--checkpoint", "y", "--stats", "y"], &["y is to be written twice"]);
    refuses(&["compare", "builtin:cornel", "-o", "report"], &["did you mean `builtin:cornell`"]);
    refuses(&["compare", "builtin:cornell", "-o", "report", "--camera", "camra"], &["did you mean \"camera\"?"]);
    refuses(&["compare", "builtin:cornell", "-o", "report", "--animation", "0"], &["no animation is called \"0\"; there are none"]);
    refuses(&["techniques", "shadow/mpa"], &["shadow/map"]);
    refuses(&["rendr"], &["render"]);
}

#[test]
fn numbers_of_every_wrong_kind_exit_with_2() {
    let folder = tempfile::tempdir().unwrap();
    for (flag, values, says) in [
        ("--spp", ["0", "-1", "nan", "1.5", "99999999999"], "expected a whole number from 1 to 4294967295"),
        ("--threads", ["0", "-1", "nan", "1.5", "100000"], "expected a whole number from 1 to 1024"),
        ("--max-depth", ["-1", "nan", "1.5", "10001", ""], "expected a whole number from 0 to 10000"),
        ("--seed", ["-1", "nan", "1.5", "1e3", "99999999999999999999"], "expected a whole number from 0 to 18446744073709551615"),
        ("--time", ["0", "-1", "nan", "1e300", "1e10"], "expected"),
        ("--noise", ["0", "-1", "nan", "1e-300", "inf"], "expected a"),
        ("--fps", ["0", "-1", "nan", "1e-300", "inf"], "expected a"),
        ("--frame", ["nan", "inf", "1e300", "-1e300", "now"], "expected a"),
        ("--frames", ["5..3", "-1..1", "a..b", "0", "0..4294967296"], "frame"),
        ("--size", ["0x0", "-1x8", "8", "nanxnan", "100000x100000"], "px"),
        ("--exposure", ["nan", "inf", "1e9", "bright", "-101"], "expected"),
    ] {
        for value in values {
            refuses(folder.path(), &["render", "builtin:cornell", "-o", "x.png", flag, value], 2, &[flag, says]);
        }
    }
}

#[test]
fn flags_of_the_path_tracer_are_refused_by_the_real_time_renderer() {
    let folder = tempfile::tempdir().unwrap();
    for flag in [
        &["--integrator", "ao"][..],
        &["--max-depth", "3"],
        &["--no-rr"],
        &["--threads", "1"],
        &["--sampler", "sobol"],
        &["--env-sampler", "kd"],
        &["--filter", "box"],
        &["--checkpoint", "c"],
    ] {
        let words = [&["render", "builtin:cornell", "-o", "x.png", "--renderer", "realtime"], flag].concat();
        refuses(folder.path(), &words, 2, &[flag[0], "is for the path tracer"]);
    }
}

/// `kajo … | head`: a reader that goes away is no failure. One that cannot take it all is.
#[test]
fn a_closed_pipe_is_no_failure_and_a_full_disk_is_one() {
    let folder = tempfile::tempdir().unwrap();
    for words in
        [&["scenes"][..], &["coverage"], &["coverage", "--json"], &["techniques", "--json"], &["info", "builtin:cornell", "--json"]]
    {
        let mut child = kajo(folder.path()).args(words).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert!(output.status.success() && output.stderr.is_empty(), "{words:?}: {}", String::from_utf8_lossy(&output.stderr));
    }
    let Ok(full) = fs::OpenOptions::new().write(true).open("/dev/full") else { return };
    let output = kajo(folder.path()).args(["scenes", "--json"]).stdout(full).output().unwrap();
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{stderr}");
    assert!(stderr.starts_with("error: cannot write to standard output: "), "{stderr}");
}

#[test]
fn wrong_technique_parameters_exit_with_2() {
    let folder = tempfile::tempdir().unwrap();
    for (technique, says) in [
        ("direct-visibility=shadow/mpa", "shadow/map"),
        ("direct-visibilty=shadow/map", "direct-visibility"),
        ("shadow/map", "ROLE=ID"),
        ("direct-visibility=shadow/map:resoluton=512", "did you mean \"resolution\"?"),
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
    for (technique, says) in [("shadow/mpa", "shadow/map"), ("shadow/map:resoluton=512", "did you mean \"resolution\"?")] {
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
fn folders_empty_files_and_devices_exit_with_1() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["empty.glb", "empty.gltf", "empty.obj", "empty.kajo.toml", "empty.png", "empty.exr", "empty.hdr", "empty.tri"] {
        fs::write(folder.path().join(name), "").unwrap();
    }
    for name in ["folder.glb", "folder.png"] {
        fs::create_dir(folder.path().join(name)).unwrap();
    }
    let refuses = |words: &[&str], says: &[&str]| refuses(folder.path(), words, 1, says);
    for scene in ["empty.glb", "empty.gltf", "empty.obj", "empty.kajo.toml", "folder.glb"] {
        refuses(&["render", scene, "-o", "x.png"], &[scene]);
        refuses(&["info", scene], &[scene]);
        refuses(&["compare", scene, "-o", "report"], &[scene]);
    }
    for picture in ["empty.png", "empty.exr", "empty.hdr"] {
        refuses(&["metrics", picture, picture], &[picture, "is empty"]);
        refuses(&["render", "builtin:cornell", "-o", "x.png", "--env", picture], &[picture, "is empty"]);
    }
    refuses(&["metrics", "folder.png", "folder.png"], &["not a regular file"]);
    refuses(&["render", "builtin:cornell", "-o", "folder.png"], &["it is a folder"]);
    refuses(&["bench", "rays", "--triangles", "empty.tri", "--rays", "empty.tri"], &["empty.tri is empty"]);
    refuses(&["bench", "rays", "--triangles", "folder.png", "--rays", "empty.tri"], &["cannot read the triangles folder.png"]);
    if Path::new("/dev/zero").exists() {
        refuses(&["metrics", "/dev/zero", "/dev/zero"], &["/dev/zero", "not a regular file"]);
        refuses(&["bench", "rays", "--triangles", "/dev/zero", "--rays", "empty.tri"], &["/dev/zero"]);
    }
}

#[test]
fn triangles_and_rays_that_are_none_exit_with_1() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, values: &[f32]| {
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        fs::write(folder.path().join(name), bytes).unwrap();
    };
    write("one.tri", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    write("nan.tri", &[f32::NAN; 9]);
    write("one.ray", &[0.2, 0.2, 1.0, 0.0, 0.0, -1.0, 0.0, f32::INFINITY]);
    write("nan.ray", &[f32::NAN; 8]);
    write("still.ray", &[0.2, 0.2, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
    for (triangles, rays, says) in [
        ("nan.tri", "one.ray", "vertex 0"),
        ("one.ray", "one.ray", "no whole number of triangles"),
        ("one.tri", "one.tri", "no whole number of rays"),
        ("one.tri", "nan.ray", "ray 0 has a number that is not finite"),
        ("one.tri", "still.ray", "no direction"),
    ] {
        refuses(folder.path(), &["bench", "rays", "--triangles", triangles, "--rays", rays], 1, &[says]);
    }
    let report = common::json(folder.path(), &["bench", "rays", "--triangles", "one.tri", "--rays", "one.ray", "--repeat", "1"]);
    assert_eq!(report["hits"], 1, "an endless ray is one");
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
fn a_checkpoint_is_never_overwritten_by_accident() {
    let folder = tempfile::tempdir().unwrap();
    let words = ["render", "builtin:cornell", "-o", "x.png", "--size", "8x8", "--spp", "2", "--checkpoint", "c.ckpt"];
    assert!(run(folder.path(), &words).status.success());
    refuses(folder.path(), &words, 1, &["--resume"]);
    let other = ["render", "builtin:cornell", "-o", "x.png", "--size", "9x9", "--spp", "2", "--checkpoint", "c.ckpt", "--resume"];
    refuses(folder.path(), &other, 1, &["another picture"]);
}

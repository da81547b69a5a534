//! `kajo compare` as a user types it.

mod common;

use common::{asset, json, run, succeed};
use std::fs;

const SMALL: [&str; 8] = ["--role", "direct-visibility", "--size", "96x54", "--reference-spp", "16", "--frames", "2"];

#[test]
fn the_report_has_the_keys_of_the_contract() {
    let folder = tempfile::tempdir().unwrap();
    let techniques = ["--technique", "shadow/none", "--technique", "shadow/map", "--technique", "shadow/ray-traced"];
    let words = [&["compare", "builtin:shadows", "-o", "report"][..], &SMALL, &techniques].concat();
    succeed(folder.path(), &words);
    let text = fs::read_to_string(folder.path().join("report/report.json")).unwrap();
    let report: serde_json::Value = serde_json::from_str(&text).unwrap();
    for key in ["kajo", "command", "device", "references", "runs", "ignored"] {
        assert!(!report[key].is_null(), "{key}");
    }
    for key in ["scene", "role", "spp", "relative_standard_error", "seconds"] {
        assert!(!report["references"][0][key].is_null(), "references: {key}");
    }
    let runs = report["runs"].as_array().unwrap();
    assert_eq!(runs.len(), 3);
    for run in runs {
        assert_eq!(run["status"], "ok", "{run}");
        for key in ["rmse", "rel_mse", "psnr", "ssim", "flip", "mean_ratio", "bias", "noise", "off_border_mismatch"] {
            assert!(run["error"][key].is_number(), "error.{key}: {}", run["error"]);
        }
        assert!(
            run["error"]["border_px"].is_number(),
            "surfaces turn away from the light, so each technique has a border: {}",
            run["error"]
        );
        for key in ["gpu_ms", "gpu_ms_p95", "cpu_ms", "memory_bytes", "rays"] {
            assert!(run["cost"][key].is_number(), "cost.{key}: {}", run["cost"]);
        }
        let image = 3 * 96 * 54 * 4;
        assert!(run["cost"]["memory_bytes"].as_u64().unwrap() >= image, "V of three lights is kept: {}", run["cost"]);
    }
    let error = |id: &str| runs.iter().find(|run| run["technique"] == id).unwrap()["error"]["rmse"].as_f64().unwrap();
    assert!(error("shadow/ray-traced") < error("shadow/none") / 4.0 && error("shadow/map") < error("shadow/none") / 2.0);
    let page = fs::read_to_string(folder.path().join("report/index.html")).unwrap();
    assert!(page.contains("shadow/ray-traced") && !page.contains("src=\"http"), "the page is self-contained");
    assert!(fs::read_to_string(folder.path().join("report/table.csv")).unwrap().lines().count() >= 4);
}

#[test]
fn a_file_without_lights_is_lit_and_compared() {
    let Some(helmet) = asset("FlightHelmet/FlightHelmet.gltf") else { return };
    let folder = tempfile::tempdir().unwrap();
    let words =
        [&["compare", helmet.to_str().unwrap(), "-o", "report"][..], &SMALL, &["--technique", "shadow/ray-traced:samples=16"]].concat();
    let report = json(folder.path(), &words);
    assert_eq!(report["runs"][0]["status"], "ok");
    assert_eq!(report["runs"][0]["params"]["samples"], 16);
    let ignored = report["ignored"].to_string();
    assert!(ignored.contains("no light"), "{ignored}");
    assert!(report["runs"][0]["error"]["off_border_mismatch"].as_f64().unwrap() < 0.01, "{}", report["runs"][0]["error"]);
}

/// The Cornell box of many engines' sample files: its lamp is an emissive mesh.
#[test]
fn a_file_lit_by_an_emissive_mesh_is_compared() {
    let Some(cornell) = asset("CornellBox/CornellBox.glb") else { return };
    let folder = tempfile::tempdir().unwrap();
    let report = json(folder.path(), &[&["compare", cornell.to_str().unwrap(), "-o", "report"][..], &SMALL].concat());
    let runs = report["runs"].as_array().unwrap();
    assert_eq!(report["references"][0]["judged_by"].as_array().unwrap().len(), 1, "{}", report["references"]);
    let error = |id: &str| &runs.iter().find(|run| run["technique"] == id).unwrap()["error"];
    let value = |id: &str, key: &str| error(id)[key].as_f64().unwrap();
    assert!(value("shadow/ray-traced", "off_border_mismatch") < 0.01, "{}", error("shadow/ray-traced"));
    assert!(value("shadow/ray-traced", "rmse") < value("shadow/none", "rmse") / 2.0, "{}", error("shadow/none"));
    assert!((error("shadow/ray-traced")["composed"]["mean_ratio"].as_f64().unwrap() - 1.0).abs() < 0.03, "{}", error("shadow/ray-traced"));
}

/// A scene lit by its sky alone: the report is there, every row skipped, and the exit code is 1.
#[test]
fn a_scene_with_nothing_to_judge_fails_and_leaves_a_report() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("triangle.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let sky = "[[asset]]\nfile = \"triangle.obj\"\n[environment]\nradiance = [1.0, 1.0, 1.0]\n";
    fs::write(folder.path().join("sky.kajo.toml"), sky).unwrap();
    let output = run(folder.path(), &[&["compare", "sky.kajo.toml", "-o", "report"][..], &SMALL].concat());
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("error: nothing was compared: sky.kajo.toml, direct-visibility: needs a light"), "{said}");
    let text = fs::read_to_string(folder.path().join("report/report.json")).unwrap();
    let report: serde_json::Value = serde_json::from_str(&text).unwrap();
    let techniques = json(folder.path(), &["techniques"]);
    let of_role = techniques.as_array().unwrap().iter().filter(|technique| technique["role"] == "direct-visibility").count();
    assert_eq!(report["runs"].as_array().unwrap().len(), of_role);
    assert!(report["runs"][0]["status"].as_str().unwrap().starts_with("skipped: needs a light"), "{}", report["runs"][0]);
}

/// Rows as a user asks for them: reflections of a room with mirrors are judged by the path tracer's, and each technique shows more than none.
#[test]
fn reflections_are_judged_by_the_path_tracer() {
    let folder = tempfile::tempdir().unwrap();
    let techniques = "reflection/none,reflection/ssr-dda,reflection/planar,reflection/ray-traced:bounces=4";
    let size = ["--size", "96x54", "--reference-spp", "32", "--frames", "2"];
    let words =
        [&["compare", "builtin:mirror-room", "-o", "report", "--role", "specular-indirect"][..], &size, &["--technique", techniques]];
    let report = json(folder.path(), &words.concat());
    let error = |name: &str, key: &str| {
        let id = format!("reflection/{name}");
        let run = report["runs"].as_array().unwrap().iter().find(|run| run["technique"] == id.as_str()).unwrap();
        assert_eq!(run["status"], "ok", "{run}");
        run["error"][key].as_f64().unwrap()
    };
    let [none, screen, planar] = ["none", "ssr-dda", "planar"].map(|name| error(name, "rmse"));
    assert!(screen < 0.8 * none && planar < 0.7 * none, "{none} {screen} {planar}");
    // What bounces on is in the reference and in the paths, not in what is drawn once.
    let [drawn, paths] = ["planar", "ray-traced"].map(|name| error(name, "mean_ratio"));
    assert!(drawn < 0.7 && (0.85..1.1).contains(&paths), "{drawn} {paths}");
}

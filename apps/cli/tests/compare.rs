//! `kajo compare` as a user types it.

mod common;

use common::{asset, json, succeed};
use std::fs;

const SMALL: [&str; 8] = ["--role", "direct-visibility", "--size", "96x54", "--reference-spp", "16", "--frames", "2"];

#[test]
fn the_report_has_the_keys_of_the_contract() {
    let folder = tempfile::tempdir().unwrap();
    let words = [&["compare", "builtin:shadows", "-o", "report"][..], &SMALL].concat();
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

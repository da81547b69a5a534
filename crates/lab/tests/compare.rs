//! A whole comparison, from scenes to the page, on whatever adapter answers.

use glam::UVec2;
use kajo_image::{ExrFile, read_image};
use kajo_lab::report::{Certainty, Report, Run};
use kajo_lab::{CompareOptions, Progress, ReferenceStop, Unwatched, compare};
use std::path::Path;
use std::sync::atomic::{AtomicU32, Ordering};

fn options(folder: &Path, techniques: &[&str]) -> CompareOptions {
    CompareOptions {
        scenes: vec!["builtin:shadows".into()],
        output: folder.into(),
        techniques: techniques.iter().map(|&t| t.into()).collect(),
        size: Some(UVec2::new(64, 48)),
        reference: ReferenceStop::Spp(64),
        frames: 3,
        repeat: 3,
        ..CompareOptions::default()
    }
}

fn run<'a>(report: &'a Report, label: &str) -> &'a Run {
    report.runs.iter().find(|r| r.label() == label).unwrap()
}

#[test]
fn ray_traced_shadows_beat_none_and_the_report_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let target = folder.path().join("report");
    let report = compare(&options(&target, &["shadow/none", "shadow/ray-traced:samples=16"]), &Unwatched).unwrap();

    let (none, traced) = (run(&report, "shadow/none"), run(&report, "shadow/ray-traced:samples=16"));
    let rmse = |run: &Run| run.error.as_ref().unwrap().image.rmse;
    assert!(rmse(none) > 5.0 * rmse(traced), "{} {}", rmse(none), rmse(traced));
    assert!(traced.error.as_ref().unwrap().off_border_mismatch.unwrap() < 0.01, "{:?}", traced.error);
    assert!(none.error.as_ref().unwrap().off_border_mismatch.unwrap() > 0.02, "{:?}", none.error);
    let composed = |run: &Run| run.error.as_ref().unwrap().composed.as_ref().unwrap().approximation_rmse.unwrap();
    assert!(composed(none) > 1.5 * composed(traced), "{} {}", composed(none), composed(traced));
    assert!(traced.cost.as_ref().unwrap().rays > 0 && none.cost.as_ref().unwrap().rays == 0);
    let cost = traced.cost.as_ref().unwrap();
    assert!((cost.gpu_ms_per_light.unwrap() * 3.0 - cost.gpu_ms.unwrap()).abs() < 1e-9, "a sun, a spot and a lantern");

    let decision = &report.decisions[0];
    assert_eq!(report.runs[decision.recommended.unwrap()].label(), "shadow/ray-traced:samples=16");
    assert_eq!(decision.certainty, Certainty::Clear);
    assert!(decision.sentence.starts_with("Use shadow/ray-traced:samples=16"), "{}", decision.sentence);

    let json: serde_json::Value = serde_json::from_slice(&std::fs::read(target.join("report.json")).unwrap()).unwrap();
    assert_eq!(json["runs"].as_array().unwrap().len(), 2);
    for file in json["files"].as_array().unwrap() {
        assert!(target.join(file.as_str().unwrap()).is_file(), "{file}");
    }
    assert_eq!(read_image(&target.join(&traced.images["png"])).unwrap().size(), UVec2::new(64, 48));
    let exr = ExrFile::read(&target.join(&report.references[0].images["exr"])).unwrap();
    assert!(exr.layers.iter().any(|l| l.name.starts_with("variance.visibility.")), "{:?}", exr.layers.iter().map(|l| &l.name));
    let html = std::fs::read_to_string(target.join("index.html")).unwrap();
    assert!(html.contains("Use shadow/ray-traced:samples=16") && !html.contains("http://") && !html.contains("https://"));
    assert!(std::fs::read_to_string(target.join("table.csv")).unwrap().lines().count() == 3);
}

/// An interruption while the first technique runs keeps nothing; later it keeps what is finished.
#[test]
fn an_interruption_keeps_what_is_finished() {
    struct After(u32, AtomicU32);
    impl Progress for After {
        fn at(&self, what: &str, _: f64) {
            self.1.fetch_add(u32::from(what.starts_with("shadow/")), Ordering::Relaxed);
        }
        fn interrupted(&self) -> bool {
            self.1.load(Ordering::Relaxed) >= self.0
        }
    }
    let folder = tempfile::tempdir().unwrap();
    let options = options(folder.path(), &["shadow/none", "shadow/ray-traced"]);
    let error = compare(&options, &After(1, AtomicU32::new(0))).unwrap_err().to_string();
    assert!(error.contains("nothing was written"), "{error}");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);

    let report = compare(&options, &After(2, AtomicU32::new(0))).unwrap();
    assert!(!report.complete && report.runs.len() == 1);
    assert!(std::fs::read_to_string(folder.path().join("index.html")).unwrap().contains("Interrupted."));
}

/// A scene lit by its sky alone has no shadow of a light: its rows say so, and other scenes go on.
#[test]
fn a_scene_without_lights_has_skipped_rows() {
    let folder = tempfile::tempdir().unwrap();
    let target = folder.path().join("report");
    std::fs::write(folder.path().join("triangle.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let path = folder.path().join("sky.kajo.toml");
    std::fs::write(&path, "[[asset]]\nfile = \"triangle.obj\"\n[environment]\nradiance = [1.0, 1.0, 1.0]\n").unwrap();
    let sky = path.to_str().unwrap().to_owned();
    let alone = CompareOptions { scenes: vec![sky.clone()], ..options(&target, &["shadow/none", "shadow/map"]) };
    let report = compare(&alone, &Unwatched).unwrap();
    assert!(report.runs.iter().all(|run| run.status.starts_with("skipped: needs a light") && run.error.is_none()), "{:?}", report.runs);
    assert_eq!((report.runs.len(), report.references.len(), report.complete), (2, 0, true));
    assert!(report.nothing_compared().unwrap().contains("sky.kajo.toml, direct-visibility: needs a light"));
    let html = std::fs::read_to_string(target.join("index.html")).unwrap();
    assert!(html.contains("Nothing was compared") && html.contains("sky.kajo.toml") && html.contains("needs a light"));
    assert!(report.ignored.iter().any(|i| i.feature == "environment as a light"), "{:?}", report.ignored);

    let both = CompareOptions { scenes: vec![sky, "builtin:shadows".into()], ..options(&target, &["shadow/none"]) };
    let report = compare(&both, &Unwatched).unwrap();
    assert_eq!((report.runs[0].is_ok(), report.runs[1].is_ok(), report.nothing_compared()), (false, true, None));
}

#[test]
fn the_reference_and_the_errors_repeat_exactly() {
    let folder = tempfile::tempdir().unwrap();
    let mut options = options(folder.path(), &["shadow/ray-traced"]);
    options.reference = ReferenceStop::Spp(8);
    let error = |report: Report| report.runs[0].error.as_ref().unwrap().image.rmse;
    let first = error(compare(&options, &Unwatched).unwrap());
    options.threads = Some(1);
    assert_eq!(error(compare(&options, &Unwatched).unwrap()), first);
}

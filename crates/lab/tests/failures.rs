//! Failure masks of real frames: a fault that is planted by a parameter is called by its name.

use glam::UVec2;
use kajo_lab::report::{Report, Run};
use kajo_lab::{CompareOptions, ReferenceStop, Unwatched, compare};
use std::path::Path;

/// Set to a folder to keep reports with their masks, to look at them.
fn folder(name: &str) -> (Option<tempfile::TempDir>, std::path::PathBuf) {
    match std::env::var_os("KAJO_FAILURES") {
        Some(kept) => (None, Path::new(&kept).join(name)),
        None => {
            let made = tempfile::tempdir().unwrap();
            let path = made.path().join(name);
            (Some(made), path)
        }
    }
}

fn report(scene: &str, name: &str, size: UVec2, techniques: &[&str]) -> Report {
    let (_kept, output) = folder(name);
    let options = CompareOptions {
        scenes: vec![scene.into()],
        output: output.clone(),
        techniques: techniques.iter().map(|&t| t.into()).collect(),
        size: Some(size),
        reference: ReferenceStop::Spp(64),
        frames: 1,
        repeat: 1,
        ..CompareOptions::default()
    };
    let report = compare(&options, &Unwatched).unwrap();
    for run in report.runs.iter().filter(|run| run.is_ok()) {
        assert!(output.join(&run.images["failures"]).is_file(), "{}", run.label());
        eprintln!("{scene} {}: {:?}", run.label(), run.failures);
    }
    report
}

/// Share of a class, %.
fn share(report: &Report, label: &str, class: &str) -> f64 {
    let found = |run: &&Run| run.label().starts_with(label) && run.label()[label.len()..].chars().next().is_none_or(|c| c == ',');
    let runs: Vec<&Run> = report.runs.iter().filter(found).collect();
    assert_eq!(runs.len(), 1, "{label}: {:?}", report.runs.iter().map(Run::label).collect::<Vec<_>>());
    100.0 * runs[0].failures[class]
}

const SMALL: UVec2 = UVec2::new(320, 180);
const BIAS_0: &str = "shadow/map:kernel=0,bias=constant,constant_bias=0.0";
const BIAS_HUGE: &str = "shadow/map:kernel=0,bias=constant,constant_bias=0.5";
const COARSE: &str = "shadow/map:resolution=128,kernel=0";

#[test]
fn no_bias_is_acne_a_huge_one_detachment_few_texels_aliasing_and_nothing_a_leak() {
    let techniques = ["shadow/ray-traced", "shadow/none", "shadow/map", BIAS_0, BIAS_HUGE, COARSE];
    let report = report("builtin:shadows", "shadows", SMALL, &techniques);
    let of = |label: &str, class: &str| share(&report, label, class);
    for class in ["acne", "detachment", "leak", "aliasing", "missed-penumbra"] {
        assert!(of("shadow/ray-traced", class) < 0.02, "{class} of shadow rays: {} %", of("shadow/ray-traced", class));
    }
    assert!(of(BIAS_0, "acne") > 5.0 && of("shadow/map", "acne") < 0.2, "{}", of(BIAS_0, "acne"));
    assert!(of(BIAS_0, "leak") < 0.02 && of(BIAS_0, "detachment") < 0.1);
    assert!(of(BIAS_HUGE, "detachment") > 5.0 * of("shadow/map", "detachment").max(0.02) && of(BIAS_HUGE, "acne") < 0.1);
    assert!(of(COARSE, "aliasing") > 3.0 * of("shadow/map", "aliasing").max(0.05), "{}", of(COARSE, "aliasing"));
    assert!(of("shadow/none", "leak") > 5.0);
}

#[test]
fn two_stacked_boards_leak_through_variance_and_not_through_compared_depth() {
    let report = report("builtin:stacked", "stacked", SMALL, &["shadow/map", "shadow/vsm"]);
    let (map, vsm) = (share(&report, "shadow/map", "leak"), share(&report, "shadow/vsm", "leak"));
    assert!(vsm > 0.2 && map < 0.02, "leak: vsm {vsm} %, map {map} %");
}

#[test]
fn hard_maps_miss_the_penumbra_of_a_strip_and_soft_rays_do_not() {
    let report = report("builtin:penumbra", "penumbra", SMALL, &["shadow/map:kernel=0", "shadow/ray-traced", "shadow/pcss"]);
    let missed = |label: &str| share(&report, label, "missed-penumbra");
    let (map, rays, pcss) = (missed("shadow/map:kernel=0"), missed("shadow/ray-traced"), missed("shadow/pcss"));
    assert!(map > 1.0 && rays < 0.1 * map && pcss < 0.6 * map, "map {map} %, rays {rays} %, pcss {pcss} %");
    let penumbra = |label: &str| {
        let run = report.runs.iter().find(|run| run.label() == label).unwrap();
        run.error.as_ref().unwrap().shadow_classes.unwrap().penumbra
    };
    assert!(penumbra("shadow/map:kernel=0").penumbra == 0.0 && penumbra("shadow/ray-traced").penumbra > 0.01);
}

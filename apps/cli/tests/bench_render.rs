//! `kajo bench render` as a user runs it.

mod common;

use common::{json, kajo, run, succeed};
use std::path::Path;

#[test]
fn scenes_are_timed_and_their_numbers_belong_together() {
    let report = json(Path::new("."), &["bench", "render", "builtin:cornell", "builtin:furnace", "--size", "24x16", "--spp", "4"]);
    let runs = report["runs"].as_array().unwrap();
    assert_eq!((runs.len(), report["error"].as_str()), (2, Some("scatter of the seeds")), "{report}");
    for run in runs {
        let number = |key: &str| run[key].as_f64().unwrap_or_else(|| panic!("{key}: {run}"));
        assert_eq!((number("width"), number("height"), number("spp"), number("invalid_samples")), (24.0, 16.0, 4.0, 0.0));
        let samples = number("samples_per_s") * number("seconds");
        assert!((samples - 24.0 * 16.0 * 4.0).abs() < 1e-6 * samples, "{run}");
        assert!((number("rays_per_s") / number("samples_per_s") / number("rays_per_sample") - 1.0).abs() < 1e-9, "{run}");
        assert!(number("cpu_seconds") > 0.0 && number("threads") >= 1.0 && number("triangles") > 0.0, "{run}");
        assert!((number("efficiency") * number("seconds") * number("mse") - 1.0).abs() < 1e-9, "{run}");
    }
}

/// The error against a better picture of the same settings is the scatter; against another picture it is not.
#[test]
fn a_reference_is_what_the_error_is_measured_against() {
    let folder = tempfile::tempdir().unwrap();
    let picture = ["--filter", "box", "--max-depth", "3"];
    succeed(folder.path(), &[&["render", "builtin:cornell", "--size", "32x32", "--spp", "1024", "-o", "truth.exr"], &picture[..]].concat());
    let bench = ["bench", "render", "builtin:cornell", "--size", "32x32", "--spp", "4", "--repeat", "16", "--sampler", "independent"];
    let relative = |more: &[&str]| json(folder.path(), &[&bench, &picture[..], more].concat())["runs"][0]["rel_mse"].as_f64().unwrap();
    let (scatter, error) = (relative(&[]), relative(&["--reference", "truth.exr"]));
    assert!((scatter / error - 1.0).abs() < 0.2, "{scatter} {error}");
    succeed(folder.path(), &["render", "builtin:cornell", "--size", "32x32", "--spp", "64", "--max-depth", "0", "-o", "lamp.exr"]);
    assert!(relative(&["--reference", "lamp.exr"]) > 3.0 * scatter);
    // Another size is found before anything is rendered.
    let words = ["bench", "render", "builtin:cornell", "--size", "16x16", "--reference", "truth.exr", "--spp", "1000000"];
    let output = run(folder.path(), &words);
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(2) && stderr.contains("the reference has 32x32 px"), "{stderr}");
}

/// The table of what was finished stays when a later scene fails.
#[test]
fn finished_rows_are_printed_when_a_later_scene_fails() {
    let words = ["bench", "render", "builtin:furnace", "builtin:nothing", "--size", "8x8", "--spp", "1"];
    let output = kajo(Path::new(".")).args(words).output().unwrap();
    let (stdout, stderr) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.code() == Some(2) && stderr.contains("builtin:nothing"), "{stderr}");
    let head: Vec<_> = stdout.lines().next().unwrap_or_default().split("  ").map(str::trim).filter(|word| !word.is_empty()).collect();
    assert!(head.contains(&"MSE") && head.contains(&"invalid") && stdout.contains("builtin:furnace"), "{stdout}");
}

#[test]
fn studies_vary_what_they_say_and_tell_how_cost_grows() {
    let study = |words: &[&str]| json(Path::new("."), &[&["bench", "render", "--spp", "1", "--repeat", "2", "--study"], words].concat());
    let column = |report: &serde_json::Value, key: &str| -> Vec<u64> {
        report["runs"].as_array().unwrap().iter().map(|run| run[key].as_u64().unwrap()).collect()
    };
    let lights = study(&["lights", "--size", "16x16"]);
    assert_eq!(column(&lights, "lights"), [1, 10, 100, 1000]);
    let triangles = study(&["triangles", "--size", "16x16"]);
    assert_eq!(column(&triangles, "triangles"), [1000, 10_000, 100_000]);
    let resolution = study(&["resolution", "builtin:furnace"]);
    assert_eq!(column(&resolution, "width"), [64, 128, 256, 512]);
    let threads = study(&["threads", "--size", "16x16"]);
    assert_eq!(column(&threads, "threads")[0], 1);
    for (report, with) in [(&lights, "lights"), (&triangles, "triangles"), (&resolution, "pixels"), (&threads, "threads")] {
        assert_eq!(report["growth"]["with"], with);
        assert!(report["growth"]["seconds"].is_number() || with == "threads", "{report}");
    }
}

/// Of 100 000 glowing triangles one is chosen for each surface: at equal samples the tree leaves less than a quarter of the error of uniform choice. Time is
/// not tested; docs/performance.md has it.
#[test]
fn a_tree_of_lights_leaves_less_than_a_quarter_of_the_error_of_uniform_choice() {
    let mse = |sampler: &str| {
        // Pixel centres: edges of embers that the camera sees would be noise whatever is chosen.
        let what = ["bench", "render", "builtin:embers:100000", "--size", "48x27", "--spp", "4", "--max-depth", "1", "--filter", "center"];
        let words = [&what[..], &["--light-sampler", sampler]].concat();
        json(Path::new("."), &words)["runs"][0]["mse"].as_f64().unwrap()
    };
    let (tree, uniform) = (mse("bvh"), mse("uniform"));
    assert!(tree < 0.25 * uniform, "{tree} and {uniform}");
}

#[test]
fn words_that_make_no_benchmark_are_refused_with_a_reason() {
    for (words, code, says) in [
        (&["builtin:cornell", "--repeat", "1"][..], 2, "raise --repeat"),
        (&["builtin:cornell", "--reference", "x.exr"], 1, "x.exr"),
        (&["builtin:cornell", "--reference", "x.png"], 2, ".exr and .hdr"),
        (&["--reference", "x.exr"], 2, "name that scene alone"),
        (&["--profile", "full"], 2, "add --study"),
        (&["--study", "lights", "builtin:cornell"], 2, "leave the scene out"),
        (&["--study", "threads", "--threads", "2"], 2, "leave --threads out"),
        (&["--study", "resolution", "--size", "8x8"], 2, "leave --size out"),
        (&["builtin:nothing"], 2, "builtin:nothing"),
        (&["--size", "0x0"], 2, "1 to 16384"),
    ] {
        let output = kajo(Path::new(".")).args(["bench", "render"]).args(words).output().unwrap();
        let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(code) && stderr.contains(says), "{words:?}: {stderr}");
        assert!(output.stdout.is_empty(), "{words:?}");
    }
}

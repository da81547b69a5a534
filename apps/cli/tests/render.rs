//! `kajo render` as a user types it.

mod common;

use common::{json, run, succeed};

const SMALL: [&str; 4] = ["render", "builtin:cornell", "--size", "32x32"];

fn render(folder: &std::path::Path, words: &[&str]) {
    succeed(folder, &[&SMALL, words].concat());
}

fn identical(folder: &std::path::Path, a: &str, b: &str) -> bool {
    json(folder, &["metrics", a, b])["identical"] == true
}

#[test]
fn threads_do_not_change_a_bit() {
    let folder = tempfile::tempdir().unwrap();
    for threads in ["1", "2", "5"] {
        render(folder.path(), &["--spp", "8", "--threads", threads, "-o", &format!("{threads}.exr")]);
    }
    assert!(identical(folder.path(), "1.exr", "2.exr") && identical(folder.path(), "1.exr", "5.exr"));
    render(folder.path(), &["--spp", "8", "--seed", "1", "-o", "seed.exr"]);
    assert!(!identical(folder.path(), "1.exr", "seed.exr"), "another seed is another image");
}

#[test]
fn a_resumed_render_equals_an_uninterrupted_one() {
    let folder = tempfile::tempdir().unwrap();
    render(folder.path(), &["--spp", "8", "-o", "whole.exr"]);
    render(folder.path(), &["--spp", "3", "-o", "part.exr", "--checkpoint", "c.ckpt"]);
    assert!(!identical(folder.path(), "whole.exr", "part.exr"));
    render(folder.path(), &["--spp", "8", "-o", "part.exr", "--checkpoint", "c.ckpt", "--resume"]);
    assert!(identical(folder.path(), "whole.exr", "part.exr"));
}

#[test]
fn statistics_have_the_keys_of_the_contract() {
    let folder = tempfile::tempdir().unwrap();
    render(folder.path(), &["--spp", "4", "-o", "a.png", "--stats", "s.json"]);
    let stats: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(folder.path().join("s.json")).unwrap()).unwrap();
    for key in ["render_seconds", "spp", "rays", "samples_per_s", "relative_standard_error"] {
        assert!(stats[key].is_number(), "{key}: {stats}");
    }
    assert_eq!(stats["spp"], 4);
}

/// Light sampling alone takes the textbook's rays: at most camera, shadow, bounce, shadow, and one a pixel in each of two looks for edges and highlights.
#[test]
fn light_sampling_alone_takes_four_rays_for_two_bounces() {
    let folder = tempfile::tempdir().unwrap();
    let rays = |strategy: &str| {
        let words = ["--spp", "8", "--max-depth", "2", "--strategy", strategy, "-o", "a.exr"];
        json(folder.path(), &[&SMALL[..], &words].concat())["rays"].as_f64().unwrap() / (32.0 * 32.0 * 8.0)
    };
    let (lights, mis) = (rays("lights"), rays("mis"));
    assert!((3.0..4.0 + 2.0 / 8.0).contains(&lights) && mis > lights + 1.0, "{lights} and {mis} rays a sample");
}

#[test]
fn the_noise_level_is_reached() {
    let folder = tempfile::tempdir().unwrap();
    let stats = json(folder.path(), &[&SMALL[..], &["--noise", "0.3", "-o", "a.exr"]].concat());
    assert!(stats["relative_standard_error"].as_f64().unwrap() <= 0.3, "{stats}");
}

#[test]
fn a_sequence_is_numbered_and_moves() {
    let folder = tempfile::tempdir().unwrap();
    succeed(folder.path(), &["render", "builtin:moving", "--size", "32x18", "--spp", "2", "--frames", "0..2", "--fps", "2", "-o", "m.exr"]);
    assert!(!identical(folder.path(), "m.0000.exr", "m.0001.exr"));
    assert!(folder.path().join("m.0002.exr").exists() && !folder.path().join("m.exr").exists());
}

#[test]
fn every_layer_is_in_one_file() {
    let folder = tempfile::tempdir().unwrap();
    render(folder.path(), &["--spp", "2", "-o", "a.exr", "--aov", "all"]);
    let file = kajo_image::ExrFile::read(&folder.path().join("a.exr")).unwrap();
    for layer in
        ["", "direct", "indirect-diffuse", "albedo", "shading-normal", "depth", "instance-id", "motion", "beauty.variance", "bounce.1"]
    {
        assert!(file.layer(layer).is_some(), "no layer `{layer}`");
    }
    assert!(file.metadata["command"].contains("builtin:cornell"), "{:?}", file.metadata);
}

/// A picture whose brightness no denoiser can judge, for its variance leaves the range of numbers: the samples are kept.
#[test]
fn a_picture_that_cannot_be_denoised_is_written_as_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let scene = "[[asset]]\nfile = \"builtin:spheres\"\n[environment]\nradiance = 1e38\n";
    std::fs::write(folder.path().join("bright.kajo.toml"), scene).unwrap();
    let words = ["render", "bright.kajo.toml", "--size", "16x16", "--spp", "64", "--max-depth", "1", "--denoise", "-o", "bright.exr"];
    let output = run(folder.path(), &words);
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(1) && stderr.contains("it holds the noisy picture"), "{stderr}");
    let file = kajo_image::ExrFile::read(&folder.path().join("bright.exr")).unwrap();
    assert!(file.layer("").is_some() && file.layer("noisy").is_none());
}

#[test]
fn a_denoised_picture_is_nearer_to_the_truth_and_the_noisy_one_is_kept() {
    let folder = tempfile::tempdir().unwrap();
    render(folder.path(), &["--spp", "8", "-o", "noisy.exr"]);
    render(folder.path(), &["--spp", "8", "--denoise", "--stats", "s.json", "-o", "denoised.exr"]);
    render(folder.path(), &["--spp", "512", "--seed", "1", "-o", "truth.exr"]);
    let error = |image: &str| json(folder.path(), &["metrics", image, "truth.exr"])["rel_mse"].as_f64().unwrap();
    assert!(error("denoised.exr") < 0.5 * error("noisy.exr"), "{} {}", error("denoised.exr"), error("noisy.exr"));
    let read = |name: &str| kajo_image::ExrFile::read(&folder.path().join(name)).unwrap();
    let (denoised, noisy) = (read("denoised.exr"), read("noisy.exr"));
    assert_eq!(denoised.color("noisy"), noisy.color(""));
    assert_eq!(denoised.color("noisy.variance"), noisy.color("beauty.variance"));
    assert!(denoised.layer("beauty.variance").is_none() && denoised.layer("albedo").is_none(), "only what was asked for");
    let stats: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(folder.path().join("s.json")).unwrap()).unwrap();
    assert!(stats["denoise_seconds"].is_number(), "{stats}");
}

#[test]
fn adaptive_samples_can_be_looked_at_and_resumed() {
    let folder = tempfile::tempdir().unwrap();
    let adaptive = ["--adaptive", "--aov", "samples", "--max-depth", "2"];
    render(folder.path(), &[&adaptive[..], &["--spp", "64", "-o", "whole.exr"]].concat());
    render(folder.path(), &[&adaptive[..], &["--spp", "20", "-o", "part.exr", "--checkpoint", "c.ckpt"]].concat());
    render(folder.path(), &[&adaptive[..], &["--spp", "64", "-o", "part.exr", "--checkpoint", "c.ckpt", "--resume"]].concat());
    assert!(identical(folder.path(), "whole.exr", "part.exr"));
    let file = kajo_image::ExrFile::read(&folder.path().join("whole.exr")).unwrap();
    let counts = file.layer("samples").unwrap().channel("Y").unwrap();
    let mean = counts.iter().sum::<f32>() / counts.len() as f32;
    assert!((mean - 64.0).abs() < 3.0 && counts.iter().any(|&n| n < 40.0) && counts.iter().any(|&n| n > 128.0), "mean {mean}");
}

#[test]
fn debug_views_are_files_named_by_picture_and_light() {
    let folder = tempfile::tempdir().unwrap();
    let words = |technique: &'static str, to: &'static str| {
        let scene = ["render", "builtin:shadows", "--size", "32x18", "--renderer", "realtime", "-o", "a.png", "--technique", technique];
        [&scene[..], &["--debug", to]].concat()
    };
    succeed(folder.path(), &words("direct-visibility=shadow/map:resolution=64", "map"));
    let files = std::fs::read_dir(folder.path().join("map")).unwrap().map(|file| file.unwrap().file_name().into_string().unwrap());
    let files: Vec<String> = files.collect();
    for name in ["light-depth.0.", "camera-depth.0.", "reprojection.0."] {
        for kind in [".png", ".exr"] {
            assert!(files.iter().any(|file| file.starts_with(name) && file.ends_with(kind)), "{name}…{kind}: {files:?}");
        }
    }
    let said = run(folder.path(), &words("direct-visibility=shadow/none", "none"));
    assert!(said.status.success() && !folder.path().join("none").exists(), "{said:?}");
    assert!(String::from_utf8_lossy(&said.stderr).contains("shadow/none has no debug views"), "{said:?}");
}

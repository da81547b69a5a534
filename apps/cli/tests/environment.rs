//! Environments as a user asks for them: `kajo bench environment` and `--env-sampler`.

mod common;

use common::{asset, json, succeed};
use kajo_image::{Image, read_image, write_hdr};
use kajo_units::LinearRgb;
use std::path::Path;

/// A gradient with clouds and a sun of a few pixels.
fn write_sky(folder: &Path) {
    let sky = Image::from_fn((512, 256).into(), |x, y| {
        let (u, v) = (x as f32 / 512.0, y as f32 / 256.0);
        let base = 0.4 + 0.8 * v + 0.2 * (u * 25.0).sin() * (v * 21.0).cos();
        let sun = 2e3 * (-((u - 0.3).powi(2) * 4.0 + (v - 0.25).powi(2)) * 2e4).exp();
        LinearRgb::new(base + sun, base + 0.9 * sun, 1.2 * base + 0.7 * sun)
    });
    write_hdr(&folder.join("sky.hdr"), &sky).unwrap();
}

/// Row GI-12: one block for 170 pixels keeps the picture of the map and takes a fiftieth of the memory of the cumulative tables.
#[test]
fn a_map_in_blocks_is_small_and_still_itself() {
    let folder = tempfile::tempdir().unwrap();
    write_sky(folder.path());
    let photographed = asset("env/spiaggia_di_mondello_1k.hdr").map(|path| path.display().to_string());
    for map in ["sky.hdr".to_owned()].into_iter().chain(photographed) {
        let report = json(folder.path(), &["bench", "environment", "--env", &map, "-o", "blocks.exr"]);
        let number =
            |pointer: &str| report.pointer(pointer).and_then(|value| value.as_f64()).unwrap_or_else(|| panic!("{pointer}: {report}"));
        assert!((number("/pixels_per_block") - 170.0).abs() < 0.1, "{report}");
        assert!(number("/memory_ratio") >= 50.0 && number("/reconstruction/psnr_db") > 25.0, "{report}");
        assert!(number("/fit/total_variation") < 0.25 && number("/sample_reads/kd") == 1.0, "{report}");
        let rebuilt = read_image(&folder.path().join("blocks.exr")).unwrap();
        assert_eq!((f64::from(rebuilt.width()), f64::from(rebuilt.height())), (number("/width"), number("/height")));
        // One block has nothing of the map but its mean.
        let single = json(folder.path(), &["bench", "environment", "--env", &map, "--blocks", "1"]);
        assert!(single["reconstruction"]["psnr_db"].as_f64().unwrap() < number("/reconstruction/psnr_db") - 3.0, "{single}");
    }
}

#[test]
fn every_environment_sampler_renders_another_noise() {
    let folder = tempfile::tempdir().unwrap();
    write_sky(folder.path());
    let words = |sampler: &'static str, file: &'static str| {
        ["render", "builtin:spheres", "--env", "sky.hdr", "--env-sampler", sampler, "--size", "32x18", "--spp", "2", "-o", file]
    };
    for (sampler, file) in [("cdf", "cdf.exr"), ("alias", "alias.exr"), ("kd", "kd.exr")] {
        succeed(folder.path(), &words(sampler, file));
    }
    for (a, b) in [("cdf.exr", "kd.exr"), ("cdf.exr", "alias.exr"), ("kd.exr", "alias.exr")] {
        assert_eq!(json(folder.path(), &["metrics", a, b])["identical"], false, "{a} and {b}");
    }
}

//! `kajo metrics`: how an image differs from a reference.

use crate::arguments::{Common, Metrics};
use crate::failure::{Failure, Outcome};
use crate::output;
use kajo_image::{read_image, write_png};
use kajo_image_metrics::{Comparison, ComparisonOptions, Palette, heat_map};
use std::collections::BTreeMap;
use std::path::Path;

/// Prints every number, and writes the FLIP map.
///
/// PSNR is of the encoded picture for 8-bit files; where a file is scene-linear it is of the linear values with peak 1.
pub fn run(common: &Common, arguments: &Metrics) -> Outcome {
    if let Some(path) = &arguments.heatmap
        && !has_extension(path, "png")
    {
        return Err(Failure::usage(format!("--heatmap writes a .png; got {}", path.display())));
    }
    let image = read_image(&arguments.image)?;
    let reference = read_image(&arguments.reference)?;
    let scene_linear = [&arguments.image, &arguments.reference].iter().any(|path| has_extension(path, "exr") || has_extension(path, "hdr"));
    let options = ComparisonOptions { hdr: scene_linear, ..Default::default() };
    let (mut comparison, flip_map) = Comparison::new(&image, &reference, &options)?;
    if scene_linear {
        comparison.psnr = comparison.psnr_linear;
    }
    if let Some(path) = &arguments.heatmap {
        write_png(path, &heat_map(&flip_map, 1.0, Palette::Magma), &BTreeMap::new())?;
    }
    if common.json { output::json(&comparison) } else { output::text(&as_text(&comparison)) }
}

fn has_extension(path: &Path, extension: &str) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case(extension))
}

fn as_text(comparison: &Comparison) -> String {
    let optional = |value: Option<f64>, absent: &str| value.map_or(absent.to_string(), |v| format!("{v:.6}"));
    let mut lines = vec![
        ("RMSE", format!("{:.6}", comparison.rmse)),
        ("relative MSE", format!("{:.6}", comparison.rel_mse)),
        ("PSNR, dB", optional(comparison.psnr, "infinite")),
        ("SSIM", optional(comparison.ssim, "not defined below 11x11 px")),
        ("FLIP (LDR)", format!("{:.6}", comparison.flip)),
        ("mean ratio", optional(comparison.mean_ratio, "not defined: the reference is black")),
    ];
    if let Some(flip) = comparison.flip_hdr {
        lines.insert(5, ("FLIP (HDR)", format!("{flip:.6}")));
    }
    if comparison.identical {
        lines.push(("identical", "yes".into()));
    }
    lines.into_iter().map(|(name, value)| format!("{name:<14}{value}\n")).collect()
}

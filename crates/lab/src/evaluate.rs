//! From images to numbers: the errors of one run.

use crate::LabError;
use crate::failures::Failures;
use crate::html::{CropPictures, ReferencePictures, RunPictures};
use crate::judge::{Judge, Kind, Part, Take};
use crate::report::{Candidate, ComposedError, LightError, RunError, Temporal};
use glam::UVec2;
use kajo_image::{ExrFile, Image, Layer};
use kajo_image_metrics::{
    ClassConfusion, Comparison, ComparisonOptions, MetricsError, MseDifference, Palette, View, bias_noise, crop, heat_map, mse,
    mse_difference, rmse, shadow_border, worst_crops,
};
use kajo_units::LinearRgb;

/// Everything that the images of a run say.
#[derive(Clone, Debug)]
pub struct Evaluation {
    /// For the report.
    pub error: RunError,
    /// For the report.
    pub temporal: Temporal,
    /// The first take, all parts below each other: for the comparison of runs.
    pub stacked: Image<LinearRgb>,
    /// FLIP of the first take, the largest over the parts.
    pub heat: Image<f32>,
}

/// Side of the crops, px: three of them at fourfold size stand beside each other.
const CROP_SIDE: u32 = 26;
/// Standard errors of bias² beyond which a technique is called biased.
const BIAS_SIGMAS: f64 = 4.0;
/// Number of crops of a run.
const CROPS: usize = 3;

/// Compares the takes of a run (one a seed) with its judge. `what` names the run in errors.
///
/// # Errors
/// No take, sizes that differ, NaN.
pub fn evaluate(judge: &Judge, takes: &[Take], what: &str) -> Result<Evaluation, LabError> {
    let named = |source: MetricsError| LabError::Metrics { what: what.to_owned(), source };
    let (reference, variance) = (judge.stacked(), judge.stacked_variance());
    let stacked: Vec<Image<LinearRgb>> = takes.iter().map(|take| judge.stacked_take(take)).collect();
    let Some(first) = stacked.first() else { return Err(LabError::NotMeasured { reason: format!("{what} gave no image") }) };
    let options = ComparisonOptions {
        view: judge.view(),
        hdr: judge.kind == Kind::Light,
        reference_variance: variance.as_ref(),
        ..Default::default()
    };
    let (mut image, map) = Comparison::new(first, &reference, &options).map_err(named)?;

    let errors = stacked.iter().map(|s| mse(s, &reference)).collect::<Result<Vec<_>, _>>().map_err(named)?;
    let (mean, standard_error) = mean_and_error(&errors);
    (image.mse, image.rmse) = (mean, mean.sqrt());
    image.psnr_linear = (mean > 0.0).then(|| -10.0 * mean.log10());

    let split = (takes.len() > 1).then(|| bias_noise(&stacked, &reference, variance.as_ref())).transpose().map_err(named)?;
    let relative = mean_relative_error(&stacked, &reference, variance.as_ref());
    let mut error = RunError {
        image,
        bias: split.map(|s| s.bias),
        noise: split.map(|s| s.noise),
        bias_floor: split.map(|s| s.bias_floor),
        label: split.map(|s| if s.bias_sigmas > BIAS_SIGMAS { "biased" } else { "unbiased" }),
        mean_relative_error: relative.map(|r| r.0),
        mean_relative_error_95: relative.map(|r| r.1),
        mse_standard_error: standard_error,
        off_border_mismatch: None,
        off_border_mismatches: None,
        border_error: None,
        border_px: None,
        shadow_classes: None,
        lights: vec![],
        composed: composed(judge, takes).map_err(named)?,
    };
    if judge.kind == Kind::Visibility {
        borders(judge, &takes[0], &mut error).map_err(named)?;
        error.shadow_classes = Some(confusion(judge, takes).map_err(named)?);
    }
    let temporal = Temporal { flicker: flicker(&stacked), still_flicker: flicker(&stacked), ..Temporal::default() };
    Ok(Evaluation { error, temporal, heat: largest_over_parts(&map, judge.size()), stacked: stacked.into_iter().next().expect("a take") })
}

/// Mean, and its standard error; 0 for one value.
fn mean_and_error(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let spread = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0).max(1.0);
    (mean, (spread / n).sqrt())
}

/// Mean over seeds of ΣI/ΣR − 1, and the half width of its 95 % interval; the reference's pixels count as independent.
fn mean_relative_error(
    stacked: &[Image<LinearRgb>],
    reference: &Image<LinearRgb>,
    variance: Option<&Image<LinearRgb>>,
) -> Option<(f64, f64)> {
    let luminance = |image: &Image<LinearRgb>| image.pixels().iter().map(|p| f64::from(p.luminance())).sum::<f64>();
    let total = luminance(reference);
    let errors: Vec<f64> = stacked.iter().map(|s| luminance(s) / total - 1.0).collect();
    let (mean, of_seeds) = mean_and_error(&errors);
    // Channels of a pixel as fully correlated: √var Y = Σ w √var.
    let deviation = |v: &LinearRgb| f64::from(LinearRgb(v.0.max(glam::Vec3::ZERO).map(f32::sqrt)).luminance());
    let of_reference = variance.map_or(0.0, |v| v.pixels().iter().map(|p| deviation(p).powi(2)).sum::<f64>().sqrt() / total);
    (total > 0.0).then(|| (mean, (student_95(errors.len()) * of_seeds).hypot(1.96 * of_reference)))
}

/// Factor from the standard error of `n` values to the half width of the 95 % interval of their mean (Student's t, n − 1 degrees).
fn student_95(n: usize) -> f64 {
    const TABLE: [f64; 10] = [12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228];
    TABLE.get(n.saturating_sub(2)).copied().unwrap_or(1.96)
}

/// Shadow borders of each light in one take; the totals are over all lights.
fn borders(judge: &Judge, take: &Take, error: &mut RunError) -> Result<(), MetricsError> {
    let scalar = |image: &Image<LinearRgb>| image.map(|p| p[0]);
    let (mut off, mut mismatches, mut border, mut border_error) = (0, 0, 0, 0.0);
    let mut distances = Vec::new();
    for (part, image) in judge.parts.iter().zip(&take.parts) {
        let result = shadow_border(&scalar(image), &scalar(&part.image), counted(judge, part).as_ref())?;
        off += result.off_border_pixels;
        mismatches += result.off_border_mismatches;
        border += result.border_pixels;
        border_error += result.border_error * result.border_pixels as f64;
        distances.extend(result.border_px);
        error.lights.push(LightError {
            light: part.name.strip_prefix("visibility.").unwrap_or(&part.name).to_owned(),
            rmse: mse(&judge.masked(image), &judge.masked(&part.image))?.sqrt(),
            off_border_mismatch: result.off_border_mismatch,
            border_px: result.border_px,
        });
    }
    error.off_border_mismatch = Some(mismatches as f64 / off.max(1) as f64);
    error.off_border_mismatches = Some(mismatches);
    error.border_error = Some(border_error / border.max(1) as f64);
    error.border_px = (!distances.is_empty()).then(|| distances.iter().sum::<f64>() / distances.len() as f64);
    Ok(())
}

/// Which class the mean over the takes takes for which: one take of one ray a pixel has no penumbra.
fn confusion(judge: &Judge, takes: &[Take]) -> Result<ClassConfusion, MetricsError> {
    let scalar = |image: &Image<LinearRgb>| image.map(|p| p[0]);
    let images: Vec<_> = mean_parts(takes).iter().map(scalar).collect();
    let references: Vec<_> = judge.parts.iter().map(|part| scalar(&part.image)).collect();
    ClassConfusion::new(images.iter().zip(&references), judge.mask.as_ref())
}

/// Pixels that show a surface, and of which it is known whether they lie on a border of the shadow.
fn counted(judge: &Judge, part: &Part) -> Option<Image<bool>> {
    match (&judge.mask, &part.settled) {
        (Some(mask), Some(settled)) => {
            let pairs = mask.pixels().iter().zip(settled.pixels());
            Some(Image::from_pixels(mask.size(), pairs.map(|(surface, settled)| *surface && *settled).collect()))
        }
        (mask, settled) => mask.clone().or_else(|| settled.clone()),
    }
}

fn composed(judge: &Judge, takes: &[Take]) -> Result<Option<ComposedError>, MetricsError> {
    let (Some(composed), Some(image)) = (&judge.composed, &takes[0].composed) else { return Ok(None) };
    let reference = &composed.part;
    let options = ComparisonOptions {
        view: View::fit(&reference.image),
        hdr: true,
        reference_variance: reference.variance.as_ref(),
        ..Default::default()
    };
    let (errors, _) = Comparison::new(image, &reference.image, &options)?;
    let simulated = composed.simulated.as_ref();
    Ok(Some(ComposedError {
        against: reference.name.clone(),
        image: errors,
        approximation_rmse: simulated.map(|s| rmse(image, s)).transpose()?,
        not_simulated_rmse: simulated.map(|s| rmse(s, &reference.image)).transpose()?,
    }))
}

/// Mean |difference| of neighbouring takes, over pixels and channels.
fn flicker(stacked: &[Image<LinearRgb>]) -> Option<f64> {
    let pairs = stacked.windows(2).map(|pair| {
        let difference = |(a, b): (&LinearRgb, &LinearRgb)| f64::from((*a - *b).0.abs().element_sum()) / 3.0;
        pair[0].pixels().iter().zip(pair[1].pixels()).map(difference).sum::<f64>() / pair[0].pixels().len() as f64
    });
    let all: Vec<f64> = pairs.collect();
    (!all.is_empty()).then(|| all.iter().sum::<f64>() / all.len() as f64)
}

fn largest_over_parts(map: &Image<f32>, size: UVec2) -> Image<f32> {
    let parts = map.height() / size.y;
    Image::from_fn(size, |x, y| (0..parts).map(|part| *map.get(x, y + part * size.y)).fold(0.0, f32::max))
}

/// The pictures of a run, for the page and the PNG files.
pub fn pictures(judge: &Judge, take: &Take, evaluation: &Evaluation, failures: Option<&Failures>) -> RunPictures {
    let view = judge.view();
    let image = view.to_srgb8(&judge.picture(&take.parts));
    let reference = view.to_srgb8(&judge.picture(&judge.images()));
    let composed = judge.composed.as_ref().zip(take.composed.as_ref());
    let composed = composed.map(|(c, image)| View::fit(&c.part.image).to_srgb8(image));
    let heat = heat_map(&evaluation.heat, 1.0, Palette::Magma);
    let crops = worst_crops(&evaluation.heat, CROP_SIDE, CROPS);
    let crops = crops.iter().map(|c| CropPictures { at: [c.x, c.y], images: [&image, &reference, &heat].map(|i| crop(i, c)) }).collect();
    let name = if judge.kind == Kind::Light { "HDR-FLIP" } else { "FLIP" };
    let over = if judge.parts.len() > 1 { ", the largest over all lights" } else { "" };
    RunPictures {
        image,
        composed,
        heat,
        heat_scale: format!("{name} of each pixel: black 0, pale yellow 1{over}"),
        failures: failures.map(|failures| failures.picture(judge)),
        crops,
        films: vec![],
    }
}

/// The pictures of the reference.
pub fn reference_pictures(judge: &Judge) -> ReferencePictures {
    let composed = judge.composed.as_ref().map(|c| View::fit(&c.part.image).to_srgb8(&c.part.image));
    ReferencePictures { image: judge.view().to_srgb8(&judge.picture(&judge.images())), composed }
}

/// Every image of a run with full precision.
pub fn run_exr(judge: &Judge, take: &Take, evaluation: &Evaluation) -> ExrFile {
    let mut file = ExrFile::new(judge.size());
    file.layers.push(Layer::color("", &judge.picture(&take.parts)));
    if judge.parts.len() > 1 {
        file.layers.extend(judge.parts.iter().zip(&take.parts).map(|(part, image)| Layer::color(&part.name, image)));
    }
    file.layers.push(Layer::scalar("flip", &evaluation.heat));
    if let Some(composed) = &take.composed {
        file.layers.push(Layer::color("composed", composed));
    }
    file
}

/// The reference with its variance.
pub fn reference_exr(judge: &Judge) -> ExrFile {
    let mut file = ExrFile::new(judge.size());
    file.layers.push(Layer::color("", &judge.picture(&judge.images())));
    for part in judge.parts.iter().chain(judge.composed.as_ref().map(|c| &c.part)) {
        file.layers.push(Layer::color(&part.name, &part.image));
        if let Some(variance) = &part.variance {
            file.layers.push(Layer::color(format!("variance.{}", part.name), variance));
        }
    }
    file
}

/// The mean over the takes of each part: what noise leaves is no fault.
pub fn mean_parts(takes: &[Take]) -> Vec<Image<LinearRgb>> {
    let scale = 1.0 / takes.len().max(1) as f32;
    let parts = takes.first().map_or(0, |take| take.parts.len());
    let mean = |part: usize| {
        let first = &takes[0].parts[part];
        let pixel = |i: usize| takes.iter().map(|take| take.parts[part].pixels()[i]).sum::<LinearRgb>() * scale;
        Image::from_pixels(first.size(), (0..first.pixels().len()).map(pixel).collect())
    };
    (0..parts).map(mean).collect()
}

/// MSE of run a minus that of run b, its standard error from the reference's noise and from the seeds.
///
/// # Errors
/// Sizes that differ.
pub fn difference(judge: &Judge, a: (&Evaluation, &Candidate), b: (&Evaluation, &Candidate)) -> Result<MseDifference, MetricsError> {
    let by_reference = mse_difference(&a.0.stacked, &b.0.stacked, &judge.stacked(), judge.stacked_variance().as_ref())?;
    let seeds = a.0.error.mse_standard_error.hypot(b.0.error.mse_standard_error);
    Ok(MseDifference { value: a.1.mse - b.1.mse, standard_error: by_reference.standard_error.hypot(seeds) })
}

#[cfg(test)]
mod tests;

//! The report as data: `report.json`. Names of fields are a contract; add, do not rename.

mod csv;
mod decision;

pub use csv::to_csv;
pub(crate) use decision::short;
pub use decision::{Candidate, Certainty, Decision, SIGMAS, decide, pareto_front};

use kajo_image_metrics::{ClassConfusion, Comparison};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// Everything that was found, and what is needed to find it again.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Report {
    /// Version of Kajo.
    pub kajo: String,
    /// Repeats this report.
    pub command: String,
    /// When it was made, UTC, ISO 8601.
    pub created: String,
    /// False when it was interrupted: later runs are missing.
    pub complete: bool,
    /// Where the techniques ran.
    pub device: Option<DeviceEntry>,
    /// Where the reference ran.
    pub host: Host,
    /// What was asked for.
    pub settings: Settings,
    /// One entry a scene and role.
    pub references: Vec<ReferenceEntry>,
    /// One entry a scene, role and technique with its parameters.
    pub runs: Vec<Run>,
    /// One entry a scene and role.
    pub decisions: Vec<Decision>,
    /// What loaders and renderers did not do as the files say.
    pub ignored: Vec<kajo_scene::Ignored>,
    /// What a reader must know before believing a number.
    pub warnings: Vec<String>,
    /// Every file of the report, relative to its folder.
    pub files: Vec<String>,
}

impl Report {
    /// When no scene had anything to judge by: why. The report then lists every run as skipped.
    pub fn nothing_compared(&self) -> Option<String> {
        if !self.references.is_empty() {
            return None;
        }
        let reasons: BTreeSet<String> = self
            .runs
            .iter()
            .map(|run| format!("{}, {}: {}", run.scene, run.role, run.status.strip_prefix("skipped: ").unwrap_or(&run.status)))
            .collect();
        Some(reasons.into_iter().collect::<Vec<_>>().join("; "))
    }
}

/// The GPU or its software stand-in.
#[derive(Clone, Debug, Default, Serialize)]
#[allow(missing_docs, reason = "as in kajo_render_graph::DeviceInfo")]
pub struct DeviceEntry {
    pub name: String,
    pub driver: String,
    pub kind: String,
    pub backend: String,
    pub ray_query: bool,
    pub timestamps: bool,
}

impl DeviceEntry {
    /// True when a CPU plays the GPU: its times say nothing about one.
    pub fn is_software(&self) -> bool {
        self.kind == "software"
    }
}

/// The computer.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Host {
    /// Name of the processor, where the system tells it.
    pub cpu: String,
    /// Threads of the reference.
    pub threads: usize,
    /// Operating system and architecture.
    pub os: String,
}

/// What was asked for.
#[derive(Clone, Debug, Default, Serialize)]
#[allow(missing_docs, reason = "the flags of `kajo compare`")]
pub struct Settings {
    pub frames: u32,
    pub warm_up_frames: u32,
    pub repeat: u32,
    pub budget_ms: Option<f64>,
    pub seed: u64,
    pub reference_spp: Option<u32>,
    pub reference_noise: Option<f32>,
    pub time: f64,
    pub temporal: u32,
}

/// The path-traced judge of one role.
#[derive(Clone, Debug, Default, Serialize)]
pub struct ReferenceEntry {
    /// As the user named it.
    pub scene: String,
    /// Id of the role.
    pub role: String,
    /// Name for people.
    pub role_title: String,
    /// The integral that is judged.
    pub estimates: String,
    /// Role ambient visibility: how far a surface blocks, m.
    pub ambient_distance: Option<f32>,
    /// Unit of the role's image.
    pub unit: String,
    /// The images of the path tracer that judge it.
    pub judged_by: Vec<String>,
    /// Width and height of each, px.
    pub size: [u32; 2],
    /// Samples per pixel.
    pub spp: u32,
    /// RMS of the pixels' standard errors, divided by the mean of the image. `null` for a black image.
    pub relative_standard_error: Option<f64>,
    /// RMSE that a perfect image has against this reference, in the unit of the role.
    pub rmse_floor: f64,
    /// Wall-clock time of the rendering that gave all references of the scene, s.
    pub seconds: f64,
    /// Rays of that rendering.
    pub rays: u64,
    /// Files of its images.
    pub images: BTreeMap<String, String>,
}

/// One technique with its parameters, on one scene, in one role.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Run {
    /// As the user named it.
    pub scene: String,
    /// Id of the role.
    pub role: String,
    /// Id of the technique.
    pub technique: String,
    /// Its name for people.
    pub title: String,
    /// Every parameter with its value.
    pub params: serde_json::Map<String, serde_json::Value>,
    /// Names of the parameters that were not left at their default.
    pub changed_params: Vec<String>,
    /// `ok`, or `skipped: …` with the reason.
    pub status: String,
    /// Error of the role's image; `null` when skipped.
    pub error: Option<RunError>,
    /// Behaviour over time.
    pub temporal: Temporal,
    /// Cost of a frame; `null` when skipped.
    pub cost: Option<Cost>,
    /// Share of each class of failure in the pixels that a light can reach, lights counted one by one, in the mean over all takes: see [`crate::failures`].
    pub failures: BTreeMap<String, f64>,
    /// Files of its images, by kind.
    pub images: BTreeMap<String, String>,
}

/// `ok`, as in [`Run::status`].
pub const OK: &str = "ok";

impl Run {
    /// Whether it gave a result.
    pub fn is_ok(&self) -> bool {
        self.status == OK
    }

    /// Technique with the parameters that differ from their defaults, as on the command line.
    pub fn label(&self) -> String {
        let text = |value: &serde_json::Value| value.as_str().map_or_else(|| value.to_string(), str::to_owned);
        let changed: Vec<String> = self.changed_params.iter().map(|name| format!("{name}={}", text(&self.params[name]))).collect();
        if changed.is_empty() { self.technique.clone() } else { format!("{}:{}", self.technique, changed.join(",")) }
    }
}

/// Errors of a run.
#[derive(Clone, Debug, Serialize)]
pub struct RunError {
    /// rmse, rel_mse, psnr, ssim, flip, mean_ratio, …: of the first seed; a visibility stacks all lights.
    #[serde(flatten)]
    pub image: Comparison,
    /// What averaging seeds would not remove; `null` with one repeat.
    pub bias: Option<f64>,
    /// What it would; `null` with one repeat.
    pub noise: Option<f64>,
    /// Smallest bias that could be seen.
    pub bias_floor: Option<f64>,
    /// `biased` when the bias is more than noise of seeds and reference explains, else `unbiased`: none that this many repeats show.
    /// `null` with one repeat.
    pub label: Option<&'static str>,
    /// Mean of the image over mean of the reference, less 1, averaged over seeds. `null` for a black reference.
    pub mean_relative_error: Option<f64>,
    /// Half width of its 95 % confidence interval, from the seeds and the reference.
    pub mean_relative_error_95: Option<f64>,
    /// Standard deviation of the MSE over seeds, divided by √repeats.
    pub mse_standard_error: f64,
    /// Share of pixels on the wrong side of one half, off the reference's shadow border (visibility).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub off_border_mismatch: Option<f64>,
    /// Their number.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub off_border_mismatches: Option<u64>,
    /// Mean |V − R| on the border (visibility).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub border_error: Option<f64>,
    /// Mean distance between the shadow borders, px (visibility).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub border_px: Option<f64>,
    /// Which of umbra, penumbra and lit the technique takes for which: `shadow_classes.penumbra.lit` is the share of pixels that are penumbra in the
    /// reference and lit in the mean over all takes (visibility).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shadow_classes: Option<ClassConfusion>,
    /// The same for each light (visibility).
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub lights: Vec<LightError>,
    /// The composed picture against the path tracer's: errors of the role as a viewer meets them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub composed: Option<ComposedError>,
}

/// Error of the visibility of one light.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LightError {
    /// Name of the light.
    pub light: String,
    /// RMSE of its visibility.
    pub rmse: f64,
    /// See [`RunError::off_border_mismatch`].
    pub off_border_mismatch: f64,
    /// See [`RunError::border_px`].
    pub border_px: Option<f64>,
}

/// Error of the picture in which the role's output is used.
#[derive(Clone, Debug, Serialize)]
pub struct ComposedError {
    /// The image of the path tracer it is compared with.
    pub against: String,
    /// Its errors.
    #[serde(flatten)]
    pub image: Comparison,
    /// RMSE against the part of the light that the real-time renderer simulates: what the technique can be blamed for.
    pub approximation_rmse: Option<f64>,
    /// RMSE between that part and the whole: light that the real-time renderer does not simulate.
    pub not_simulated_rmse: Option<f64>,
}

/// Behaviour over time; `null` is not measured.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Temporal {
    /// Mean |difference| of neighbouring frames, in the unit of the role: on moving sequences with motion taken out, and beyond what the reference changes, averaged over
    /// them; of a still view where none were rendered.
    pub flicker: Option<f64>,
    /// Frames that are short of 95 % of the way after a light has jumped: 0 for techniques that keep nothing. Needs moving sequences.
    pub lag: Option<f64>,
    /// Share of the frame before in the picture, where that has changed, averaged over the sequences. Needs moving sequences.
    pub ghost: Option<f64>,
    /// Mean |difference| of neighbouring takes of a still view, in the unit of the role.
    pub still_flicker: Option<f64>,
    /// One entry a moving sequence.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub sequences: Vec<SequenceError>,
    /// The way towards the new picture, frame by frame after a light has jumped, until it has been followed.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub response: Vec<f64>,
}

/// Behaviour on one moving sequence.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct SequenceError {
    /// What moves: `camera`, `light`, `object`, or `animation` where the scene has its own.
    pub motion: String,
    /// See [`Temporal::flicker`]. `null` where no surface was seen twice.
    pub flicker: Option<f64>,
    /// See [`Temporal::ghost`]. `null` where the reference does not change.
    pub ghost: Option<f64>,
    /// Against the reference, over all frames.
    pub rmse: f64,
}

/// Cost of a frame.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Cost {
    /// Median time of the technique's passes on the device; `null` without timers.
    pub gpu_ms: Option<f64>,
    /// 95th percentile of the same.
    pub gpu_ms_p95: Option<f64>,
    /// The median over the number of lights of the scene (visibility of lights).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gpu_ms_per_light: Option<f64>,
    /// Median wall-clock time of the whole frame, recording and waiting included.
    pub cpu_ms: f64,
    /// What the technique keeps on the device, bytes.
    pub memory_bytes: u64,
    /// Rays a frame; 0 for techniques that trace none.
    pub rays: u64,
    /// What the technique counts in a frame, by name: a number for each light, in the order of the lights.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub statistics: BTreeMap<String, Vec<u64>>,
}

impl Cost {
    /// What is compared: the device's time where it can be measured, the frame's otherwise, ms.
    pub fn ms(&self) -> f64 {
        self.gpu_ms.unwrap_or(self.cpu_ms)
    }
}

#[cfg(test)]
pub(crate) mod example;

#[cfg(test)]
mod tests {
    use super::example::report;

    #[test]
    fn json_has_every_key_of_the_contract() {
        let json = serde_json::to_value(report()).unwrap();
        let has = |value: &serde_json::Value, keys: &[&str]| keys.iter().for_each(|k| assert!(value.get(k).is_some(), "{k} in {value}"));
        has(&json, &["kajo", "command", "device", "references", "runs", "ignored"]);
        has(&json["references"][0], &["scene", "role", "spp", "relative_standard_error", "seconds"]);
        let run = &json["runs"][0];
        has(run, &["scene", "role", "technique", "params", "status", "error", "temporal", "cost", "failures", "images"]);
        has(&run["error"], &["rmse", "rel_mse", "psnr", "ssim", "flip", "mean_ratio", "bias", "noise", "off_border_mismatch", "border_px"]);
        has(&run["temporal"], &["flicker", "lag", "ghost"]);
        has(&run["cost"], &["gpu_ms", "gpu_ms_p95", "cpu_ms", "memory_bytes", "rays"]);
        let skipped = json["runs"].as_array().unwrap().iter().find(|r| r["status"] != "ok").unwrap();
        assert!(skipped["status"].as_str().unwrap().starts_with("skipped: needs "));
    }

    #[test]
    fn label_names_what_was_changed() {
        let labels: Vec<String> = report().runs.iter().map(super::Run::label).collect();
        assert!(labels.contains(&"shadow/map".to_owned()) && labels.contains(&"shadow/map:resolution=512".to_owned()), "{labels:?}");
    }
}

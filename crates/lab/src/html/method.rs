//! The end of the page: what is missing, and how to repeat everything.

use super::format::number;
use crate::report::{Report, Run, SIGMAS};
use kajo_image_metrics::REL_MSE_EPSILON;
use maud::{Markup, html};
use std::collections::BTreeMap;

/// Skipped techniques, and what was ignored of the scenes.
pub fn skipped_and_ignored(report: &Report) -> Markup {
    let mut skipped: BTreeMap<(String, &str), Vec<&str>> = BTreeMap::new();
    for run in report.runs.iter().filter(|r| !r.is_ok()) {
        skipped.entry((run.label(), &run.status)).or_default().push(&run.scene);
    }
    html! {
        section.left-out {
            header.section-head { h2 { "Left out" } p.what { "Nothing is skipped silently: this is all of it." } }
            @if skipped.is_empty() { p.note { "Every technique ran." } } @else {
                ul {
                    @for ((label, status), scenes) in &skipped { li { code { (label) } " " (status) " " span.where { (scenes.join(", ")) } } }
                }
            }
            @if report.ignored.is_empty() { p.note { "Nothing in the scenes was ignored." } } @else {
                h3 { "Ignored in the scenes" }
                ul {
                    @for item in &report.ignored {
                        li {
                            code { (item.feature) } " " (item.consequence) " "
                            span.where { (item.file) @if !item.place.is_empty() { ", " (item.place) } }
                        }
                    }
                }
            }
        }
    }
}

/// Hardware, settings, definitions, command.
pub fn how_it_was_measured(report: &Report) -> Markup {
    let s = &report.settings;
    let device = report.device.as_ref();
    html! {
        section.method {
            header.section-head { h2 { "How it was measured" } }
            div.command {
                pre { code #command { (report.command) } }
                button #copy type="button" { "Copy" }
            }
            p.note { "This command repeats the report: the references are equal bit by bit, the errors on the same driver, the times on the same machine." }
            dl.settings {
                @if let Some(d) = device {
                    div { dt { "device" } dd { (d.name) " (" (d.kind) ", " (d.backend) ")" } }
                    div { dt { "driver" } dd { (d.driver) } }
                    div { dt { "ray queries" } dd { @if d.ray_query { "yes" } @else { "no" } } }
                    div { dt { "timers" } dd { @if d.timestamps { "on the device" } @else { "none; wall clock instead" } } }
                }
                div { dt { "processor" } dd { (report.host.cpu) ", " (report.host.threads) " threads" } }
                div { dt { "system" } dd { (report.host.os) } }
                div { dt { "frames" } dd { (s.frames) " timed after " (s.warm_up_frames) " to warm up" } }
                div { dt { "repeats" } dd { (s.repeat) ", seeds " (s.seed) " to " (s.seed + u64::from(s.repeat.max(1)) - 1) } }
                div { dt { "reference" } dd {
                    @match (s.reference_spp, s.reference_noise) {
                        (Some(spp), _) => { (spp) " samples per pixel" },
                        (_, Some(noise)) => { "to a relative standard error of " (number(Some(noise.into()))) },
                        _ => "as given in each section",
                    }
                } }
                @if s.temporal > 0 { div { dt { "moving sequences" } dd { (s.temporal) " frames each" } } }
                div { dt { "made" } dd { (report.created) " with Kajo " (report.kajo) } }
            }
            (definitions())
            (parameters(report))
        }
    }
}

fn definitions() -> Markup {
    html! {
        details {
            summary { "What the numbers mean" }
            dl.definitions {
                div { dt { "RMSE, relMSE" } dd { "Over pixels and channels in linear light; relMSE divides by the squared reference + " (REL_MSE_EPSILON) "." } }
                div { dt { "bias, noise" } dd { "From repeats with other seeds. Noise² is the mean variance over repeats; bias² is the mean squared error of their average, less what the noise of that average and of the reference add to it. The verdict is biased where bias² exceeds 4 of its standard errors; unbiased means that none could be shown." } }
                div { dt { "not distinguishable" } dd { "The mean squared error is within " (SIGMAS) " standard errors of what a perfect image would show against this noisy reference." } }
                div { dt { "tie, standard errors" } dd { "The difference of two mean squared errors, against the standard error that the reference's noise and the seeds give it. Below " (SIGMAS) " it is a tie." } }
                div { dt { "PSNR, SSIM" } dd { "Of visibility as it is; of light after exposure, clamped and sRGB-encoded. SSIM: Gaussian window 11×11, σ 1.5, luminance (Wang 2004)." } }
                div { dt { "FLIP" } dd { "Andersson 2020; HDR-FLIP 2021: the largest over all exposures. 67 pixels per degree." } }
                div { dt { "off border" } dd { "Share of pixels on the wrong side of one half, farther than 1 px from a shadow border or penumbra of the reference, also from such as run between the centres of its pixels (" (crate::settled::SPP) " samples each)." } }
                div { dt { "border px" } dd { "Mean distance of the half-light contours, the larger of both directions." } }
                div { dt { "flicker, ghost, lag" } dd {
                    "On sequences in which the camera, a light or a thing moves, or the animation of the scene plays. Flicker: change of pixels from frame to frame, along the motion of "
                    "surfaces, beyond what the reference changes; without sequences, of a still view. Ghost: share of the frame before in the picture where the reference has changed, by least squares. "
                    "Lag: frames that are short of 95 % of the way after a light has jumped."
                } }
                div { dt { "composed, approx." } dd {
                    "The picture made with the technique, against the path tracer's image of all the same light; "
                    "and against the part of that light that the real-time renderer simulates at all (every light but the environment and unlit surfaces)."
                } }
            }
        }
    }
}

fn parameters(report: &Report) -> Markup {
    let mut seen: Vec<&Run> = Vec::new();
    for run in &report.runs {
        if !seen.iter().any(|s| s.technique == run.technique && s.params == run.params) {
            seen.push(run);
        }
    }
    html! {
        details {
            summary { "Every parameter" }
            dl.definitions {
                @for run in seen {
                    div { dt { (run.label()) } dd {
                        @if run.params.is_empty() { "no parameters" }
                        @for (i, (name, value)) in run.params.iter().enumerate() {
                            @if i > 0 { ", " }
                            code { (name) "=" (value.as_str().map_or_else(|| value.to_string(), str::to_owned)) }
                        }
                    } }
                }
            }
        }
    }
}

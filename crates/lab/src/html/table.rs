//! All numbers of all runs, sortable by any column.

use super::format::{NONE, bytes, count, number, percent};
use crate::report::{Decision, Report, Run, short};
use maud::{Markup, html};

/// A column; left out when no run has a value.
struct Column {
    heading: &'static str,
    help: &'static str,
    /// What it sorts by.
    value: fn(&Run) -> Option<f64>,
    text: fn(f64) -> String,
}

const fn column(heading: &'static str, help: &'static str, value: fn(&Run) -> Option<f64>, text: fn(f64) -> String) -> Column {
    Column { heading, help, value, text }
}

const COLUMNS: [Column; 23] = [
    column("GPU ms", "median time of the technique's passes on the device", |r| r.cost.as_ref()?.gpu_ms, short),
    column("p95", "95th percentile of the same, ms", |r| r.cost.as_ref()?.gpu_ms_p95, short),
    column("ms / light", "the median over the number of lights of the scene", |r| r.cost.as_ref()?.gpu_ms_per_light, short),
    column("RMSE", "root mean square error against the reference", |r| Some(r.error.as_ref()?.image.rmse), short),
    column("bias", "what averaging frames would not remove, RMS", |r| r.error.as_ref()?.bias, short),
    column("noise", "what averaging frames would remove, RMS", |r| r.error.as_ref()?.noise, short),
    column("verdict", "biased: more than the noise of seeds and reference explains", is_biased, verdict),
    column("FLIP", "difference that a viewer sees, 0 to 1", |r| Some(r.error.as_ref()?.image.flip), short),
    column("HDR-FLIP", "the same over all exposures", |r| r.error.as_ref()?.image.flip_hdr, short),
    column("SSIM", "structural similarity, 1 is equal", |r| r.error.as_ref()?.image.ssim, decimals),
    column("PSNR", "peak signal-to-noise ratio, dB", psnr, decibels),
    column("relMSE", "relative mean square error", |r| Some(r.error.as_ref()?.image.rel_mse), short),
    column("mean", "mean of the image over mean of the reference", |r| r.error.as_ref()?.image.mean_ratio, decimals),
    column("off border", "pixels in the wrong light, away from shadow borders", |r| r.error.as_ref()?.off_border_mismatch, share),
    column("border px", "mean distance between the shadow borders, px", |r| r.error.as_ref()?.border_px, short),
    column("composed", "RMSE of the composed picture against the path tracer's", composed, short),
    column(
        "approx.",
        "the part of composed that the technique can be blamed for, RMSE; the rest is light that is not simulated",
        |r| r.error.as_ref()?.composed.as_ref()?.approximation_rmse,
        short,
    ),
    column("flicker", "change from frame to frame beyond that of the reference", |r| r.temporal.flicker, short),
    column("lag", "frames that are short of 95 % of the way after a light has jumped", |r| r.temporal.lag, short),
    column("ghost", "share of the frame before that is still in the picture, where that has changed", |r| r.temporal.ghost, share),
    column("frame ms", "median wall-clock time of a whole frame", |r| Some(r.cost.as_ref()?.cpu_ms), short),
    column("memory", "what the technique keeps on the device", |r| Some(r.cost.as_ref()?.memory_bytes as f64), |v| bytes(v as u64)),
    column("rays", "rays traced in a frame", rays, |v| count(v as u64)),
];

fn decimals(value: f64) -> String {
    format!("{value:.4}")
}

fn share(value: f64) -> String {
    percent(Some(value))
}

fn composed(run: &Run) -> Option<f64> {
    Some(run.error.as_ref()?.composed.as_ref()?.image.rmse)
}

fn rays(run: &Run) -> Option<f64> {
    Some(run.cost.as_ref()?.rays as f64).filter(|&rays| rays > 0.0)
}

fn is_biased(run: &Run) -> Option<f64> {
    run.error.as_ref()?.label.map(|label| f64::from(u8::from(label == "biased")))
}

fn verdict(biased: f64) -> String {
    if biased > 0.0 { "biased".into() } else { "unbiased".into() }
}

/// Infinite for equal pictures.
fn psnr(run: &Run) -> Option<f64> {
    Some(run.error.as_ref()?.image.psnr.unwrap_or(f64::INFINITY))
}

fn decibels(value: f64) -> String {
    if value.is_finite() { format!("{value:.1}") } else { "∞".into() }
}

/// A number as the script reads it.
fn sort_key(value: f64) -> String {
    if value.is_finite() { value.to_string() } else { "Infinity".into() }
}

/// The table of one scene and role.
pub fn runs(report: &Report, decision: Option<&Decision>, runs: &[usize], section: usize) -> Markup {
    let columns: Vec<&Column> = COLUMNS.iter().filter(|c| runs.iter().any(|&i| (c.value)(&report.runs[i]).is_some())).collect();
    let caption = format!("table-caption-{section}");
    html! {
        div.scroll tabindex="0" role="region" aria-labelledby=(caption) {
            table.runs {
                caption id=(caption) { "Every run. Choose a heading to sort by it." }
                thead { tr {
                    th scope="col" aria-sort="none" { button type="button" { "#" } }
                    th.technique scope="col" aria-sort="none" { button type="button" { "technique" } }
                    @for column in &columns { th scope="col" aria-sort="none" title=(column.help) { button type="button" { (column.heading) } } }
                } }
                tbody {
                    @for (number, &i) in runs.iter().enumerate() { (row(&report.runs[i], i, number + 1, decision, &columns)) }
                }
            }
        }
    }
}

fn row(run: &Run, index: usize, number: usize, decision: Option<&Decision>, columns: &[&Column]) -> Markup {
    let recommended = decision.is_some_and(|d| d.recommended == Some(index));
    let tie = decision.is_some_and(|d| d.ties.contains(&index));
    let on_front = decision.is_some_and(|d| d.pareto.contains(&index));
    let distinguishable = run.error.as_ref().and_then(|e| e.image.distinguishable) != Some(false);
    html! {
        tr .recommended[recommended] .skipped[!run.is_ok()] {
            td data-v=(number) { (number) }
            th.technique scope="row" data-v=(run.label()) {
                span.id { (run.label()) }
                @if recommended { span.chip.use { "use" } }
                @if tie { span.chip { "tie" } }
                @if on_front && !recommended { span.chip { "Pareto" } }
                @if run.is_ok() && !distinguishable { span.chip { "not distinguishable" } }
                span.title { (run.title) }
            }
            @if run.is_ok() {
                @for column in columns {
                    @match (column.value)(run) {
                        Some(value) => { td data-v=(sort_key(value)) { ((column.text)(value)) } }
                        None => { td { (NONE) } }
                    }
                }
            } @else {
                td.reason colspan=(columns.len()) { (run.status) }
            }
        }
    }
}

/// Errors of each light, where a role has several images.
pub fn lights(report: &Report, runs: &[usize]) -> Markup {
    let of = |i: &usize| report.runs[*i].error.as_ref().map_or(0, |e| e.lights.len());
    html! {
        @if runs.iter().any(|i| of(i) > 1) {
            details {
                summary { "Errors of each light" }
                div.scroll tabindex="0" role="region" aria-label="Errors of each light" { table {
                    thead { tr { th.technique scope="col" { "technique" } th scope="col" { "light" } th scope="col" { "RMSE" } th scope="col" { "off border" } th scope="col" { "border px" } } }
                    tbody {
                        @for &i in runs { @for light in report.runs[i].error.iter().flat_map(|e| &e.lights) {
                            tr {
                                th.technique scope="row" { (report.runs[i].label()) }
                                td { (light.light) }
                                td { (number(Some(light.rmse))) }
                                td { (percent(Some(light.off_border_mismatch))) }
                                td { (number(light.border_px)) }
                            }
                        } }
                    }
                } }
            }
        }
    }
}

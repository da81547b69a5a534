//! All numbers of all runs, sortable by any column.

use super::format::{NONE, bytes, count, number, percent};
use crate::report::{Decision, Report, Run};
use maud::{Markup, html};

/// A column: heading, what it means, text and the value it sorts by.
struct Column {
    heading: &'static str,
    help: &'static str,
    cell: fn(&Run) -> (String, Option<f64>),
    /// Left out when no run has a value.
    optional: bool,
}

/// A column of plain numbers.
macro_rules! numbers {
    ($heading:literal, $help:literal, $value:expr, $format:expr, $optional:literal) => {
        Column {
            heading: $heading,
            help: $help,
            cell: |run| {
                let value: Option<f64> = ($value)(run);
                (($format)(value), value)
            },
            optional: $optional,
        }
    };
}

const COLUMNS: [Column; 19] = [
    numbers!("GPU ms", "median time of the technique's passes on the device", |r: &Run| r.cost.as_ref()?.gpu_ms, number, false),
    numbers!("p95", "95th percentile of the same, ms", |r: &Run| r.cost.as_ref()?.gpu_ms_p95, number, false),
    numbers!("RMSE", "root mean square error against the reference", |r: &Run| Some(r.error.as_ref()?.image.rmse), number, false),
    numbers!("bias", "what averaging frames would not remove, RMS", |r: &Run| r.error.as_ref()?.bias, number, true),
    numbers!("noise", "what averaging frames would remove, RMS", |r: &Run| r.error.as_ref()?.noise, number, true),
    Column { heading: "verdict", help: "biased: more than the noise of seeds and reference explains", cell: verdict, optional: true },
    numbers!("FLIP", "difference that a viewer sees, 0 to 1", |r: &Run| Some(r.error.as_ref()?.image.flip), number, false),
    numbers!("HDR-FLIP", "the same over all exposures", |r: &Run| r.error.as_ref()?.image.flip_hdr, number, true),
    numbers!("SSIM", "structural similarity, 1 is equal", |r: &Run| r.error.as_ref()?.image.ssim, decimals, false),
    Column { heading: "PSNR", help: "peak signal-to-noise ratio, dB", cell: psnr, optional: false },
    numbers!("relMSE", "relative mean square error", |r: &Run| Some(r.error.as_ref()?.image.rel_mse), number, false),
    numbers!("mean", "mean of the image over mean of the reference", |r: &Run| r.error.as_ref()?.image.mean_ratio, decimals, false),
    numbers!(
        "off border",
        "pixels in the wrong light, away from shadow borders",
        |r: &Run| r.error.as_ref()?.off_border_mismatch,
        percent,
        true
    ),
    numbers!("border px", "mean distance between the shadow borders, px", |r: &Run| r.error.as_ref()?.border_px, number, true),
    numbers!(
        "composed",
        "RMSE of the composed picture against the path tracer's",
        |r: &Run| Some(r.error.as_ref()?.composed.as_ref()?.image.rmse),
        number,
        true
    ),
    numbers!(
        "approx.",
        "the part of composed that the technique can be blamed for, RMSE; the rest is light that is not simulated",
        |r: &Run| r.error.as_ref()?.composed.as_ref()?.approximation_rmse,
        number,
        true
    ),
    numbers!("frame ms", "median wall-clock time of a whole frame", |r: &Run| Some(r.cost.as_ref()?.cpu_ms), number, false),
    Column { heading: "memory", help: "what the technique keeps on the device", cell: memory, optional: false },
    Column { heading: "rays", help: "rays traced in a frame", cell: rays, optional: true },
];

fn decimals(value: Option<f64>) -> String {
    value.map_or_else(|| NONE.into(), |v| format!("{v:.4}"))
}

fn verdict(run: &Run) -> (String, Option<f64>) {
    let label = run.error.as_ref().and_then(|e| e.label);
    (label.unwrap_or(NONE).into(), label.map(|l| f64::from(u8::from(l == "biased"))))
}

/// An infinite PSNR sorts above all others.
fn psnr(run: &Run) -> (String, Option<f64>) {
    match run.error.as_ref().map(|e| e.image.psnr) {
        Some(Some(db)) => (format!("{db:.1}"), Some(db)),
        Some(None) => ("∞".into(), Some(1e9)),
        None => (NONE.into(), None),
    }
}

fn memory(run: &Run) -> (String, Option<f64>) {
    let value = run.cost.as_ref().map(|c| c.memory_bytes);
    (value.map_or_else(|| NONE.into(), bytes), value.map(|v| v as f64))
}

fn rays(run: &Run) -> (String, Option<f64>) {
    let value = run.cost.as_ref().map(|c| c.rays).filter(|&rays| rays > 0);
    (value.map_or_else(|| NONE.into(), count), value.map(|v| v as f64))
}

/// The table of one scene and role.
pub fn runs(report: &Report, decision: Option<&Decision>, runs: &[usize], section: usize) -> Markup {
    let columns: Vec<&Column> =
        COLUMNS.iter().filter(|c| !c.optional || runs.iter().any(|&i| (c.cell)(&report.runs[i]).1.is_some())).collect();
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
                    @let (text, value) = (column.cell)(run);
                    td data-v=[value] { (text) }
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

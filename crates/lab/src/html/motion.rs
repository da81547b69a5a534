//! Behaviour over time: what each technique does on moving sequences, and how it follows a light that jumps; and what techniques count.

use super::format::{NONE, number, percent};
use crate::report::{Report, Run};
use maud::{Markup, html};

const WIDTH: f64 = 160.0;
const HEIGHT: f64 = 36.0;

/// Share of the way that counts as followed.
const FOLLOWED: f64 = 0.95;

/// A table of sequences; nothing where none were rendered.
pub fn sequences(report: &Report, runs: &[usize]) -> Markup {
    let shown: Vec<&Run> = runs.iter().map(|&i| &report.runs[i]).filter(|run| !run.temporal.sequences.is_empty()).collect();
    html! {
        @if !shown.is_empty() {
            details {
                summary { "Behaviour over time" }
                div.scroll tabindex="0" role="region" aria-label="Behaviour over time" { table {
                    thead { tr {
                        th.technique scope="col" { "technique" } th scope="col" { "what moves" } th scope="col" { "flicker" } th scope="col" { "ghost" }
                        th scope="col" { "RMSE" } th scope="col" { "after a light has jumped" }
                    } }
                    tbody {
                        @for run in &shown { @for (i, sequence) in run.temporal.sequences.iter().enumerate() {
                            tr {
                                th.technique scope="row" { (run.label()) }
                                td { (sequence.motion) }
                                td { (number(sequence.flicker)) }
                                td { (percent(sequence.ghost)) }
                                td { (number(Some(sequence.rmse))) }
                                @if i == 0 { td rowspan=(run.temporal.sequences.len()) { (response(&run.temporal.response)) } }
                            }
                        } }
                    }
                } }
            }
        }
    }
}

/// The way gone, frame by frame, with the line at which it counts as followed.
fn response(ways: &[f64]) -> Markup {
    if ways.is_empty() {
        return html! { (NONE) };
    }
    let at = |frame: usize, way: f64| {
        let (x, y) = (frame as f64 / ways.len() as f64 * WIDTH, HEIGHT - way.clamp(0.0, 1.1) / 1.1 * HEIGHT);
        format!("{x:.1},{y:.1}")
    };
    let line: Vec<String> = std::iter::once(at(0, 0.0)).chain(ways.iter().enumerate().map(|(i, way)| at(i + 1, *way))).collect();
    let followed = HEIGHT - FOLLOWED / 1.1 * HEIGHT;
    let frames = ways.iter().take_while(|way| **way < FOLLOWED).count();
    html! {
        svg width=(WIDTH) height=(HEIGHT) viewBox=(format!("0 0 {WIDTH} {HEIGHT}")) role="img" aria-label=(format!("{frames} frames behind")) {
            line x1="0" x2=(WIDTH) y1=(followed) y2=(followed) stroke="currentColor" stroke-opacity="0.3" {}
            polyline points=(line.join(" ")) fill="none" stroke="currentColor" stroke-width="1.5" {}
        }
        " " (frames) " frames behind"
    }
}

/// What techniques counted in a frame, light by light; nothing where none does.
pub fn counts(report: &Report, runs: &[usize]) -> Markup {
    let of = |i: usize| report.runs[i].cost.iter().flat_map(|cost| &cost.statistics);
    html! {
        @if runs.iter().any(|&i| of(i).next().is_some()) {
            details {
                summary { "What techniques count" }
                div.scroll tabindex="0" role="region" aria-label="What techniques count" { table {
                    thead { tr { th.technique scope="col" { "technique" } th scope="col" { "count" } th scope="col" { "for each light" } } }
                    tbody {
                        @for &i in runs { @for (name, values) in of(i) {
                            tr {
                                th.technique scope="row" { (report.runs[i].label()) }
                                td { (name) }
                                td { (values.iter().map(u64::to_string).collect::<Vec<_>>().join(", ")) }
                            }
                        } }
                    }
                } }
            }
        }
    }
}

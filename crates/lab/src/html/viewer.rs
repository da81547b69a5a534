//! The pictures: a slider between technique and reference, the error, and where it is worst.

use super::format::data_uri;
use super::{Pictures, RunPictures};
use crate::report::{Decision, Report};
use maud::{Markup, html};

/// The viewer of one scene and role; nothing without pictures.
pub fn pictures(report: &Report, pictures: &Pictures, decision: Option<&Decision>, runs: &[usize], section: usize) -> Markup {
    let shown: Vec<(usize, usize, &RunPictures)> = runs
        .iter()
        .enumerate()
        .filter_map(|(number, &i)| pictures.runs.get(i).and_then(Option::as_ref).map(|p| (number + 1, i, p)))
        .collect();
    let (Some(reference), false) = (pictures.references.get(section).and_then(Option::as_ref), shown.is_empty()) else {
        return html! {};
    };
    let first = decision.and_then(|d| d.recommended).filter(|r| shown.iter().any(|s| s.1 == *r)).unwrap_or(shown[0].1);
    let ratio = format!("aspect-ratio: {} / {}", reference.width(), reference.height());
    html! {
        div.viewer {
            h3 { "Look for yourself" }
            div.choices role="group" aria-label="Run to show" {
                @for (number, i, _) in &shown {
                    button type="button" data-run=(i) aria-pressed=(if *i == first { "true" } else { "false" }) {
                        span.n { (number) } " " (report.runs[*i].label())
                    }
                }
            }
            div.split style=(ratio) {
                img.reference src=(data_uri(reference)) alt="Path-traced reference";
                @for (_, i, p) in &shown {
                    img.shot data-run=(i) hidden[*i != first] src=(data_uri(&p.image)) alt=(format!("Image of {}", report.runs[*i].label()));
                }
                @for (_, i, p) in &shown {
                    img.heat data-run=(i) hidden src=(data_uri(&p.heat)) alt=(format!("Error of {}", report.runs[*i].label()));
                }
                span.tag.left aria-hidden="true" { "technique" }
                span.tag.right aria-hidden="true" { "reference" }
                span.bar aria-hidden="true" {}
                input type="range" min="0" max="100" value="50" aria-label="Share of the technique's image shown, the rest is the reference";
            }
            div.tools {
                button.toggle type="button" aria-pressed="false" { "Show the error" }
                @for (_, i, p) in &shown { span.scale data-run=(i) hidden[*i != first] { (p.heat_scale) } }
            }
            @for (_, i, p) in &shown { (crops(p, *i, *i != first)) }
        }
    }
}

fn crops(p: &RunPictures, run: usize, hidden: bool) -> Markup {
    html! {
        div.crops data-run=(run) hidden[hidden] {
            @for crop in &p.crops {
                figure {
                    div.triple {
                        @for (image, name) in crop.images.iter().zip(["technique", "reference", "error"]) {
                            div {
                                img src=(data_uri(image)) alt=(format!("{name} at column {}, row {}", crop.at[0], crop.at[1]));
                                span { (name) }
                            }
                        }
                    }
                    figcaption { "column " (crop.at[0]) ", row " (crop.at[1]) ", 4×" }
                }
            }
            @if p.crops.is_empty() { p.note { "No place of this image differs from the reference." } }
        }
    }
}

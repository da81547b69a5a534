//! The pictures: a slider between technique and reference, the error, and where it is worst.

use super::classes::legend;
use super::format::data_uri;
use super::{Pictures, ReferencePictures, RunPictures};
use crate::report::{Decision, Report};
use crate::temporal::FULL_SCALE;
use kajo_image::Image;
use kajo_units::Srgb8;
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
    let ratio = format!("aspect-ratio: {} / {}", reference.image.width(), reference.image.height());
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
                (references(reference))
                @for (_, i, p) in &shown { (shots(p, *i, *i == first, &report.runs[*i].label())) }
                span.tag.left aria-hidden="true" { "technique" }
                span.tag.right aria-hidden="true" { "reference" }
                span.bar aria-hidden="true" {}
                input type="range" min="0" max="100" value="50" aria-label="Share of the technique's image shown, the rest is the reference";
            }
            div.tools {
                div.views role="group" aria-label="What to show" {
                    @for (view, name) in views(report, section, reference, &shown) {
                        button type="button" data-view=(view) aria-pressed=(if view == "image" { "true" } else { "false" }) { (name) }
                    }
                }
                @if shown.iter().any(|(_, _, p)| p.failures.is_some()) {
                    @for (_, i, _) in &shown { span.scale data-view="failures" data-run=(i) hidden { (legend()) } }
                }
                @for (_, i, p) in &shown { span.scale data-view="error" data-run=(i) hidden { (p.heat_scale) } }
            }
            @for (_, i, p) in &shown { (crops(p, *i, *i != first)) }
            @for (_, i, p) in &shown { (films(p, *i, *i != first)) }
        }
    }
}

/// What can be shown: its key, and its name for people.
fn views(
    report: &Report,
    section: usize,
    reference: &ReferencePictures,
    shown: &[(usize, usize, &RunPictures)],
) -> Vec<(&'static str, String)> {
    let title = report.references.get(section).map_or_else(|| "image".to_owned(), |r| r.role_title.clone());
    let mut views = vec![("image", title)];
    if reference.composed.is_some() {
        views.push(("composed", "The picture with it".into()));
    }
    views.push(("error", "Its error".into()));
    if shown.iter().any(|(_, _, p)| p.failures.is_some()) {
        views.push(("failures", "How it fails".into()));
    }
    views
}

/// The error is shown over the reference of the role's image.
fn references(reference: &ReferencePictures) -> Markup {
    html! {
        img.under data-view="image error failures" src=(data_uri(&reference.image)) alt="Path-traced reference";
        @if let Some(composed) = &reference.composed {
            img.under data-view="composed" hidden src=(data_uri(composed)) alt="Path-traced picture";
        }
    }
}

fn shots(p: &RunPictures, run: usize, first: bool, label: &str) -> Markup {
    let shot = |view: &str, image: &Image<Srgb8>, what: &str| {
        let hidden = !first || view != "image";
        html! { img.shot data-view=(view) data-run=(run) hidden[hidden] src=(data_uri(image)) alt=(format!("{what} of {label}")); }
    };
    html! {
        (shot("image", &p.image, "Image"))
        @if let Some(composed) = &p.composed { (shot("composed", composed, "Picture")) }
        (shot("error", &p.heat, "Error"))
        @if let Some(failures) = &p.failures { (shot("failures", failures, "Failures")) }
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

/// Frames of each moving sequence side by side; nothing where none was rendered or none flickers.
fn films(p: &RunPictures, run: usize, hidden: bool) -> Markup {
    html! {
        div.films data-run=(run) hidden[hidden] {
            @for film in &p.films {
                figure {
                    div.scroll tabindex="0" role="region" aria-label=(format!("Frames in which this moves: {}", film.motion)) {
                        img src=(data_uri(&film.image)) width=(2 * film.image.width()) height=(2 * film.image.height())
                            alt=(format!("Technique, reference and difference at column {}, row {}, frame by frame", film.at[0], film.at[1]));
                    }
                    figcaption {
                        "What moves: " (film.motion) ". Frames " (numbers(&film.frames)) " where they flicker most (column " (film.at[0]) ", row " (film.at[1])
                        ", 2×): technique, reference, difference (black 0, pale yellow " (FULL_SCALE) " and more)"
                    }
                }
            }
        }
    }
}

fn numbers(frames: &[usize]) -> String {
    frames.iter().map(usize::to_string).collect::<Vec<_>>().join(", ")
}

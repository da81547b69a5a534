//! The report as one page: no other file, no host. It opens from a disk, in light and dark, on wide and narrow screens.
//!
//! The page reads as a decision: what to use, how sure that is, then the evidence (table, chart, pictures), then how it was measured.
//! Everything is in the markup; the script only sorts tables, moves sliders and copies the command.

mod cards;
mod chart;
mod classes;
mod format;
mod method;
mod motion;
mod table;
mod viewer;

pub(crate) use format::data_uri;

use crate::report::Report;
use crate::temporal::Film;
use kajo_image::Image;
use kajo_units::Srgb8;
use maud::{DOCTYPE, Markup, PreEscaped, html};

/// Pictures of the page; the lists have the order of the report's.
#[derive(Clone, Debug, Default)]
pub struct Pictures {
    /// The reference of each scene and role.
    pub references: Vec<Option<ReferencePictures>>,
    /// Of each run that gave a result.
    pub runs: Vec<Option<RunPictures>>,
}

/// What a reference looks like.
#[derive(Clone, Debug)]
pub struct ReferencePictures {
    /// The role's image.
    pub image: Image<Srgb8>,
    /// The picture in which it is used.
    pub composed: Option<Image<Srgb8>>,
}

/// What a run looks like.
#[derive(Clone, Debug)]
pub struct RunPictures {
    /// The role's image.
    pub image: Image<Srgb8>,
    /// The picture in which it is used.
    pub composed: Option<Image<Srgb8>>,
    /// Error of `image`.
    pub heat: Image<Srgb8>,
    /// What the colours of `heat` mean.
    pub heat_scale: String,
    /// How it fails, in colours; of shadows.
    pub failures: Option<Image<Srgb8>>,
    /// Where it fails most.
    pub crops: Vec<CropPictures>,
    /// Frames of moving sequences.
    pub films: Vec<Film>,
}

/// A place of failure, in the pixels of the image.
#[derive(Clone, Debug)]
pub struct CropPictures {
    /// Column and row of its corner.
    pub at: [u32; 2],
    /// Technique, reference, error.
    pub images: [Image<Srgb8>; 3],
}

/// Nothing is loaded from anywhere: the browser enforces it.
pub(crate) const POLICY: &str =
    "default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'; base-uri 'none'; form-action 'none'";

/// The page.
pub fn page(report: &Report, pictures: &Pictures) -> String {
    let title = cards::title(report);
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                meta http-equiv="Content-Security-Policy" content=(POLICY);
                title { (title) " · Kajo" }
                style { (PreEscaped(include_str!("style.css"))) }
            }
            body {
                a.skip href="#decisions" { "To the decision" }
                (cards::header(report, &title))
                main {
                    (cards::warnings(report))
                    (cards::decisions(report))
                    @for index in 0..report.references.len() { (section(report, pictures, index)) }
                    (method::skipped_and_ignored(report))
                    (method::how_it_was_measured(report))
                }
                script { (PreEscaped(include_str!("script.js"))) }
            }
        }
    }
    .into_string()
}

/// The evidence for one scene and role.
fn section(report: &Report, pictures: &Pictures, index: usize) -> Markup {
    let reference = &report.references[index];
    let runs: Vec<usize> =
        (0..report.runs.len()).filter(|&i| report.runs[i].scene == reference.scene && report.runs[i].role == reference.role).collect();
    let decision = report.decisions.iter().find(|d| d.scene == reference.scene && d.role == reference.role);
    html! {
        section.evidence id=(format!("evidence-{index}")) {
            header.section-head {
                p.eyebrow { (reference.scene) }
                h2 { (reference.role_title) }
                p.what { "Every technique estimates " span.math { (reference.estimates) } ". Unit: " (reference.unit) "."
                    @if let Some(distance) = reference.ambient_distance { " Surfaces block up to " (distance) " m." } }
            }
            (cards::reference(reference))
            @if let Some(decision) = decision { (chart::error_and_cost(report, decision, &runs, reference.rmse_floor, index)) }
            (table::runs(report, decision, &runs, index))
            (viewer::pictures(report, pictures, decision, &runs, index))
            (table::lights(report, &runs))
            (classes::failures(report, &runs))
            (classes::confusion(report, &runs))
            (motion::sequences(report, &runs))
            (motion::counts(report, &runs))
        }
    }
}

#[cfg(test)]
mod tests;

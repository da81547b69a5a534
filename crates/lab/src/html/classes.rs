//! How shadows fail: shares of each class of failure, and which of umbra, penumbra and lit is taken for which.

use super::format::percent;
use crate::failures::Class;
use crate::report::Report;
use kajo_image_metrics::ShadowClass;
use kajo_units::Srgb8;
use maud::{Markup, html};

fn swatch(Srgb8([r, g, b]): Srgb8) -> Markup {
    html! { span.swatch aria-hidden="true" style=(format!("background: rgb({r} {g} {b})")) {} }
}

/// What the colours of a mask of failures mean.
pub fn legend() -> Markup {
    html! { @for class in Class::ALL { (swatch(class.color())) " " (class.id()) " " } }
}

/// Shares of each class of failure.
pub fn failures(report: &Report, runs: &[usize]) -> Markup {
    let told = |i: &usize| !report.runs[*i].failures.is_empty();
    html! {
        @if runs.iter().any(told) {
            details {
                summary { "How shadows fail" }
                p.note { "Shares of the pixels that show a surface within the reach of a light, lights counted one by one, in the mean over all takes. The masks are among the pictures." }
                div.scroll tabindex="0" role="region" aria-label="How shadows fail" { table {
                    thead { tr {
                        th.technique scope="col" { "technique" }
                        @for class in Class::ALL { th scope="col" title=(class.meaning()) { (swatch(class.color())) " " (class.id()) } }
                    } }
                    tbody {
                        @for &i in runs.iter().filter(|i| told(i)) {
                            tr {
                                th.technique scope="row" { (report.runs[i].label()) }
                                @for class in Class::ALL { td { (percent(report.runs[i].failures.get(class.id()).copied())) } }
                            }
                        }
                    }
                } }
                dl.definitions { @for class in Class::ALL { div { dt { (class.id()) } dd { (class.meaning()) } } } }
            }
        }
    }
}

/// Which class of the reference a technique takes for which.
pub fn confusion(report: &Report, runs: &[usize]) -> Markup {
    let table = |i: usize| report.runs[i].error.as_ref().and_then(|error| error.shadow_classes);
    html! {
        @if runs.iter().any(|&i| table(i).is_some()) {
            details {
                summary { "Umbra, penumbra and light" }
                p.note {
                    "Shares of the pixels that show a surface, lights counted one by one, by their class in the reference and in the mean over all takes. Umbra: none of the light is seen; "
                    "penumbra: a part of it; lit: all."
                }
                div.scroll tabindex="0" role="region" aria-label="Umbra, penumbra and light" { table {
                    thead { tr {
                        th.technique scope="col" { "technique" } th scope="col" { "agree" }
                        @for reference in ShadowClass::ALL { @for image in ShadowClass::ALL {
                            th scope="col" title=(format!("{} in the reference, {} in the image", reference.name(), image.name())) {
                                (swatch(reference.color())) "→" (swatch(image.color())) " " (reference.name()) " as " (image.name())
                            }
                        } }
                    } }
                    tbody {
                        @for (i, confusion) in runs.iter().filter_map(|&i| Some((i, table(i)?))) {
                            tr {
                                th.technique scope="row" { (report.runs[i].label()) }
                                td { (percent(Some(confusion.agreement()))) }
                                @for row in confusion.rows() { @for share in row.to_array() { td { (percent(Some(share))) } } }
                            }
                        }
                    }
                } }
            }
        }
    }
}

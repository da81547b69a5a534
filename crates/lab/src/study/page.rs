//! The page of a study: one file, as the report of a comparison.

use super::plot::svg;
use super::{Findings, Study, Table};
use crate::html::{POLICY, data_uri};
use crate::report::DeviceEntry;
use maud::{DOCTYPE, Markup, PreEscaped, html};

/// The page.
pub fn page(study: &Study, findings: &Findings, device: &DeviceEntry) -> String {
    let confirmed = findings.claims.iter().filter(|claim| claim.holds).count();
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                meta http-equiv="Content-Security-Policy" content=(POLICY);
                title { (study.title) " · Kajo" }
                style { (PreEscaped(include_str!("../html/style.css"))) }
            }
            body {
                header.top {
                    p.brand { span.sun aria-hidden="true" {} "Kajo" span.version { (env!("CARGO_PKG_VERSION")) } }
                    h1 { (study.title) }
                    @for paragraph in study.doc.trim().split("\n\n") { (text(paragraph)) }
                }
                main {
                    section.evidence {
                        header.section-head { h2 { (confirmed) " of " (findings.claims.len()) " claims hold" } }
                        ul { @for claim in &findings.claims {
                            li { strong { @if claim.holds { "Holds. " } @else { "Does not hold. " } } (claim.text) " " span.where { (claim.measured) } }
                        } }
                    }
                    @for plot in &findings.plots {
                        figure.chart { figcaption { strong { (plot.caption) } } (PreEscaped(svg(plot))) }
                    }
                    @for table in &findings.tables { (numbers(table)) }
                    @for picture in &findings.pictures {
                        figure.chart {
                            figcaption { (picture.caption) }
                            img src=(data_uri(&picture.image)) alt=(picture.caption) style="width: 100%; image-rendering: pixelated";
                        }
                    }
                    section.method { p.note { "Measured on " (device.name) ", " (device.driver) ", " (device.backend) ". Repeat: " code { "kajo study " (study.id) " -o DIR" } } }
                }
            }
        }
    }
    .into_string()
}

/// A paragraph; an indented one is a formula.
fn text(paragraph: &str) -> Markup {
    html! { @if paragraph.starts_with("    ") { pre { (paragraph) } } @else { p.lead { (paragraph) } } }
}

fn numbers(table: &Table) -> Markup {
    html! {
        div.scroll tabindex="0" role="region" aria-label=(table.caption) { table {
            caption { (table.caption) }
            thead { tr { @for (i, column) in table.columns.iter().enumerate() { th.technique[i == 0] scope="col" { (column) } } } }
            tbody { @for row in &table.rows { tr {
                @for (i, cell) in row.iter().enumerate() {
                    @if i == 0 { th.technique scope="row" { (cell.shown()) } } @else { td { (cell.shown()) } }
                }
            } } }
        } }
    }
}

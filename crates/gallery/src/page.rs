//! The page: every plate with its pictures, its numbers and its files. It needs the files beside it and nothing else, and no script.

use crate::check::{Check, Expected};
use crate::plates::Plate;
use crate::{Gallery, Section, Shown};
use maud::{DOCTYPE, Markup, PreEscaped, html};

/// Nothing is loaded from any host: the browser enforces it.
const POLICY: &str = "default-src 'none'; img-src 'self' file: data:; style-src 'unsafe-inline'; base-uri 'none'; form-action 'none'";

pub fn page(gallery: &Gallery) -> String {
    let checks = gallery.checks().count();
    let held = gallery.checks().filter(|check| check.holds).count();
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                meta http-equiv="Content-Security-Policy" content=(POLICY);
                title { "Reflectance models · Kajo" }
                style { (PreEscaped(include_str!("page.css"))) }
            }
            body {
                a.skip href="#plates" { "To the pictures" }
                header.top {
                    p.brand { span.sun aria-hidden="true" {} "Kajo" span.version { (gallery.kajo) } }
                    h1 { "How surfaces reflect" }
                    p.lead {
                        "The models of reflectance as pictures, and what the pictures measure: " strong { (held) " of " (checks) " measurements" }
                        " are what the equations say. Every picture can be opened, with its numbers, in the formats named below it."
                    }
                }
                nav aria-label="Plates" {
                    @for section in &gallery.sections {
                        div { span.group { (section.title) } @for plate in &section.plates { a href=(format!("#{}", plate.id)) { (short_name(plate)) } " " } }
                    }
                }
                main id="plates" {
                    @for section in &gallery.sections { (section_of(section)) }
                    section.method {
                        h2 { "To repeat it" }
                        pre tabindex="0" { code { (gallery.command) } }
                        p { "The numbers of this page as data: " a href="report.json" { "report.json" } "." }
                    }
                }
            }
        }
    }
    .into_string()
}

fn short_name(plate: &Plate) -> &str {
    plate.title.split_once(" · ").map_or(&plate.title, |(number, _)| number)
}

fn section_of(section: &Section) -> Markup {
    html! {
        section {
            h2 { (section.title) }
            p.lead { (section.lead) }
            @for plate in &section.plates { (article(plate)) }
        }
    }
}

fn article(plate: &Plate) -> Markup {
    html! {
        article id=(plate.id) {
            h3 { a.anchor href=(format!("#{}", plate.id)) { (plate.title) } }
            p.caption { (plate.caption) }
            @for shown in plate.shown.iter().filter(|shown| shown.wide) { (figure(shown)) }
            div.beside { @for shown in plate.shown.iter().filter(|shown| !shown.wide) { (figure(shown)) } }
            @if !plate.parameters.is_empty() {
                details { summary { "Parameters" } ul.parameters { @for line in &plate.parameters { li { code { (line) } } } } }
            }
            @if !plate.checks.is_empty() { (checks(&plate.checks)) }
        }
    }
}

fn figure(shown: &Shown) -> Markup {
    html! {
        figure.wide[shown.wide] {
            a href=(shown.image) { img src=(shown.image) alt=(shown.alt) loading="lazy"; }
            figcaption { @for file in &shown.files { a href=(file) download { (ending(file)) } " " } }
        }
    }
}

fn ending(file: &str) -> String {
    let kind = file.rsplit('.').next().unwrap_or(file).to_uppercase();
    if file.contains("_level.") { format!("level view, {kind}") } else { kind }
}

fn checks(checks: &[Check]) -> Markup {
    let held = checks.iter().filter(|check| check.holds).count();
    html! {
        details open[held < checks.len()] {
            summary { (held) " of " (checks.len()) " measurements hold" @if held < checks.len() { strong.failed { " – look" } } }
            div.scroll tabindex="0" role="region" aria-label="Measurements" {
                table {
                    thead { tr { th scope="col" { "measured on the pixels" } th scope="col" { "found" } th scope="col" { "expected" } th scope="col" { "holds" } } }
                    tbody {
                        @for check in checks {
                            tr.failed[!check.holds] {
                                th scope="row" { (check.what) }
                                td { (number(check.measured)) }
                                td { (expected(check.expected)) }
                                td { @if check.holds { "yes" } @else { strong { "no" } } }
                            }
                        }
                    }
                }
            }
        }
    }
}

fn expected(expected: Expected) -> String {
    match expected {
        Expected::Near { value, within } => format!("{} ± {}", number(value), number(within)),
        Expected::AtLeast(least) => format!("≥ {}", number(least)),
        Expected::AtMost(most) => format!("≤ {}", number(most)),
    }
}

/// Six significant digits at most.
fn number(value: f64) -> String {
    if value == 0.0 {
        "0".into()
    } else if !(1e-4..1e6).contains(&value.abs()) {
        format!("{value:.3e}")
    } else {
        let digits = (5 - value.abs().log10().floor() as i32).max(0) as usize;
        let text = format!("{value:.digits$}");
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_holds_every_plate_and_says_what_fails() {
        let shown = Shown { image: "a.svg".into(), alt: "a < b".into(), files: vec!["a.svg".into(), "a.csv".into()], wide: false };
        let checks = vec![Check::near("one", 1.0, 1.0, 0.1), Check::at_most("two", 3.0, 2.0)];
        let plate = Plate { shown: vec![shown], checks, ..Plate::new("figure_1", "1 · First", "Look & see.") };
        let section = Section { title: "S".into(), lead: "L".into(), plates: vec![plate] };
        let html = page(&Gallery { kajo: "0".into(), command: "kajo".into(), sections: vec![section], files: vec![] });
        for part in [
            "id=\"figure_1\"",
            "alt=\"a &lt; b\"",
            "Look &amp; see.",
            "href=\"a.csv\"",
            "1 of 2 measurements",
            "<strong>no</strong>",
            "≤ 2",
        ] {
            assert!(html.contains(part), "{part}");
        }
        assert!(!html.contains("<script") && !html.contains("http:") && !html.contains("https:"));
    }

    #[test]
    fn numbers_keep_their_digits() {
        let numbers = [0.0, 0.286_807_1, 12.0, 9.487e-10, 1_234_567.0, -0.5, 123_456.7].map(number);
        assert_eq!(numbers, ["0", "0.286807", "12", "9.487e-10", "1.235e6", "-0.5", "123457"]);
    }
}

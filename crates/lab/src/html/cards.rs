//! The top of the page: what to use, and how far to believe it.

use super::format::{bytes, count, number, seconds};
use crate::report::{Certainty, Decision, ReferenceEntry, Report, short};
use maud::{Markup, html};

/// The page's headline.
pub fn title(report: &Report) -> String {
    let label = |d: &Decision| d.recommended.map(|run| report.runs[run].label());
    let Some(first) = report.decisions.first() else { return "Nothing was compared".into() };
    let role = role_title(report, first).to_lowercase();
    if report.decisions.iter().any(|d| d.role != first.role || label(d) != label(first)) {
        return "Which technique to use".into();
    }
    label(first).map_or_else(|| format!("No technique for {role}"), |label| format!("Use {label} for {role}"))
}

fn role_title<'a>(report: &'a Report, decision: &'a Decision) -> &'a str {
    report.references.iter().find(|r| r.role == decision.role).map_or(&decision.role, |r| &r.role_title)
}

/// Name, headline, what was compared.
pub fn header(report: &Report, title: &str) -> Markup {
    let mut scenes: Vec<&str> = report.runs.iter().map(|r| r.scene.as_str()).collect();
    scenes.dedup();
    let compared = report.runs.iter().filter(|r| r.is_ok()).count();
    html! {
        header.top {
            p.brand { span.sun aria-hidden="true" {} "Kajo" span.version { (report.kajo) } }
            h1 { (title) }
            p.lead {
                (compared) " runs on " (scenes.join(", "))
                @if let Some(budget) = report.settings.budget_ms { ", for a budget of " strong { (short(budget)) " ms" } }
                ", each judged by a path-traced image of the same light."
            }
        }
    }
}

/// What a reader must know first.
pub fn warnings(report: &Report) -> Markup {
    html! {
        @if !report.complete || !report.warnings.is_empty() {
            aside.warnings role="note" {
                @if !report.complete { p { strong { "Interrupted." } " Runs that had not been made are missing or listed as skipped." } }
                @for warning in &report.warnings { p { (warning) } }
            }
        }
    }
}

/// One card a scene and role.
pub fn decisions(report: &Report) -> Markup {
    html! {
        section #decisions aria-label="Recommendations" {
            @for (index, decision) in report.decisions.iter().enumerate() { (card(report, decision, index)) }
        }
    }
}

fn card(report: &Report, decision: &Decision, index: usize) -> Markup {
    let run = decision.recommended.map(|i| &report.runs[i]);
    html! {
        article.card {
            p.eyebrow { (role_title(report, decision)) " · " (decision.scene) }
            // A single decision is the headline already.
            @if report.decisions.len() > 1 { p.choice { @match run { Some(run) => (run.label()), None => "Nothing fits" } } }
            p.sentence { (reason(decision, run.map(|r| r.label()))) }
            p { (certainty(decision)) }
            @if let Some((error, cost)) = run.and_then(|r| r.error.as_ref().zip(r.cost.as_ref())) {
                dl.facts {
                    div { dt { "RMSE" } dd { (number(Some(error.image.rmse))) } }
                    div { dt { "FLIP" } dd { (number(Some(error.image.flip))) } }
                    div { dt { "cost" } dd { (number(Some(cost.ms()))) small { " ms" } } }
                    div { dt { "memory" } dd { (bytes(cost.memory_bytes)) } }
                }
            }
            p.more { a href=(format!("#evidence-{index}")) { "See the evidence" } }
        }
    }
}

/// The sentence without the name that stands above it.
fn reason(decision: &Decision, label: Option<String>) -> String {
    let rest = label.and_then(|label| decision.sentence.strip_prefix(&format!("Use {label}: ")).map(str::to_owned));
    let mut characters = rest.as_deref().unwrap_or(&decision.sentence).chars();
    characters.next().map_or_else(String::new, |c| c.to_uppercase().chain(characters).collect())
}

/// Standard errors beyond which their number says nothing more.
const FAR: f64 = 100.0;

/// How sure a decision is, in words and a mark that does not depend on colour.
fn certainty(decision: &Decision) -> Markup {
    let (class, mark, text) = match (decision.certainty, decision.sigmas) {
        (Certainty::Clear, Some(s)) if s > FAR => ("clear", "●", format!("Clear: the next is more than {FAR} standard errors away")),
        (Certainty::Clear, Some(s)) => ("clear", "●", format!("Clear: the next is {} standard errors away", short(s))),
        (Certainty::Clear, None) => ("clear", "●", "Clear: the reference is exact here".into()),
        (Certainty::Tie, _) => ("tie", "◐", format!("Tie: {} cannot be told apart, so cost decides", decision.ties.len() + 1)),
        (Certainty::OnlyOne, _) => ("only", "○", "No alternative was measured within the budget".into()),
        (Certainty::None, _) => ("only", "○", "No recommendation".into()),
    };
    html! { span.certainty .(class) { span aria-hidden="true" { (mark) } " " (text) } }
}

/// The judge, and how far it can be trusted.
pub fn reference(reference: &ReferenceEntry) -> Markup {
    let [width, height] = reference.size;
    html! {
        dl.facts.judge {
            div { dt { "reference" } dd { (reference.spp) small { " spp" } } }
            div { dt { "standard error" } dd {
                @match reference.relative_standard_error { Some(e) => { (short(100.0 * e)) small { " %" } }, None => (number(None)) }
            } }
            div { dt { "error floor" } dd { (number(Some(reference.rmse_floor))) } }
            div { dt { "rendered in" } dd { (seconds(reference.seconds)) } }
            div { dt { "rays" } dd { (count(reference.rays)) } }
            div { dt { "size" } dd { (width) "×" (height) } }
        }
        p.note {
            "Below the error floor (RMSE " (number(Some(reference.rmse_floor))) ") an error is noise of the reference, "
            "not of the technique: such runs are marked " em { "not distinguishable" } " and no order among them is claimed. Judged by "
            @for (i, name) in reference.judged_by.iter().enumerate() { @if i > 0 { ", " } code { (name) } } "."
        }
    }
}

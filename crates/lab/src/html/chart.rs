//! Error against cost, both logarithmic, with the Pareto front: what is on no staircase is never worth its time.

use super::format::number;
use crate::report::{Decision, Report, short};
use maud::{Markup, html};

const WIDTH: f64 = 860.0;
const HEIGHT: f64 = 420.0;
const LEFT: f64 = 78.0;
const RIGHT: f64 = 24.0;
const TOP: f64 = 22.0;
const BOTTOM: f64 = 56.0;

/// A logarithmic axis: values to pixels.
struct Axis {
    low: f64,
    high: f64,
    from: f64,
    to: f64,
}

impl Axis {
    /// Spans all positive values with a margin. Without any, one decade.
    fn new(values: impl Iterator<Item = f64> + Clone, from: f64, to: f64) -> Self {
        let positive = values.filter(|v| *v > 0.0 && v.is_finite());
        let low = positive.clone().fold(f64::INFINITY, f64::min);
        let high = positive.fold(0.0, f64::max);
        let (low, high) = if high > 0.0 { (low / 1.6, high * 1.6) } else { (0.1, 1.0) };
        // At least two ticks must fit.
        let (low, high) = if high / low < 6.0 { (low / 2.0, high * 2.0) } else { (low, high) };
        Self { low, high, from, to }
    }

    /// Values off the axis, 0 among them, stand at its end.
    fn at(&self, value: f64) -> f64 {
        let t = (value.clamp(self.low, self.high) / self.low).ln() / (self.high / self.low).ln();
        self.from + t * (self.to - self.from)
    }

    /// 1, 2, 5 of each decade, or the decades alone when there are many.
    fn ticks(&self) -> Vec<f64> {
        let decades = self.low.log10().floor() as i32..=self.high.log10().ceil() as i32;
        let steps: &[f64] = if (self.high / self.low).log10() < 2.6 { &[1.0, 2.0, 5.0] } else { &[1.0] };
        let all = decades.flat_map(|d| steps.iter().map(move |s| s * 10f64.powi(d)));
        all.filter(|v| (self.low..=self.high).contains(v)).collect()
    }
}

struct Point {
    number: usize,
    label: String,
    x: f64,
    y: f64,
    ms: f64,
    rmse: f64,
    on_front: bool,
    recommended: bool,
}

/// The chart; nothing when no run has a cost.
pub fn error_and_cost(report: &Report, decision: &Decision, runs: &[usize], floor: f64, section: usize) -> Markup {
    let measured = |&i: &usize| Some((i, report.runs[i].error.as_ref()?.image.rmse, report.runs[i].cost.as_ref()?.ms()));
    let values: Vec<(usize, f64, f64)> = runs.iter().filter_map(measured).collect();
    if values.is_empty() {
        return html! {};
    }
    let budget = decision.budget_ms;
    let x = Axis::new(values.iter().map(|v| v.2).chain(budget), LEFT, WIDTH - RIGHT);
    let y = Axis::new(values.iter().map(|v| v.1).chain([floor]), HEIGHT - BOTTOM, TOP);
    let points: Vec<Point> = values
        .iter()
        .map(|&(i, rmse, ms)| Point {
            number: 1 + runs.iter().position(|r| *r == i).expect("a run of this section"),
            label: report.runs[i].label(),
            x: x.at(ms),
            y: y.at(rmse),
            ms,
            rmse,
            on_front: decision.pareto.contains(&i),
            recommended: decision.recommended == Some(i),
        })
        .collect();
    let title = format!("chart-title-{section}");
    html! {
        figure.chart {
            figcaption { strong { "Error against cost" } " Lower left is better; the line joins the runs that nothing beats in both. Numbers as in the table." }
            svg viewBox=(format!("0 0 {WIDTH} {HEIGHT}")) role="img" aria-labelledby=(title) {
                title id=(title) { (description(&points)) }
                (axes(&x, &y))
                (floor_band(&y, floor))
                @if let Some(budget) = budget { (budget_line(&x, budget)) }
                (front(&points))
                @for point in points.iter().filter(|p| !p.recommended).chain(points.iter().filter(|p| p.recommended)) { (mark(point)) }
                @for (point, text_y) in placed_labels(&points) { (label(point, text_y)) }
            }
        }
    }
}

fn description(points: &[Point]) -> String {
    let list: Vec<String> =
        points.iter().map(|p| format!("{}: RMSE {} at {} ms", p.label, number(Some(p.rmse)), number(Some(p.ms)))).collect();
    format!("Error against cost. {}", list.join("; "))
}

fn axes(x: &Axis, y: &Axis) -> Markup {
    let (bottom, middle) = (HEIGHT - BOTTOM, (TOP + HEIGHT - BOTTOM) / 2.0);
    html! {
        g.axis aria-hidden="true" {
            @for tick in x.ticks() {
                line x1=(px(x.at(tick))) x2=(px(x.at(tick))) y1=(px(TOP)) y2=(px(bottom)) {}
                text x=(px(x.at(tick))) y=(px(bottom + 20.0)) text-anchor="middle" { (short(tick)) }
            }
            @for tick in y.ticks() {
                line x1=(px(LEFT)) x2=(px(WIDTH - RIGHT)) y1=(px(y.at(tick))) y2=(px(y.at(tick))) {}
                text x=(px(LEFT - 8.0)) y=(px(y.at(tick) + 4.0)) text-anchor="end" { (short(tick)) }
            }
            text.name x=(px((LEFT + WIDTH - RIGHT) / 2.0)) y=(px(HEIGHT - 10.0)) text-anchor="middle" { "cost of a frame, ms" }
            text.name x="16" y=(px(middle)) text-anchor="middle" transform=(format!("rotate(-90 16 {middle})")) { "error, RMSE" }
        }
    }
}

fn floor_band(y: &Axis, floor: f64) -> Markup {
    let (top, bottom) = (y.at(floor), HEIGHT - BOTTOM);
    html! {
        @if floor > 0.0 && bottom - top > 1.0 {
            g.floor aria-hidden="true" {
                rect x=(px(LEFT)) y=(px(top)) width=(px(WIDTH - RIGHT - LEFT)) height=(px(bottom - top)) {}
                text x=(px(WIDTH - RIGHT - 6.0)) y=(px(bottom - 6.0)) text-anchor="end" { "below the reference's own noise" }
            }
        }
    }
}

fn budget_line(x: &Axis, budget: f64) -> Markup {
    html! {
        g.budget aria-hidden="true" {
            line x1=(px(x.at(budget))) x2=(px(x.at(budget))) y1=(px(TOP)) y2=(px(HEIGHT - BOTTOM)) {}
            text x=(px(x.at(budget) + 5.0)) y=(px(TOP + 4.0)) { "budget " (short(budget)) " ms" }
        }
    }
}

/// A staircase: between two runs only the dearer's time buys the lower error.
fn front(points: &[Point]) -> Markup {
    let mut on: Vec<&Point> = points.iter().filter(|p| p.on_front).collect();
    on.sort_by(|a, b| a.x.total_cmp(&b.x));
    let mut path = String::new();
    for (i, p) in on.iter().enumerate() {
        path += &if i == 0 { format!("M{} {}", px(p.x), px(p.y)) } else { format!(" H{} V{}", px(p.x), px(p.y)) };
    }
    html! { @if on.len() > 1 { path.front d=(path) aria-hidden="true" {} } }
}

fn mark(p: &Point) -> Markup {
    let class = if p.recommended {
        "recommended"
    } else if p.on_front {
        "pareto"
    } else {
        "beaten"
    };
    html! {
        g.mark .(class) {
            title { (p.label) ": RMSE " (number(Some(p.rmse))) " at " (number(Some(p.ms))) " ms" }
            circle cx=(px(p.x)) cy=(px(p.y)) r=(if p.recommended { "13" } else { "10" }) {}
            text x=(px(p.x)) y=(px(p.y + 4.0)) text-anchor="middle" { (p.number) }
        }
    }
}

/// Names of the runs on the front, moved up or down where they would overlap.
fn placed_labels(points: &[Point]) -> Vec<(&Point, f64)> {
    const LINE: f64 = 15.0;
    const CHARACTER: f64 = 6.6;
    let mut placed: Vec<(&Point, f64)> = Vec::new();
    let mut named: Vec<&Point> = points.iter().filter(|p| p.on_front || p.recommended).collect();
    named.sort_by(|a, b| a.y.total_cmp(&b.y));
    for p in named {
        let mut text_y = p.y - 14.0;
        let overlaps = |y: f64, placed: &[(&Point, f64)]| {
            placed
                .iter()
                .any(|(q, qy)| (qy - y).abs() < LINE && (q.x - p.x).abs() < CHARACTER * 0.5 * (q.label.len() + p.label.len()) as f64)
        };
        if overlaps(text_y, &placed) || text_y < TOP {
            text_y = p.y + 26.0;
        }
        while overlaps(text_y, &placed) {
            text_y += LINE;
        }
        placed.push((p, text_y));
    }
    placed
}

fn label(p: &Point, text_y: f64) -> Markup {
    let anchor = if p.x > WIDTH * 0.8 {
        "end"
    } else if p.x < WIDTH * 0.2 {
        "start"
    } else {
        "middle"
    };
    html! { text.label .strong[p.recommended] x=(px(p.x)) y=(px(text_y)) text-anchor=(anchor) aria-hidden="true" { (p.label) } }
}

fn px(value: f64) -> String {
    format!("{value:.1}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axis_maps_its_ends_and_keeps_zero_on_the_paper() {
        let axis = Axis::new([0.01, 1.0, 0.0].into_iter(), 100.0, 500.0);
        assert!((axis.at(axis.low) - 100.0).abs() < 1e-9 && (axis.at(axis.high) - 500.0).abs() < 1e-9);
        assert_eq!(axis.at(0.0), 100.0);
        assert!(axis.at(0.1) > axis.at(0.05));
        let ticks = Axis::new([3.0].into_iter(), 0.0, 1.0).ticks();
        assert!(ticks.len() >= 2 && ticks.contains(&2.0), "{ticks:?}");
        assert!(Axis::new([].into_iter(), 0.0, 1.0).ticks().len() >= 2);
    }
}

//! Draws [`Figure`]s and [`Map`]s: one layout, as vectors (SVG) or as pixels (PNG).

mod map;
mod raster;
mod svg;

use crate::figures::Figure;
pub use map::{Map, map_png, map_svg};
use raster::Raster;
use svg::Svg;

/// Size of a picture, pixels.
const SIZE: [f64; 2] = [960.0, 600.0];
/// Left, top, right and bottom of the field of curves; the names of the curves are to its right.
const FIELD: [f64; 4] = [84.0, 48.0, 720.0, 530.0];
/// Distinguishable colours of curves, in turn.
const COLOURS: [[u8; 3]; 10] = [
    [31, 119, 180],
    [255, 127, 14],
    [44, 160, 44],
    [214, 39, 40],
    [148, 103, 189],
    [140, 86, 75],
    [227, 119, 194],
    [90, 90, 90],
    [170, 170, 20],
    [23, 190, 207],
];
const INK: [u8; 3] = [20, 20, 20];
const GRID: [u8; 3] = [222, 222, 222];

/// Where text stands from its point.
#[derive(Clone, Copy)]
enum Anchor {
    Start,
    Middle,
    End,
}

/// What is drawn on; y downwards.
trait Canvas {
    fn line(&mut self, points: &[[f64; 2]], colour: [u8; 3], width: f64);
    /// Fills from left, top to right, bottom.
    fn cell(&mut self, area: [f64; 4], colour: [u8; 3]);
    /// One line of text, its middle at the height of `at`; `upwards` turns it by 90°.
    fn text(&mut self, at: [f64; 2], text: &str, anchor: Anchor, upwards: bool);
}

/// The figure as an SVG document.
pub fn svg(figure: &Figure) -> String {
    let mut canvas = Svg::new(SIZE);
    draw(figure, &mut canvas);
    canvas.finish()
}

/// The figure as a PNG file.
pub fn png(figure: &Figure) -> Vec<u8> {
    let mut canvas = Raster::new(SIZE);
    draw(figure, &mut canvas);
    canvas.finish()
}

fn draw(figure: &Figure, canvas: &mut impl Canvas) {
    let ranges = ranges(figure);
    let [left, top, right, bottom] = FIELD;
    let x_at = |x: f64| left + (x - ranges[0][0]) / (ranges[0][1] - ranges[0][0]) * (right - left);
    let y_at = |y: f64| bottom - (y - ranges[1][0]) / (ranges[1][1] - ranges[1][0]) * (bottom - top);
    for (x, label) in ticks(ranges[0]) {
        canvas.line(&[[x_at(x), top], [x_at(x), bottom]], GRID, 1.0);
        canvas.text([x_at(x), bottom + 16.0], &label, Anchor::Middle, false);
    }
    for (y, label) in ticks(ranges[1]) {
        canvas.line(&[[left, y_at(y)], [right, y_at(y)]], GRID, 1.0);
        canvas.text([left - 8.0, y_at(y)], &label, Anchor::End, false);
    }
    canvas.line(&[[left, top], [left, bottom], [right, bottom]], INK, 1.0);
    canvas.text([(left + right) / 2.0, top / 2.0], &figure.title, Anchor::Middle, false);
    canvas.text([(left + right) / 2.0, bottom + 44.0], &figure.axes[0], Anchor::Middle, false);
    canvas.text([18.0, (top + bottom) / 2.0], &figure.axes[1], Anchor::Middle, true);
    for (k, curve) in figure.curves.iter().enumerate() {
        let colour = COLOURS[k % COLOURS.len()];
        let points: Vec<[f64; 2]> = curve.points.iter().map(|[x, y]| [x_at(*x), y_at(*y)]).collect();
        canvas.line(&points, colour, 2.0);
        let y = top + 12.0 + 22.0 * k as f64;
        canvas.line(&[[right + 16.0, y], [right + 40.0, y]], colour, 2.0);
        canvas.text([right + 46.0, y], &curve.name, Anchor::Start, false);
    }
}

/// From and to of each axis; 0 is on the second.
fn ranges(figure: &Figure) -> [[f64; 2]; 2] {
    let mut ranges = [[f64::INFINITY, f64::NEG_INFINITY], [0.0, 0.0]];
    for point in figure.curves.iter().flat_map(|curve| &curve.points) {
        for (range, value) in ranges.iter_mut().zip(point) {
            *range = [range[0].min(*value), range[1].max(*value)];
        }
    }
    for range in &mut ranges {
        if range[1] <= range[0] {
            *range = [if range[0].is_finite() { range[0] } else { 0.0 }; 2];
            range[1] += 1.0;
        }
    }
    if figure.equal_scales {
        let pixels = [FIELD[2] - FIELD[0], FIELD[3] - FIELD[1]];
        let unit = (0..2).map(|k| (ranges[k][1] - ranges[k][0]) / pixels[k]).fold(0.0, f64::max);
        let middle = (ranges[0][0] + ranges[0][1]) / 2.0;
        ranges[0] = [middle - unit * pixels[0] / 2.0, middle + unit * pixels[0] / 2.0];
        ranges[1][1] = ranges[1][0] + unit * pixels[1];
    }
    ranges
}

/// Round values within a range, five to ten, with their text.
fn ticks([from, to]: [f64; 2]) -> Vec<(f64, String)> {
    let rough = (to - from) / 10.0;
    let decade = 10_f64.powf(rough.log10().floor());
    let step = decade * [1.0, 2.0, 5.0, 10.0].into_iter().find(|step| step * decade >= rough * (1.0 - 1e-9)).unwrap_or(10.0);
    let digits = (-step.log10().floor()).max(0.0) as usize;
    let (first, last) = ((from / step - 1e-9).ceil() as i64, (to / step + 1e-9).floor() as i64);
    (first..=last).map(|k| k as f64 * step).map(|value| (value, format!("{value:.digits$}"))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::{Curve, survey_figure};

    #[test]
    fn ticks_are_round_and_inside() {
        let text = |range| ticks(range).into_iter().map(|(_, text)| text).collect::<Vec<_>>().join(" ");
        assert_eq!(text([0.0, 90.0]), "0 10 20 30 40 50 60 70 80 90");
        assert_eq!(text([0.0, 1.0]), "0.0 0.1 0.2 0.3 0.4 0.5 0.6 0.7 0.8 0.9 1.0");
        assert_eq!(text([-0.011, 0.028]), "-0.010 -0.005 0.000 0.005 0.010 0.015 0.020 0.025");
    }

    /// Row BR-38: the picture shows the curve where its points are.
    #[test]
    fn pixels_show_the_curve_at_its_points() {
        let figure = survey_figure("2.2").unwrap();
        let bytes = png(&figure);
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        let colour = |x: f64, y: f64| {
            let at = (y.floor() as usize * SIZE[0] as usize + x.floor() as usize) * 3;
            [pixels[at], pixels[at + 1], pixels[at + 2]]
        };
        // n = 1, the only curve high up at 60°: cos 60° = ½.
        let x = FIELD[0] + (FIELD[2] - FIELD[0]) * 60.0 / 90.0;
        let middle = (FIELD[1] + FIELD[3]) / 2.0;
        let distance = |colour: [u8; 3]| colour.iter().zip(COLOURS[0]).map(|(a, b)| a.abs_diff(b)).max().unwrap();
        assert!(distance(colour(x, middle)) < 40, "{:?}", colour(x, middle));
        assert!(distance(colour(x, middle + 12.0)) > 100, "planted fault: not everything has the curve's colour");
        assert!(svg(&figure).matches("<polyline").count() > 6 && svg(&figure).contains(">n = 200</text>"));
    }

    #[test]
    fn empty_and_flat_figures_are_drawn() {
        let curve = Curve { name: "<a & b>".into(), points: vec![[1.0, 0.0], [1.0, 0.0]] };
        for curves in [vec![], vec![curve]] {
            let figure = Figure { name: "f".into(), title: "t".into(), axes: ["x".into(), "y".into()], curves, equal_scales: true };
            assert!(!png(&figure).is_empty() && !svg(&figure).contains("NaN") && !svg(&figure).contains("<a"));
        }
    }
}

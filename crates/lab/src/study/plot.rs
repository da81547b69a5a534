//! Curves over one quantity, as SVG that needs nothing else.

use crate::report::short;
use serde::Serialize;

/// Curves with their axes.
#[derive(Clone, Debug, Serialize)]
pub struct Plot {
    /// Of its file.
    pub name: String,
    /// What it shows.
    pub caption: String,
    /// Names of x and y, with units.
    pub axes: [String; 2],
    /// How each is divided.
    pub scales: [Scale; 2],
    /// The curves.
    pub series: Vec<Series>,
}

/// How an axis is divided.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Scale {
    /// Evenly, from 0 where all values are positive.
    Linear,
    /// By factors; what is not above 0 stands at the lower end.
    Logarithmic,
}

/// A curve.
#[derive(Clone, Debug, Serialize)]
pub struct Series {
    /// Its name.
    pub name: String,
    /// Its points, x and y.
    pub points: Vec<[f64; 2]>,
}

const WIDTH: f64 = 860.0;
const HEIGHT: f64 = 440.0;
/// Left, top, right and bottom of the field; the names of the curves stand to its right.
const FIELD: [f64; 4] = [78.0, 16.0, 600.0, 384.0];

/// Told apart by people who see few colours, on dark and on light.
const COLORS: [&str; 8] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#a98600", "#56b4e9", "#7f7f7f", "#8c564b"];

/// The plot as an SVG document.
pub fn svg(plot: &Plot) -> String {
    let [left, top, right, bottom] = FIELD;
    let values = |axis: usize| plot.series.iter().flat_map(move |s| s.points.iter().map(move |p| p[axis]));
    let x = Axis::new(plot.scales[0], values(0), [left, right]);
    let y = Axis::new(plot.scales[1], values(1), [bottom, top]);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" aria-label=\"{}\" font-family=\"system-ui, \
         sans-serif\" font-size=\"13\" fill=\"currentColor\" color=\"#6a665d\">\n",
        escaped(&plot.caption)
    );
    for tick in x.ticks() {
        let at = x.at(tick);
        out += &format!("<line x1=\"{at:.1}\" x2=\"{at:.1}\" y1=\"{top}\" y2=\"{bottom}\" stroke=\"currentColor\" opacity=\"0.2\"/>\n");
        out += &format!("<text x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>\n", bottom + 20.0, short(tick));
    }
    for tick in y.ticks() {
        let at = y.at(tick);
        out += &format!("<line x1=\"{left}\" x2=\"{right}\" y1=\"{at:.1}\" y2=\"{at:.1}\" stroke=\"currentColor\" opacity=\"0.2\"/>\n");
        out += &format!("<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>\n", left - 8.0, at + 4.0, short(tick));
    }
    let (middle_x, middle_y) = (0.5 * (left + right), 0.5 * (top + bottom));
    out += &format!("<text x=\"{middle_x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>\n", HEIGHT - 12.0, escaped(&plot.axes[0]));
    out += &format!(
        "<text x=\"16\" y=\"{middle_y:.1}\" text-anchor=\"middle\" transform=\"rotate(-90 16 {middle_y:.1})\">{}</text>\n",
        escaped(&plot.axes[1])
    );
    for (index, series) in plot.series.iter().enumerate() {
        let color = COLORS[index % COLORS.len()];
        // The second round of colours is dashed.
        let dash = if index >= COLORS.len() { " stroke-dasharray=\"6 4\"" } else { "" };
        let points: Vec<[f64; 2]> = series.points.iter().filter(|p| p[1].is_finite()).map(|p| [x.at(p[0]), y.at(p[1])]).collect();
        let path: Vec<String> = points.iter().map(|[x, y]| format!("{x:.1},{y:.1}")).collect();
        out += &format!("<polyline points=\"{}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"2\"{dash}/>\n", path.join(" "));
        if points.len() <= 24 {
            for [x, y] in &points {
                out += &format!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3\" fill=\"{color}\"/>\n");
            }
        }
        let row = top + 12.0 + 22.0 * index as f64;
        out += &format!(
            "<line x1=\"{:.1}\" x2=\"{:.1}\" y1=\"{row:.1}\" y2=\"{row:.1}\" stroke=\"{color}\" stroke-width=\"2\"{dash}/>\n",
            right + 12.0,
            right + 36.0
        );
        out += &format!("<text x=\"{:.1}\" y=\"{:.1}\">{}</text>\n", right + 42.0, row + 4.0, escaped(&series.name));
    }
    out + "</svg>\n"
}

struct Axis {
    scale: Scale,
    range: [f64; 2],
    pixels: [f64; 2],
}

impl Axis {
    fn new(scale: Scale, values: impl Iterator<Item = f64>, pixels: [f64; 2]) -> Self {
        let usable = values.filter(|v| v.is_finite() && (scale == Scale::Linear || *v > 0.0));
        let [low, high] = usable.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)]);
        let range = match scale {
            _ if low > high => [1.0, 10.0],
            Scale::Linear => [low.min(0.0), if high > low.min(0.0) { high * 1.04 } else { low.min(0.0) + 1.0 }],
            Scale::Logarithmic => [low / 1.25, high * 1.25],
        };
        Self { scale, range, pixels }
    }

    fn at(&self, value: f64) -> f64 {
        let [low, high] = self.range;
        let t = match self.scale {
            Scale::Linear => (value - low) / (high - low),
            Scale::Logarithmic => (value.max(low) / low).ln() / (high / low).ln(),
        };
        self.pixels[0] + t.clamp(0.0, 1.0) * (self.pixels[1] - self.pixels[0])
    }

    fn ticks(&self) -> Vec<f64> {
        let [low, high] = self.range;
        match self.scale {
            Scale::Linear => {
                let rough = (high - low) / 8.0;
                let decade = 10f64.powf(rough.log10().floor());
                let step = [1.0, 2.0, 5.0, 10.0].map(|s| s * decade).into_iter().find(|s| *s >= rough).unwrap_or(10.0 * decade);
                ((low / step).ceil() as i64..=(high / step).floor() as i64).map(|i| i as f64 * step).collect()
            }
            Scale::Logarithmic => {
                let decades = (high / low).log10();
                let steps: &[f64] = if decades < 2.6 { &[1.0, 2.0, 5.0] } else { &[1.0] };
                let every = (decades / 8.0).ceil().max(1.0) as usize;
                let all = (low.log10().floor() as i32..=high.log10().ceil() as i32).step_by(every);
                all.flat_map(|d| steps.iter().map(move |s| s * 10f64.powi(d))).filter(|v| (low..=high).contains(v)).collect()
            }
        }
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_map_their_ends_and_keep_zero_on_the_paper() {
        let log = Axis::new(Scale::Logarithmic, [0.01, 1.0, 0.0].into_iter(), [100.0, 500.0]);
        assert_eq!(log.at(0.0), 100.0);
        assert!(log.at(0.01) < log.at(0.02) && log.at(1.0) < 500.0 && log.ticks().contains(&0.1));
        let linear = Axis::new(Scale::Linear, [2.0, 4.0].into_iter(), [0.0, 100.0]);
        assert_eq!(linear.at(0.0), 0.0);
        assert!(linear.ticks().len() >= 4);
        assert!(!Axis::new(Scale::Linear, [0.0].into_iter(), [0.0, 1.0]).ticks().is_empty());
        assert!(!Axis::new(Scale::Logarithmic, [].into_iter(), [0.0, 1.0]).ticks().is_empty());
    }

    #[test]
    fn names_are_escaped() {
        let series = vec![Series { name: "a < b".into(), points: vec![[1.0, 2.0], [2.0, f64::NAN]] }];
        let plot = Plot { name: "p".into(), caption: "\"q\"".into(), axes: ["x".into(), "y".into()], scales: [Scale::Linear; 2], series };
        let text = svg(&plot);
        assert!(text.contains("a &lt; b") && text.contains("&quot;q&quot;") && !text.contains("NaN"));
    }
}

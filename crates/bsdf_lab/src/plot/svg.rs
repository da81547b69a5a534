//! Vectors.

use super::{Anchor, Canvas};

/// A document in the making.
pub(super) struct Svg(String);

impl Svg {
    pub fn new([width, height]: [f64; 2]) -> Self {
        Self(format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
             font-family=\"sans-serif\" font-size=\"13\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
        ))
    }

    pub fn finish(self) -> String {
        self.0 + "</svg>\n"
    }
}

impl Canvas for Svg {
    fn line(&mut self, points: &[[f64; 2]], [r, g, b]: [u8; 3], width: f64) {
        let points: Vec<String> = points.iter().map(|[x, y]| format!("{x:.2},{y:.2}")).collect();
        self.0 +=
            &format!("<polyline fill=\"none\" stroke=\"rgb({r},{g},{b})\" stroke-width=\"{width}\" points=\"{}\"/>\n", points.join(" "));
    }

    fn cell(&mut self, [left, top, right, bottom]: [f64; 4], [r, g, b]: [u8; 3]) {
        let (width, height) = (right - left, bottom - top);
        self.0 += &format!(
            "<rect x=\"{left:.2}\" y=\"{top:.2}\" width=\"{width:.2}\" height=\"{height:.2}\" fill=\"rgb({r},{g},{b})\" shape-rendering=\"crispEdges\"/>\n"
        );
    }

    fn text(&mut self, [x, y]: [f64; 2], text: &str, anchor: Anchor, upwards: bool) {
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let turn = if upwards { format!(" transform=\"rotate(-90 {x:.2} {y:.2})\"") } else { String::new() };
        let text = text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
        self.0 += &format!("<text x=\"{x:.2}\" y=\"{y:.2}\" text-anchor=\"{anchor}\" dominant-baseline=\"central\"{turn}>{text}</text>\n");
    }
}

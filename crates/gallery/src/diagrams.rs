//! The survey's drawings: facets that hide one another (3.3), and a layered surface (4.4). Lengths and widths in them are numbers of the models.

use crate::GalleryError;
use crate::check::{Check, smallest};
use crate::plates::Plate;
use crate::probe::pixel;
use crate::stage::Ball;
use crate::studio::{Shown, Studio};
use crate::survey::SETS;
use kajo_bsdf_lab::figures::{Curve, Figure};

/// Text and lines of a drawing, y upwards in the units of each panel.
struct Drawing {
    out: String,
    size: [f64; 2],
    /// Where the origin of the current panel is, and pixels a unit.
    panel: ([f64; 2], f64),
}

impl Drawing {
    fn new(size: [f64; 2]) -> Self {
        let [width, height] = size;
        let out = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" \
             font-size=\"15\" fill=\"#222\" text-anchor=\"middle\">\n<defs><marker id=\"tip\" viewBox=\"0 0 8 8\" refX=\"6\" refY=\"4\" markerWidth=\"14\" \
             markerHeight=\"14\" markerUnits=\"userSpaceOnUse\" orient=\"auto\"><path d=\"M0 0 8 4 0 8z\" fill=\"context-stroke\"/></marker></defs>\n\
             <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
        );
        Self { out, size, panel: ([0.0; 2], 1.0) }
    }

    fn at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let ([left, top], unit) = self.panel;
        [left + x * unit, top - y * unit]
    }

    fn line(&mut self, points: &[[f64; 2]], stroke: &str, width: f64, more: &str) {
        let points: Vec<String> = points.iter().map(|&point| self.at(point)).map(|[x, y]| format!("{x:.1},{y:.1}")).collect();
        self.out +=
            &format!("<polyline points=\"{}\" fill=\"none\" stroke=\"{stroke}\" stroke-width=\"{width:.1}\" {more}/>\n", points.join(" "));
    }

    fn arrow(&mut self, from: [f64; 2], to: [f64; 2], stroke: &str, width: f64) {
        self.line(&[from, to], stroke, width, "marker-end=\"url(#tip)\"");
    }

    fn area(&mut self, points: &[[f64; 2]], fill: &str) {
        let points: Vec<String> = points.iter().map(|&point| self.at(point)).map(|[x, y]| format!("{x:.1},{y:.1}")).collect();
        self.out += &format!("<polygon points=\"{}\" fill=\"{fill}\"/>\n", points.join(" "));
    }

    fn text(&mut self, point: [f64; 2], words: &str) {
        let [x, y] = self.at(point);
        self.out += &format!("<text x=\"{x:.1}\" y=\"{y:.1}\">{words}</text>\n");
    }

    fn finish(self, studio: &mut Studio, name: &str, alt: &str) -> Result<Shown, GalleryError> {
        debug_assert!(self.size[0] > 0.0);
        let file = format!("{name}.svg");
        studio.write(&file, (self.out + "</svg>\n").as_bytes())?;
        Ok(Shown { image: file.clone(), alt: alt.into(), files: vec![file], wide: true })
    }
}

const LIGHT: &str = "#d9822b";
const VIEW: &str = "#2d6a75";

/// Inclination of the drawn facets, degrees.
const FACET: f64 = 40.0;

/// Share of a facet of a symmetric groove that a ray from `theta` degrees off the normal reaches, over the rim at its side; by construction.
fn reached(theta: f64, facet: f64) -> f64 {
    // The ray over the rim (−1, 0) meets the facet from (0, −tan ψ) to (1, 0) at t: t = (k − 1)/(k + 1), k = tan θ tan ψ.
    let k = theta.to_radians().tan() * facet.to_radians().tan();
    1.0 - ((k - 1.0) / (k + 1.0)).max(0.0)
}

/// G_c or G_m of (3.1) for a half vector `facet` off the normal.
fn formula(theta: f64, beta: f64, facet: f64) -> f64 {
    let [facet, theta, beta] = [facet, theta, beta].map(|degrees| degrees.to_radians().cos());
    (2.0 * facet * theta / beta).min(1.0)
}

/// Figure 3.3.
pub fn facets(studio: &mut Studio) -> Result<Plate, GalleryError> {
    let mut drawing = Drawing::new([1000.0, 330.0]);
    for (k, (title, light, view)) in
        [("nothing hidden", 50.0, 30.0), ("shadowing", 75.0, 5.0), ("masking", 5.0, 75.0)].into_iter().enumerate()
    {
        drawing.panel = ([170.0 + 330.0 * k as f64, 190.0], 85.0);
        let depth = FACET.to_radians().tan();
        let hidden = 1.0 - reached(f64::max(light, view), FACET);
        let on_facet = |t: f64| [t, -depth * (1.0 - t)];
        drawing.area(
            &[
                [-1.7, -depth - 0.35],
                [-1.7, -depth * 0.7],
                [-1.0, 0.0],
                [0.0, -depth],
                [1.0, 0.0],
                [1.7, -depth * 0.7],
                [1.7, -depth - 0.35],
            ],
            "#e9e5da",
        );
        drawing.line(&[[-1.7, -depth * 0.7], [-1.0, 0.0], [0.0, -depth], [1.0, 0.0], [1.7, -depth * 0.7]], "#222", 2.0, "");
        if hidden > 1e-9 {
            drawing.line(
                &[on_facet(0.0), on_facet(hidden)],
                if light > view { LIGHT } else { VIEW },
                7.0,
                "stroke-linecap=\"round\" stroke-opacity=\"0.8\"",
            );
        }
        let toward = |degrees: f64, length: f64| [-degrees.to_radians().sin() * length, degrees.to_radians().cos() * length];
        for t in [hidden + 0.02 + (1.0 - hidden) * 0.12, hidden + (1.0 - hidden) * 0.5, hidden + (1.0 - hidden) * 0.88] {
            let [x, y] = on_facet(t);
            let ([lx, ly], [vx, vy]) = (toward(light, 1.75), toward(view, 1.75));
            drawing.arrow([x + lx, y + ly], [x, y], LIGHT, 2.0);
            drawing.arrow([x, y], [x + vx, y + vy], VIEW, 2.0);
        }
        drawing.text([0.0, -depth - 0.62], &format!("{title}: G = {:.3}", 1.0 - hidden));
    }
    let alt = "Three grooves of two facets. First, light reaches the whole facet and all of it is seen: G = 1. Then the rim keeps light from half of the facet; then it hides \
               half of the facet from the viewer.";
    let shown = vec![drawing.finish(studio, "figure_3.3", alt)?];
    Ok(Plate { shown, checks: facet_checks()?, ..Plate::new("figure_3.3", "3.3 · Facets: nothing hidden, shadowing, masking", FACETS) })
}

const FACETS: &str = "Symmetric grooves whose facets are inclined by 40°. Orange arrows come from the light, blue ones go to the viewer; the thick part of the facet gets no light or is \
    not seen. What is left is G = min(1, 2 cos δ cos θr/cos β, 2 cos δ cos θi/cos β). Measured as the ratio of two pixels, Cook-Torrance with and without attenuation.";

fn facet_checks() -> Result<Vec<Check>, GalleryError> {
    let mut checks: Vec<Check> = [(75.0, 35.0), (60.0, 20.0), (50.0, 10.0)]
        .map(|(theta, beta)| {
            Check::near(
                format!("the drawn facet's free share at {theta}° against (3.1)"),
                reached(theta, FACET),
                formula(theta, beta, FACET),
                1e-12,
            )
        })
        .into();
    let ball = Ball::new("cook-torrance", "kd=0 ks=1 m=0.6 eta=1.5", "");
    let golden = [("A", 1.0, "nothing hidden"), ("C", 0.512_993_281_1, "masking"), ("D", 0.826_351_822_3, "light and viewer in one place")];
    let swapped = |[theta_i, phi_i, theta_r, phi_r]: [f64; 4]| [theta_r, phi_r, theta_i, phi_i];
    let mut pairs: Vec<(String, [f64; 4], f64)> = Vec::new();
    for (set, g, what) in golden {
        let angles = SETS.iter().find(|(name, _)| *name == set).map_or([0.0; 4], |(_, angles)| *angles);
        pairs.push((format!("set {set}, {what}"), angles, g));
        if set == "C" {
            pairs.push(("set C with light and viewer exchanged, shadowing".into(), swapped(angles), g));
        }
    }
    for (what, angles, g) in pairs {
        let ratio = pixel(&ball, angles)?.x / pixel(&ball.with("masking=none"), angles)?.x;
        checks.push(Check::near(format!("{what}: G as a ratio of pixels"), ratio, g, 1e-5));
    }
    Ok(checks)
}

/// Varnish on something matte.
const LAYERS: &str = "c=0.04 r=0.1 p=1 c2=0.6 r2=0.8 p2=1";

/// Share of f that the upper layer sends to the mirror direction, for light from β, from three pixels.
///
/// f is linear in S'(β) = C' + (1 − C') q, q = (1 − cos β)⁵: spheres with C' = 0 and 1 give both parts.
fn upper_share(beta: f64, directional: &str) -> Result<f64, GalleryError> {
    let ball = Ball::new("schlick-double", format!("{LAYERS} directional={directional}"), "");
    let angles = [beta, 0.0, beta, 180.0];
    let [none, all, real] = [ball.with("c2=0"), ball.with("c2=1"), ball].map(|ball| pixel(&ball, angles).map(|f| f.x));
    let (none, all, real) = (none?, all?, real?);
    let q = (1.0 - beta.to_radians().cos()).powi(5);
    Ok((none - q * (all - none) / (1.0 - q)) / real)
}

/// Over 0°, 5° … 85°.
fn upper_shares(directional: &str) -> Result<Vec<f64>, GalleryError> {
    degrees().map(|beta| upper_share(beta, directional)).collect()
}

fn degrees() -> impl Iterator<Item = f64> {
    (0..=17).map(|k| f64::from(k) * 5.0)
}

/// Figure 4.4.
pub fn layers(studio: &mut Studio) -> Result<Plate, GalleryError> {
    let (simple, blocked) = (upper_shares("simple")?, upper_shares("blocked")?);
    let fresnel = |beta: f64| 0.04 + 0.96 * (1.0 - beta.to_radians().cos()).powi(5);
    let mut drawing = Drawing::new([1000.0, 330.0]);
    for (k, beta) in [15.0, 75.0].into_iter().enumerate() {
        drawing.panel = ([260.0 + 480.0 * k as f64, 220.0], 100.0);
        drawing.area(&[[-2.2, 0.0], [2.2, 0.0], [2.2, -0.35], [-2.2, -0.35]], "#f1dfb8");
        drawing.area(&[[-2.2, -0.35], [2.2, -0.35], [2.2, -0.8], [-2.2, -0.8]], "#a9957a");
        drawing.line(&[[-2.2, 0.0], [2.2, 0.0]], "#8a6d2f", 2.0, "");
        let (sin, cos) = f64::to_radians(beta).sin_cos();
        let length = 1.9;
        let share = fresnel(beta);
        drawing.arrow([-sin * length, cos * length], [0.0, 0.03], LIGHT, 14.0);
        drawing.arrow([0.0, 0.03], [sin * length, cos * length], VIEW, (14.0 * share).max(0.8));
        drawing.line(&[[0.0, 0.0], [0.1 + 0.12 * sin, -0.35]], LIGHT, 14.0 * (1.0 - share), "stroke-opacity=\"0.5\"");
        for spread in [-60_f64, -30.0, 0.0, 30.0, 60.0] {
            let (s, c) = spread.to_radians().sin_cos();
            let foot = [0.1 + 0.12 * sin, -0.35];
            drawing.arrow(foot, [foot[0] + s * 0.95, foot[1] + c * 0.95], "#7a5c3a", (14.0 * (1.0 - share) * 0.6 / 5.0).max(0.8));
        }
        drawing.text([0.0, -1.02], &format!("light from {beta}°: the upper layer mirrors {:.0} %", 100.0 * share));
    }
    let alt = "Light on a translucent layer over a matte one. At 15° a thin arrow is mirrored and most light is scattered by the lower layer; at 75° the mirrored arrow is much wider.";
    let mut shown = vec![drawing.finish(studio, "figure_4.4", alt)?];
    let curve = |name: &str, points: Vec<f64>| Curve { name: name.into(), points: degrees().zip(points).map(|(x, y)| [x, y]).collect() };
    shown.push(studio.curves(&Figure {
        name: "figure_4.4_share".into(),
        title: "Figure 4.4: share of the upper layer, from pixels".into(),
        axes: ["light and viewer from the normal, degrees".into(), "share".into()],
        curves: vec![
            curve("of f, (4.19)", simple.clone()),
            curve("of f, (4.22)", blocked.clone()),
            curve("of the light, S", degrees().map(fresnel).collect()),
        ],
        equal_scales: false,
    })?);
    let plate = Plate {
        shown,
        checks: layer_checks(&simple, &blocked),
        ..Plate::new("figure_4.4", "4.4 · A layered surface: the mirror's share grows", CAPTION)
    };
    Ok(Plate { parameters: vec![format!("schlick-double: {LAYERS}")], ..plate })
}

const CAPTION: &str = "A translucent layer over a matte one, Schlick's two layers with C = 0.04, r = 0.1 over C' = 0.6, r' = 0.8. Widths of the arrows are shares of the light. The curve \
    separates the layers on rendered pixels, at the mirror direction, by spheres with C' = 0, 0.6 and 1. With the simple directional factor (4.19) the upper layer's share rises \
    throughout; with (4.22), which gives blocked light back as diffuse light, it first falls a little, to 0.29 near 35°, as the lower layer's lobe grows faster.";

fn layer_checks(simple: &[f64], blocked: &[f64]) -> Vec<Check> {
    let smallest = smallest(simple.windows(2).map(|pair| pair[1] - pair[0]));
    vec![
        // S rises by less than single precision tells up to 10°.
        Check::at_least("(4.19): share of the upper layer in f, smallest step of 5° from 0° to 85°", smallest, -1e-6),
        Check::at_least("(4.19): share of the upper layer in f at 85° over that at 0°", simple[17] / simple[0], 1.5),
        Check::at_least("(4.22): share of the upper layer in f at 85° over that at 0°", blocked[17] / blocked[0], 1.5),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Row BR-37.
    #[test]
    fn figure_3_3_attenuation_is_that_of_the_drawn_groove_and_of_the_pixels() {
        let wrong: Vec<Check> = facet_checks().unwrap().into_iter().filter(|check| !check.holds).collect();
        assert!(wrong.is_empty(), "{wrong:#?}");
        assert!((reached(75.0, FACET) - formula(75.0, 30.0, FACET)).abs() > 1e-3, "planted fault");
    }

    /// Row BR-37.
    #[test]
    fn figure_4_4_the_upper_layers_share_of_the_pixels_rises() {
        let [simple, blocked] = ["simple", "blocked"].map(|directional| upper_shares(directional).unwrap());
        assert!(layer_checks(&simple, &blocked).iter().all(|check| check.holds), "{simple:?} {blocked:?}");
        let [mut falling, mut down] = [simple, blocked];
        falling.reverse();
        down.reverse();
        assert!(layer_checks(&falling, &down).iter().all(|check| !check.holds), "planted fault");
    }
}

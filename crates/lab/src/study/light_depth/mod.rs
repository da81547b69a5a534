//! Errors of stored distances over the distance, for each layout and precision of depth.

use super::{Bench, Findings, Plot, Rig, Scale, Series, Set, Study, Table};
use crate::LabError;
use glam::{Affine3A, UVec2, Vec3};
use kajo_scene::{LightShape, Projection, shapes};
use kajo_techniques::DebugPixels;
use kajo_units::Radians;

/// The study.
pub const STUDY: Study = Study { id: "light-depth", title: "Linear or perspective light depth?", doc: include_str!("doc.md"), run };

const RESOLUTION: u32 = 256;
/// Height of the light over the floor, m, and half the angle of its cone.
const HEIGHT: f32 = 0.25;
const OUTER: f32 = 0.6;
/// Distances, two a doubling.
const BINS: usize = 14;

fn bin_of(distance: f64) -> Option<usize> {
    let bin = (2.0 * (distance / 0.5).log2()).floor();
    (bin >= 0.0 && bin < BINS as f64).then_some(bin as usize)
}

fn middle_of(bin: usize) -> f64 {
    0.5 * 2f64.powf((bin as f64 + 0.5) / 2.0)
}

fn run(bench: &Bench) -> Result<Findings, LabError> {
    let size = UVec2::new(32, 24);
    let set = Set::default()
        .place(shapes::floor(128.0, 128.0, 1.0), Affine3A::from_translation(Vec3::new(63.9, 0.0, 0.0)))
        .light(LightShape::Spot { inner: Radians(OUTER), outer: Radians(OUTER) }, Vec3::Y * HEIGHT, Vec3::new(1.0, HEIGHT, 0.0))
        .camera(Projection::Perspective { yfov: Radians(0.7), aspect: None }, Vec3::new(-3.0, 3.0, 0.0), Vec3::new(20.0, 0.0, 0.0));
    let mut rig = Rig::new(bench.device, set.scene, size)?;
    let variants = [("perspective", "float32"), ("linear", "float32"), ("perspective", "unorm16"), ("linear", "unorm16")];
    let mut out = Findings::default();
    let mut table = Table::new("depth", "Mean error of stored distances.", &["layout", "precision", "distance, m", "error, m"]);
    let mut series = Vec::new();
    for (index, (layout, precision)) in variants.into_iter().enumerate() {
        bench.at(layout, index as f64 / variants.len() as f64)?;
        let frame = rig.debug_frame(&format!("shadow/map:resolution={RESOLUTION},kernel=0,depth={layout},precision={precision}"))?;
        let view = frame.debug.iter().find(|view| view.name == "light-depth").expect("shadow maps show their depth");
        let DebugPixels::Scalar(depth) = &view.pixels else { unreachable!("depth is a quantity") };
        let errors = errors(depth.pixels());
        let points: Vec<[f64; 2]> = errors.iter().enumerate().filter_map(|(bin, e)| Some([middle_of(bin), (*e)?])).collect();
        for [distance, error] in &points {
            table.row([layout.into(), precision.into(), (*distance).into(), (*error).into()]);
        }
        series.push(Series { name: format!("{layout}, {precision}"), points });
    }
    claims(&mut out, &series);
    out.tables.push(table);
    out.plots.push(Plot {
        name: "depth".into(),
        caption: "Error of the stored distance over the distance from the light.".into(),
        axes: ["distance, m".into(), "mean error, m".into()],
        scales: [Scale::Logarithmic; 2],
        series,
    });
    Ok(out)
}

/// Mean error in each bin of distance. Rows of the map lie level: the ray of a texel below the middle meets the floor at distance height / slope.
fn errors(stored: &[f32]) -> Vec<Option<f64>> {
    let margin = 1.0 + 2.0 * 1.5 / f64::from(RESOLUTION);
    let half = f64::from(OUTER).tan() * margin;
    let mut sums = vec![(0.0, 0u32); BINS];
    for (i, &distance) in stored.iter().enumerate() {
        let row_of = |i: u32| ((f64::from(i) + 0.5) / f64::from(RESOLUTION) * 2.0 - 1.0) * half;
        let (x, y) = (row_of(i as u32 % RESOLUTION), row_of(i as u32 / RESOLUTION));
        // The axes of the map may be turned against the floor: the one that points down is found by the sign of what is stored.
        let slope = slope_down(x, y);
        if slope <= 0.0 || !distance.is_finite() {
            continue;
        }
        let exact = f64::from(HEIGHT) / slope;
        if let Some(bin) = bin_of(exact) {
            sums[bin].0 += (f64::from(distance) - exact).abs();
            sums[bin].1 += 1;
        }
    }
    sums.iter().map(|(sum, n)| (*n >= 8).then(|| sum / f64::from(*n))).collect()
}

/// How far the ray of a texel falls over a unit of distance: its coordinates in the axes of the map.
fn slope_down(x: f64, y: f64) -> f64 {
    let (right, up) = Vec3::NEG_X.any_orthonormal_pair();
    -(f64::from(right.y) * x - f64::from(up.y) * y)
}

fn claims(out: &mut Findings, series: &[Series]) {
    let growth = |s: &Series| {
        let (first, last) = (s.points[0], s.points[s.points.len() - 1]);
        (last[1] / first[1]).ln() / (last[0] / first[0]).ln()
    };
    let exponents: Vec<f64> = series.iter().map(growth).collect();
    let shown = |i: usize| format!("error grows as distance^{:.2}", exponents[i]);
    out.claim("16 bits of perspective depth lose distances with their square.", (1.6..=2.4).contains(&exponents[2]), shown(2));
    out.claim("16 bits of linear depth are equally good at every distance.", exponents[3].abs() < 0.4, shown(3));
    let relative = series[0].points.iter().map(|p| p[1] / p[0]).fold(0.0, f64::max);
    out.claim(
        "Single precision with reversed depth is good to a hundred-thousandth of every distance.",
        relative < 1e-5,
        format!("at most {relative:.1e} of the distance; {}", shown(0)),
    );
    let far = |i: usize| series[i].points.last().map_or(f64::NAN, |p| p[1]);
    out.claim(
        "Far from the light 16 bits of linear depth beat 16 bits of perspective depth.",
        far(3) < 0.5 * far(2),
        format!("{:.2e} m and {:.2e} m", far(3), far(2)),
    );
}

//! Errors of the border of hard shadow maps over their resolution, seen from far and near.

use super::fit::exponent;
use super::{Bench, Findings, Picture, Plot, Rig, Scale, Series, Set, Study, Table};
use crate::LabError;
use glam::{Affine3A, Quat, UVec2, Vec3};
use kajo_image::Image;
use kajo_image_metrics::shadow_border;
use kajo_scene::{LightShape, Projection, shapes};
use kajo_units::Radians;

/// The study.
pub const STUDY: Study = Study { id: "shadow-aliasing", title: "How do shadow maps alias?", doc: include_str!("doc.md"), run };

fn set(eye: Vec3, target: Vec3) -> Set {
    let turned = Affine3A::from_rotation_translation(Quat::from_rotation_y(0.4), Vec3::new(0.0, 0.8, 0.0));
    Set::default()
        .place(shapes::floor(12.0, 12.0, 1.0), Affine3A::IDENTITY)
        .place(shapes::cuboid(Vec3::new(0.7, 0.02, 0.5)), turned)
        .light(LightShape::Spot { inner: Radians(0.5), outer: Radians(0.55) }, Vec3::new(1.0, 5.0, 0.6), Vec3::ZERO)
        .camera(Projection::Perspective { yfov: Radians(0.7), aspect: None }, eye, target)
}

fn run(bench: &Bench) -> Result<Findings, LabError> {
    let size = if bench.quick { UVec2::new(320, 240) } else { UVec2::new(640, 480) };
    let resolutions: &[u32] = if bench.quick { &[256, 512, 1024, 2048] } else { &[256, 512, 1024, 2048, 4096, 8192] };
    let views = [
        ("far", Vec3::new(-0.2, 4.2, 4.0), Vec3::new(-0.2, 0.0, -0.1)),
        // Half a metre above the border of the shadow on the floor.
        ("near", Vec3::new(-1.25, 0.5, 0.55), Vec3::new(-0.9, 0.0, 0.15)),
    ];
    let mut out = Findings::default();
    let mut table =
        Table::new("border", "Distance between the borders of map and path tracer.", &["view", "resolution, px", "border error, px"]);
    let mut series = Vec::new();
    for (index, (name, eye, target)) in views.into_iter().enumerate() {
        let mut rig = Rig::new(bench.device, set(eye, target).scene, size)?;
        let truth = rig.visibility(1)?;
        let mut points = Vec::new();
        for (step, &resolution) in resolutions.iter().enumerate() {
            bench.at(name, (index as f64 + step as f64 / resolutions.len() as f64) / 2.0)?;
            let frame = rig.frame(&format!("shadow/map:resolution={resolution},kernel=0"))?;
            // The floor alone: on the board light and dark meet at edges of the surface.
            let instances = &frame.gbuffer.as_ref().expect("asked for").instance;
            let floor = Image::from_fn(size, |x, y| *instances.get(x, y) == Some(0));
            let border = shadow_border(&frame.visibility[0], &truth, Some(&floor))
                .map_err(|source| LabError::Metrics { what: format!("{name}, {resolution} px"), source })?;
            let error = border.border_px.unwrap_or(f64::NAN);
            table.row([name.into(), f64::from(resolution).into(), error.into()]);
            points.push([f64::from(resolution), error]);
            if [256, 1024].contains(&resolution) {
                let caption = format!("Seen from {name}: a map of {resolution} px.");
                out.pictures.push(Picture::of_visibility(&format!("{name}-{resolution}"), &caption, &frame.visibility[0]));
            }
        }
        let fall = fall(&points);
        out.claim(
            format!("Seen from {name}, the error halves with each doubling of the resolution."),
            (1.7..=2.4).contains(&fall),
            format!("it falls by a factor of {fall:.2} a doubling"),
        );
        series.push(Series { name: name.into(), points });
    }
    let ratio = series[1].points[1][1] / series[0].points[1][1];
    out.claim("Near the shadow the same map is off by many more pixels.", ratio > 3.0, format!("{ratio:.1} times as many at 512 px"));
    out.tables.push(table);
    out.plots.push(Plot {
        name: "border".into(),
        caption: "Border error over the resolution of the map.".into(),
        axes: ["resolution of the map, px".into(), "border error, px".into()],
        scales: [Scale::Logarithmic; 2],
        series,
    });
    Ok(out)
}

/// The factor by which values fall with each doubling of x, by least squares of logarithms. Errors below a twenty-fifth of a pixel are left out: there
/// the grid of the picture decides.
fn fall(points: &[[f64; 2]]) -> f64 {
    const LEAST: f64 = 0.04;
    let seen: Vec<[f64; 2]> = points.iter().copied().filter(|p| p[1] > LEAST).collect();
    (-exponent(&seen)).exp2()
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_halving_is_found_as_such() {
        let points: Vec<[f64; 2]> = (0..5).map(|i| [f64::from(256 << i), 8.0 / f64::from(1 << i)]).collect();
        assert!((super::fall(&points) - 2.0).abs() < 1e-9);
    }
}

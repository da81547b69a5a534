//! Levels and error of multi-sampled shadows over the number of samples.

use super::{Bench, Findings, Picture, Plot, Rig, Scale, Series, Set, Study, Table};
use crate::LabError;
use glam::{Affine3A, UVec2, Vec3};
use kajo_image::Image;
use kajo_image_metrics::rmse;
use kajo_params::ParamKind;
use kajo_scene::{LightShape, Projection, shapes};
use kajo_units::{LinearRgb, Meters, Radians};
use std::collections::BTreeSet;

/// The study.
pub const STUDY: Study = Study { id: "shadow-samples", title: "How many hard shadows make a soft one?", doc: include_str!("doc.md"), run };

fn set(extent: f32) -> Set {
    Set::default()
        .place(shapes::floor(8.0, 8.0, 1.0), Affine3A::IDENTITY)
        .place(shapes::cuboid(Vec3::new(0.5, 0.02, 0.4)), Affine3A::from_translation(Vec3::new(0.0, 0.7, 0.0)))
        .place(shapes::cuboid(Vec3::new(0.1, 0.35, 0.1)), Affine3A::from_translation(Vec3::new(-0.9, 0.35, 0.3)))
        .light(LightShape::Rectangle { width: Meters(extent), height: Meters(0.6 * extent) }, Vec3::new(0.3, 3.0, 0.4), Vec3::ZERO)
        .camera(Projection::Perspective { yfov: Radians(0.7), aspect: None }, Vec3::new(0.3, 2.8, 3.4), Vec3::new(-0.1, 0.1, 0.1))
}

/// The hard algorithms: what the parameter `over` may be.
fn algorithms() -> Vec<&'static str> {
    let technique = kajo_techniques::find("shadow/multi-sample").expect("a technique of the registry");
    let over = technique.params.iter().find(|param| param.name == "over").expect("its first parameter");
    match over.kind {
        ParamKind::Choice { names } => names.to_vec(),
        _ => Vec::new(),
    }
}

fn run(bench: &Bench) -> Result<Findings, LabError> {
    let size = if bench.quick { UVec2::new(80, 60) } else { UVec2::new(320, 240) };
    let counts: &[u32] = if bench.quick { &[1, 4, 16, 64] } else { &[1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024] };
    let mut rig = Rig::new(bench.device, set(0.5).scene, size)?;
    let truth = rig.visibility(if bench.quick { 256 } else { 1024 })?;
    let grey = |image: &Image<f32>| image.map(|&v| LinearRgb::splat(v));
    let mut out = Findings::default();
    let mut table = Table::new("samples", "Levels of grey and error.", &["algorithm", "samples", "levels", "RMSE"]);
    let (mut errors, mut levels) = (Vec::new(), Vec::new());
    let algorithms = algorithms();
    for (index, over) in algorithms.iter().enumerate() {
        let (mut error_points, mut level_points) = (Vec::new(), Vec::new());
        for (step, &count) in counts.iter().enumerate() {
            bench.at(over, (index as f64 + step as f64 / counts.len() as f64) / algorithms.len() as f64)?;
            let frame = rig.frame(&format!("shadow/multi-sample:over={over},samples={count},resolution=1024"))?;
            let image = &frame.visibility[0];
            let distinct = image.pixels().iter().map(|v| v.to_bits()).collect::<BTreeSet<u32>>().len() as f64;
            let error = rmse(&grey(image), &grey(&truth))
                .map_err(|source| LabError::Metrics { what: format!("{over}, {count} samples"), source })?;
            table.row([(*over).into(), f64::from(count).into(), distinct.into(), error.into()]);
            error_points.push([f64::from(count), error]);
            level_points.push([f64::from(count), distinct]);
            if count == 16 {
                out.pictures.push(Picture::of_visibility(
                    &format!("{}-16", over.replace('/', "-")),
                    &format!("16 samples over {over}."),
                    image,
                ));
            }
        }
        let few = level_points.iter().all(|[n, levels]| *levels <= n + 1.0);
        out.claim(
            format!("N samples over {over} give at most N + 1 levels."),
            few,
            format!("{} of {}", level_points.last().map_or(0.0, |p| p[1]), counts.last().unwrap_or(&0)),
        );
        let falls = error_points.windows(2).all(|pair| pair[1][1] < 1.05 * pair[0][1]);
        let ends = [error_points.first(), error_points.last()].map(|p| p.map_or(f64::NAN, |p| p[1]));
        out.claim(
            format!("The error over {over} falls as N grows."),
            falls && ends[1] < 0.2 * ends[0],
            format!("from {:.3} to {:.4}", ends[0], ends[1]),
        );
        errors.push(Series { name: (*over).into(), points: error_points });
        levels.push(Series { name: (*over).into(), points: level_points });
    }
    if !bench.quick {
        for (extent, samples) in [(0.25, 128), (1.0, 1024)] {
            let mut rig = Rig::new(bench.device, set(extent).scene, UVec2::new(640, 480))?;
            let frame = rig.frame(&format!("shadow/multi-sample:samples={samples},resolution=1024"))?;
            let caption = format!("A light {extent} m wide, {samples} samples.");
            out.pictures.push(Picture::of_visibility(&format!("light-{samples}"), &caption, &frame.visibility[0]));
        }
    }
    out.tables.push(table);
    let plot = |name: &str, caption: &str, y: &str, series| Plot {
        name: name.into(),
        caption: caption.into(),
        axes: ["samples".into(), y.into()],
        scales: [Scale::Logarithmic; 2],
        series,
    };
    out.plots.push(plot("error", "Error over the number of samples.", "RMSE", errors));
    out.plots.push(plot("levels", "Levels of grey over the number of samples.", "distinct values", levels));
    Ok(out)
}

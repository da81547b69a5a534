//! Error of penumbra wedges over the size of the light, for a plate and for a body.

use super::{Bench, Findings, Picture, Plot, Rig, Scale, Series, Set, Study, Table};
use crate::LabError;
use glam::{Affine3A, Quat, UVec2, Vec3};
use kajo_scene::{LightShape, Mesh, Projection, shapes};
use kajo_units::{Meters, Radians};

/// The study.
pub const STUDY: Study =
    Study { id: "shadow-wedges", title: "How large may a light be for penumbra wedges?", doc: include_str!("doc.md"), run };

fn occluders() -> [(&'static str, Mesh); 2] {
    let flat = Quat::from_rotation_y(0.4) * Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2);
    let body = shapes::cuboid(Vec3::new(0.3, 0.45, 0.2)).moved(Quat::from_rotation_y(0.5), Vec3::ZERO);
    [("plate", shapes::rectangle(0.9, 0.6).moved(flat, Vec3::ZERO)), ("body", body)]
}

fn set(occluder: Mesh, side: f32) -> Set {
    Set::default()
        .place(shapes::floor(5.0, 5.0, 1.0), Affine3A::IDENTITY)
        .place(occluder, Affine3A::from_translation(Vec3::Y * 0.9))
        .light(LightShape::Rectangle { width: Meters(side), height: Meters(side) }, Vec3::new(0.2, 2.4, 0.1), Vec3::new(0.2, 0.0, 0.1))
        .camera(Projection::Perspective { yfov: Radians(0.7), aspect: None }, Vec3::new(0.6, 3.6, 3.4), Vec3::new(0.0, 0.2, 0.0))
}

fn run(bench: &Bench) -> Result<Findings, LabError> {
    let (size, spp) = if bench.quick { (UVec2::splat(80), 256) } else { (UVec2::splat(256), 1024) };
    let sides: &[f32] = if bench.quick { &[0.2, 0.6, 1.8] } else { &[0.1, 0.2, 0.4, 0.6, 0.9, 1.3, 1.8] };
    let mut out = Findings::default();
    let mut table = Table::new("wedges", "Mean error of visibility.", &["occluder", "side of the light, m", "mean error"]);
    let mut series = Vec::new();
    for (index, (name, mesh)) in occluders().into_iter().enumerate() {
        let mut points = Vec::new();
        for (step, &side) in sides.iter().enumerate() {
            bench.at(name, (index as f64 + step as f64 / sides.len() as f64) / 2.0)?;
            let mut rig = Rig::new(bench.device, set(mesh.clone(), side).scene, size)?;
            let (truth, frame) = (rig.visibility(spp)?, rig.frame("shadow/wedges")?);
            let instances = frame.gbuffer.as_ref().expect("asked for").instance.pixels();
            let pairs = frame.visibility[0].pixels().iter().zip(truth.pixels()).zip(instances);
            let errors: Vec<f64> = pairs.filter(|(_, id)| id.is_some()).map(|((v, r), _)| f64::from((v - r).abs())).collect();
            let error = errors.iter().sum::<f64>() / errors.len() as f64;
            table.row([name.into(), f64::from(side).into(), error.into()]);
            points.push([f64::from(side), error]);
            if step + 1 == sides.len() {
                for (of, image) in [("wedges", &frame.visibility[0]), ("rays", &truth)] {
                    let caption = format!("A {name} under a light {side} m wide: {of}.");
                    out.pictures.push(Picture::of_visibility(&format!("{name}-{of}"), &caption, image));
                }
            }
        }
        series.push(Series { name: name.into(), points });
    }
    claims(&mut out, [&series[0].points, &series[1].points]);
    out.tables.push(table);
    out.plots.push(Plot {
        name: "wedges".into(),
        caption: "Error over the size of the light.".into(),
        axes: ["side of the light, m".into(), "mean error of visibility".into()],
        scales: [Scale::Logarithmic; 2],
        series,
    });
    Ok(out)
}

/// Points are side of the light and error.
fn claims(out: &mut Findings, [plate, body]: [&[[f64; 2]]; 2]) {
    let range = |points: &[[f64; 2]]| format!("from {:.4} to {:.4}", points[0][1], points[points.len() - 1][1]);
    let most = plate.iter().map(|p| p[1]).fold(0.0, f64::max);
    out.claim("A plate is right to 0.02 under every light.", most <= 0.02, format!("at most {most:.4}"));
    out.claim("The error of a body rises with the size of the light.", body.windows(2).all(|pair| pair[0][1] < pair[1][1]), range(body));
    let [noise, error] = [plate, body].map(|points| points[points.len() - 1][1]);
    out.claim(
        "Under the largest light it is more than twice that of the plate: it is not noise.",
        error > 2.0 * noise,
        format!("{error:.4} and {noise:.4}"),
    );
}

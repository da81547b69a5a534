//! Light in the shadow of two stacked boards, for every filtered map.

use super::{Bench, Findings, Picture, Plot, Rig, Scale, Series, Set, Study, Table};
use crate::LabError;
use glam::{Affine3A, UVec2, Vec3};
use kajo_image::Image;
use kajo_scene::{LightShape, Projection, shapes};
use kajo_units::Radians;

/// The study.
pub const STUDY: Study = Study { id: "shadow-leaks", title: "Where do filtered shadow maps leak?", doc: include_str!("doc.md"), run };

/// All filter over seven texels.
const METHODS: [(&str, &str); 6] = [
    ("percentage-closer", "shadow/map:resolution=512,kernel=3"),
    ("variance", "shadow/vsm:resolution=512,radius=3"),
    ("variance, bleeding 0.3", "shadow/vsm:resolution=512,radius=3,bleeding=0.3"),
    ("exponential variance", "shadow/evsm:resolution=512,radius=3"),
    ("four moments", "shadow/msm:resolution=512,radius=3"),
    ("four moments, bleeding 0.3", "shadow/msm:resolution=512,radius=3,bleeding=0.3"),
];

/// Height of the upper board and of the light, m.
const HIGH: f32 = 2.4;
const LIGHT: f32 = 4.0;

fn set(low: f32) -> Set {
    // The shadow of the lower board is always as large.
    let half = 0.785 * (LIGHT - low) / LIGHT;
    let board = |half: f32, height: f32| (shapes::cuboid(Vec3::new(half, 0.01, half)), Affine3A::from_translation(Vec3::Y * height));
    let ((low_mesh, low_place), (high_mesh, high_place)) = (board(half, low), board(0.25, HIGH));
    Set::default()
        .place(shapes::floor(8.0, 8.0, 1.0), Affine3A::IDENTITY)
        .place(low_mesh, low_place)
        .place(high_mesh, high_place)
        .light(LightShape::Spot { inner: Radians(0.6), outer: Radians(0.65) }, Vec3::Y * LIGHT, Vec3::ZERO)
        // From below the lower board.
        .camera(Projection::Perspective { yfov: Radians(1.9), aspect: None }, Vec3::new(0.02, 0.9 * low, 0.01), Vec3::new(0.02, 0.0, 0.01))
}

fn run(bench: &Bench) -> Result<Findings, LabError> {
    let size = UVec2::splat(192);
    let heights: &[f32] = if bench.quick { &[0.6, 1.2] } else { &[0.3, 0.6, 0.9, 1.2, 1.5, 1.8, 2.1] };
    let mut out = Findings::default();
    let mut table =
        Table::new("leaks", "Light where there is none.", &["method", "height of the lower board, m", "mean leak", "pixels over 5 %, %"]);
    let mut series: Vec<Series> = METHODS.iter().map(|(name, _)| Series { name: (*name).into(), points: Vec::new() }).collect();
    for (index, &low) in heights.iter().enumerate() {
        let mut rig = Rig::new(bench.device, set(low).scene, size)?;
        let truth = rig.visibility(1)?;
        let deep = deep(&truth);
        for (method, (name, technique)) in METHODS.iter().enumerate() {
            bench.at(name, (index as f64 + method as f64 / METHODS.len() as f64) / heights.len() as f64)?;
            let frame = rig.frame(technique)?;
            let values: Vec<f64> = deep.iter().map(|&(x, y)| f64::from(*frame.visibility[0].get(x, y))).collect();
            let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
            let lit = values.iter().filter(|v| **v > 0.05).count() as f64 / values.len().max(1) as f64;
            table.row([(*name).into(), f64::from(low).into(), mean.into(), (100.0 * lit).into()]);
            series[method].points.push([f64::from(low), mean]);
            if low == 1.2 {
                let caption = format!("Visibility under the boards: {name}.");
                let file = format!("{}-{method}", technique.split(':').next().unwrap_or(technique).replace('/', "-"));
                out.pictures.push(Picture::of_visibility(&file, &caption, &frame.visibility[0]));
            }
        }
    }
    let worst = |i: usize| series[i].points.iter().map(|p| p[1]).fold(0.0, f64::max);
    out.claim("Comparing depth does not leak.", worst(0) < 1e-4, format!("at most {:.1e}", worst(0)));
    out.claim("Variance leaks.", worst(1) > 0.005, format!("at most {:.3}", worst(1)));
    out.claim("Four moments leak less than two.", worst(4) < 0.7 * worst(1), format!("{:.4} and {:.4}", worst(4), worst(1)));
    out.claim(
        "Exponential warps leak less than plain variance.",
        worst(3) < 0.3 * worst(1),
        format!("{:.4} and {:.4}", worst(3), worst(1)),
    );
    out.claim(
        "Cutting off small shares takes most of the leak away.",
        worst(2) < 0.5 * worst(1),
        format!("{:.4} and {:.4}", worst(2), worst(1)),
    );
    out.tables.push(table);
    out.plots.push(Plot {
        name: "leaks".into(),
        caption: "Leak over the height of the lower board.".into(),
        axes: ["height of the lower board, m".into(), "mean visibility where there is none".into()],
        scales: [Scale::Linear; 2],
        series,
    });
    Ok(out)
}

/// Dark pixels more than five pixels from any light.
fn deep(truth: &Image<f32>) -> Vec<(u32, u32)> {
    let size = truth.size();
    let dark = |x: i64, y: i64| x >= 0 && y >= 0 && x < size.x.into() && y < size.y.into() && *truth.get(x as u32, y as u32) == 0.0;
    let all = (0..i64::from(size.y)).flat_map(|y| (0..i64::from(size.x)).map(move |x| (x, y)));
    all.filter(|&(x, y)| (-5..=5).all(|v| (-5..=5).all(|u| dark(x + u, y + v)))).map(|(x, y)| (x as u32, y as u32)).collect()
}

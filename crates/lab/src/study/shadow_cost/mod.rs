//! Cost of shadow volumes over triangles and the size of shadow polygons, and of shadow maps over texels.

use super::fit::exponent;
use super::{Bench, Findings, Plot, Rig, Scale, Series, Set, Study, Table};
use crate::LabError;
use glam::{Affine3A, UVec2, Vec3};
use kajo_renderer::FrameOutput;
use kajo_scene::{LightShape, Projection, shapes};
use kajo_units::{Meters, Radians};

/// The study.
pub const STUDY: Study =
    Study { id: "shadow-cost", title: "What do shadow volumes and shadow maps cost?", doc: include_str!("doc.md"), run };

const TO_SUN: Vec3 = Vec3::new(-0.9, 1.0, 0.35);

/// Triangles of a box.
const BOX: f64 = 12.0;

/// How far the floors of the tower lie apart, m.
const STOREY: f32 = 0.1;

fn stage() -> Set {
    Set::default()
        .place(shapes::floor(30.0, 30.0, 1.0), Affine3A::IDENTITY)
        .light(LightShape::Directional { half_angle: Radians(0.0) }, TO_SUN, Vec3::ZERO)
        .camera(Projection::Orthographic { xmag: Meters(5.0), ymag: Meters(5.0) }, Vec3::new(-6.0, 12.0, 10.0), Vec3::new(2.0, 0.0, 0.0))
}

/// Posts of one size, as many as side times side, on the same ground.
fn field(side: u32) -> Set {
    let post = shapes::cuboid(Vec3::new(0.04, 0.25, 0.04));
    let place = |i: u32| (i as f32 + 0.5) / side as f32 * 5.0 - 2.5;
    (0..side * side)
        .fold(stage(), |set, i| set.place(post.clone(), Affine3A::from_translation(Vec3::new(place(i % side), 0.26, place(i / side)))))
}

/// Floors above each other.
fn tower(storeys: u32) -> Set {
    let floor = shapes::cuboid(Vec3::new(0.5, 0.01, 0.5));
    (1..=storeys).fold(stage(), |set, i| set.place(floor.clone(), Affine3A::from_translation(Vec3::Y * (STOREY * i as f32))))
}

/// A measured number of casters.
struct Sample {
    casters: u32,
    polygons: f64,
    fragments: f64,
    /// Times of z-pass volumes and of a map, ms.
    ms: [f64; 2],
}

/// A name, what makes a scene of a size, and the sizes.
type Family = (&'static str, fn(u32) -> Set, Vec<u32>);

fn run(bench: &Bench) -> Result<Findings, LabError> {
    let (size, frames) = if bench.quick { (UVec2::splat(192), 1) } else { (UVec2::splat(512), 7) };
    // Posts any closer hide the ground from the camera.
    let sides: &[u32] = if bench.quick { &[2, 4, 8, 16] } else { &[2, 3, 4, 6, 8, 11, 16] };
    let storeys: &[u32] = if bench.quick { &[4, 8, 16, 32] } else { &[4, 8, 16, 32, 64] };
    let families: [Family; 2] =
        [("field", |n| field(n.isqrt()), sides.iter().map(|side| side * side).collect()), ("tower", tower, storeys.to_vec())];
    let mut out = Findings::default();
    let mut table = Table::new(
        "casters",
        "Shadow volumes (z-pass) and a map of 1024 px, over the number of casters.",
        &["casters", "triangles", "shadow polygons", "stencil fragments", "volumes, ms", "map, ms"],
    );
    let (mut counts, mut times) = (Vec::new(), Vec::new());
    for (index, (name, family, numbers)) in families.into_iter().enumerate() {
        let mut samples = Vec::new();
        for (step, &casters) in numbers.iter().enumerate() {
            bench.at(name, (index as f64 + step as f64 / numbers.len() as f64) / 3.0)?;
            let mut rig = Rig::new(bench.device, family(casters).scene, size)?;
            let (volumes, volumes_ms) = least(&mut rig, "shadow/volume-zpass", "", frames)?;
            let (_, map_ms) = least(&mut rig, "shadow/map", "resolution=1024", frames)?;
            let count = |name: &str| volumes.statistics.iter().find(|s| s.name == name).expect("counted").value as f64;
            let sample =
                Sample { casters, polygons: count("shadow polygons"), fragments: count("stencil fragments"), ms: [volumes_ms, map_ms] };
            let triangles = f64::from(casters) * BOX;
            let cells = [triangles, sample.polygons, sample.fragments, volumes_ms, map_ms];
            table.row([format!("{name} of {casters}").as_str().into()].into_iter().chain(cells.map(Into::into)));
            samples.push(sample);
        }
        let points = |of: fn(&Sample) -> f64| samples.iter().map(|s| [f64::from(s.casters) * BOX, of(s)]).collect::<Vec<_>>();
        claims(&mut out, name, &points(|s| s.polygons), &points(|s| s.fragments));
        counts.push(Series { name: format!("{name}, fragments"), points: points(|s| s.fragments) });
        counts.push(Series { name: format!("{name}, polygons"), points: points(|s| s.polygons) });
        times.push(Series { name: format!("{name}, volumes"), points: points(|s| s.ms[0]) });
        times.push(Series { name: format!("{name}, map"), points: points(|s| s.ms[1]) });
    }
    out.tables.push(table);
    let plot = |name: &str, caption: &str, axes: [&str; 2], series| Plot {
        name: name.into(),
        caption: caption.into(),
        axes: axes.map(Into::into),
        scales: [Scale::Logarithmic; 2],
        series,
    };
    out.plots.push(plot("counts", "What shadow volumes have to draw.", ["triangles of the casters", "number"], counts));
    out.plots.push(plot("times", "Time of the technique's passes.", ["triangles of the casters", "ms"], times));

    bench.at("maps", 2.0 / 3.0)?;
    let resolutions: &[u32] = if bench.quick { &[512, 1024] } else { &[1024, 2048, 4096, 8192] };
    let mut table = Table::new("texels", "A map over its texels; a tower of 16 floors.", &["resolution, px", "texels", "bytes", "ms"]);
    let mut rig = Rig::new(bench.device, tower(16).scene, size)?;
    let (mut texels, mut bytes) = (Vec::new(), Vec::new());
    for &resolution in resolutions {
        let (frame, ms) = least(&mut rig, "shadow/map", &format!("resolution={resolution}"), frames)?;
        let kept = frame.technique_bytes.iter().find(|(id, _)| *id == "shadow/map").expect("the technique that ran").1 as f64;
        let number = f64::from(resolution).powi(2);
        table.row([f64::from(resolution), number, kept, ms].map(Into::into));
        texels.push([number, ms]);
        bytes.push([number, kept]);
    }
    let memory = exponent(&bytes);
    out.claim("Memory of maps is in proportion to their texels.", (memory - 1.0).abs() < 0.1, format!("it grows with power {memory:.3}"));
    if !bench.quick {
        let more: Vec<[f64; 2]> = texels.windows(2).map(|pair| [0, 1].map(|axis| pair[1][axis] - pair[0][axis])).collect();
        let time = exponent(&more);
        out.claim(
            "Their time is a constant and a part in proportion to the texels.",
            (time - 1.0).abs() < 0.25,
            format!("what more texels add grows with power {time:.2}"),
        );
    }
    out.tables.push(table);
    let series = vec![Series { name: "map".into(), points: texels }];
    out.plots.push(plot("texels", "Time of a map over its texels.", ["texels", "ms"], series));
    Ok(out)
}

/// A frame, and the least time that the technique's passes took in some frames.
fn least(rig: &mut Rig, id: &str, params: &str, frames: u32) -> Result<(FrameOutput, f64), LabError> {
    let technique = if params.is_empty() { id.into() } else { format!("{id}:{params}") };
    let mut frame = rig.frame(&technique)?;
    let mut ms = f64::INFINITY;
    for _ in 0..frames {
        frame = rig.frame(&technique)?;
        ms = ms.min(frame.timings.sum_of(id));
    }
    Ok((frame, ms))
}

/// The ground throws some polygons, too, which counts where casters are few.
fn claims(out: &mut Findings, family: &str, polygons: &[[f64; 2]], fragments: &[[f64; 2]]) {
    let [polygons, fragments] = [polygons, fragments].map(exponent);
    let measured = format!("polygons with power {polygons:.2}, fragments with power {fragments:.2}");
    match family {
        "field" => out.claim(
            "In a field of casters of one size, polygons and fragments grow in proportion to the triangles.",
            (polygons - 1.0).abs() < 0.1 && (fragments - 1.0).abs() < 0.15,
            measured,
        ),
        _ => out.claim(
            "In a tower, whose polygons grow with its height, fragments grow faster than the triangles.",
            (polygons - 1.0).abs() < 0.1 && fragments > 1.5,
            measured,
        ),
    }
}

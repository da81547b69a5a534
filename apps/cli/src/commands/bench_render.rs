//! `kajo bench render`: speed and efficiency of the path tracer, and how its cost grows.

use crate::arguments::{BenchRender, Common, Profile, Study};
use crate::failure::{Failure, Outcome};
use crate::path_tracing::{self, in_pool};
use crate::{output, progress, view};
use glam::UVec2;
use kajo_image::{Image, read_image};
use kajo_lab::render_cost::{RenderCost, exponent, render_cost};
use kajo_path_tracer::Progress;
use kajo_units::LinearRgb;
use serde_json::json;
use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

/// Side of the picture when none is given: a minute for the suite, and rows enough for every thread.
const SIDE: u32 = 256;

/// What is rendered without a scene and without a study.
const SUITE: [&str; 4] = ["builtin:cornell", "builtin:chair-room", "builtin:spheres", "builtin:many-lights:100"];

/// One picture to measure.
struct Case {
    scene: String,
    size: UVec2,
    threads: Option<u16>,
}

/// One measured picture.
#[derive(serde::Serialize)]
struct Row {
    scene: String,
    triangles: u64,
    /// Analytic lights and emissive meshes.
    lights: usize,
    threads: usize,
    build_seconds: f64,
    #[serde(flatten)]
    cost: RenderCost,
}

/// Renders and times every case. What is finished when one fails, or Ctrl-C ends it, is printed all the same.
pub fn run(common: &Common, arguments: &BenchRender) -> Outcome {
    check(arguments)?;
    let reference = arguments.reference.as_deref().map(read_image).transpose()?;
    let cases = cases(arguments, reference.as_ref().map(Image::size))?;
    let bar = progress::bar(common.quiet, "rendering");
    let (mut rows, mut outcome) = (Vec::new(), Ok(()));
    for (index, case) in cases.iter().enumerate() {
        bar.set_message(case.scene.clone());
        bar.set_position((1000 * index / cases.len()) as u64);
        match measure(arguments, case, reference.as_ref()) {
            Ok(row) => rows.push(row),
            Err(failure) => {
                outcome = Err(failure);
                break;
            }
        }
    }
    bar.finish_and_clear();
    if !rows.is_empty() {
        print(common, arguments, &rows)?;
    }
    outcome
}

fn print(common: &Common, arguments: &BenchRender, rows: &[Row]) -> Outcome {
    let growth = arguments.study.map(|study| Growth::of(study, rows));
    if common.json {
        let error_is = if arguments.reference.is_some() { "against the reference" } else { "scatter of the seeds" };
        return output::json(&json!({ "study": arguments.study.map(Study::name), "error": error_is, "runs": rows, "growth": growth }));
    }
    output::text(&as_text(rows, growth.as_ref()))
}

fn check(arguments: &BenchRender) -> Outcome {
    if arguments.profile == Profile::Full && arguments.study.is_none() {
        return Err(Failure::usage("--profile says how far a study goes; add --study, or leave --profile out"));
    }
    let holds_light =
        |path: &Path| path.extension().is_some_and(|ending| ["exr", "hdr"].iter().any(|known| ending.eq_ignore_ascii_case(known)));
    if let Some(path) = arguments.reference.as_deref().filter(|path| !holds_light(path)) {
        let path = path.display();
        return Err(Failure::usage(format!("--reference {path} has no light in linear units, which .exr and .hdr have; render it to one")));
    }
    if arguments.repeat < 2 && arguments.reference.is_none() {
        return Err(Failure::usage("the scatter of one picture says nothing; raise --repeat or give a --reference"));
    }
    if arguments.reference.is_some() && (arguments.scenes.len() != 1 || arguments.study.is_some()) {
        return Err(Failure::usage("--reference is the picture of one scene; name that scene alone, without --study"));
    }
    match arguments.study {
        Some(study @ (Study::Triangles | Study::Lights)) if !arguments.scenes.is_empty() => {
            Err(Failure::usage(format!("--study {} makes its own scenes; leave the scene out", study.name())))
        }
        Some(study @ Study::Threads) if arguments.tracing.threads.is_some() => {
            Err(Failure::usage(format!("--study {} sets the threads; leave --threads out", study.name())))
        }
        Some(study @ Study::Resolution) if arguments.size.is_some() => {
            Err(Failure::usage(format!("--study {} sets the size; leave --size out", study.name())))
        }
        _ => Ok(()),
    }
}

/// What to render: the scenes, or the steps of the study for each of them.
fn cases(arguments: &BenchRender, reference: Option<UVec2>) -> Outcome<Vec<Case>> {
    let full = arguments.profile == Profile::Full;
    let size = arguments.size.map(|size| size.0).or(reference).unwrap_or(UVec2::splat(SIDE));
    if let Some(of) = reference.filter(|&of| of != size) {
        return Err(Failure::usage(format!("--size {}x{}, but the reference has {}x{} px; leave --size out", size.x, size.y, of.x, of.y)));
    }
    let threads = arguments.tracing.threads;
    let given = |default: &[&str]| match &arguments.scenes[..] {
        [] => default.iter().map(ToString::to_string).collect(),
        scenes => scenes.to_vec(),
    };
    let counted = |name: &str, first: u32, last: u32| -> Vec<Case> {
        powers_of_ten(first, last).map(|n| Case { scene: format!("builtin:{name}:{n}"), size, threads }).collect()
    };
    Ok(match arguments.study {
        None => given(&SUITE).into_iter().map(|scene| Case { scene, size, threads }).collect(),
        Some(Study::Triangles) => counted("terrain", 1000, if full { 10_000_000 } else { 100_000 }),
        Some(Study::Lights) => counted("many-lights", 1, if full { 100_000 } else { 1000 }),
        Some(Study::Threads) => {
            let all = std::thread::available_parallelism().map_or(1, |n| n.get() as u16);
            let steps = move |scene: String| doubling(all).map(move |n| Case { scene: scene.clone(), size, threads: Some(n) });
            given(&SUITE[..1]).into_iter().flat_map(steps).collect()
        }
        Some(Study::Resolution) => {
            let sides = if full { 64..=2048 } else { 64..=512 };
            let steps = |scene: String| {
                let sides = std::iter::successors(Some(*sides.start()), |side| Some(2 * side)).take_while(|side| side <= sides.end());
                sides.map(move |side| Case { scene: scene.clone(), size: UVec2::splat(side), threads }).collect::<Vec<_>>()
            };
            given(&SUITE[..1]).into_iter().flat_map(steps).collect()
        }
    })
}

/// `first`, 10 `first`, 100 `first` … `last`.
fn powers_of_ten(first: u32, last: u32) -> impl Iterator<Item = u32> {
    std::iter::successors(Some(first), |n| n.checked_mul(10)).take_while(move |n| *n <= last)
}

/// 1, 2, 4 … and `last`.
fn doubling(last: u16) -> impl Iterator<Item = u16> {
    std::iter::successors(Some(1u16), |n| n.checked_mul(2)).take_while(move |n| *n < last).chain([last])
}

fn measure(arguments: &BenchRender, case: &Case, reference: Option<&Image<LinearRgb>>) -> Outcome<Row> {
    let scene = view::load_scene(&case.scene, &arguments.view)?;
    let summary = scene.summary();
    let (snapshot, camera) = view::snapshot(&scene, &arguments.view, arguments.view.frame)?;
    let settings = path_tracing::settings(&arguments.tracing, case.size, camera, arguments.spp);
    let control = |_: &Progress| if progress::interrupted() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
    let (lights, threads, build_seconds, cost) = in_pool(case.threads, || -> Outcome<_> {
        let start = Instant::now();
        let tracer = path_tracing::tracer(&scene, snapshot, &arguments.tracing)?.with_culling(arguments.view.ray_culling, &settings)?;
        let build_seconds = start.elapsed().as_secs_f64();
        let cost = render_cost(&tracer, &settings, arguments.spp, arguments.repeat, reference, &control)?;
        Ok((tracer.visibility_light_names().count(), rayon::current_num_threads(), build_seconds, cost))
    })??;
    let cost = cost.ok_or_else(|| Failure::run(format!("interrupted while {} was timed", case.scene)))?;
    Ok(Row { scene: case.scene.clone(), triangles: summary.placed_triangles as u64, lights, threads, build_seconds, cost })
}

/// How cost grows with what a study varies: exponents of the power law that fits best.
#[derive(serde::Serialize)]
struct Growth {
    /// Triangles, lights, threads or pixels.
    with: String,
    /// Of the time of a picture.
    seconds: Option<f64>,
    /// Of the time to build the tracer.
    build_seconds: Option<f64>,
    /// Of time × relative MSE: the time to a picture of one relative error.
    work: Option<f64>,
}

impl Growth {
    fn of(study: Study, rows: &[Row]) -> Self {
        let x = |row: &Row| match study {
            Study::Triangles => row.triangles as f64,
            Study::Lights => row.lights as f64,
            Study::Threads => row.threads as f64,
            Study::Resolution => f64::from(row.cost.width) * f64::from(row.cost.height),
        };
        let fit = |y: fn(&Row) -> f64| exponent(&rows.iter().map(|row| (x(row), y(row))).collect::<Vec<_>>());
        Self {
            with: if study == Study::Resolution { "pixels".into() } else { study.name() },
            seconds: fit(|row| row.cost.seconds),
            build_seconds: fit(|row| row.build_seconds),
            work: fit(|row| row.cost.seconds * row.cost.rel_mse),
        }
    }
}

fn as_text(rows: &[Row], growth: Option<&Growth>) -> String {
    let head =
        ["scene", "size", "threads", "triangles", "build s", "s", "Msamples/s", "Mrays/s", "rel. MSE", "MSE", "1/(s MSE)", "invalid"];
    let cells = |row: &Row| {
        let cost = &row.cost;
        vec![
            row.scene.clone(),
            format!("{}x{}", cost.width, cost.height),
            row.threads.to_string(),
            row.triangles.to_string(),
            format!("{:.3}", row.build_seconds),
            format!("{:.3}", cost.seconds),
            format!("{:.3}", cost.samples_per_s / 1e6),
            format!("{:.3}", cost.rays_per_s / 1e6),
            format!("{:.3e}", cost.rel_mse),
            format!("{:.3e}", cost.mse),
            format!("{:.3e}", cost.efficiency),
            cost.invalid_samples.to_string(),
        ]
    };
    let table = output::table(&head, &rows.iter().map(cells).collect::<Vec<_>>());
    let line = |name: &str, with: &str, exponent: Option<f64>| exponent.map(|b| format!("{name} grows as {with}^{b:.2}\n"));
    let growth = growth.map(|growth| {
        let lines = [("time", growth.seconds), ("build time", growth.build_seconds), ("time x relative MSE", growth.work)];
        lines.into_iter().filter_map(|(name, exponent)| line(name, &growth.with, exponent)).collect::<String>()
    });
    table + &growth.unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_of_studies_end_where_they_should() {
        assert_eq!(powers_of_ten(1, 1000).collect::<Vec<_>>(), [1, 10, 100, 1000]);
        assert_eq!(doubling(1).collect::<Vec<_>>(), [1]);
        assert_eq!(doubling(6).collect::<Vec<_>>(), [1, 2, 4, 6]);
        assert_eq!(doubling(8).collect::<Vec<_>>(), [1, 2, 4, 8]);
    }
}

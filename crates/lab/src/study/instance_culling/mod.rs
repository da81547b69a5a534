//! Instances that reflections do without.    \[Varjus23] section 7.2

use super::{Bench, Findings, Picture, Plot, Scale, Series, Study, Table};
use crate::LabError;
use cpu_time::ThreadTime;
use glam::{UVec2, Vec3};
use kajo_bvh::{Blas, BuildOptions, BvhInstance, Counters, Filter as RayFilter, Ray, Tlas};
use kajo_image::{Image, ToneMap, tone_map};
use kajo_path_tracer::{Aov, Filter, Frame, Pixels, Settings, Stop, Tracer, render, uncontrolled};
use kajo_scene::{Culling, LoadOptions, Scene, Snapshot, load};
use kajo_units::{LinearRgb, Meters, Seconds};
use std::f32::consts::TAU;
use std::sync::Arc;

/// The study.
pub const STUDY: Study =
    Study { id: "instance-culling", title: "How many instances does a reflection need?", doc: include_str!("doc.md"), run };

/// Most that the reflection may be off: RMSE over its mean.
const ALLOWED: f64 = 0.01;
/// Share of instances that a good threshold leaves out.
const WANTED: f64 = 0.3;
/// Factor between thresholds that are lengths.
const STEP: f32 = 2.0;
/// Thresholds of a way at most, and halves of the last step.
const STEPS: usize = 12;
/// See [`STEPS`].
const HALVES: usize = 4;
/// Rays about the normal of each pixel's surface.
const SPREAD: u8 = 3;
/// From the rays of each pixel to those of the next, rad.
const GOLDEN_ANGLE: f32 = 2.399_963;
/// Rounds of the timed rays.
const ROUNDS: usize = 5;

/// A way to cull.
struct Way {
    name: &'static str,
    make: fn(f32) -> Culling,
    /// The first threshold.
    coarsest: f32,
    /// From each to the next.
    factor: f32,
}

const WAYS: [Way; 4] = [
    Way { name: "distance", make: |limit| Culling::Distance(Meters(limit)), coarsest: 8.0, factor: STEP },
    Way { name: "expanded frustum", make: |limit| Culling::Frustum(Meters(limit)), coarsest: 1.0, factor: STEP },
    Way { name: "size", make: |limit| Culling::Size(Meters(limit)), coarsest: 0.3, factor: 1.0 / STEP },
    Way { name: "solid angle", make: Culling::SolidAngle, coarsest: 1e-3, factor: 1.0 / (STEP * STEP) },
];

/// One rendering with fewer instances.
struct Trial {
    culling: Culling,
    removed: f64,
    error: f64,
    image: Image<LinearRgb>,
}

/// The scene, and what does not change.
struct Subject {
    scene: Scene,
    snapshot: Snapshot,
    settings: Settings,
    spp: u32,
    /// With all instances, by seed.
    references: [Image<LinearRgb>; 2],
    mean: f64,
}

impl Subject {
    fn new(bench: &Bench) -> Result<(Self, Vec<Ray>), LabError> {
        let size = if bench.quick { UVec2::new(160, 90) } else { UVec2::new(480, 270) };
        let scene = load("builtin:scatter:10000", &LoadOptions::default())?;
        let snapshot = Snapshot::new(&scene, Seconds(0.0));
        let settings = Settings {
            size,
            // Points at pixel centres would meet a body that fills a hundredth of a pixel in full, or not.
            filter: Filter::Box,
            max_depth: 2,
            aovs: vec![Aov::SpecularIndirect, Aov::Position, Aov::ShadingNormal, Aov::Coverage],
            ..Settings::default()
        };
        let spp = if bench.quick { 16 } else { 64 };
        let tracer = Tracer::new(&scene, snapshot.clone())?;
        let frame = rendered(&tracer, &settings, spp, 0)?;
        let rays = secondary_rays(&frame, snapshot.cameras[0].world_from_view.w_axis.truncate());
        let references = [reflection(&frame), reflection(&rendered(&tracer, &settings, spp, 1)?)];
        let values = references[0].pixels().iter().map(|p| f64::from(p.0.element_sum()) / 3.0);
        let mean = values.sum::<f64>() / references[0].pixels().len() as f64;
        Ok((Self { scene, snapshot, settings, spp, references, mean }, rays))
    }

    fn kept(&self, culling: Culling) -> Vec<bool> {
        let aspect = self.settings.size.x as f32 / self.settings.size.y as f32;
        culling.kept(&self.scene, &self.snapshot, &self.snapshot.cameras[0], aspect)
    }

    fn trial(&self, culling: Culling) -> Result<Trial, LabError> {
        let kept = self.kept(culling);
        let removed = kept.iter().filter(|kept| !**kept).count() as f64 / kept.len() as f64;
        let tracer = Tracer::new(&self.scene, self.snapshot.clone())?.with_culling(culling, &self.settings)?;
        let [first, second] = [0, 1].map(|seed| rendered(&tracer, &self.settings, self.spp, seed).map(|frame| reflection(&frame)));
        let images = [first?, second?];
        let error = mse(&images, &self.references).max(0.0).sqrt() / self.mean;
        let [image, _] = images;
        Ok(Trial { culling, removed, error, image })
    }

    /// The trials of a way: from coarse to fine until the error is small enough, then by halves of the last step, in the order of what is left out.
    fn trials(&self, way: &Way) -> Result<Vec<Trial>, LabError> {
        let mut out: Vec<Trial> = Vec::new();
        let mut limit = way.coarsest;
        for _ in 0..STEPS {
            let trial = self.trial((way.make)(limit))?;
            let enough = trial.error < ALLOWED || trial.removed == 0.0;
            out.push(trial);
            if enough {
                break;
            }
            limit *= way.factor;
        }
        let (mut bad, mut good) = (limit / way.factor, limit);
        for _ in 0..HALVES {
            let middle = (bad * good).sqrt();
            let trial = self.trial((way.make)(middle))?;
            *(if trial.error < ALLOWED { &mut good } else { &mut bad }) = middle;
            out.push(trial);
        }
        out.sort_by(|a, b| b.removed.total_cmp(&a.removed));
        Ok(out)
    }

    /// Nodes visited by a ray on average, and rays per second, millions, through the structure of what is kept.
    fn traced(&self, culling: Culling, rays: &[Ray]) -> Result<(f64, f64), LabError> {
        let failed = |e: kajo_bvh::BvhError| LabError::NotMeasured { reason: e.to_string() };
        let blas = |mesh: &Arc<kajo_scene::Mesh>| Ok(Arc::new(Blas::build(&mesh.positions, &mesh.indices, &BuildOptions::default())?));
        let blases = self.snapshot.meshes.iter().map(blas).collect::<Result<Vec<_>, _>>().map_err(failed)?;
        let kept = self.kept(culling);
        let instances = self.snapshot.instances.iter().zip(&kept).filter(|(_, kept)| **kept);
        let placed = instances.map(|(instance, _)| BvhInstance::new(instance.mesh, instance.world_from_object)).collect();
        let tlas = Tlas::build(blases, placed).map_err(failed)?;
        let mut counters = Counters::default();
        for ray in rays {
            tlas.closest_hit_counted(ray, RayFilter::ALL, |_| true, &mut counters);
        }
        let round = || {
            let begin = ThreadTime::now();
            let hits = rays.iter().filter(|ray| tlas.closest_hit_opaque(ray, RayFilter::ALL).is_some()).count();
            std::hint::black_box(hits);
            begin.elapsed().as_secs_f64()
        };
        let best = (0..ROUNDS).map(|_| round()).fold(f64::INFINITY, f64::min);
        Ok((counters.nodes as f64 / rays.len() as f64, rays.len() as f64 / best / 1e6))
    }
}

fn rendered(tracer: &Tracer, settings: &Settings, spp: u32, seed: u64) -> Result<Frame, LabError> {
    let settings = Settings { seed, ..settings.clone() };
    Ok(render(tracer, &settings, Stop::at_spp(spp), None, &uncontrolled)?.develop())
}

/// Mean squared error that the noise of few samples does not raise: the product of the errors of two seeds, whose noise is independent, so that the mean of
/// the product is the square of the mean. May come out below zero where there is none.
fn mse(images: &[Image<LinearRgb>; 2], references: &[Image<LinearRgb>; 2]) -> f64 {
    let error = |seed: usize, i: usize| images[seed].pixels()[i] - references[seed].pixels()[i];
    let count = images[0].pixels().len();
    (0..count).map(|i| f64::from((error(0, i).0 * error(1, i).0).element_sum()) / 3.0).sum::<f64>() / count as f64
}

fn reflection(frame: &Frame) -> Image<LinearRgb> {
    frame.image(&Aov::SpecularIndirect.to_string()).expect("an image that was asked for").pixels.to_color()
}

/// Rays that leave what is seen: one in the mirror direction, and [`SPREAD`] about the normal by the cosine.
fn secondary_rays(frame: &Frame, eye: Vec3) -> Vec<Ray> {
    let image = |aov: Aov| &frame.image(&aov.to_string()).expect("an image that was asked for").pixels;
    let (position, normal, coverage) = (image(Aov::Position), image(Aov::ShadingNormal), image(Aov::Coverage));
    let seen = |&(x, y): &(u32, u32)| match coverage {
        Pixels::Scalar(image) => *image.get(x, y) > 0.5,
        Pixels::Color(_) | Pixels::Vector(_) => false,
    };
    let pixels = (0..frame.size.y).flat_map(|y| (0..frame.size.x).map(move |x| (x, y))).filter(seen);
    let rays = |(x, y): (u32, u32)| {
        let (p, n) = (position.get(x, y), normal.get(x, y).normalize_or_zero());
        let origin = p + n * 1e-3 * p.distance(eye).max(1.0);
        let (tangent, bitangent) = n.any_orthonormal_pair();
        let turn = (x + frame.size.x * y) as f32 * GOLDEN_ANGLE;
        let spread = move |k: u8| {
            let (share, angle) = ((f32::from(k) + 0.5) / f32::from(SPREAD), turn + f32::from(k) * TAU / f32::from(SPREAD));
            (tangent * angle.cos() + bitangent * angle.sin()) * share.sqrt() + n * (1.0 - share).sqrt()
        };
        let directions = std::iter::once((p - eye).normalize_or_zero().reflect(n)).chain((0..SPREAD).map(spread));
        directions.map(move |direction| Ray::new(origin, direction))
    };
    pixels.flat_map(rays).collect()
}

fn run(bench: &Bench) -> Result<Findings, LabError> {
    bench.at("all instances", 0.0)?;
    let (subject, rays) = Subject::new(bench)?;
    let (nodes, speed) = subject.traced(Culling::Off, &rays)?;
    let mut out = Findings::default();
    let columns = ["way", "threshold", "left out, %", "error of the reflection, %", "nodes a ray", "of all, %", "Mrays/s", "of all, %"];
    let mut table = Table::new("culling", "The most that each way leaves out with an error below one per cent.", &columns);
    let mut series = Vec::new();
    // Of the way that leaves out most: share, nodes a ray, and what it is.
    let mut most: Option<(f64, f64, String)> = None;
    let show = |image: &Image<LinearRgb>| tone_map(image, 1.0, ToneMap::Linear);
    out.pictures.push(Picture {
        name: "all".into(),
        caption: "The reflection with all instances.".into(),
        image: show(&subject.references[0]),
    });
    for (number, way) in WAYS.iter().enumerate() {
        bench.at(way.name, (1.0 + number as f64) / (1.0 + WAYS.len() as f64))?;
        let trials = subject.trials(way)?;
        series.push(Series {
            name: way.name.into(),
            points: trials.iter().map(|trial| [100.0 * trial.removed, 100.0 * trial.error]).collect(),
        });
        let Some(best) = trials.iter().find(|trial| trial.error < ALLOWED) else {
            out.claim("Some instances can be left out unseen.", false, format!("no threshold of {} tried stays below 1 %", way.name));
            continue;
        };
        let (fewer, faster) = subject.traced(best.culling, &rays)?;
        if most.as_ref().is_none_or(|(removed, ..)| best.removed > *removed) {
            most = Some((best.removed, fewer, best.culling.to_string()));
        }
        let text = best.culling.to_string();
        let threshold = text.split(':').next_back().unwrap_or(&text);
        let percent = |share: f64| (100.0 * share).into();
        table.row([
            way.name.into(),
            threshold.into(),
            percent(best.removed),
            percent(best.error),
            fewer.into(),
            percent(fewer / nodes),
            faster.into(),
            percent(faster / speed),
        ]);
        if way.name == "solid angle" {
            let measured = format!(
                "{:.1} % of {} instances left out by {text}: error {:.2} %",
                100.0 * best.removed,
                subject.snapshot.instances.len(),
                100.0 * best.error
            );
            out.claim(
                "Three instances in ten and more can be left out by solid angle with an error below one per cent.",
                best.removed >= WANTED && best.error < ALLOWED,
                measured,
            );
            let caption = format!("The reflection with {text}.");
            out.pictures.push(Picture { name: "solid-angle".into(), caption, image: show(&best.image) });
            let coarse = &trials[0];
            let caption = format!("The same with {}: too much is missing.", coarse.culling);
            out.pictures.push(Picture { name: "solid-angle-coarse".into(), caption, image: show(&coarse.image) });
            out.claim(
                "Leaving out too much shows.",
                coarse.error > ALLOWED && coarse.removed > best.removed,
                format!("{:.1} %", 100.0 * coarse.error),
            );
        }
    }
    if let Some((removed, fewer, culling)) = most {
        let measured = format!("{fewer:.2} nodes a ray instead of {nodes:.2}, with {culling} and {:.1} % left out", 100.0 * removed);
        out.claim("Rays visit fewer nodes by the way that leaves out most.", fewer < 0.95 * nodes, measured);
    }
    out.tables.push(table);
    out.plots.push(Plot {
        name: "culling".into(),
        caption: "Error of the reflection over the share of instances that are left out.".into(),
        axes: ["instances left out, %".into(), "RMSE over the mean of the reflection, %".into()],
        scales: [Scale::Linear, Scale::Logarithmic],
        series,
    });
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Independent noise of both seeds leaves the mean product at the square of the bias; the plain error would be the noise.
    #[test]
    fn noise_does_not_raise_the_error_and_a_planted_one_is_found() {
        let size = UVec2::new(200, 200);
        let noise = |salt: u32| {
            Image::from_fn(size, |x, y| {
                let word = (x + 200 * y + 77_777 * salt).wrapping_mul(0x9e37_79b9).rotate_left(13).wrapping_mul(0x85eb_ca6b);
                LinearRgb::splat((word >> 8) as f32 / (1 << 24) as f32 - 0.5)
            })
        };
        let references = [noise(1), noise(2)];
        let with = |salt: u32, bias: f32| noise(salt).map(|p| *p + LinearRgb::splat(bias));
        let error = |bias: f32| mse(&[with(3, bias), with(4, bias)], &references);
        assert!(error(0.0).abs() < 0.005, "{}", error(0.0));
        assert!((error(0.3) - 0.09).abs() < 0.02, "{}", error(0.3));
    }
}

//! Instances that reflections do without.    \[Varjus23] section 7.2

mod device;
mod rays;
mod search;

use super::{Bench, Findings, Picture, Plot, Scale, Series, Study, Table};
use crate::LabError;
use device::pass_times;
use glam::UVec2;
use kajo_image::{Image, ToneMap, tone_map};
use kajo_path_tracer::{Aov, Filter, Frame, Settings, Stop, Tracer, render, uncontrolled};
use kajo_scene::{Culling, LoadOptions, Scene, Snapshot, load};
use kajo_techniques::TraceBackend;
use kajo_units::{LinearRgb, Meters, Seconds};
use rays::{Kind, Work, secondary_rays};
use search::search;

/// The study.
pub const STUDY: Study =
    Study { id: "instance-culling", title: "How many instances does a reflection need?", doc: include_str!("doc.md"), run };

/// Most that the reflection may be off: RMSE over its mean.
const ALLOWED: f64 = 0.01;
/// Share of instances that a good threshold leaves out.
const WANTED: f64 = 0.3;
/// Factor between thresholds that are lengths.
const STEP: f32 = 2.0;

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

/// The reflection with all instances, by the random numbers of a seed.
struct Reference {
    seed: u64,
    image: Image<LinearRgb>,
}

/// The scene, and what does not change.
struct Subject {
    scene: Scene,
    snapshot: Snapshot,
    settings: Settings,
    spp: u32,
    /// With all instances: those that thresholds are chosen by, and others.
    references: [Reference; 2],
    fresh: [Reference; 2],
    mean: f64,
}

impl Subject {
    fn new(bench: &Bench) -> Result<(Self, [Kind; 2]), LabError> {
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
        let reference = |seed| Ok::<_, LabError>(Reference { seed, image: reflection(&rendered(&tracer, &settings, spp, seed)?) });
        let (references, fresh) = ([Reference { seed: 0, image: reflection(&frame) }, reference(1)?], [reference(2)?, reference(3)?]);
        let values = references[0].image.pixels().iter().map(|p| f64::from(p.0.element_sum()) / 3.0);
        let mean = values.sum::<f64>() / references[0].image.pixels().len() as f64;
        Ok((Self { scene, snapshot, settings, spp, references, fresh, mean }, rays))
    }

    fn kept(&self, culling: Culling) -> Vec<bool> {
        let aspect = self.settings.size.x as f32 / self.settings.size.y as f32;
        culling.kept(&self.scene, &self.snapshot, &self.snapshot.cameras[0], aspect)
    }

    fn trial(&self, culling: Culling, references: &[Reference; 2]) -> Result<Trial, LabError> {
        let kept = self.kept(culling);
        let removed = kept.iter().filter(|kept| !**kept).count() as f64 / kept.len() as f64;
        let tracer = Tracer::new(&self.scene, self.snapshot.clone())?.with_culling(culling, &self.settings)?;
        let [first, second] =
            references.each_ref().map(|r| rendered(&tracer, &self.settings, self.spp, r.seed).map(|frame| reflection(&frame)));
        let images = [first?, second?];
        let error = mse([&images[0], &images[1]], references.each_ref().map(|r| &r.image)).max(0.0).sqrt() / self.mean;
        let [image, _] = images;
        Ok(Trial { culling, removed, error, image })
    }

    /// The trials of a way, in the order of what is left out.
    fn trials(&self, way: &Way) -> Result<Vec<Trial>, LabError> {
        let mut out: Vec<Trial> = Vec::new();
        search(way.coarsest, way.factor, |limit| {
            let trial = self.trial((way.make)(limit), &self.references)?;
            let is_good = trial.error < ALLOWED;
            out.push(trial);
            Ok::<_, LabError>(is_good)
        })?;
        out.sort_by(|a, b| b.removed.total_cmp(&a.removed));
        Ok(out)
    }

    /// The trial that leaves out most with an error that is allowed, also by seeds that had no part in its choice, by which it is told.
    fn best(&self, trials: &[Trial]) -> Result<Option<Trial>, LabError> {
        for chosen in trials.iter().filter(|trial| trial.error < ALLOWED) {
            let again = self.trial(chosen.culling, &self.fresh)?;
            if again.error < ALLOWED {
                return Ok(Some(again));
            }
        }
        Ok(None)
    }
}

fn rendered(tracer: &Tracer, settings: &Settings, spp: u32, seed: u64) -> Result<Frame, LabError> {
    let settings = Settings { seed, ..settings.clone() };
    Ok(render(tracer, &settings, Stop::at_spp(spp), None, &uncontrolled)?.develop())
}

/// Mean squared error that the noise of few samples does not raise: the product of the errors of two seeds, whose noise is independent, so that the mean of
/// the product is the square of the mean. May come out below zero where there is none.
fn mse(images: [&Image<LinearRgb>; 2], references: [&Image<LinearRgb>; 2]) -> f64 {
    let error = |seed: usize, i: usize| images[seed].pixels()[i] - references[seed].pixels()[i];
    let count = images[0].pixels().len();
    (0..count).map(|i| f64::from((error(0, i).0 * error(1, i).0).element_sum()) / 3.0).sum::<f64>() / count as f64
}

fn reflection(frame: &Frame) -> Image<LinearRgb> {
    frame.image(&Aov::SpecularIndirect.to_string()).expect("an image that was asked for").pixels.to_color()
}

fn run(bench: &Bench) -> Result<Findings, LabError> {
    bench.at("all instances", 0.0)?;
    let (subject, kinds) = Subject::new(bench)?;
    let work = |culling: Culling| {
        let kept = subject.kept(culling);
        let [mirror, about] = kinds.each_ref().map(|kind| Work::of(&kind.rays, &subject.snapshot, &kept));
        Ok::<_, LabError>([mirror?, about?])
    };
    let all = work(Culling::Off)?;
    let mut out = Findings::default();
    let columns = ["way", "threshold", "left out, %", "error of the reflection, %"];
    let mut table = Table::new("culling", "The most that each way leaves out with an error below one per cent.", &columns);
    let columns = [
        "way",
        "rays",
        "nodes a ray",
        "instances a ray",
        "triangles a ray",
        "tests, % of those with all",
        "Mrays/s",
        "of that with all, %",
    ];
    let mut cost = Table::new("cost", "What rays cost with what is left.", &columns);
    let mut tell = |name: &str, works: &[Work; 2]| {
        for ((kind, work), all) in kinds.iter().zip(works).zip(&all) {
            let percent = |share: f64| (100.0 * share).into();
            cost.row([
                name.into(),
                kind.name.into(),
                work.nodes.into(),
                work.instances.into(),
                work.triangles.into(),
                percent(work.total() / all.total()),
                work.speed.into(),
                percent(work.speed / all.speed),
            ]);
        }
    };
    tell("all instances", &all);
    // Times are no test.
    let size = UVec2::new(320, 180);
    let times = |culling: Culling| {
        if bench.quick { Ok(Vec::new()) } else { pass_times(bench.device, &subject.scene, &subject.snapshot, size, culling) }
    };
    let all_times = times(Culling::Off)?;
    let columns = ["way", "rays by", "ms", "of that with all, %"];
    let mut passes = Table::new("passes", "Time of the pass `reflection/ray-traced` in the real-time renderer.", &columns);
    let mut tell_times = |name: &str, times: &[(TraceBackend, f64)]| {
        for ((backend, ms), (_, all)) in times.iter().zip(&all_times) {
            passes.row([name.into(), backend.id().into(), (*ms).into(), (100.0 * ms / all).into()]);
        }
    };
    tell_times("all instances", &all_times);
    let mut series = Vec::new();
    // Of the way that leaves out most: share, work, and what it is.
    let mut most: Option<(f64, [Work; 2], String)> = None;
    let show = |image: &Image<LinearRgb>| tone_map(image, 1.0, ToneMap::Linear);
    out.pictures.push(Picture {
        name: "all".into(),
        caption: "The reflection with all instances.".into(),
        image: show(&subject.references[0].image),
    });
    for (number, way) in WAYS.iter().enumerate() {
        bench.at(way.name, (1.0 + number as f64) / (1.0 + WAYS.len() as f64))?;
        let trials = subject.trials(way)?;
        series.push(Series {
            name: way.name.into(),
            points: trials.iter().map(|trial| [100.0 * trial.removed, 100.0 * trial.error]).collect(),
        });
        let Some(best) = subject.best(&trials)? else {
            out.claim("Some instances can be left out unseen.", false, format!("no threshold of {} tried stays below 1 %", way.name));
            continue;
        };
        let works = work(best.culling)?;
        tell(way.name, &works);
        let way_times = times(best.culling)?;
        tell_times(way.name, &way_times);
        if most.as_ref().is_none_or(|(removed, ..)| best.removed > *removed) {
            most = Some((best.removed, works, best.culling.to_string()));
        }
        let text = best.culling.to_string();
        let threshold = text.split(':').next_back().unwrap_or(&text);
        table.row([way.name.into(), threshold.into(), (100.0 * best.removed).into(), (100.0 * best.error).into()]);
        if way.name == "solid angle" {
            solid_angle(&mut out, &subject, &trials, &best);
            let entered = [works, all].map(|kinds| kinds.map(|work| work.instances));
            let tests: Vec<f64> = works.iter().zip(&all).map(|(work, all)| 100.0 * work.total() / all.total()).collect();
            let measured = format!(
                "{:.4} instances entered a mirror ray instead of {:.4}, {:.4} instead of {:.4} about the normal; {:.1} and {:.1} % of the tests",
                entered[0][0], entered[1][0], entered[0][1], entered[1][1], tests[0], tests[1]
            );
            let holds = entered[0].iter().zip(entered[1]).all(|(now, before)| *now > 0.98 * before);
            out.claim("What can be left out by solid angle unseen, rays hardly met: they enter as many instances.", holds, measured);
            if let (Some((backend, now)), Some((_, before))) = (way_times.first(), all_times.first()) {
                let measured = format!("{now:.0} ms instead of {before:.0} by {}, {size}", backend.id());
                out.claim("The pass of reflections takes less time with what solid angle leaves.", now < before, measured);
            }
        }
    }
    if let Some((removed, works, culling)) = most {
        let [fewer, before] = [works, all].map(|[mirror, about]| [mirror.nodes, about.nodes]);
        let measured = format!(
            "{:.2} nodes a mirror ray instead of {:.2}, {:.2} instead of {:.2} about the normal, with {culling} and {:.1} % left out",
            fewer[0],
            before[0],
            fewer[1],
            before[1],
            100.0 * removed
        );
        let holds = fewer.iter().zip(before).all(|(fewer, before)| *fewer < 0.95 * before);
        out.claim("Rays visit fewer nodes by the way that leaves out most.", holds, measured);
    }
    out.tables.extend([table, cost]);
    if !all_times.is_empty() {
        out.tables.push(passes);
    }
    out.plots.push(Plot {
        name: "culling".into(),
        caption: "Error of the reflection over the share of instances that are left out.".into(),
        axes: ["instances left out, %".into(), "RMSE over the mean of the reflection, %".into()],
        scales: [Scale::Linear, Scale::Logarithmic],
        series,
    });
    Ok(out)
}

/// What is claimed of culling by solid angle, and pictures of it.
fn solid_angle(out: &mut Findings, subject: &Subject, trials: &[Trial], best: &Trial) {
    let show = |image: &Image<LinearRgb>| tone_map(image, 1.0, ToneMap::Linear);
    let text = best.culling.to_string();
    let count = subject.snapshot.instances.len();
    let measured =
        format!("{:.1} % of {count} instances left out by {text}: error {:.2} % by fresh seeds", 100.0 * best.removed, 100.0 * best.error);
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
    let shows = coarse.error > ALLOWED && coarse.removed > best.removed;
    out.claim("Leaving out too much shows.", shows, format!("{:.1} %", 100.0 * coarse.error));
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
        let error = |bias: f32| mse([&with(3, bias), &with(4, bias)], references.each_ref());
        assert!(error(0.0).abs() < 0.005, "{}", error(0.0));
        assert!((error(0.3) - 0.09).abs() < 0.02, "{}", error(0.3));
    }
}

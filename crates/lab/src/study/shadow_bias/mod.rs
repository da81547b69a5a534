//! Acne and detachment of the biases of `shadow/map`, over the slope of the floor.

use super::rig::{looking, shining};
use super::{Bench, Findings, Plot, Rig, Scale, Series, Set, Study, Table};
use crate::LabError;
use glam::{Affine3A, UVec2, Vec3};
use kajo_image::Image;
use kajo_scene::{LightShape, Projection, shapes};
use kajo_units::{Meters, Radians};
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

/// The study.
pub const STUDY: Study = Study { id: "shadow-bias", title: "What bias do shadow maps need?", doc: include_str!("doc.md"), run };

const RESOLUTION: u32 = 512;
/// Half the angle of the cone, and the distance of the light: texels of 8 mm where it shines straight down.
const OUTER: f32 = 0.2;
const DISTANCE: f32 = 10.0;
/// Height of the wall, m.
const WALL: f32 = 0.4;

/// A bias, and the parameter that is its strength.
struct Kind {
    name: &'static str,
    params: &'static str,
    /// Name of the strength and its default; none for the automatic bias.
    strength: Option<(&'static str, f64)>,
}

const KINDS: [Kind; 4] = [
    Kind { name: "automatic", params: "bias=automatic", strength: None },
    Kind { name: "constant", params: "bias=constant", strength: Some(("constant_bias", 0.005)) },
    Kind { name: "slope-scaled", params: "bias=slope-scaled,constant_bias=0", strength: Some(("slope_bias", 1.5)) },
    Kind { name: "normal-offset", params: "bias=normal-offset,constant_bias=0", strength: Some(("normal_offset", 2.0)) },
];

/// What was measured at one slope.
#[derive(Clone, Copy, Debug)]
struct Sample {
    slope: f64,
    /// Share of the floor.
    acne: f64,
    /// Texels; not a number where the wall casts no shadow.
    detachment: f64,
    retreat: f64,
}

struct Measurement {
    bare: Rig,
    walled: Rig,
    /// What the path tracer sees of the walled floor, by the bits of the slope: biases share it.
    truths: BTreeMap<u64, Image<f32>>,
}

fn scene(wall: bool, size: UVec2) -> Set {
    let floor = shapes::floor(60.0, 60.0, 1.0);
    let mut set = Set::default().place(floor, Affine3A::IDENTITY);
    if wall {
        let half = Vec3::new(0.01, 0.5 * WALL, 0.6);
        set = set.place(shapes::cuboid(half), Affine3A::from_translation(Vec3::new(-half.x, half.y, 0.0)));
    }
    let aspect = size.x as f32 / size.y as f32;
    let view = Projection::Orthographic { xmag: Meters(1.0), ymag: Meters(1.0 / aspect) };
    let spot = LightShape::Spot { inner: Radians(OUTER), outer: Radians(OUTER) };
    set.light(spot, Vec3::Y, Vec3::ZERO).camera(view, Vec3::Y, Vec3::ZERO)
}

impl Measurement {
    fn new(bench: &Bench) -> Result<Self, LabError> {
        let (bare, walled) = (UVec2::new(96, 96), UVec2::new(240, 24));
        Ok(Self {
            bare: Rig::new(bench.device, scene(false, bare).scene, bare)?,
            walled: Rig::new(bench.device, scene(true, walled).scene, walled)?,
            truths: BTreeMap::new(),
        })
    }

    /// Share of the bare floor that is not fully lit.
    fn acne(&mut self, technique: &str, slope: f64) -> Result<f64, LabError> {
        let (sin, cos) = (slope.to_radians().sin() as f32, slope.to_radians().cos() as f32);
        // Not along an axis of the map: its rows must cross the slope.
        let to_light = Vec3::new(0.8 * sin, cos, 0.6 * sin);
        self.bare.snapshot.lights[0].world_from_light = shining(to_light * DISTANCE, Vec3::ZERO);
        self.bare.snapshot.cameras[0].world_from_view = looking(Vec3::new(0.013, 3.0, 0.007), Vec3::new(0.013, 0.0, 0.007));
        let out = self.bare.frame(technique)?;
        let dark = out.visibility[0].pixels().iter().filter(|v| **v < 1.0).count();
        Ok(dark as f64 / out.visibility[0].pixels().len() as f64)
    }

    /// Lengths of the lit strip at the wall's foot and of the missing end of its shadow, texels.
    fn shadow(&mut self, technique: &str, slope: f64) -> Result<[f64; 2], LabError> {
        let (sin, cos) = (slope.to_radians().sin() as f32, slope.to_radians().cos() as f32);
        let length = WALL * sin / cos;
        let texel = 2.0 * DISTANCE * OUTER.tan() / RESOLUTION as f32;
        if length < 4.0 * texel {
            return Ok([f64::NAN; 2]);
        }
        self.walled.snapshot.lights[0].world_from_light = shining(Vec3::new(-sin, cos, 0.0) * DISTANCE, Vec3::ZERO);
        // From straight above, as wide as the shadow is long.
        let half = 0.6 * length;
        let size = self.walled.size();
        let view = Projection::Orthographic { xmag: Meters(half), ymag: Meters(half * size.y as f32 / size.x as f32) };
        let middle = Vec3::new(half * 0.95, 0.0, 0.0);
        self.walled.snapshot.cameras[0].camera.projection = view;
        self.walled.snapshot.cameras[0].world_from_view = looking(middle + Vec3::Y * 3.0, middle);
        let truth = match self.truths.entry(slope.to_bits()) {
            Entry::Occupied(known) => known.into_mut(),
            Entry::Vacant(unknown) => unknown.insert(self.walled.visibility(1)?),
        };
        let out = self.walled.frame(technique)?;
        let (mut lost, mut rows, mut cut) = ([0.0f64; 2], 0u32, false);
        for y in 0..size.y {
            let shaded: Vec<u32> = (0..size.x).filter(|&x| *truth.get(x, y) < 0.5).collect();
            let (Some(first), Some(last)) = (shaded.first(), shaded.last()) else { continue };
            rows += 1;
            cut |= *last == size.x - 1;
            let middle = (first + last) / 2;
            for x in shaded {
                lost[usize::from(x > middle)] += f64::from(*out.visibility[0].get(x, y));
            }
        }
        let pixel = f64::from(2.0 * half) / f64::from(size.x);
        let [detachment, retreat] = lost.map(|sum| sum / f64::from(rows.max(1)) * pixel / f64::from(texel));
        // A shadow that leaves the picture has its end elsewhere.
        Ok([detachment, if cut { f64::NAN } else { retreat }])
    }

    fn sample(&mut self, technique: &str, slope: f64) -> Result<Sample, LabError> {
        let [detachment, retreat] = self.shadow(technique, slope)?;
        Ok(Sample { slope, acne: self.acne(technique, slope)?, detachment, retreat })
    }
}

fn technique(params: &str) -> String {
    format!("shadow/map:resolution={RESOLUTION},kernel=1,{params}")
}

fn run(bench: &Bench) -> Result<Findings, LabError> {
    let step = if bench.quick { 17.0 } else { 5.0 };
    let slopes: Vec<f64> = (0..).map(|i| f64::from(i) * step).take_while(|slope| *slope <= 85.0).collect();
    let mut measurement = Measurement::new(bench)?;
    let mut curves: Vec<(String, Vec<Sample>)> = Vec::new();
    for (index, kind) in KINDS.iter().enumerate() {
        bench.at(kind.name, index as f64 / KINDS.len() as f64)?;
        let mut settings = vec![match kind.strength {
            None => (kind.name.to_owned(), kind.params.to_owned()),
            Some((name, default)) => (format!("{} {default}, default", kind.name), format!("{},{name}={default}", kind.params)),
        }];
        if let Some((name, _)) = kind.strength {
            let least = least_without_acne(&mut measurement, kind.params, name, &slopes)?;
            settings.push((format!("{} {least}, least clean", kind.name), format!("{},{name}={least}", kind.params)));
        }
        for (label, params) in settings {
            let samples = slopes.iter().map(|&slope| measurement.sample(&technique(&params), slope)).collect::<Result<Vec<_>, _>>()?;
            curves.push((label, samples));
        }
    }
    Ok(findings(&curves))
}

/// The least strength, to a sixteenth, with which the bare floor is fully lit at every slope.
fn least_without_acne(measurement: &mut Measurement, params: &str, name: &str, slopes: &[f64]) -> Result<f64, LabError> {
    let mut clean = |strength: f64| {
        // The steepest slope first: it needs most, as a rule.
        for &slope in slopes.iter().rev() {
            if measurement.acne(&technique(&format!("{params},{name}={strength}")), slope)? > 0.0 {
                return Ok(false);
            }
        }
        Ok::<bool, LabError>(true)
    };
    let mut high = 1.0 / 64.0;
    while high < 32.0 && !clean(high)? {
        high *= 2.0;
    }
    let mut low = 0.5 * high;
    for _ in 0..3 {
        let middle = 0.5 * (low + high);
        if clean(middle)? { high = middle } else { low = middle }
    }
    Ok(high)
}

fn findings(curves: &[(String, Vec<Sample>)]) -> Findings {
    let mut table = Table::new(
        "bias",
        "Acne, detachment and retreat of each bias at each slope.",
        &["bias", "slope, °", "acne, %", "detachment, texels", "retreat, texels"],
    );
    for (label, samples) in curves {
        for s in samples {
            table.row([label.as_str().into(), s.slope.into(), (100.0 * s.acne).into(), s.detachment.into(), s.retreat.into()]);
        }
    }
    let plot = |name: &str, caption: &str, y: &str, value: &dyn Fn(&Sample) -> f64| Plot {
        name: name.into(),
        caption: caption.into(),
        axes: ["slope, °".into(), y.into()],
        scales: [Scale::Linear; 2],
        series: curves
            .iter()
            .map(|(name, samples)| Series { name: name.clone(), points: samples.iter().map(|s| [s.slope, value(s)]).collect() })
            .collect(),
    };
    let mut out = Findings {
        plots: vec![
            plot("acne", "Acne over the slope.", "acne, % of the floor", &|s| 100.0 * s.acne),
            plot("detachment", "Detachment over the slope.", "lit strip at the foot of the wall, texels", &|s| s.detachment),
            plot("retreat", "Retreat over the slope.", "missing end of the shadow, texels", &|s| s.retreat),
        ],
        tables: vec![table],
        ..Findings::default()
    };
    let acne = |samples: &[Sample]| samples.iter().map(|s| s.acne).fold(0.0, f64::max);
    // Less than any where nothing was measured: then no claim holds.
    let worst = |samples: &[Sample]| samples.iter().map(|s| s.detachment).filter(|d| d.is_finite()).fold(f64::NEG_INFINITY, f64::max);
    let (_, automatic) = &curves[0];
    out.claim("The automatic bias has no acne at any slope.", acne(automatic) == 0.0, format!("at most {} %", 100.0 * acne(automatic)));
    let others: Vec<(&str, f64)> =
        curves[1..].iter().filter(|(_, samples)| acne(samples) == 0.0).map(|(name, samples)| (name.as_str(), worst(samples))).collect();
    let least = others.iter().map(|(_, d)| *d).fold(f64::INFINITY, f64::min);
    let list: Vec<String> = others.iter().map(|(name, d)| format!("{name}: {d:.2}")).collect();
    out.claim(
        "Of all biases without acne none detaches shadows less than the automatic one.",
        worst(automatic).is_finite() && least.is_finite() && worst(automatic) <= least + 0.02,
        format!("greatest detachment {:.2} texels; {}", worst(automatic), list.join(", ")),
    );
    let constant = curves.iter().find(|(name, _)| name.starts_with("constant 0.005")).map(|(_, samples)| acne(samples));
    out.claim(
        "A constant bias that suits gentle slopes leaves acne on steep ones.",
        constant.is_some_and(|acne| acne > 0.01),
        format!("up to {:.1} %", 100.0 * constant.unwrap_or(0.0)),
    );
    out
}

//! One run on the device: images for several seeds, and the cost of a frame.

use crate::judge::Take;
use crate::plan::Choice;
use crate::report::Cost;
use kajo_image::Image;
use kajo_renderer::{Error, FrameOutput, FrameSettings, Read, Renderer, RoleSelection};
use kajo_scene::Ignored;
use kajo_techniques::Role;
use kajo_units::LinearRgb;
use std::collections::BTreeMap;
use std::time::Instant;

/// Frames before the clock counts: shaders, caches and clocks settle.
pub const WARM_UP_FRAMES: u32 = 3;

/// What was measured.
#[derive(Clone, Debug)]
pub struct Measured {
    /// One for each seed.
    pub takes: Vec<Take>,
    /// Of a frame.
    pub cost: Cost,
    /// What the renderer and the technique took otherwise than the scene has it.
    pub ignored: Vec<Ignored>,
}

/// How the role's images are seen.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    /// Role ambient visibility: how far a surface blocks, m.
    pub ambient_distance: f32,
}

impl Seen {
    /// Of a frame that gives the image of `role`. Edges are judged by the light of lights alone: that of the environment is only as right as the techniques
    /// of other roles.
    pub fn settings(&self, role: Role) -> FrameSettings {
        FrameSettings {
            ambient_distance: self.ambient_distance,
            read: Read::One(role),
            environment_light: role != Role::AntiAlias,
            ..FrameSettings::default()
        }
    }
}

/// Renders `frames` timed frames, with numbers from `seed` on, and `repeat` takes: each is one frame; of techniques that keep a history the frame after which that
/// has forgotten how it began, each take begun anew.
///
/// # Errors
/// When the technique cannot run on this device or the device fails.
pub fn measure(
    renderer: &mut Renderer,
    role: Role,
    choice: &Choice,
    (seed, frames, repeat): (u64, u32, u32),
    seen: Seen,
) -> Result<Measured, Error> {
    let selection = RoleSelection::new().with(choice.technique, choice.params.clone());
    let settings = |frame: u32| FrameSettings { index: (seed as u32).wrapping_add(frame), ..seen.settings(role) };
    let of = |list: &[(&str, u64)]| list.iter().filter(|(id, _)| *id == choice.technique.id).map(|(_, count)| count).sum();
    for frame in 0..WARM_UP_FRAMES {
        renderer.render(&selection, &settings(frame))?;
    }
    let (mut takes, mut gpu, mut cpu) = (Vec::new(), Vec::new(), Vec::new());
    let (mut rays, mut memory_bytes) = (0, 0);
    let (mut statistics, mut ignored) = (BTreeMap::<String, Vec<u64>>::new(), Vec::new());
    let settled = renderer.history(&selection)?.max(1);
    // Numbers that do not follow each other begin anew.
    let gap = u32::from(settled > 1);
    let mut timed = 0;
    for number in 0..repeat.max(frames.div_ceil(settled)) {
        for step in 0..settled {
            let first = number == 0 && step == 0;
            let start = Instant::now();
            let output = renderer.render(&selection, &settings(number * (settled + gap) + step))?;
            if timed < frames {
                timed += 1;
                cpu.push(start.elapsed().as_secs_f64() * 1e3);
                gpu.push(output.timings.sum_of(choice.technique.id));
                rays = of(&output.technique_rays);
                if first {
                    output.statistics.iter().for_each(|s| statistics.entry(s.name.to_owned()).or_default().push(s.value));
                    ignored.clone_from(&output.ignored);
                }
                memory_bytes = of(&output.technique_bytes);
            }
            if number < repeat && step + 1 == settled {
                takes.push(take(role, &output));
            } else if timed == frames && number >= repeat {
                break;
            }
        }
    }
    let lights = renderer.light_names().len();
    let per_light = role == Role::DirectVisibility && lights > 0;
    let cost = Cost {
        gpu_ms: Some(percentile(&gpu, 0.5)),
        gpu_ms_per_light: per_light.then(|| percentile(&gpu, 0.5) / lights as f64),
        gpu_ms_p95: Some(percentile(&gpu, 0.95)),
        cpu_ms: percentile(&cpu, 0.5),
        memory_bytes,
        rays,
        statistics,
    };
    Ok(Measured { takes, cost, ignored })
}

/// The role's images out of a frame, in the order of [`Judge::parts`](crate::judge::Judge::parts) where the renderer watches the lights that are judged.
pub fn take(role: Role, output: &FrameOutput) -> Take {
    let grey = |image: &Image<f32>| image.map(|&v| LinearRgb::splat(v));
    match role {
        Role::DirectVisibility => Take { parts: output.visibility.iter().map(grey).collect(), composed: Some(output.direct.clone()) },
        Role::AmbientVisibility | Role::DiffuseIndirect | Role::SpecularIndirect => {
            Take { parts: output.estimate(role).into_iter().cloned().collect(), composed: None }
        }
        Role::AntiAlias => Take { parts: vec![output.color.clone()], composed: None },
        _ => Take { parts: vec![output.direct.clone()], composed: None },
    }
}

/// Nearest rank: the smallest value that `share` of all do not exceed.
fn percentile(values: &[f64], share: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let rank = (share * sorted.len() as f64).ceil() as usize;
    sorted[rank.clamp(1, sorted.len()) - 1]
}

#[cfg(test)]
mod tests {
    use super::percentile;

    #[test]
    fn percentiles_are_by_nearest_rank() {
        let values: Vec<f64> = (1..=20).rev().map(f64::from).collect();
        assert_eq!((percentile(&values, 0.5), percentile(&values, 0.95)), (10.0, 19.0));
        assert_eq!(percentile(&[7.0], 0.95), 7.0);
    }
}

//! Where paths of light start: at which light, how often, and from where in the sky.

use crate::gi::light_power::light_powers;
use crate::gi::sky::{SkyRay, sky_rays};
use crate::{Error, FrameContext};
use kajo_render_graph::Buffer;
use kajo_render_graph::wgpu::BufferUsages;
use kajo_units::LinearRgb;
use std::f32::consts::PI;

/// Directions of the sky that paths start from.
const SKY_RAYS: u32 = 4096;

/// The environment on the device: it is the scene's, whatever moves.
pub(super) struct Sky {
    /// Its rays.
    pub rays: Buffer,
    /// Mean of the luminance of their weights; `None` where it does not shine.
    mean: Option<f32>,
}

impl Sky {
    pub fn new(frame: &FrameContext) -> Result<Self, Error> {
        let mut rays = sky_rays(frame.scene.environment.as_ref(), SKY_RAYS);
        let mean = || (rays.iter().map(|ray| f64::from(LinearRgb(ray.weight).luminance())).sum::<f64>() / f64::from(SKY_RAYS)) as f32;
        let mean = (!rays.is_empty()).then(mean);
        if mean.is_none() {
            rays.push(SkyRay::default());
        }
        Ok(Self { rays: frame.device.buffer_with("gi/vpl sky", &rays, BufferUsages::STORAGE)?, mean })
    }
}

/// The sources on the device.
pub(super) struct Sources {
    /// Of each, the end of its interval of [0, 1) and its length.
    pub choices: Buffer,
    /// How many; none where nothing shines.
    pub count: u32,
    /// The last one is the environment.
    pub sky_shines: bool,
}

impl Sources {
    pub fn new(frame: &FrameContext, sky: &Sky, radius: f32) -> Result<Self, Error> {
        let mut powers: Vec<f32> = light_powers(frame.scene, frame.snapshot, radius).iter().map(|power| power.luminance()).collect();
        powers.extend(sky.mean.map(|mean| mean * PI * radius * radius));
        let choices = choices(&powers);
        Ok(Self {
            count: choices.len() as u32,
            choices: frame.device.buffer_with("gi/vpl choices", &choices, BufferUsages::STORAGE)?,
            sky_shines: sky.mean.is_some(),
        })
    }
}

/// Ends of intervals of [0, 1) as long as the shares in the power, and their lengths. None where there is no power.
pub(super) fn choices(powers: &[f32]) -> Vec<[f32; 2]> {
    let total: f64 = powers.iter().map(|&power| f64::from(power)).sum();
    if !(total > 0.0 && total.is_finite()) {
        return Vec::new();
    }
    let last = powers.iter().rposition(|&power| power > 0.0).unwrap_or(0);
    let mut sum = 0.0;
    let end = |(i, &power): (usize, &f32)| {
        sum += f64::from(power);
        let end = if i >= last { 2.0 } else { sum / total };
        [end as f32, (f64::from(power) / total) as f32]
    };
    powers.iter().enumerate().map(end).collect()
}

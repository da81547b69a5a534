//! The table by which paths choose what light to look for: see choices.wesl.

use glam::{UVec2, Vec3};
use kajo_scene::{Environment, Scene, Snapshot};
use kajo_techniques::gi::light_powers;
use std::f32::consts::{PI, TAU};

/// Share of choices that ignores power: estimates of power know nothing of distance and shadows. As in the path tracer.
const UNIFORM_CHOICE: f64 = 0.1;

/// Ends of intervals of [0, 2³²).
pub(super) struct Choices {
    /// Of the lights and the environment, of the image's rows, of the texels of each row.
    pub ends: Vec<u32>,
    /// Size of the image; zeros where its light is found by chance alone: none, a constant or a black one.
    pub sky: UVec2,
    /// Some light can be chosen.
    pub any: bool,
}

impl Choices {
    /// `bounds` of what is placed, world, m.
    pub fn new(scene: &Scene, snapshot: &Snapshot, [low, high]: [Vec3; 2]) -> Self {
        let radius = 0.5 * (high - low).length();
        let sky = scene.environment.as_ref().and_then(Sky::new);
        let lights = light_powers(scene, snapshot, radius).into_iter().map(|power| f64::from(power.luminance()));
        let environment = sky.as_ref().map_or(0.0, |sky| f64::from(sky.flux_density * PI * radius * radius));
        let powers: Vec<f64> = lights.chain([environment]).collect();
        let total: f64 = powers.iter().sum();
        let count = powers.iter().filter(|power| **power > 0.0).count() as f64;
        let weight = |power: &f64| if *power > 0.0 { (1.0 - UNIFORM_CHOICE) * power / total + UNIFORM_CHOICE / count } else { 0.0 };
        let mut ends = intervals(&powers.iter().map(weight).collect::<Vec<_>>());
        let size = sky.as_ref().map_or(UVec2::ZERO, |sky| sky.size);
        ends.extend(sky.into_iter().flat_map(|sky| sky.ends));
        Self { ends, sky: size, any: total > 0.0 }
    }
}

/// The image of an environment.
struct Sky {
    size: UVec2,
    ends: Vec<u32>,
    /// ∫ Y dω, W/m².
    flux_density: f32,
}

impl Sky {
    fn new(environment: &Environment) -> Option<Self> {
        let grid = environment.importance()?;
        let size = grid.size();
        let rows: Vec<Vec<f64>> = grid.pixels().chunks_exact(size.x as usize).map(|row| row.iter().map(|&w| w.into()).collect()).collect();
        let sums: Vec<f64> = rows.iter().map(|row| row.iter().sum()).collect();
        let total: f64 = sums.iter().sum();
        let ends = intervals(&sums).into_iter().chain(rows.iter().flat_map(|row| intervals(row))).collect();
        // Weights are ∫ Y sin θ dθ over a texel; columns share 2π.
        (total > 0.0).then(|| Self { size, ends, flux_density: (total / f64::from(size.x)) as f32 * TAU })
    }
}

/// Ends of intervals as long as the weights, which need not sum to 1; the last one with a weight ends at 2³² − 1. Without weights, zeros.
fn intervals(weights: &[f64]) -> Vec<u32> {
    let total: f64 = weights.iter().sum();
    let Some(last) = weights.iter().rposition(|&weight| weight > 0.0) else { return vec![0; weights.len()] };
    let mut sum = 0.0;
    let end = |(i, weight): (usize, &f64)| {
        sum += weight;
        if i >= last { u32::MAX } else { (sum / total * 4_294_967_296.0) as u32 }
    };
    weights.iter().enumerate().map(end).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_are_as_long_as_the_weights() {
        assert_eq!(intervals(&[0.0, 1.0, 0.0, 3.0, 0.0]), [0, 1 << 30, 1 << 30, u32::MAX, u32::MAX]);
        assert_eq!(intervals(&[0.0, 0.0]), [0, 0]);
        assert!(intervals(&[]).is_empty());
    }
}

//! Comparison of renderings within their own uncertainty.

use super::scenes::{cornell, render_at};
use crate::{Frame, Settings};
use glam::UVec2;
use kajo_sampling::SamplerKind;

/// Largest |z| over blocks of `block × block` pixels and the three channels: the difference of the block's means over its standard
/// error. With independent samples, z is about normally distributed. Differences below a thousandth of the picture's mean do not count:
/// in the dark an estimator may have found nothing yet and think it knows.
pub(crate) fn largest_block_z(a: &Frame, b: &Frame, block: u32) -> f64 {
    (0..3).map(|channel| largest_channel_z(a, b, block, channel)).fold(0.0, f64::max)
}

/// The same over one channel.
pub(crate) fn largest_channel_z(a: &Frame, b: &Frame, block: u32, channel: usize) -> f64 {
    assert_eq!(a.size, b.size);
    let (mut largest, negligible) = (0.0f64, f64::from(block * block) * 1e-3 * super::scenes::mean(a));
    for by in 0..a.size.y / block {
        for bx in 0..a.size.x / block {
            let (mut difference, mut variance) = (0.0f64, 0.0f64);
            for i in 0..block * block {
                let (x, y) = (bx * block + i % block, by * block + i / block);
                difference += f64::from(a.beauty().get(x, y)[channel] - b.beauty().get(x, y)[channel]);
                variance += f64::from(a.beauty_variance().get(x, y)[channel] + b.beauty_variance().get(x, y)[channel]);
            }
            if difference.abs() > negligible {
                largest = largest.max(difference.abs() / variance.sqrt());
            }
        }
    }
    largest
}

/// Asserts that two renderings agree within 4 standard errors in every block of 8 × 8 pixels, Bonferroni-corrected for their number.
pub(crate) fn assert_same_mean(name: &str, a: &Frame, b: &Frame) {
    let blocks = f64::from((a.size.x / 8) * (a.size.y / 8)) * 3.0;
    // 4 σ for one comparison; the quantile grows with the logarithm of their number.
    let limit = (16.0 + 2.0 * blocks.ln()).sqrt();
    let z = largest_block_z(a, b, 8);
    assert!(z < limit, "{name}: {z} standard errors, limit {limit}");
}

#[test]
fn planted_faults_are_seen_by_the_block_comparison() {
    let settings = |seed| Settings { size: UVec2::new(32, 32), seed, sampler: SamplerKind::Independent, ..Settings::default() };
    let scene = cornell();
    let a = render_at(&scene, &settings(1), 64);
    assert_same_mean("another seed", &a, &render_at(&scene, &settings(2), 64));
    let mut brighter = cornell();
    brighter.lights[0].emission *= 1.1;
    let mut moved = cornell();
    moved.nodes.iter_mut().filter(|n| n.name == "small box").for_each(|n| n.transform = Default::default());
    let mut recolored = cornell();
    recolored.materials.iter_mut().filter(|m| m.name == "green").for_each(|m| m.base_color.0 = m.base_color.0.zxy());
    for (name, scene) in [("brighter", brighter), ("moved", moved), ("recolored", recolored)] {
        let z = largest_block_z(&a, &render_at(&scene, &settings(3), 64), 8);
        assert!(z > 6.0, "{name}: {z}");
    }
}

trait Zxy {
    fn zxy(self) -> Self;
}

impl Zxy for glam::Vec3 {
    fn zxy(self) -> Self {
        Self::new(self.z, self.x, self.y)
    }
}

//! Techniques of the role anti-alias: the mean of the picture over the area of each pixel.
//!
//! Each reads the linear picture ([`slot::COLOR`](kajo_render_graph::slot::COLOR)) and writes [`slot::RESOLVED`](kajo_render_graph::slot::RESOLVED). A technique that averages over
//! frames says where each is to be sampled ([`Effect::jitter`](crate::Effect::jitter)) and keeps its own `History`; renderer, lab and viewer know of neither.

pub mod accumulate;
pub mod fxaa;
mod history;
pub mod none;
pub mod taa;

use crate::Technique;
use glam::Vec2;
use history::History;
use kajo_sampling::halton_2d;

/// In the order of every list.
pub const ALL: &[&Technique] = &[&none::TECHNIQUE, &fxaa::TECHNIQUE, &accumulate::TECHNIQUE, &taa::TECHNIQUE];

/// Where frame `index` samples its pixels: the first `period` points of the Halton sequence in bases 2 and 3, again and again. Point 0, the corner of the
/// square, is left out.
fn halton_jitter(index: u32, period: u32) -> Vec2 {
    halton_2d(index % period + 1) - 0.5
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn jitter_repeats_and_stays_in_the_pixel() {
        for index in 0..64 {
            let jitter = halton_jitter(index, 16);
            assert_eq!(jitter, halton_jitter(index + 16, 16));
            assert!(jitter.abs().max_element() <= 0.5);
        }
        assert_eq!(halton_jitter(0, 16), Vec2::new(0.0, 1.0 / 3.0 - 0.5));
        let mean = (0..16).map(|index| halton_jitter(index, 16)).sum::<Vec2>() / 16.0;
        assert!(mean.length() < 0.05, "{mean}");
    }
}

//! Filtering one tile: weights of a row of the window for all pixels, then their sums, sixteen pixels at a time.

#![allow(clippy::needless_range_loop, reason = "lanes and matrices are indexed as in their formulas")]

use crate::patches::{self, Scratch};
use crate::plane;
use crate::planes::Planes;
use crate::regression::{FEATURES, LANES, Lanes, Sums};
use glam::{UVec2, Vec3};
use kajo_units::LinearRgb;

/// Half the width of the window, px. Wider ones took longer and gained nothing.
pub(crate) const RADIUS: i32 = 7;
const DIAMETER: usize = 2 * RADIUS as usize + 1;

/// Pixels filtered together: their sums fit into the processor's second cache. `x`, `y` is the upper left one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tile {
    pub x: i32,
    pub y: i32,
}

impl Tile {
    pub(crate) const WIDTH: usize = 64;
    pub(crate) const HEIGHT: usize = 16;
    pub(crate) const SIZE: UVec2 = UVec2::new(Self::WIDTH as u32, Self::HEIGHT as u32);
    const PIXELS: usize = Self::WIDTH * Self::HEIGHT;

    /// The tiles of a picture.
    pub(crate) fn cover(size: UVec2) -> impl Iterator<Item = Self> {
        let columns = move |y| (0..size.x as i32).step_by(Self::WIDTH).map(move |x| Self { x, y });
        (0..size.y as i32).step_by(Self::HEIGHT).flat_map(columns)
    }
}

/// The pixels of a tile, `Tile::HEIGHT × Tile::WIDTH`, filtered. The same code is compiled for wider registers; none of it contracts or reorders
/// sums, so every processor has the same bits.
pub(crate) fn filter(planes: &Planes, tile: Tile) -> Vec<LinearRgb> {
    #[cfg(target_arch = "x86_64")]
    {
        if is_x86_feature_detected!("avx512f") {
            // SAFETY: the processor has it.
            return unsafe { filter_avx512(planes, tile) };
        }
        if is_x86_feature_detected!("avx2") {
            // SAFETY: the processor has it.
            return unsafe { filter_avx2(planes, tile) };
        }
    }
    filter_portable(planes, tile)
}

/// [`filter`] by every path that this processor has.
#[cfg(test)]
pub(crate) fn by_every_path(planes: &Planes, tile: Tile) -> Vec<(&'static str, Vec<LinearRgb>)> {
    let mut all = vec![("portable", filter_portable(planes, tile))];
    #[cfg(target_arch = "x86_64")]
    {
        if is_x86_feature_detected!("avx2") {
            // SAFETY: the processor has it.
            all.push(("AVX2", unsafe { filter_avx2(planes, tile) }));
        }
        if is_x86_feature_detected!("avx512f") {
            // SAFETY: the processor has it.
            all.push(("AVX-512", unsafe { filter_avx512(planes, tile) }));
        }
    }
    all
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f")]
fn filter_avx512(planes: &Planes, tile: Tile) -> Vec<LinearRgb> {
    filter_portable(planes, tile)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn filter_avx2(planes: &Planes, tile: Tile) -> Vec<LinearRgb> {
    filter_portable(planes, tile)
}

#[inline(always)]
fn filter_portable(planes: &Planes, tile: Tile) -> Vec<LinearRgb> {
    let mut scratch = Scratch::new();
    let mut weights = vec![0.0; DIAMETER * Tile::PIXELS];
    let mut sums = vec![Sums::ZERO; Tile::PIXELS / LANES];
    for dy in -RADIUS..=RADIUS {
        for (dx, out) in (-RADIUS..=RADIUS).zip(weights.chunks_exact_mut(Tile::PIXELS)) {
            patches::weights(planes, tile, (dx, dy), &mut scratch, out);
        }
        for (group, sums) in sums.iter_mut().enumerate() {
            let first = group * LANES;
            let (x, y) = (tile.x + (first % Tile::WIDTH) as i32, tile.y + (first / Tile::WIDTH) as i32);
            let lanes = |plane: usize, dx: i32, dy: i32| *planes.row(plane, x + dx, y + dy, LANES).first_chunk().expect("sixteen pixels");
            let centre: [Lanes; FEATURES] = std::array::from_fn(|i| lanes(plane::FEATURE + i, 0, 0));
            for (dx, weights) in (-RADIUS..=RADIUS).zip(weights.chunks_exact(Tile::PIXELS)) {
                let mut features: [Lanes; FEATURES] = std::array::from_fn(|i| lanes(plane::FEATURE + i, dx, dy));
                for (feature, centre) in features.iter_mut().zip(&centre) {
                    for l in 0..LANES {
                        feature[l] -= centre[l];
                    }
                }
                let color = std::array::from_fn(|c| lanes(plane::COLOR + c, dx, dy));
                sums.add(weights[first..].first_chunk().expect("sixteen pixels"), &color, &features);
            }
        }
    }
    let mut out = Vec::with_capacity(Tile::PIXELS);
    for sums in &sums {
        let color = sums.solve();
        out.extend((0..LANES).map(|l| LinearRgb(Vec3::from_array(color.map(|channel| channel[l])))));
    }
    out
}

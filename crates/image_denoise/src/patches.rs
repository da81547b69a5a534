//! How alike two pixels are: the distance of the patches around them, less what noise alone makes of it.
//!
//! ```text
//! d²(p, q) = Σ_c (u_c(p) − u_c(q))² − (V(p) + min(V(p), V(q)))      summed over the patch,
//!            ─────────────────────────────────────────────────
//!                      ε + k² (V(p) + V(q))
//!
//! w(p, q) = (1 − d²/4)⁴ where 0 ≤ d² < 4;  1 below, 0 above         [Rousselle12] section 4
//! ```
//!
//! V: variance of the pixel, summed over the channels. The kernel is exp(−d²) to within 0.06, but ends.

#![allow(clippy::needless_range_loop, reason = "lanes and matrices are indexed as in their formulas")]

use crate::plane;
use crate::planes::Planes;
use crate::tile::Tile;

/// k: how much more than noise two patches may differ.
const BANDWIDTH: f32 = 0.7;
/// Half the width of a patch, px.
pub(crate) const PATCH: usize = 3;
/// Keeps 0/0 away where neither pixel has noise: pixels of one value are alike then, all others are not.
const EPSILON: f32 = 1e-20;
/// One pixel of a patch says no more than this: the sum of 49 stays finite, and rounding small.
const MAX_DISTANCE: f32 = 1e4;

/// Room for the distances of the pixels of a tile and of the patches that reach out of it.
pub(crate) struct Scratch {
    distances: Vec<f32>,
    sums: Vec<f32>,
}

/// Rows and columns of a tile with the patches around its pixels.
const ROWS: usize = Tile::HEIGHT + 2 * PATCH;
const COLUMNS: usize = Tile::WIDTH + 2 * PATCH;

impl Scratch {
    pub(crate) fn new() -> Self {
        Self { distances: vec![0.0; ROWS * COLUMNS], sums: vec![0.0; Tile::HEIGHT * COLUMNS] }
    }
}

/// Weights of the pixels `offset` away from those of a tile; `out`: `Tile::HEIGHT × Tile::WIDTH`.
#[inline(always)]
pub(crate) fn weights(planes: &Planes, tile: Tile, offset: (i32, i32), scratch: &mut Scratch, out: &mut [f32]) {
    for (row, distances) in scratch.distances.chunks_exact_mut(COLUMNS).enumerate() {
        let (x, y) = (tile.x - PATCH as i32, tile.y + row as i32 - PATCH as i32);
        let here = |p| planes.row(p, x, y, COLUMNS);
        let there = |p| planes.row(p, x + offset.0, y + offset.1, COLUMNS);
        let color = plane::COLOR;
        let (r, g, b, v) = (here(color), here(color + 1), here(color + 2), here(plane::VARIANCE));
        let (r2, g2, b2, v2) = (there(color), there(color + 1), there(color + 2), there(plane::VARIANCE));
        for i in 0..COLUMNS {
            let (dr, dg, db) = (r[i] - r2[i], g[i] - g2[i], b[i] - b2[i]);
            let difference = dr * dr + dg * dg + db * db - (v[i] + v[i].min(v2[i]));
            distances[i] = (difference / (EPSILON + BANDWIDTH * BANDWIDTH * (v[i] + v2[i]))).min(MAX_DISTANCE);
        }
    }
    for (row, sums) in scratch.sums.chunks_exact_mut(COLUMNS).enumerate() {
        let rows: [&[f32]; 2 * PATCH + 1] = std::array::from_fn(|i| &scratch.distances[(row + i) * COLUMNS..][..COLUMNS]);
        for i in 0..COLUMNS {
            sums[i] = rows.iter().map(|row| row[i]).sum();
        }
    }
    const PER_PATCH: f32 = 1.0 / (4 * (2 * PATCH + 1) * (2 * PATCH + 1)) as f32;
    for (sums, out) in scratch.sums.chunks_exact(COLUMNS).zip(out.chunks_exact_mut(Tile::WIDTH)) {
        let columns: [&[f32]; 2 * PATCH + 1] = std::array::from_fn(|i| &sums[i..][..Tile::WIDTH]);
        for i in 0..Tile::WIDTH {
            let sum: f32 = columns.iter().map(|column| column[i]).sum();
            let near = (1.0 - sum.max(0.0) * PER_PATCH).max(0.0);
            out[i] = (near * near) * (near * near);
        }
    }
}

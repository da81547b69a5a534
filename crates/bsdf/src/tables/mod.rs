//! Directional albedos as tables: plain arrays, made by `cargo run --release -p kajo-bsdf --example make_tables`.
//!
//! Files hold little-endian 16-bit fractions of one, fastest axis first. The arrays can be uploaded to a GPU as they are; the
//! axes are given with each, nodes lie at the ends of the interval, interpolation is linear in the table coordinates.

mod aniso;
mod grid;
pub mod quadrature;

pub use aniso::{
    ANISO_AVERAGE, ANISO_AVERAGE_GRID, ANISO_COS_GRID, ANISO_COS_SCALE, ANISO_GLASS, ANISO_GLASS_GRID, ANISO_MEAN_COS, ANISO_WHITE,
    ANISO_WHITE_GRID, aniso_alpha, aniso_eta, aniso_from_half_stretched, aniso_from_stretched, aniso_half_stretched, aniso_index,
    aniso_stretched, aniso_widths,
};
pub use grid::{Fractions, Grid};

/// Nodes over √cos θ in [0, 1].
pub const COS_NODES: usize = 64;
/// Nodes over the perceptual roughness √α in [0, 1].
pub const ROUGHNESS_NODES: usize = 32;
/// Nodes over √cos θ in [0, 1] of the glass table.
pub const GLASS_COS_NODES: usize = 32;
/// Nodes over the perceptual roughness √α in [0, 1] of the glass table.
pub const GLASS_ROUGHNESS_NODES: usize = 24;
/// Nodes over z = (η − 1)/(η + 1) in [−[`GLASS_Z_MAX`], [`GLASS_Z_MAX`]] of the glass table; an even number: z = 0 lies between.
pub const GLASS_ETA_NODES: usize = 32;
/// Largest |z| of the glass table: η from 1/3 to 3.
pub const GLASS_Z_MAX: f32 = 0.5;

/// Nodes over √cos θ in [0, 1] of the sheen table.
pub const SHEEN_COS_NODES: usize = 32;
/// Nodes over the perceptual roughness √α in [0, 1] of the sheen table.
pub const SHEEN_ROUGHNESS_NODES: usize = 16;
/// Nodes over wo·m in [0, 1] at which an arbitrary Fresnel curve is given to [`GGX_HAT_ALBEDO`].
pub const HAT_NODES: usize = 16;
/// Nodes over √cos θ and over √α of [`GGX_HAT_ALBEDO`].
pub const HAT_AXIS_NODES: usize = 16;

/// Directional albedo of GGX with Schlick's Fresnel, f0 · `[0]` + f90 · `[1]`, [`ROUGHNESS_NODES`] × [`COS_NODES`].
pub static GGX_ALBEDO: [[f32; 2]; COS_NODES * ROUGHNESS_NODES] = decode_pairs(include_bytes!("ggx_albedo.bin"));
/// Cosine-weighted mean of [`GGX_ALBEDO`] over the hemisphere, [`ROUGHNESS_NODES`].
pub static GGX_ALBEDO_AVERAGE: [[f32; 2]; ROUGHNESS_NODES] = decode_pairs(include_bytes!("ggx_albedo_average.bin"));
/// Reflected plus transmitted share of rough glass, [`GLASS_ETA_NODES`] × [`GLASS_ROUGHNESS_NODES`] × [`GLASS_COS_NODES`].
pub static GLASS_ALBEDO: [f32; GLASS_COS_NODES * GLASS_ROUGHNESS_NODES * GLASS_ETA_NODES] = decode(include_bytes!("glass_albedo.bin"));

/// The sheen table holds albedos divided by this: the fitted masking lets narrow lobes exceed one near the horizon.
pub const SHEEN_TABLE_SCALE: f32 = 4.0;
/// Directional albedo of a white Charlie sheen over [`SHEEN_TABLE_SCALE`], [`SHEEN_ROUGHNESS_NODES`] × [`SHEEN_COS_NODES`].
pub static SHEEN_ALBEDO: [f32; SHEEN_COS_NODES * SHEEN_ROUGHNESS_NODES] = decode(include_bytes!("sheen_albedo.bin"));
/// Directional albedo of GGX whose Fresnel is the hat function of node k, √α × √cos θ × k, [`HAT_AXIS_NODES`]² × [`HAT_NODES`].
pub static GGX_HAT_ALBEDO: [f32; HAT_NODES * HAT_AXIS_NODES * HAT_AXIS_NODES] = decode(include_bytes!("ggx_hat_albedo.bin"));

const fn fraction(bytes: &[u8], i: usize) -> f32 {
    u16::from_le_bytes([bytes[2 * i], bytes[2 * i + 1]]) as f32 / 65535.0
}

const fn decode<const N: usize>(bytes: &[u8]) -> [f32; N] {
    assert!(bytes.len() == 2 * N, "the file does not have the size of its table; run the example make_tables");
    let mut out = [0.0; N];
    let mut i = 0;
    while i < N {
        out[i] = fraction(bytes, i);
        i += 1;
    }
    out
}

const fn decode_pairs<const N: usize>(bytes: &[u8]) -> [[f32; 2]; N] {
    assert!(bytes.len() == 4 * N, "the file does not have the size of its table; run the example make_tables");
    let mut out = [[0.0; 2]; N];
    let mut i = 0;
    while i < N {
        out[i] = [fraction(bytes, 2 * i), fraction(bytes, 2 * i + 1)];
        i += 1;
    }
    out
}

/// Node below `x` in [0, 1] and the weight of the one above, for `nodes` nodes.
#[inline]
pub(crate) fn place(x: f32, nodes: usize) -> (usize, f32) {
    let s = x.clamp(0.0, 1.0) * (nodes - 1) as f32;
    let i = (s as usize).min(nodes - 2);
    (i, s - i as f32)
}

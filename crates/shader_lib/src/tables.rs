//! The albedo tables of `kajo_bsdf` in one buffer, as `shader_lib::bsdf::tables` reads them, and behind them those of models that are read from files,
//! as `shader_lib::models::tabulated` does.

use kajo_bsdf::models::tabulated::Tabulated;
use kajo_bsdf::tables::{self, HAT_AXIS_NODES, HAT_NODES, ROUGHNESS_NODES};

/// Name of the buffer's binding: bind [`bsdf_tables`] or [`BsdfTables::numbers`] under it wherever a shader imports the material.
pub const BSDF_TABLES: &str = "bsdf_tables";

/// GGX albedo and its average (pairs of factors of f0 and f90), sheen, glass, hat functions and their averages, then for anisotropic facets
/// white albedo, mean cosine, average (pairs) and glass, one after the other.
pub fn bsdf_tables() -> Vec<f32> {
    let mut out = Vec::new();
    out.extend(tables::GGX_ALBEDO.as_flattened());
    out.extend(tables::GGX_ALBEDO_AVERAGE.as_flattened());
    out.extend(tables::SHEEN_ALBEDO);
    out.extend(tables::GLASS_ALBEDO);
    out.extend(tables::GGX_HAT_ALBEDO);
    out.extend((0..ROUGHNESS_NODES).flat_map(hat_albedo_average));
    out.extend(tables::ANISO_WHITE.iter());
    out.extend(tables::ANISO_MEAN_COS.iter());
    out.extend(tables::ANISO_AVERAGE.iter());
    out.extend(tables::ANISO_GLASS.iter());
    out
}

/// The contents of the buffer for a scene with models of files.
#[derive(Clone, Debug)]
pub struct BsdfTables {
    numbers: Vec<f32>,
}

impl BsdfTables {
    /// [`bsdf_tables`], and nothing behind them.
    pub fn new() -> Self {
        let mut numbers = bsdf_tables();
        // Tables of models are addressed by colours.
        numbers.resize(numbers.len().next_multiple_of(3), 0.0);
        Self { numbers }
    }

    /// Puts a table behind the others. What comes back are the constants of the materials that use it: where it begins, in blocks of 2¹² colours and colours
    /// behind them, so that both are exact in f32, and its numbers of nodes.
    pub fn add(&mut self, table: &Tabulated) -> Vec<f32> {
        let first = self.numbers.len() / 3;
        let grid = table.grid;
        self.numbers.extend(table.values.iter().flat_map(|color| color.to_array()));
        [first >> 12, first & 0xfff, grid.theta_h, grid.phi_d, grid.theta_d, grid.phi_h].map(|count| count as f32).to_vec()
    }

    /// What to upload.
    pub fn numbers(&self) -> &[f32] {
        &self.numbers
    }
}

impl Default for BsdfTables {
    fn default() -> Self {
        Self::new()
    }
}

/// Cosine-weighted means over directions of the hat functions' albedos at node `roughness` of the finer axis, scaled so that they sum to
/// the white albedo at every angle: what the CPU integrates for each material, by midpoints in cos².
fn hat_albedo_average(roughness: usize) -> [f32; HAT_NODES] {
    const STEPS: usize = 48;
    let perceptual = roughness as f32 / (ROUGHNESS_NODES - 1) as f32;
    let (r, tr) = place(perceptual);
    let mut sum = [0.0; HAT_NODES];
    for step in 0..STEPS {
        let cos_theta = ((step as f32 + 0.5) / STEPS as f32).sqrt();
        let (c, tc) = place(cos_theta.sqrt());
        let row = |r: usize, c: usize| &tables::GGX_HAT_ALBEDO[(r * HAT_AXIS_NODES + c) * HAT_NODES..][..HAT_NODES];
        let corners = [row(r, c), row(r, c + 1), row(r + 1, c), row(r + 1, c + 1)];
        let weights = [(1.0 - tr) * (1.0 - tc), (1.0 - tr) * tc, tr * (1.0 - tc), tr * tc];
        let hats: [f32; HAT_NODES] = std::array::from_fn(|k| (0..4).map(|i| weights[i] * corners[i][k]).sum());
        let white = kajo_bsdf::ggx_albedo(perceptual * perceptual, cos_theta).white();
        let scale = white / hats.iter().sum::<f32>().max(1e-3) / STEPS as f32;
        sum.iter_mut().zip(hats).for_each(|(sum, hat)| *sum += hat * scale);
    }
    sum
}

/// Node of the coarse axis below `x` in [0, 1], and the weight of the one above.
fn place(x: f32) -> (usize, f32) {
    let at = x * (HAT_AXIS_NODES - 1) as f32;
    let node = (at as usize).min(HAT_AXIS_NODES - 2);
    (node, at - node as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The hat functions sum to one, so their averages sum to Ē of the white albedo.
    #[test]
    fn hat_averages_sum_to_the_white_average() {
        for roughness in [3, 15, 31] {
            let perceptual = roughness as f32 / (ROUGHNESS_NODES - 1) as f32;
            let sum: f32 = hat_albedo_average(roughness).iter().sum();
            let white = kajo_bsdf::ggx_albedo_average(perceptual * perceptual).white();
            assert!((sum - white).abs() < 4e-3, "roughness {perceptual}: {sum} {white}");
        }
    }

    #[test]
    fn tables_of_models_are_found_where_their_constants_say() {
        use glam::Vec3;
        use kajo_bsdf::models::tabulated::Grid;
        let grids = [Grid { theta_h: 40, phi_h: 1, phi_d: 30, theta_d: 20 }, Grid { theta_h: 4, phi_h: 3, phi_d: 2, theta_d: 5 }];
        let mut buffer = BsdfTables::new();
        for (i, grid) in grids.into_iter().enumerate() {
            let colors = (0..grid.nodes()).map(|k| Vec3::new(k as f32, -1.0, i as f32)).collect();
            let constants = buffer.add(&Tabulated { grid, values: colors });
            let first = 3 * ((constants[0] as usize) << 12 | constants[1] as usize);
            let last = first + 3 * (grid.nodes() - 1);
            assert_eq!(buffer.numbers()[first..first + 3], [0.0, -1.0, i as f32]);
            assert_eq!(buffer.numbers()[last..], [(grid.nodes() - 1) as f32, -1.0, i as f32]);
            assert_eq!(constants[2..], [grid.theta_h, grid.phi_d, grid.theta_d, grid.phi_h].map(|count| count as f32));
        }
    }
}

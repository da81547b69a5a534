//! The albedo tables of `kajo_bsdf` in one buffer, as `shader_lib::bsdf::tables` reads them.

use kajo_bsdf::tables::{self, HAT_AXIS_NODES, HAT_NODES};

/// Name of the buffer's binding: bind [`bsdf_tables`] under it wherever a shader imports the material.
pub const BSDF_TABLES: &str = "bsdf_tables";

/// GGX albedo and its average (pairs of factors of f0 and f90), sheen, glass, hat functions and their averages, one after the other.
pub fn bsdf_tables() -> Vec<f32> {
    let mut out = Vec::new();
    out.extend(tables::GGX_ALBEDO.as_flattened());
    out.extend(tables::GGX_ALBEDO_AVERAGE.as_flattened());
    out.extend(tables::SHEEN_ALBEDO);
    out.extend(tables::GLASS_ALBEDO);
    out.extend(tables::GGX_HAT_ALBEDO);
    out.extend((0..HAT_AXIS_NODES).flat_map(hat_albedo_average));
    out
}

/// Cosine-weighted means over directions of the hat functions' albedos, row `roughness` of the table: 2 ∫ E_k(c) c dc by 64 midpoints, as
/// the CPU integrates it.
fn hat_albedo_average(roughness: usize) -> [f32; HAT_NODES] {
    const STEPS: usize = 64;
    let mut sum = [0.0; HAT_NODES];
    for step in 0..STEPS {
        let c = (step as f32 + 0.5) / STEPS as f32;
        let at = c.sqrt() * (HAT_AXIS_NODES - 1) as f32;
        let node = (at as usize).min(HAT_AXIS_NODES - 2);
        let weight = at - node as f32;
        let row = &tables::GGX_HAT_ALBEDO[(roughness * HAT_AXIS_NODES + node) * HAT_NODES..][..2 * HAT_NODES];
        for (k, sum) in sum.iter_mut().enumerate() {
            *sum += (row[k] + weight * (row[k + HAT_NODES] - row[k])) * 2.0 * c / STEPS as f32;
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The hat functions sum to one, so their averages sum to Ē of the white albedo.
    #[test]
    fn hat_averages_sum_to_the_white_average() {
        for roughness in [3, 8, 15] {
            let perceptual = roughness as f32 / (HAT_AXIS_NODES - 1) as f32;
            let sum: f32 = hat_albedo_average(roughness).iter().sum();
            let white = kajo_bsdf::ggx_albedo_average(perceptual * perceptual).white();
            assert!((sum - white).abs() < 4e-3, "roughness {perceptual}: {sum} {white}");
        }
    }
}

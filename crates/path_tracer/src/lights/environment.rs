//! The image of light around the scene: drawing directions towards it, by one of three tables.

use super::LightSample;
use crate::EnvironmentSampler;
use glam::{Vec2, Vec3};
use kajo_sampling::environment::{AlphaPlane, DensityImage, EnvironmentError, KdSampler};
use kajo_sampling::{Alias2d, Piecewise2d};
use kajo_scene::Environment;
use std::f32::consts::PI;

/// A density over the image, positive wherever light comes from.
#[derive(Clone, Debug)]
pub(super) struct EnvironmentLight {
    table: Table,
    /// ∫ Y dω, W/(m² sr) · sr.
    flux_density: f32,
}

#[derive(Clone, Debug)]
enum Table {
    Cdf(Piecewise2d),
    Alias(Alias2d),
    /// Densities of directions found otherwise are read from a plane: one read instead of a descent.
    Kd(KdSampler, AlphaPlane),
}

impl EnvironmentLight {
    /// The table of that kind. `None` for a constant or a black environment, which is left to BSDF sampling.
    ///
    /// # Errors
    /// [`EnvironmentError::Size`] for an image that blocks cannot be made of.
    pub(super) fn new(environment: &Environment, kind: EnvironmentSampler) -> Result<Option<Self>, EnvironmentError> {
        let Some(grid) = environment.importance() else { return Ok(None) };
        let (size, weights) = (grid.size(), grid.pixels());
        let (width, height) = (size.x as usize, size.y as usize);
        let total: f64 = weights.chunks_exact(width).map(|row| row.iter().map(|&w| f64::from(w)).sum::<f64>()).sum();
        if total <= 0.0 {
            return Ok(None);
        }
        let table = match kind {
            EnvironmentSampler::Cdf => Piecewise2d::new(weights, width, height).map(Table::Cdf),
            EnvironmentSampler::Alias => Alias2d::new(weights, width, height).map(Table::Alias),
            EnvironmentSampler::Kd => {
                let sampler = KdSampler::new(&DensityImage::from_weights(size, weights)?, KdSampler::default_count(size))?;
                let plane = AlphaPlane::new(&sampler);
                Some(Table::Kd(sampler, plane))
            }
        };
        // Weights are ∫ Y sin θ dθ over a texel; columns share 2π.
        let flux_density = (total / f64::from(size.x)) as f32 * 2.0 * PI;
        Ok(table.map(|table| Self { table, flux_density }))
    }

    /// A direction: `choice` and `u` are uniform numbers in [0, 1). `None` at the poles, where the density has no value.
    #[inline]
    pub(super) fn sample(&self, environment: &Environment, choice: f32, u: Vec2) -> Option<LightSample> {
        let (uv, pdf_uv) = match &self.table {
            Table::Cdf(table) => table.sample(u),
            Table::Alias(table) => table.sample(u),
            Table::Kd(sampler, _) => sampler.sample(choice.into(), u),
        };
        let pdf = environment.pdf_from_uv(pdf_uv, uv);
        let wi = environment.direction(uv);
        (pdf > 0.0).then(|| LightSample { wi, distance: f32::INFINITY, radiance: environment.radiance_at(uv), pdf })
    }

    /// Density per steradian with which [`Self::sample`] finds `direction`.
    #[inline]
    pub(super) fn pdf(&self, environment: &Environment, direction: Vec3) -> f32 {
        let uv = environment.uv(direction);
        let pdf_uv = match &self.table {
            Table::Cdf(table) => table.pdf(uv),
            Table::Alias(table) => table.pdf(uv),
            Table::Kd(_, plane) => plane.density(uv),
        };
        environment.pdf_from_uv(pdf_uv, uv)
    }

    /// Estimated flux into a scene of that radius (m), W.
    pub(super) fn power(&self, radius: f32) -> f32 {
        self.flux_density * PI * radius * radius
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::skies::{photographed, sky};
    use kajo_sampling::Rng;
    use kajo_sampling::environment::{BlockTree, Criterion};
    use kajo_sampling::statistics::Moments;
    use std::f64::consts::TAU;

    fn lights(environment: &Environment) -> impl Iterator<Item = (&'static str, EnvironmentLight)> {
        EnvironmentSampler::ALL.map(|(name, kind)| (name, EnvironmentLight::new(environment, kind).unwrap().unwrap())).into_iter()
    }

    /// ∫ g dω over the sphere: the midpoint rule with four points a texel.
    fn sphere_integral(environment: &Environment, g: impl Fn(Vec3) -> f32) -> f64 {
        let (columns, rows) = environment.image.as_ref().map_or((64, 32), |image| (2 * image.width, 2 * image.height));
        let row = |y: u32| {
            let v = (f64::from(y) + 0.5) / f64::from(rows);
            let point = |x: u32| Vec2::new((x as f32 + 0.5) / columns as f32, v as f32);
            let sum: f64 = (0..columns).map(|x| f64::from(g(environment.direction(point(x))))).sum();
            sum * (v * TAU * 0.5).sin() * TAU / f64::from(columns) * TAU * 0.5 / f64::from(rows)
        };
        (0..rows).map(row).sum()
    }

    #[test]
    fn densities_integrate_to_one_over_the_sphere_and_a_planted_fault_is_seen() {
        for environment in [Some(sky(256, 128)), photographed()].into_iter().flatten() {
            for (name, light) in lights(&environment) {
                let integral = sphere_integral(&environment, |direction| light.pdf(&environment, direction));
                assert!((integral - 1.0).abs() < 0.005, "{name}: {integral}");
                // Without the factor 1 / sin θ.
                let sine = |direction: Vec3| direction.x.hypot(direction.z);
                let wrong = sphere_integral(&environment, |direction| light.pdf(&environment, direction) * sine(direction));
                assert!((wrong - 1.0).abs() > 0.005, "{name}: {wrong}");
            }
        }
    }

    #[test]
    fn samples_find_the_energy_of_the_map_and_their_density_is_that_of_their_direction() {
        for environment in [Some(sky(256, 128)), photographed()].into_iter().flatten() {
            let truth = sphere_integral(&environment, |direction| environment.radiance(direction).luminance());
            for (name, light) in lights(&environment) {
                let mut rng = Rng::new(7);
                let (mut energy, mut differences) = (Moments::default(), 0);
                for _ in 0..200_000 {
                    let sample = light.sample(&environment, rng.next_1d(), rng.next_2d()).unwrap();
                    energy.add(f64::from(sample.radiance.luminance() / sample.pdf));
                    // A direction has fewer digits than a point of the image: at edges of texels it may lie in the neighbour.
                    differences += u32::from((light.pdf(&environment, sample.wi) / sample.pdf - 1.0).abs() > 1e-3);
                }
                let error = (energy.mean() - truth) / energy.standard_error();
                assert!(error.abs() < 3.0, "{name}: {} and {truth}, {error} standard errors", energy.mean());
                assert!(differences < 200, "{name}: {differences} of 200 000 densities differ");
                assert!((light.flux_density / truth as f32 - 1.0).abs() < 0.01, "{name}: {} and {truth}", light.flux_density);
            }
        }
    }

    /// At one block for 170 texels, of a photographed sky.
    #[test]
    fn the_law_is_near_the_shares_of_a_photographed_sky() {
        let Some(environment) = photographed() else { return };
        let grid = environment.importance().unwrap();
        let image = DensityImage::from_weights(grid.size(), grid.pixels()).unwrap();
        let tree = BlockTree::new(&image, KdSampler::default_count(grid.size()), Criterion::default()).unwrap();
        let shares: Vec<f64> = tree.ranked_leaves().iter().map(|&leaf| tree.nodes()[leaf as usize].share).collect();
        let law = *KdSampler::from_tree(&tree).law();
        let distance = law.total_variation(&shares);
        assert!(distance < 0.25, "u {}, distance {distance}", law.u());
    }

    #[test]
    fn environments_without_contrast_or_light_have_no_table() {
        let mut black = sky(8, 4);
        black.scale = kajo_units::LinearRgb::BLACK;
        for (_, kind) in EnvironmentSampler::ALL {
            assert!(EnvironmentLight::new(&Environment::uniform(kajo_units::LinearRgb::WHITE), kind).unwrap().is_none());
            assert!(EnvironmentLight::new(&black, kind).unwrap().is_none());
        }
    }
}

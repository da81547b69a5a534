//! The second estimator: paths by BSDF sampling alone.
//!
//! It looks for light by running into it, weighs nothing and chooses no light, so an error in light tables, densities or weights of
//! the path tracer shows as a difference between the two. Point, spot and parallel lights are invisible to it.

use super::dispersion::disperse;
use super::{Chance, Context, Sink, Split, TracedRay, open_ray, transmittance};
use crate::surface::Surface;
use kajo_bsdf::Lobe;
use kajo_sampling::Sampler;
use kajo_units::LinearRgb;

impl Context<'_> {
    /// Follows the path that starts with `start` until it leaves the scene or reaches the depth limit.
    pub(crate) fn bsdf_only(&self, start: TracedRay, sampler: &mut Sampler, chance: &mut Chance, sink: &mut impl Sink) {
        let TracedRay { mut ray, mut hit } = start;
        let mut throughput = Split::CAMERA;
        let mut channel = None;
        let mut absorption = LinearRgb::BLACK;
        for bounces in 0..=self.max_depth {
            self.pass(&TracedRay { ray, hit }, None, |t, seen| {
                sink.light(bounces, seen.light, throughput.scaled(seen.radiance * transmittance(absorption, t)));
            });
            let Some(found) = hit else { return };
            let passed = transmittance(absorption, found.t);
            let (wo, mut room) = (-ray.direction, None);
            let Some(surface) = Surface::new(self.world, &found, wo, self.settings.smooth_terminator, &mut room) else { return };
            if let Some((light, radiance)) = surface.emission(self.world, self.lights) {
                sink.light(bounces, light, throughput.scaled(passed * radiance));
            }
            if surface.unlit(self.world) {
                return;
            }
            sampler.start_bounce(bounces);
            let bsdf = surface.bsdf(channel);
            let Some(sample) = bsdf.view(surface.frame.to_local(wo)).sample(sampler.next_1d(), sampler.next_2d()) else { return };
            let Some(wi) = surface.direction_of(&sample) else { return };
            throughput = if bounces == 0 {
                Split { diffuse: passed * sample.weight.diffuse, specular: passed * sample.weight.specular }
            } else {
                throughput.scaled(passed * sample.weight.total())
            };
            disperse(&surface, sample.weight, &mut channel, &mut throughput, sampler);
            if sample.lobe.contains(Lobe::TRANSMIT) && !surface.material.params.thin {
                absorption = if surface.front { surface.material.absorption } else { LinearRgb::BLACK };
            }
            ray = open_ray(surface.origin_towards(self.world, wi), wi);
            hit = self.world.closest(&ray, Some(surface.primitive), chance.next());
        }
    }
}

//! The path tracer: next-event estimation and BSDF sampling at every surface, combined by multiple importance sampling.
//!
//! ```text
//! L(x, ωo) = Le + ∫ f(ωi, ωo) L(x, ωi) |cos θi| dωi                                 [Kajiya86] eq. 1
//! ```
//!
//! Both strategies find direct light; each contribution weighs w = p² / (p² + p_other²), the power heuristic \[Veach98] eq. 9.11. Where light sampling
//! draws M candidates, its p is M times the density of one.
//! Transmissive surfaces block shadow rays, so caustics come from BSDF sampling alone. A volume absorbs by the Beer-Lambert law
//! between entering and leaving it; volumes do not nest: leaving any surface outwards ends the absorption.
//!
//! At a first surface that is no mirror the path divides into [`BRANCHES`], each of which brings its share: most noise comes from behind it, and what the camera
//! ray and its light cost is paid once.    \[Arvo90] section 3, splitting

use super::dispersion::{Channel, disperse};
use super::{Chance, Context, Sink, Split, TracedRay, open_ray, transmittance};
use crate::lights::{ChosenLight, rng_of};
use crate::settings::Strategy;
use crate::surface::Surface;
use glam::Vec2;
use kajo_bsdf::{AnyBsdfView, Lobe};
use kajo_bvh::Ray;
use kajo_sampling::light_tree::Receiver;
use kajo_sampling::resampling::Reservoir;
use kajo_sampling::{Sampler, power_heuristic};
use kajo_units::LinearRgb;

/// Shadow rays end this share of their length before the light: the light must not shadow itself.
pub(super) const BEFORE_LIGHT: f32 = 1.0 - 2e-5;

/// Directions in which a path goes on from its first surface.
const BRANCHES: u32 = 2;

/// A path on its way: its next surface is found, and nothing has been looked for there.
#[derive(Clone, Copy)]
struct Walk {
    traced: TracedRay,
    throughput: Split,
    bounces: u32,
    /// Density with which the ray was found; infinite where light sampling could not have found it.
    ray_pdf: f32,
    absorption: LinearRgb,
    /// Radiance is compressed inside of denser media and divided among branches; roulette must not take that for darkness.
    compression: f32,
    channel: Channel,
    /// Where the ray comes from, if light sampling looked for light there, too.
    receiver: Option<Receiver>,
}

impl Walk {
    fn new(traced: TracedRay) -> Self {
        Self {
            traced,
            throughput: Split::CAMERA,
            bounces: 0,
            ray_pdf: f32::INFINITY,
            absorption: LinearRgb::BLACK,
            compression: 1.0,
            channel: None,
            receiver: None,
        }
    }
}

impl Context<'_> {
    /// What a camera ray meets of lamps and sky.
    pub(crate) fn emission(&self, TracedRay { ray, hit }: TracedRay, sink: &mut impl Sink) {
        self.pass(&TracedRay { ray, hit }, None, |_, seen| sink.light(0, seen.light, Split::CAMERA.scaled(seen.radiance)));
        let Some(found) = hit.filter(|found| self.lights.of_instance(found.instance).is_some()) else { return };
        let mut room = None;
        let surface = Surface::new(self.world, &found, -ray.direction, false, &mut room);
        if let Some((light, radiance)) = surface.and_then(|surface| surface.emission(self.world, self.lights)) {
            sink.light(0, light, Split::CAMERA.scaled(radiance));
        }
    }

    /// Follows the path that starts with `start`; leaves everything it finds in `sink`. Bounce b uses the random numbers of bounce
    /// `dimensions + b`.
    pub(crate) fn path(&self, start: TracedRay, dimensions: u32, sampler: &Sampler, chance: &mut Chance, sink: &mut impl Sink) {
        self.follow(Walk::new(start), dimensions, &mut sampler.clone(), chance, sink);
    }

    fn follow(&self, mut walk: Walk, dimensions: u32, sampler: &mut Sampler, chance: &mut Chance, sink: &mut impl Sink) {
        loop {
            let Walk { traced: TracedRay { ray, hit }, bounces, ray_pdf, absorption, .. } = walk;
            self.pass(&walk.traced, walk.receiver.as_ref(), |t, seen| {
                let value = seen.radiance * transmittance(absorption, t) * self.weight_of_ray(bounces, ray_pdf, seen.pdf);
                sink.light(bounces, seen.light, walk.throughput.scaled(value));
            });
            let Some(found) = hit else { return };
            walk.throughput = walk.throughput.scaled(transmittance(absorption, found.t));
            let (wo, mut room) = (-ray.direction, None);
            let Some(surface) = Surface::new(self.world, &found, wo, self.settings.smooth_terminator, &mut room) else { return };
            if let Some((light, radiance)) = surface.emission(self.world, self.lights) {
                let along = (ray.origin, ray.direction, found.t);
                let pdf = walk.receiver.map_or(0.0, |from| self.lights.pdf_of_surface(self.world, &from, found.primitive_ref(), along));
                sink.light(bounces, light, walk.throughput.scaled(radiance * self.weight_of_ray(bounces, ray_pdf, pdf)));
            }
            if bounces >= self.max_depth || surface.unlit(self.world) {
                return;
            }

            let bsdf = surface.bsdf(walk.channel);
            let view = bsdf.view(surface.frame.to_local(wo));
            sampler.start_bounce(dimensions + bounces);
            let (choice, on_light) = (sampler.next_1d(), sampler.next_2d());
            if !bsdf.is_delta() && sink.wants(bounces + 1) {
                self.direct(&surface, &view, walk.throughput, bounces, absorption, (choice, on_light), chance, sink);
            }
            if bounces == 0 && self.branches() && !bsdf.is_delta() {
                // Roulette takes a branch for what it would be alone.
                walk.throughput = walk.throughput.scaled(LinearRgb::splat(1.0 / BRANCHES as f32));
                walk.compression *= BRANCHES as f32;
                for branch in 1..BRANCHES {
                    let (mut walk, mut sampler) = (walk, sampler.branch(branch, BRANCHES));
                    if self.scatter(&surface, &view, &mut walk, &mut sampler, chance) {
                        self.follow(walk, dimensions, &mut sampler, chance, sink);
                    }
                }
                *sampler = sampler.branch(0, BRANCHES);
            }
            if !self.scatter(&surface, &view, &mut walk, sampler, chance) {
                return;
            }
        }
    }

    /// Whether a path divides at its first surface. That of light sampling alone is the textbook's, one direction a surface.
    #[inline]
    fn branches(&self) -> bool {
        self.max_depth > 1 && self.settings.strategy == Strategy::Mis
    }

    /// Takes a direction from the BSDF and traces it; false where the path ends.
    #[inline(always)]
    fn scatter(&self, surface: &Surface, view: &AnyBsdfView, walk: &mut Walk, sampler: &mut Sampler, chance: &mut Chance) -> bool {
        let (lobe, u) = (sampler.next_1d(), sampler.next_2d());
        let Some(sample) = view.sample(lobe, u) else { return false };
        let Some(wi) = surface.direction_of(&sample) else { return false };
        walk.throughput = if walk.bounces == 0 {
            let all = walk.throughput.total();
            Split { diffuse: all * sample.weight.diffuse, specular: all * sample.weight.specular }
        } else {
            walk.throughput.scaled(sample.weight.total())
        };
        disperse(surface, sample.weight, &mut walk.channel, &mut walk.throughput, sampler);
        walk.bounces += 1;
        let is_delta = sample.lobe.is_delta();
        walk.ray_pdf = if is_delta { f32::INFINITY } else { surface.pdf_of(view, &sample, wi) };
        walk.receiver = (!is_delta).then(|| surface.receiver());
        walk.compression *= sample.eta2;
        let brightness = walk.compression * walk.throughput.total().max_component();
        let survival = self.settings.russian_roulette.survival(walk.bounces, is_delta, brightness);
        if survival < 1.0 {
            if sampler.next_1d() >= survival {
                return false;
            }
            walk.throughput = walk.throughput.scaled(LinearRgb::splat(1.0 / survival));
        }
        if walk.throughput.total().is_black() || (walk.bounces == self.max_depth && !self.ray_can_find_light(walk.ray_pdf)) {
            return false;
        }
        if sample.lobe.contains(Lobe::TRANSMIT) && !surface.material.params.thin {
            walk.absorption = if surface.front { surface.material.absorption } else { LinearRgb::BLACK };
        }
        let ray = open_ray(surface.origin_towards(self.world, wi), wi);
        walk.traced = TracedRay { ray, hit: self.world.closest(&ray, Some(surface.primitive), chance.next()) };
        true
    }

    /// Next-event estimation: one light, one shadow ray.
    #[allow(clippy::too_many_arguments, reason = "the state of one bounce; a struct would only rename it")]
    #[inline]
    fn direct(
        &self,
        surface: &Surface,
        bsdf: &AnyBsdfView,
        throughput: Split,
        bounces: u32,
        absorption: LinearRgb,
        (choice, u): (f32, Vec2),
        chance: &mut Chance,
        sink: &mut impl Sink,
    ) {
        let receiver = surface.receiver();
        let candidate = |choice, u| {
            let chosen = self.lights.sample(self.world, &receiver, choice, u)?;
            let (f_cos, bsdf_pdf) = surface.eval(bsdf, chosen.sample.wi);
            let value = chosen.value * transmittance(absorption, chosen.sample.distance);
            let share = if bounces == 0 {
                let all = throughput.total() * value;
                Split { diffuse: f_cos.diffuse * all, specular: f_cos.specular * all }
            } else {
                throughput.scaled(f_cos.total() * value)
            };
            let weight = match self.settings.strategy {
                Strategy::Mis => power_heuristic(self.candidates(bounces) as f32 * chosen.sample.pdf, bsdf_pdf),
                Strategy::Lights => 1.0,
            };
            (!share.total().is_black()).then(|| (chosen, share.scaled(LinearRgb::splat(weight))))
        };
        let found = match self.candidates(bounces) {
            1 => candidate(choice, u),
            many => resampled(many, choice, u, candidate),
        };
        let Some((chosen, share)) = found else { return };
        let wi = chosen.sample.wi;
        let t_max = chosen.sample.distance * BEFORE_LIGHT;
        let ray = Ray { origin: surface.origin_towards(self.world, wi), t_min: 0.0, direction: wi, t_max };
        if !self.world.occluded(&ray, chosen.primitive, chance.next()) {
            sink.light(bounces + 1, chosen.light, share);
        }
    }

    /// How many candidates light sampling draws after `bounces`. Light sampling alone, the textbook's, draws no more at the first surface than elsewhere.
    #[inline]
    fn candidates(&self, bounces: u32) -> u32 {
        match self.settings.strategy {
            Strategy::Mis => self.lights.candidates(bounces),
            Strategy::Lights => self.lights.candidates(1),
        }
    }

    /// Weight of light that a ray of density `ray_pdf` met after `bounces` and of which light sampling finds each candidate with `light_pdf`.
    #[inline]
    fn weight_of_ray(&self, bounces: u32, ray_pdf: f32, light_pdf: f32) -> f32 {
        match self.settings.strategy {
            Strategy::Mis => power_heuristic(ray_pdf, self.candidates(bounces.saturating_sub(1)) as f32 * light_pdf),
            Strategy::Lights => f32::from(u8::from(ray_pdf == f32::INFINITY || light_pdf == 0.0)),
        }
    }

    /// Whether a ray that will not be continued can still add light.
    fn ray_can_find_light(&self, ray_pdf: f32) -> bool {
        match self.settings.strategy {
            Strategy::Mis => self.lights.can_be_met,
            Strategy::Lights => ray_pdf == f32::INFINITY || self.lights.only_met,
        }
    }
}

/// One of many candidates, by how much unshadowed light each brings: resampling in the space of the random numbers, where their density is 1. They
/// are spread evenly, the choices by steps of 1/M, the points by the R2 sequence \[Roberts18], shifted by `choice` and `u`.
#[inline(never)]
fn resampled(
    many: u32,
    choice: f32,
    u: Vec2,
    candidate: impl Fn(f32, Vec2) -> Option<(ChosenLight, Split)>,
) -> Option<(ChosenLight, Split)> {
    const R2: Vec2 = Vec2::new(0.754_877_7, 0.569_840_3);
    let (mut random, mut reservoir) = (rng_of(choice, u), Reservoir::new());
    for i in 0..many {
        let shifted = (choice + i as f32 / many as f32).fract();
        let found = candidate(shifted, (u + i as f32 * R2).fract());
        let target = found.as_ref().map_or(0.0, |(_, share)| share.total().luminance());
        reservoir.offer(found, target, 1.0, random.next_f64());
    }
    let (chosen, share) = (*reservoir.sample()?)?;
    Some((chosen, share.scaled(LinearRgb::splat(reservoir.contribution_weight()))))
}

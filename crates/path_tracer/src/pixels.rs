//! Samples of pixels: from random numbers over camera rays to the channels of the film.

use crate::Integrator;
use crate::camera::CameraView;
use crate::edges::{EDGE_RAYS, Edges};
use crate::film::Row;
use crate::filter::FilterSampler;
use crate::integrator::first_hit::Previous;
use crate::integrator::{Chance, Context, Sink, Split, TracedRay};
use crate::record::{Record, Slots};
use crate::surface::Surface;
use crate::world::Rays;
use glam::{UVec2, Vec2};
use kajo_bvh::{Hit, Ray};
use kajo_sampling::{Sampler, hash_u64};
use kajo_units::LinearRgb;

/// What a pixel needs to be sampled.
pub(crate) struct Pixels<'a> {
    pub cx: Context<'a>,
    pub view: CameraView,
    pub edges: Option<Edges>,
    pub previous: Option<Previous<'a>>,
    pub filter: FilterSampler,
    pub slots: Slots,
    pub channels: usize,
}

/// First bounce number of the random numbers of the additional rays at edges: far above any other.
const EDGE_DIMENSIONS: u32 = 1 << 18;

/// Samples whose camera rays are traced together: the rays of a packet.
pub(crate) const BATCH: usize = 16;

/// A sample on its way.
struct Sample {
    /// Column of the pixel.
    x: u32,
    number: u32,
    sampler: Sampler,
    chance: Chance,
    is_edge: bool,
}

/// Room for the samples of one batch.
#[derive(Default)]
struct Batch {
    samples: Vec<Sample>,
    rays: Rays,
    hits: Vec<Option<Hit>>,
    /// Additional rays at edges.
    edge_rays: Rays,
    edge_hits: Vec<Option<Hit>>,
    /// Channels of one sample.
    channels: Vec<f32>,
    counts: Counts,
}

/// Rays, and samples that were not finite.
#[derive(Clone, Copy, Default)]
pub(crate) struct Counts {
    pub rays: u64,
    pub invalid: u64,
}

impl Pixels<'_> {
    /// Brings a row to `goal` samples per pixel.
    pub(crate) fn row(&self, row: &mut Row, goal: u32) -> Counts {
        let mut batch = Batch { channels: vec![0.0; self.channels], ..Batch::default() };
        for x in 0..self.cx.settings.size.x {
            for number in row.count(x, *row.level)..row.count(x, goal) {
                self.start(&mut batch, UVec2::new(x, row.y), number);
                if batch.samples.len() == BATCH {
                    self.finish(&mut batch, row);
                }
            }
        }
        self.finish(&mut batch, row);
        *row.level = goal.max(*row.level);
        batch.counts
    }

    /// Puts a sample's camera rays into the batch.
    fn start(&self, batch: &mut Batch, pixel: UVec2, number: u32) {
        let (mut sampler, mut chance) = (self.sampler(pixel, number), self.chance(pixel, number));
        batch.rays.push(self.camera_ray(pixel, &mut sampler), chance.next());
        let is_edge = self.edges.as_ref().is_some_and(|edges| edges.at(pixel));
        if is_edge {
            for sub in 0..EDGE_RAYS {
                let mut sampler = self.sampler(pixel, number.wrapping_mul(EDGE_RAYS).wrapping_add(sub));
                sampler.start_bounce(EDGE_DIMENSIONS);
                batch.edge_rays.push(self.camera_ray(pixel, &mut sampler), chance.next());
            }
        }
        batch.samples.push(Sample { x: pixel.x, number, sampler, chance, is_edge });
    }

    /// Traces the camera rays of a batch, completes its samples and adds them to the row.
    fn finish(&self, batch: &mut Batch, row: &mut Row) {
        let Batch { samples, rays, hits, edge_rays, edge_hits, channels, counts } = batch;
        self.cx.world.closest_of(rays, hits);
        self.cx.world.closest_of(edge_rays, edge_hits);
        let traced = |rays: &Rays, hits: &[Option<Hit>], ray: usize| TracedRay { ray: rays.ray(ray), hit: hits[ray] };
        let mut edge_ray = 0;
        for (ray, mut sample) in samples.drain(..).enumerate() {
            channels.fill(0.0);
            if sample.is_edge {
                let mut record = Record { slots: &self.slots, channels, sees_lamps: true };
                for _ in 0..EDGE_RAYS {
                    self.cx.emission(traced(edge_rays, edge_hits, edge_ray), &mut Share(&mut record));
                    edge_ray += 1;
                }
            }
            self.complete(&mut sample, traced(rays, hits, ray), channels);
            counts.rays += sample.chance.rays;
            counts.invalid += u64::from(!row.add(sample.x, sample.number, channels));
        }
        rays.clear();
        edge_rays.clear();
    }

    /// All of a sample that comes by its camera ray.
    fn complete(&self, sample: &mut Sample, start: TracedRay, channels: &mut [f32]) {
        let (sampler, chance) = (&mut sample.sampler, &mut sample.chance);
        let mut record = Record { slots: &self.slots, channels, sees_lamps: !sample.is_edge };
        match self.cx.settings.integrator {
            Integrator::Path | Integrator::Direct => self.cx.path(start, 0, sampler, chance, &mut record),
            Integrator::BsdfOnly => self.cx.bsdf_only(start, sampler, chance, &mut record),
            quick => record.add(0, self.quick(quick, start, sampler, chance)),
        }
        if self.slots.first_hit || self.slots.coverage.is_some() {
            self.cx.first_hit(start, &self.view, self.previous.as_ref(), &self.slots, (sampler, chance), channels);
        }
    }

    fn sampler(&self, pixel: UVec2, sample: u32) -> Sampler {
        Sampler::new(self.cx.settings.sampler, self.cx.settings.seed, pixel, sample)
    }

    fn chance(&self, pixel: UVec2, sample: u32) -> Chance {
        let pixel_key = u64::from(pixel.y) << 32 | u64::from(pixel.x);
        Chance::new(hash_u64(hash_u64(self.cx.settings.seed ^ hash_u64(pixel_key)) ^ u64::from(sample)))
    }

    /// A ray through the pixel; takes the next two pairs of random numbers.
    fn camera_ray(&self, pixel: UVec2, sampler: &mut Sampler) -> Ray {
        let place = pixel.as_vec2() + 0.5 + self.filter.offset(sampler.next_2d());
        let lens = if self.view.has_lens() { sampler.next_2d() } else { Vec2::ZERO };
        self.view.ray(place, lens).traced()
    }

    /// The integrators that look at the first hit only.
    fn quick(&self, integrator: Integrator, start: TracedRay, sampler: &mut Sampler, chance: &mut Chance) -> LinearRgb {
        let mut room = None;
        let surface = start.hit.and_then(|hit| Surface::new(self.cx.world, &hit, -start.ray.direction, false, &mut room));
        let Some(surface) = surface else {
            let open = matches!(integrator, Integrator::Ao | Integrator::AoUniform);
            return if open { LinearRgb::WHITE } else { LinearRgb::BLACK };
        };
        sampler.start_bounce(0);
        match integrator {
            Integrator::Albedo => surface.material.params.base_color,
            Integrator::Normal => LinearRgb(surface.normal() * 0.5 + 0.5),
            _ => {
                let uniform = integrator == Integrator::AoUniform;
                LinearRgb::splat(self.cx.ambient(&surface, uniform, sampler.next_2d(), chance).1)
            }
        }
    }
}

/// One of [`EDGE_RAYS`] rays.
struct Share<'a, S>(&'a mut S);

impl<S: Sink> Sink for Share<'_, S> {
    fn light(&mut self, bounces: u32, light: u32, share: Split) {
        self.0.light(bounces, light, share.scaled(LinearRgb::splat(1.0 / EDGE_RAYS as f32)));
    }
}

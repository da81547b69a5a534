//! Samples of pixels: from random numbers over camera rays to the channels of the film.

use crate::Integrator;
use crate::camera::CameraView;
use crate::extra::{EXTRA_RAYS, Extra, Extras};
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
    pub extras: Option<Extras>,
    pub previous: Option<Previous<'a>>,
    pub filter: FilterSampler,
    pub slots: Slots,
    pub channels: usize,
}

/// First bounce number of the random numbers of additional rays: far above any other.
const EXTRA_DIMENSIONS: u32 = 1 << 18;

/// Samples whose camera rays are traced together: the rays of a packet.
pub(crate) const BATCH: usize = 16;

/// A sample on its way.
struct Sample {
    pixel: UVec2,
    number: u32,
    sampler: Sampler,
    chance: Chance,
    extra: Extra,
}

/// Room for the samples of one batch.
#[derive(Default)]
struct Batch {
    samples: Vec<Sample>,
    rays: Rays,
    hits: Vec<Option<Hit>>,
    extra_rays: Rays,
    extra_hits: Vec<Option<Hit>>,
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
        let extra = self.extras.as_ref().map_or(Extra::Nothing, |extras| extras.at(pixel));
        if extra != Extra::Nothing {
            for sub in 0..EXTRA_RAYS {
                batch.extra_rays.push(self.camera_ray(pixel, &mut self.extra_sampler(pixel, number, sub)), chance.next());
            }
        }
        batch.samples.push(Sample { pixel, number, sampler, chance, extra });
    }

    /// Traces the camera rays of a batch, completes its samples and adds them to the row.
    fn finish(&self, batch: &mut Batch, row: &mut Row) {
        let Batch { samples, rays, hits, extra_rays, extra_hits, channels, counts } = batch;
        self.cx.world.closest_of(rays, hits);
        self.cx.world.closest_of(extra_rays, extra_hits);
        let traced = |rays: &Rays, hits: &[Option<Hit>], ray: usize| TracedRay { ray: rays.ray(ray), hit: hits[ray] };
        let mut extra_ray = 0;
        for (ray, mut sample) in samples.drain(..).enumerate() {
            channels.fill(0.0);
            if sample.extra != Extra::Nothing {
                let mut record = Record { slots: &self.slots, channels, least_bounces: 0 };
                for sub in 0..EXTRA_RAYS {
                    self.extra(&mut sample, sub, traced(extra_rays, extra_hits, extra_ray), &mut Share(&mut record));
                    extra_ray += 1;
                }
            }
            self.complete(&mut sample, traced(rays, hits, ray), channels);
            counts.rays += sample.chance.rays;
            counts.invalid += u64::from(!row.add(sample.pixel.x, sample.number, channels));
        }
        rays.clear();
        extra_rays.clear();
    }

    /// What an additional ray of a sample brings.
    fn extra(&self, sample: &mut Sample, sub: u32, start: TracedRay, sink: &mut impl Sink) {
        match sample.extra {
            Extra::Nothing => {}
            Extra::Lamps => self.cx.emission(start, sink),
            Extra::Direct => {
                let sampler = self.extra_sampler(sample.pixel, sample.number, sub);
                self.cx.direct_only().path(start, EXTRA_DIMENSIONS + 1, &sampler, &mut sample.chance, sink);
            }
        }
    }

    /// All of a sample that comes by its camera ray.
    fn complete(&self, sample: &mut Sample, start: TracedRay, channels: &mut [f32]) {
        let (sampler, chance) = (&mut sample.sampler, &mut sample.chance);
        let mut record = Record { slots: &self.slots, channels, least_bounces: sample.extra.least_bounces() };
        match self.cx.settings.integrator {
            // Additional rays bring all light that there is.
            Integrator::Path | Integrator::Direct if sample.extra.least_bounces() > self.cx.max_depth => {}
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

    /// The random numbers of an additional ray.
    fn extra_sampler(&self, pixel: UVec2, sample: u32, sub: u32) -> Sampler {
        let mut sampler = self.sampler(pixel, sample.wrapping_mul(EXTRA_RAYS).wrapping_add(sub));
        sampler.start_bounce(EXTRA_DIMENSIONS);
        sampler
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

/// One of [`EXTRA_RAYS`] rays.
struct Share<'a, S>(&'a mut S);

impl<S: Sink> Sink for Share<'_, S> {
    fn light(&mut self, bounces: u32, light: u32, share: Split) {
        self.0.light(bounces, light, share.scaled(LinearRgb::splat(1.0 / EXTRA_RAYS as f32)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::FilmLayout;
    use crate::tests::scenes::{Stage, at, cornell, floor, lambert, mirror, sized, tracer};
    use crate::{Settings, Tracer};
    use glam::Vec3;

    impl<'a> Pixels<'a> {
        /// The pixels of the first camera without additional rays.
        pub(crate) fn of(tracer: &'a Tracer, settings: &'a Settings, layout: &FilmLayout) -> Self {
            Self {
                extras: None,
                cx: Context { world: &tracer.world, lights: &tracer.lights, settings, max_depth: settings.max_depth },
                view: CameraView::new(&tracer.world.snapshot.cameras[0], settings.size),
                previous: None,
                filter: FilterSampler::new(settings.filter),
                slots: Slots::new(layout, &tracer.lights).unwrap(),
                channels: layout.channels,
            }
        }
    }

    /// Number of times that light came, by bounces.
    #[derive(Default)]
    struct Bounces([u32; 8]);

    impl Sink for Bounces {
        fn light(&mut self, bounces: u32, _light: u32, _share: Split) {
            self.0[bounces as usize] += 1;
        }
    }

    /// What they bring is what the path of the sample leaves out: nothing twice, nothing lost.
    #[test]
    fn additional_rays_bring_the_light_that_paths_leave_to_them() {
        let (tracer, settings) = (tracer(&cornell()), Settings { max_depth: 5, ..sized(32, 32) });
        let pixels = Pixels::of(&tracer, &settings, &FilmLayout::new(&[]));
        for extra in [Extra::Lamps, Extra::Direct] {
            let (mut brought, mut all) = (Bounces::default(), Bounces::default());
            for pixel in (0..32).flat_map(|y| (0..32).map(move |x| UVec2::new(x, y))) {
                let (sampler, chance) = (pixels.sampler(pixel, 0), pixels.chance(pixel, 0));
                let mut sample = Sample { pixel, number: 0, sampler, chance, extra };
                let ray = pixels.camera_ray(pixel, &mut sample.sampler);
                let start = TracedRay { ray, hit: pixels.cx.world.closest(&ray, None, 0) };
                pixels.extra(&mut sample, 0, start, &mut brought);
                pixels.cx.path(start, 0, &sample.sampler, &mut sample.chance, &mut all);
            }
            let least = extra.least_bounces() as usize;
            for bounces in 0..=5 {
                assert_eq!(brought.0[bounces] > 0, bounces < least, "{extra:?}, {bounces}: {:?}", brought.0);
                assert!(all.0[bounces] > 0, "{:?}", all.0);
            }
        }
    }

    /// A floor under an even sky, which only rays by the BSDF look for.
    #[test]
    fn paths_divide_at_a_first_surface_that_is_no_mirror() {
        for (material, max_depth, rays) in [(lambert(0.8), 4, 2), (lambert(0.8), 1, 1), (mirror(), 4, 1)] {
            let stage = Stage::default().mesh(floor(), material, at(Vec3::ZERO)).environment(1.0);
            let tracer = tracer(&stage.orthographic(Vec3::Y, Vec3::new(0.1, 0.0, 0.0), 1.0).0);
            let settings = Settings { max_depth, ..sized(8, 8) };
            let pixels = Pixels::of(&tracer, &settings, &FilmLayout::new(&[]));
            for number in 0..16 {
                let (mut sampler, mut chance) = (pixels.sampler(UVec2::splat(4), number), pixels.chance(UVec2::splat(4), number));
                let ray = pixels.camera_ray(UVec2::splat(4), &mut sampler);
                let start = TracedRay { ray, hit: pixels.cx.world.closest(&ray, None, 0) };
                let mut seen = Bounces::default();
                pixels.cx.path(start, 0, &sampler, &mut chance, &mut seen);
                assert_eq!((chance.rays, u64::from(seen.0[1])), (rays, rays), "depth {max_depth}");
            }
        }
    }
}

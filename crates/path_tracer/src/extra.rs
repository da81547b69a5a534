//! Which pixels get additional camera rays.
//!
//! Few pixels have most of the noise that the eye and the mean squared error see: those along the edges of lamps, which hold far more contrast than
//! anything that they light (one in a hundred pixels of the Cornell box has a quarter of its noise), and those with the image of the sun in metal (one in
//! a hundred has nine tenths). Smoothing them takes camera rays, and at highlights light at the first surface; both are cheap beside a path. So at
//! these pixels [`EXTRA_RAYS`] rays a sample look for lamps, or for lamps and direct light, in the place of one. Which pixels they are is found by one
//! ray through the centre of each before the first sample, with random numbers that no sample has, so the mean stays what it is.

use crate::Integrator;
use crate::camera::CameraView;
use crate::integrator::{Chance, Context, Sink, Split, TracedRay};
use crate::pixels::BATCH;
use crate::world::Rays;
use glam::{UVec2, Vec2};
use kajo_sampling::{Sampler, hash_u64};
use rayon::prelude::*;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU64, Ordering};

/// Additional camera rays, a sample.
pub(crate) const EXTRA_RAYS: u32 = 8;

/// First bounce number of the random numbers that pixels are chosen with: far above any other.
const CHOICE_DIMENSIONS: u32 = 1 << 19;

/// Difference of luminance within three by three pixels, over the greatest, that is the edge of a lamp.
const CONTRAST: f32 = 0.5;

/// The same over the mean of the image: edges within a photographed sky, and those of bodies before it, are no brighter than the rest of the picture.
const PROMINENCE: f32 = 2.0;

/// Variance of direct light within three by three pixels, over the mean of the image's noise, that is a highlight: where the additional rays take away
/// more than as many samples spread over the image would.
const HIGHLIGHT: f32 = EXTRA_RAYS as f32;

/// What additional rays of a pixel look for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Extra {
    /// There are none.
    #[default]
    Nothing,
    /// Light that has not bounced.
    Lamps,
    /// Light that has bounced once at most.
    Direct,
}

impl Extra {
    /// Bounces of the light that is left to the path of the sample, at least.
    pub(crate) fn least_bounces(self) -> u32 {
        match self {
            Self::Nothing => 0,
            Self::Lamps => 1,
            Self::Direct => 2,
        }
    }
}

/// What additional rays of each pixel look for.
pub(crate) struct Extras {
    width: usize,
    pixels: Vec<Extra>,
}

impl Extras {
    /// What the rays look for, `None` where there are none or where the integrator sees no light, and the number of rays that it took to know. `row` is
    /// called after every row of pixels, from any thread, and may end the search.
    pub(crate) fn find(cx: &Context, view: &CameraView, row: impl Fn() -> ControlFlow<()> + Sync) -> ControlFlow<(), (Option<Self>, u64)> {
        if !matches!(cx.settings.integrator, Integrator::Path | Integrator::Direct) {
            return ControlFlow::Continue((None, 0));
        }
        let (width, height) = (cx.settings.size.x as usize, cx.settings.size.y as usize);
        let mut seen = vec![Seen::default(); width * height];
        let rays = AtomicU64::new(0);
        seen.par_chunks_exact_mut(width).enumerate().try_for_each(|(y, pixels)| {
            rays.fetch_add(see(cx, view, y as u32, pixels), Ordering::Relaxed);
            row()
        })?;
        ControlFlow::Continue((Self::between(width, &seen), rays.into_inner()))
    }

    /// The pixels of an image that stand out of what is around them.
    fn between(width: usize, seen: &[Seen]) -> Option<Self> {
        let prominent = PROMINENCE * average(seen.iter().map(|seen| seen.emission));
        let is_edge = |pixel: usize| {
            let emission = around(width, seen, pixel).map(|seen| seen.emission);
            let (low, high) = emission.fold((f32::INFINITY, 0.0f32), |(low, high), value| (low.min(value), high.max(value)));
            high - low > prominent.max(CONTRAST * high)
        };
        let variance = |pixel: usize| {
            let (n, sum, squares) = around(width, seen, pixel)
                .fold((0.0, 0.0, 0.0), |(n, sum, squares), Seen { direct, .. }| (n + 1.0, sum + direct, squares + direct * direct));
            (squares / n - (sum / n) * (sum / n)).max(0.0f32)
        };
        let variances: Vec<f32> = (0..seen.len()).into_par_iter().map(variance).collect();
        let highlight = highlight(&variances, average(seen.iter().map(|seen| seen.direct)));
        let extra = |pixel: usize| match variances[pixel] > highlight {
            true => Extra::Direct,
            false if is_edge(pixel) => Extra::Lamps,
            false => Extra::Nothing,
        };
        let pixels: Vec<Extra> = (0..seen.len()).into_par_iter().map(extra).collect();
        pixels.iter().any(|&extra| extra != Extra::Nothing).then_some(Self { width, pixels })
    }

    #[inline]
    pub(crate) fn at(&self, pixel: UVec2) -> Extra {
        self.pixels[pixel.y as usize * self.width + pixel.x as usize]
    }
}

/// Variance from which on additional rays pay: [`HIGHLIGHT`] times the mean of what remains. Light of more bounces, which was not looked for, is taken
/// to have the noise of paths of which each brings the mean of the image or twice that or nothing: its square.
fn highlight(variances: &[f32], mean_of_direct: f32) -> f32 {
    let mut limit = f32::INFINITY;
    for _ in 0..ROUNDS {
        let remaining = average(variances.iter().map(|&variance| if variance > limit { variance / EXTRA_RAYS as f32 } else { variance }));
        limit = HIGHLIGHT * (remaining + mean_of_direct * mean_of_direct);
    }
    limit
}

/// Rounds in which the limit settles; each takes the noise of the pixels beyond the one before out of the mean.
const ROUNDS: u32 = 16;

fn average(values: impl ExactSizeIterator<Item = f32>) -> f32 {
    let count = values.len() as f64;
    (values.map(f64::from).sum::<f64>() / count) as f32
}

/// Three by three pixels, fewer at the border.
fn around(width: usize, seen: &[Seen], pixel: usize) -> impl Iterator<Item = &Seen> {
    let (x, y, height) = (pixel % width, pixel / width, seen.len() / width);
    let columns = x.saturating_sub(1)..(x + 2).min(width);
    (y.saturating_sub(1)..(y + 2).min(height)).flat_map(move |y| &seen[y * width..][columns.clone()])
}

/// Looks through the centres of a row of pixels; returns the number of rays.
fn see(cx: &Context, view: &CameraView, y: u32, row: &mut [Seen]) -> u64 {
    let (mut rays, mut hits, mut count) = (Rays::default(), Vec::new(), 0);
    let direct = cx.direct_only();
    let key = |pixel: UVec2| hash_u64(u64::from(pixel.y) << 32 | u64::from(pixel.x));
    for (first, chunk) in row.chunks_mut(BATCH).enumerate() {
        let pixel = |x: usize| UVec2::new((first * BATCH + x) as u32, y);
        rays.clear();
        for pixel in (0..chunk.len()).map(pixel) {
            rays.push(view.ray(pixel.as_vec2() + 0.5, Vec2::splat(0.5)).traced(), key(pixel));
        }
        cx.world.closest_of(&rays, &mut hits);
        for (x, (seen, &hit)) in chunk.iter_mut().zip(&hits).enumerate() {
            let sampler = Sampler::new(cx.settings.sampler, cx.settings.seed, pixel(x), 0);
            let (start, mut chance) = (TracedRay { ray: rays.ray(x), hit }, Chance::new(key(pixel(x))));
            direct.path(start, CHOICE_DIMENSIONS, &sampler, &mut chance, seen);
            count += 1 + chance.rays;
            if !(seen.emission + seen.direct).is_finite() {
                *seen = Seen::default();
            }
        }
    }
    count
}

/// Luminance of lamps and sky, and of what they light, in one sample.
#[derive(Clone, Copy, Debug, Default)]
struct Seen {
    emission: f32,
    direct: f32,
}

impl Sink for Seen {
    fn light(&mut self, bounces: u32, _light: u32, share: Split) {
        let kept = if bounces == 0 { &mut self.emission } else { &mut self.direct };
        *kept += share.total().luminance();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{Film, FilmLayout, Fingerprint};
    use crate::pixels::Pixels;
    use crate::tests::scenes::{Stage, at, floor, glowing, lambert, looking, mean, render_at, sized, tracer};
    use crate::{Frame, Settings};
    use glam::{Quat, Vec3};
    use kajo_sampling::SamplerKind;
    use kajo_scene::{LightShape, Material, Scene, Transform, shapes};
    use kajo_units::Meters;

    #[test]
    fn edges_are_where_neighbours_differ_and_nowhere_else() {
        let extras = |emission: &[f32]| {
            let seen: Vec<Seen> = emission.iter().map(|&emission| Seen { emission, direct: 0.0 }).collect();
            Extras::between(7, &seen)
        };
        let mut seen = [0.0; 7 * 5];
        seen[2 * 7 + 3] = 4.0;
        let found = extras(&seen).expect("an edge");
        for (x, y) in (0..5).flat_map(|y| (0..7).map(move |x| (x, y))) {
            let expected = if (2..5).contains(&x) && (1..4).contains(&y) { Extra::Lamps } else { Extra::Nothing };
            assert_eq!(found.at(UVec2::new(x, y)), expected, "{x} {y}");
        }
        let slope: Vec<f32> = (0..35).map(|pixel| 10.0 + (pixel % 7) as f32).collect();
        assert!(extras(&slope).is_none() && extras(&[0.0; 35]).is_none());
        // A bright half is no lamp, a bright pixel among others is one.
        let half: Vec<f32> = (0..35).map(|pixel| if pixel % 7 < 4 { 1.0 } else { 0.2 }).collect();
        assert!(extras(&half).is_none());
        let sun: Vec<f32> = half.iter().enumerate().map(|(pixel, &sky)| if pixel == 16 { 100.0 } else { sky }).collect();
        let found = extras(&sun).expect("a sun");
        assert_eq!([UVec2::new(2, 2), UVec2::new(5, 2)].map(|pixel| found.at(pixel)), [Extra::Lamps, Extra::Nothing]);
    }

    #[test]
    fn highlights_stand_out_of_all_noise_of_the_image() {
        let width = 64;
        let mut seen: Vec<Seen> = (0..width * width).map(|pixel| Seen { emission: 0.0, direct: 0.5 + (pixel % 2) as f32 }).collect();
        assert!(Extras::between(width, &seen).is_none(), "noise alike everywhere");
        seen[20 * width + 30].direct = 100.0;
        let found = Extras::between(width, &seen).expect("a highlight");
        for (x, y) in (0..64).flat_map(|y| (0..64).map(move |x| (x, y))) {
            let expected = if (29..32).contains(&x) && (19..22).contains(&y) { Extra::Direct } else { Extra::Nothing };
            assert_eq!(found.at(UVec2::new(x, y)), expected, "{x} {y}");
        }
        // Of two, the brighter does not hide the other: its noise will be an eighth.
        seen[40 * width + 40].direct = 30.0;
        let found = Extras::between(width, &seen).expect("two highlights");
        assert_eq!([UVec2::new(30, 20), UVec2::new(40, 40)].map(|pixel| found.at(pixel)), [Extra::Direct; 2]);
    }

    /// A ball of rough metal under a small sun: its highlight, with additional rays and without. The floor's images of the highlight are as noisy either way.
    #[test]
    fn highlights_have_less_noise_and_the_same_mean() {
        let metal = Material { metallic: 1.0, roughness: 0.15, ..Material::default() };
        let scene = Stage::default()
            .mesh(shapes::sphere(0.5, 64), metal, at(Vec3::ZERO))
            .mesh(floor(), lambert(0.8), at(Vec3::NEG_Y * 0.5))
            .mesh(shapes::sphere(0.1, 64), glowing(400.0, 0.0), at(Vec3::new(-2.0, 2.5, 3.0)))
            .environment(0.1)
            .perspective(Vec3::new(0.0, 0.0, 2.0), Vec3::ZERO, 40.0)
            .0;
        let tracer = tracer(&scene);
        let picture = |seed, extra: bool| {
            let settings = Settings { seed, max_depth: 3, ..sized(32, 32) };
            let layout = FilmLayout::new(&[]);
            let mut pixels = Pixels::of(&tracer, &settings, &layout);
            if extra {
                let ControlFlow::Continue((Some(extras), rays)) = Extras::find(&pixels.cx, &pixels.view, || ControlFlow::Continue(()))
                else {
                    panic!("no highlight");
                };
                let direct = extras.pixels.iter().filter(|&&extra| extra == Extra::Direct).count();
                assert!((4..100).contains(&direct) && rays > 32 * 32, "{direct} pixels, {rays} rays");
                pixels.extras = Some(extras);
            }
            let mut film = Film::new(settings.size, layout, Fingerprint::default(), false);
            for mut row in film.rows() {
                pixels.row(&mut row, 64);
            }
            film.develop()
        };
        let [with, without] = [true, false].map(|extra| error_of(&(0..16).map(|seed| picture(seed, extra)).collect::<Vec<_>>()));
        assert!(without.1 > 2.0 * with.1, "{} over {}", without.1, with.1);
        assert_same_mean(&with.0, &without.0);
    }

    /// Emission alone, by several seeds: for each its mean, and the mean squared error of a picture.
    fn emission(scene: &Scene, integrator: Integrator, sampler: SamplerKind) -> (Vec<f64>, f64) {
        let settings = |seed| Settings { integrator, sampler, seed, max_depth: 0, ..sized(32, 32) };
        error_of(&(0..16).map(|seed| render_at(scene, &settings(seed), 16)).collect::<Vec<_>>())
    }

    /// The mean of each of several pictures, and the mean squared error of one.
    fn error_of(frames: &[Frame]) -> (Vec<f64>, f64) {
        let count = frames.len() as f64;
        let mut error = 0.0;
        for (x, y) in (0..32).flat_map(|y| (0..32).map(move |x| (x, y))) {
            let values = frames.iter().map(|frame| f64::from(frame.beauty().get(x, y).luminance()));
            let center = values.clone().sum::<f64>() / count;
            error += values.map(|value| (value - center).powi(2)).sum::<f64>() / (count - 1.0) / (32.0 * 32.0);
        }
        (frames.iter().map(mean).collect(), error)
    }

    /// Lamps of every kind before a dim sky, against rays that look once a sample.
    #[test]
    fn edges_of_lamps_have_less_noise_and_the_same_mean() {
        let lamp = shapes::rectangle(0.5, 0.5);
        let turned = Transform::Trs { translation: Vec3::X * 0.6, rotation: Quat::from_rotation_z(0.3), scale: Vec3::ONE };
        let scene = Stage::default()
            .light(
                LightShape::Rectangle { width: Meters(0.5), height: Meters(0.5) },
                5.0,
                looking(-0.6 * Vec3::X, Vec3::new(-0.5, 0.1, 1.0)),
            )
            .light(LightShape::Sphere { radius: Meters(0.25) }, 5.0, at(Vec3::ZERO))
            .mesh(lamp, Material { double_sided: true, ..glowing(5.0, 0.0) }, turned)
            .environment(0.1)
            .perspective(Vec3::new(0.0, 0.0, 2.0), Vec3::ZERO, 60.0)
            .0;
        for sampler in [SamplerKind::Sobol, SamplerKind::Independent] {
            let (means, error) = emission(&scene, Integrator::Path, sampler);
            let (once, error_once) = emission(&scene, Integrator::BsdfOnly, sampler);
            // Independent samples: one eighth. Sobol points: 8 to the power of 3/2.
            let least = if sampler == SamplerKind::Sobol { 12.0 } else { 6.0 };
            assert!(error_once > least * error, "{sampler:?}: {error_once} over {error}");
            assert_same_mean(&means, &once);
        }
    }

    /// Equal within four standard errors, which see a difference of five per cent.
    fn assert_same_mean(a: &[f64], b: &[f64]) {
        let moments = |values: &[f64]| {
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            let scatter = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>();
            (mean, scatter / (values.len() * (values.len() - 1)) as f64)
        };
        let ((a, variance_a), (b, variance_b)) = (moments(a), moments(b));
        let error = (variance_a + variance_b).sqrt();
        assert!((a - b).abs() < 4.0 * error, "{a} and {b}, {error} is one standard error");
        assert!(a > 0.0 && (1.05 * a - b).abs() > 4.0 * error, "planted fault: five per cent more is seen: {a} and {b}, {error}");
    }
}

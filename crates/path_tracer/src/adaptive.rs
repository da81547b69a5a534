//! Adaptive sampling: where the samples of a picture go.
//!
//! # What is minimised
//! A display shows about the square root of light, so the error that counts is that of √(Y + Ȳ), Y being a pixel's luminance and Ȳ the picture's mean:
//! σ/(2√(Y + Ȳ)) for a standard deviation of σ. The sum of its squares, Σ σ²/((Y + Ȳ) n), is least for a given number of samples when \[Neyman34]
//!
//! ```text
//! n_p ∝ s_p = σ_p / √(Y_p + Ȳ)
//! ```
//!
//! # Why the mean stays unbiased
//! A rule that looks at a pixel's own samples stops early where they happened to miss what is rare and bright, and keeps that too dark mean \[Kirk91].
//! Here the number of samples of a pixel is a function of the samples of *other* pixels: σ and Y are taken from the ring of 24 neighbours within 2 px,
//! not from the pixel. The points of different pixels are randomised independently, so with N the number of samples and x_i those of the pixel
//!
//! ```text
//! E[1/N Σ_{i<N} x_i] = E_N[ E[1/N Σ_{i<N} x_i | N] ] = E_N[μ] = μ
//! ```
//!
//! for every rule that decides so once. The plan is revised, though, and what a neighbour knows must not depend on the pixel through the number of samples
//! that the neighbour was given. So a revision reads the first m samples of each pixel alone, as many as every pixel is sure to have by then: a fixed number.
//! There are two, m = 16 and m = 64; with the 24 neighbours the second knows 1536 samples. By induction N is a function of the points of other pixels.
//!
//! What a pixel shares with its own samples is the scale: the means over the whole picture (Ȳ, the sum of all s), and when the rendering stops. That is
//! one part in the number of pixels, and the same for `Stop::noise` without a plan.

use crate::blocks::BlockSums;
use glam::UVec2;
use kajo_sampling::{hash_u64, unit_f32};
use kajo_units::LinearRgb;

/// Samples of every pixel before the first plan.
pub(crate) const PILOT: u32 = 16;
/// Growth of what a plan is made from.
const GROWTH: u32 = 4;
/// Samples that the last plan is made from. Later a pixel may be past a milestone before the plan that asks for it.
const LAST: u32 = 64;
/// Share of the samples that is dealt evenly: what no pilot has seen yet is found in time, and the next revision comes.
const EVEN: f32 = 1.0 / 8.0;
/// Most samples of a pixel, relative to the mean.
const MOST: f32 = 16.0;
/// Neighbours lie within this distance, px.
const RADIUS: i32 = 2;
/// A plan aims for the best numbers when the samples have grown by this.
const HORIZON: f32 = 4.0;

/// Mean luminance of a pixel and the standard deviation of one of its samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub(crate) struct Pilot {
    pub mean: f32,
    pub deviation: f32,
}

impl Pilot {
    /// From sums and blocks of the first `n` samples of red, green and blue.
    pub(crate) fn new(sums: &[f64], blocks: &[BlockSums], n: u32) -> Self {
        let weights = LinearRgb::LUMINANCE.map(f64::from);
        let (mut mean, mut deviation) = (0.0, 0.0);
        for ((weight, sum), block) in weights.iter().zip(sums).zip(blocks) {
            mean += weight * sum / f64::from(n);
            deviation += weight * (f64::from(block.variance_of_mean(n)) * f64::from(n)).sqrt();
        }
        Self { mean: mean as f32, deviation: deviation as f32 }
    }
}

/// How many samples each pixel has when the picture has a mean of so many: its level.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Plan {
    /// Level at which this plan was made.
    pub level: u32,
    /// Samples that the next revision is made from.
    pub milestone: u32,
    /// Samples of each pixel at `level`.
    pub base: Vec<u32>,
    /// Samples of each pixel for one more level; mean 1, at least [`EVEN`].
    pub density: Vec<f32>,
    /// What the first `milestone` samples of each pixel say.
    pub pilots: Vec<Pilot>,
}

impl Plan {
    /// The same for every pixel.
    pub(crate) fn even(pixels: usize) -> Self {
        Self { level: 0, milestone: PILOT, base: vec![0; pixels], density: vec![1.0; pixels], pilots: vec![Pilot::default(); pixels] }
    }

    /// Level of the next revision: every pixel has `milestone` samples then, whatever the plan. The greatest number after the last one.
    pub(crate) fn revision(&self) -> u32 {
        match self.milestone {
            PILOT => PILOT,
            milestone if milestone > LAST => u32::MAX,
            milestone => self.level.saturating_add((milestone - milestone / GROWTH).saturating_mul((1.0 / EVEN) as u32)),
        }
    }

    /// Makes a new plan at the level of [`Plan::revision`], from the pilots.
    pub(crate) fn revise(&mut self, size: UVec2) {
        self.revise_by(size, wanted);
    }

    fn revise_by(&mut self, size: UVec2, rule: fn(&[Pilot], UVec2) -> Vec<f32>) {
        let level = self.revision();
        for (pixel, base) in self.base.iter_mut().enumerate() {
            *base = count(pixel, *base, self.density[pixel], level.saturating_sub(self.level));
        }
        self.density = densities(&rule(&self.pilots, size), &self.base, level);
        self.level = level;
        self.milestone = self.milestone.saturating_mul(GROWTH);
    }

    /// Samples of pixel number `pixel` at `level`, no lower than the plan's.
    #[inline]
    pub(crate) fn count(&self, pixel: usize, level: u32) -> u32 {
        count(pixel, self.base[pixel], self.density[pixel], level.saturating_sub(self.level))
    }
}

/// `base` + `density` × `more`, rounded to three leading bits, up or down by a number of the pixel's own, so that the mean is kept. Sets of Sobol points
/// are good in multiples of powers of two, and less than even in numbers between them.
#[inline]
pub(crate) fn count(pixel: usize, base: u32, density: f32, more: u32) -> u32 {
    let threshold = f64::from(unit_f32((hash_u64(pixel as u64) >> 32) as u32));
    let exact = f64::from(base) + f64::from(density) * f64::from(more);
    let step = f64::from((1u32 << (exact as u32).max(1).ilog2()) / 4).max(1.0);
    ((exact / step + threshold).floor() * step) as u32
}

/// s of each pixel, by the ring of its neighbours.
fn wanted(pilots: &[Pilot], size: UVec2) -> Vec<f32> {
    let mean = pilots.iter().map(|p| f64::from(p.mean)).sum::<f64>() / pilots.len() as f64;
    let (width, height) = (size.x as i32, size.y as i32);
    let of = |x: i32, y: i32| {
        let (mut variance, mut luminance, mut count) = (0.0f64, 0.0f64, 0.0f64);
        for ny in (y - RADIUS).max(0)..=(y + RADIUS).min(height - 1) {
            for nx in (x - RADIUS).max(0)..=(x + RADIUS).min(width - 1) {
                if (nx, ny) != (x, y) {
                    let pilot = pilots[(ny * width + nx) as usize];
                    variance += f64::from(pilot.deviation).powi(2);
                    luminance += f64::from(pilot.mean);
                    count += 1.0;
                }
            }
        }
        let floor = luminance + count * mean;
        if floor > 0.0 { (variance / floor).sqrt() as f32 } else { 0.0 }
    };
    (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| of(x, y)).collect()
}

/// Samples of each pixel for one more level, so that all together come near the wanted proportions at the horizon.
fn densities(wanted: &[f32], base: &[u32], level: u32) -> Vec<f32> {
    /// Clipping changes the mean, and scaling what is clipped: a few rounds settle it.
    const ROUNDS: u32 = 8;
    let mean = |values: &[f32]| values.iter().map(|&v| f64::from(v)).sum::<f64>() as f32 / values.len() as f32;
    let average = mean(wanted);
    if average <= 0.0 || !average.is_finite() {
        return vec![1.0; wanted.len()];
    }
    let mut shape: Vec<f32> = wanted
        .iter()
        .zip(base)
        .map(|(s, &base)| {
            let missing = HORIZON * (s / average).min(MOST) - base as f32 / level as f32;
            (missing / (HORIZON - 1.0)).max(0.0)
        })
        .collect();
    if mean(&shape) <= 0.0 {
        return vec![1.0; wanted.len()];
    }
    for _ in 0..ROUNDS {
        let scale = 1.0 / mean(&shape);
        shape.iter_mut().for_each(|d| *d = (*d * scale).min(MOST));
    }
    // What clipping left over goes to all alike.
    let left = 1.0 - mean(&shape);
    shape.iter().map(|d| EVEN + (1.0 - EVEN) * (d + left)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{Film, FilmLayout, Fingerprint};
    use kajo_sampling::Rng;

    const SIZE: UVec2 = UVec2::new(48, 32);

    /// Noise like that of a caustic: one sample in forty is bright. Mean 1.
    fn rarely_bright(rng: &mut Rng) -> f32 {
        if rng.next_1d() < 1.0 / 40.0 { 40.0 } else { 0.0 }
    }

    /// Mean over the pixels of their means at the level, and its standard error from the numbers of samples; the plan is made by `rule`.
    fn sampled(level: u32, rule: fn(&[Pilot], UVec2) -> Vec<f32>) -> (f64, f64) {
        let mut film = Film::new(SIZE, FilmLayout::new(&[]), Fingerprint::default(), true);
        let mut streams: Vec<Rng> = (0..SIZE.x * SIZE.y).map(|pixel| Rng::new(hash_u64(pixel.into()))).collect();
        while film.spp() < level {
            let goal = level.min(film.plan.as_ref().map_or(0, Plan::revision));
            for row in &mut film.rows() {
                for x in 0..SIZE.x {
                    for sample in row.count(x, *row.level)..row.count(x, goal) {
                        let value = rarely_bright(&mut streams[(row.y * SIZE.x + x) as usize]);
                        assert!(row.add(x, sample, &[value; 3]));
                    }
                }
                *row.level = goal;
            }
            let plan = film.plan.as_mut().unwrap();
            if goal == plan.revision() {
                plan.revise_by(SIZE, rule);
            }
        }
        let frame = film.develop();
        let pixels = f64::from(SIZE.x * SIZE.y);
        let mean = frame.beauty().pixels().iter().map(|p| f64::from(p[0])).sum::<f64>() / pixels;
        let variance: f64 = (0..film.sums.len() / 3).map(|pixel| 39.0 / f64::from(film.count(pixel))).sum();
        (mean, variance.sqrt() / pixels)
    }

    /// The rule that everybody thinks of first.
    fn by_own_samples(pilots: &[Pilot], _: UVec2) -> Vec<f32> {
        let mean = pilots.iter().map(|p| p.mean).sum::<f32>() / pilots.len() as f32;
        pilots.iter().map(|p| p.deviation / (p.mean + mean).sqrt()).collect()
    }

    #[test]
    fn the_mean_is_unbiased_where_stopping_by_own_samples_darkens_it() {
        for level in [64, 1000] {
            let (mean, error) = sampled(level, wanted);
            assert!((mean - 1.0).abs() < 3.0 * error, "level {level}: {mean} ± {error}");
            let (naive, error) = sampled(level, by_own_samples);
            assert!(naive < 1.0 - 6.0 * error, "level {level}: {naive} ± {error} by the pixels' own samples");
        }
    }

    fn pilots(seed: u64) -> Vec<Pilot> {
        let mut rng = Rng::new(seed);
        (0..SIZE.x * SIZE.y).map(|_| Pilot { mean: 0.5 + rng.next_1d(), deviation: rng.next_1d() }).collect()
    }

    #[test]
    fn what_a_pixel_saw_does_not_count_for_it() {
        let (before, pixel, far) = (pilots(1), 600, 700);
        let mut after = before.clone();
        // The mean of the picture is kept, for that is shared by all.
        (after[pixel].mean, after[pixel].deviation) = (before[pixel].mean + 0.25, 100.0);
        after[far].mean -= 0.25;
        let (before, after) = (wanted(&before, SIZE), wanted(&after, SIZE));
        assert!((before[pixel] - after[pixel]).abs() < 1e-5 * before[pixel]);
        assert!(
            after[pixel + 1] > 5.0 * before[pixel + 1] && after[pixel - 2 * SIZE.x as usize] > 5.0 * before[pixel - 2 * SIZE.x as usize]
        );
    }

    #[test]
    fn plans_keep_the_level_and_have_what_the_next_revision_reads() {
        let mut plan = Plan::even((SIZE.x * SIZE.y) as usize);
        let mut level = 0;
        for seed in 0..2 {
            assert!(plan.revision() > level);
            level = plan.revision();
            let counts: Vec<u32> = (0..plan.base.len()).map(|pixel| plan.count(pixel, level)).collect();
            let mean = counts.iter().map(|&n| f64::from(n)).sum::<f64>() / counts.len() as f64;
            assert!((mean / f64::from(level) - 1.0).abs() < 0.02, "mean of {mean} at level {level}");
            assert!(counts.iter().all(|&n| n >= plan.milestone), "{} samples at level {level}", plan.milestone);
            plan.pilots = pilots(seed);
            plan.pilots[..200].fill(Pilot { mean: 1.0, deviation: 0.0 });
            plan.revise(SIZE);
        }
        let quiet = plan.density[0];
        assert!((EVEN..0.2).contains(&quiet), "{quiet}");
        assert_eq!(plan.revision(), u32::MAX, "there are two revisions");
    }

    /// The numbers of samples are those of [`LAST`] samples a pixel and of what came before: whatever follows.
    #[test]
    fn later_samples_do_not_count() {
        let size = UVec2::new(12, 8);
        // The same values up to a sample, others from there on; more samples than a third revision would wait for, above quiet pixels, below noisy ones.
        let plan = |same: u32| {
            let mut film = Film::new(size, FilmLayout::new(&[]), Fingerprint::default(), true);
            while film.spp() < 4000 {
                let goal = film.plan.as_ref().map_or(0, Plan::revision).min(4000);
                for row in &mut film.rows() {
                    for x in 0..size.x {
                        for sample in row.count(x, *row.level)..row.count(x, goal) {
                            let key = u64::from(row.y * size.x + x) << 32 | u64::from(sample);
                            let value = rarely_bright(&mut Rng::new(key)) * if row.y < 4 { 0.02 } else { 1.0 };
                            assert!(row.add(x, sample, &[if sample < same { value } else { value * (x + 2) as f32 }; 3]));
                        }
                    }
                    *row.level = goal;
                }
                film.revise();
            }
            film.plan.map(|plan| (plan.base, plan.density))
        };
        assert!(plan(u32::MAX) == plan(LAST));
        assert!(plan(u32::MAX) != plan(LAST - 1), "planted fault: the last sample before counts");
    }

    #[test]
    fn no_pixel_gets_more_than_sixteen_times_the_mean() {
        for noisy in [1, 10, 96, 200] {
            let mut wanted = vec![0.0; (SIZE.x * SIZE.y) as usize];
            wanted[..noisy].fill(1.0);
            let dealt = densities(&wanted, &vec![PILOT; wanted.len()], PILOT);
            let mean = dealt.iter().sum::<f32>() / dealt.len() as f32;
            assert!((mean - 1.0).abs() < 1e-4, "{noisy} noisy pixels: mean density of {mean}");
            assert!(dealt.iter().all(|d| (EVEN..=MOST).contains(d)), "{noisy} noisy pixels: {} at most", dealt[0]);
            assert!(dealt[0] > 0.4 * MOST, "{noisy} noisy pixels: {} at most", dealt[0]);
        }
    }

    #[test]
    fn numbers_of_samples_grow_with_the_level_have_three_leading_bits_and_keep_their_mean() {
        for (base, density) in [(0, 1.0f32), (16, 0.125), (16, 0.7), (64, 16.0)] {
            let mut sum = 0.0;
            for pixel in 0..1000 {
                let counts: Vec<u32> = (0..300).map(|more| count(pixel, base, density, more)).collect();
                assert_eq!(counts[0], base);
                assert!(
                    counts.is_sorted()
                        && counts
                            .iter()
                            .all(|n| n >> (32 - n.leading_zeros()).saturating_sub(3) << (32 - n.leading_zeros()).saturating_sub(3) == *n)
                );
                sum += f64::from(counts[299]);
            }
            let exact = f64::from(base) + f64::from(density) * 299.0;
            assert!((sum / 1000.0 / exact - 1.0).abs() < 0.02, "{} for {exact}", sum / 1000.0);
        }
    }

    #[test]
    fn black_and_constant_pictures_are_sampled_evenly() {
        for pilot in [Pilot::default(), Pilot { mean: 2.0, deviation: 0.0 }, Pilot { mean: f32::INFINITY, deviation: f32::INFINITY }] {
            let pilots = vec![pilot; (SIZE.x * SIZE.y) as usize];
            assert!(densities(&wanted(&pilots, SIZE), &vec![PILOT; pilots.len()], PILOT).iter().all(|&d| d == 1.0));
        }
    }
}

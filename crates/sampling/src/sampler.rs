//! The sampler of one pixel sample: a stream of dimensions, each a function of (seed, pixel, sample, dimension).
//!
//! One concrete type with three kinds. Dimensions are padded: a request takes the next dimension and gets a point of its own,
//! independently randomised set, which is well stratified over the samples of the pixel. A 2D request right after a 1D request
//! joins its set, so that the pair (which lobe or light, where on it) is stratified in all three coordinates together. A caller
//! with a varying number of requests jumps to fixed dimensions ([`Sampler::start_bounce`]) so that they stay the same quantity
//! in every sample.

use crate::bits::{hash_u64, morton_2d, scramble_reversed, unit_f32};
use crate::sobol::{sobol_2d_scrambled, sobol_third_scrambled};
use glam::{UVec2, Vec2};

/// Which points a [`Sampler`] hands out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum SamplerKind {
    /// Owen-scrambled Sobol pairs, shuffled per pixel and dimension: error falls faster than N^-1/2.    \[Burley20]
    #[default]
    Sobol,
    /// Independent pseudo-random numbers: the plain Monte Carlo baseline.
    Independent,
    /// One Owen-scrambled Sobol set per dimension, dealt to the pixels along a scrambled Z curve: neighbouring pixels get
    /// points that complement each other, so the error of the image is blue noise.    \[Ahmed20]
    BlueNoise {
        /// Base-2 logarithm of the samples a pixel will take; later samples start a new, independent pass.
        log2_samples: u32,
    },
}

/// The random numbers of one sample of one pixel, all in [0, 1).
#[derive(Clone, Debug)]
pub struct Sampler {
    kind: Kind,
    /// Randomises the dimensions; shared by the samples of a pixel (Sobol, Independent) or of the image (BlueNoise).
    stream: u64,
    /// Bits of the index in the point set, reversed: the scrambles work on that.
    reversed_index: u32,
    dimension: u32,
    /// Hash of the set whose third coordinate the last 1D request took; 0 when the next 2D request starts a set.
    open: u64,
    /// The shuffled index in that set.
    open_index: u32,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    /// Sobol with a per-dimension shuffle of the index; blue noise differs only in what stream and index are.
    Scrambled,
    Independent,
}

impl Sampler {
    /// Dimensions before the first bounce: film, lens, time.
    const CAMERA_DIMENSIONS: u32 = 16;
    /// Dimensions of one bounce; dimensions cost nothing, so there are more than any integrator needs.
    const BOUNCE_DIMENSIONS: u32 = 64;

    /// The stream of sample `sample` in `pixel`.
    #[inline]
    pub fn new(kind: SamplerKind, seed: u64, pixel: UVec2, sample: u32) -> Self {
        let pixel_stream = || hash_u64(hash_u64(seed) ^ (u64::from(pixel.y) << 32 | u64::from(pixel.x)));
        match kind {
            SamplerKind::Sobol => Self {
                kind: Kind::Scrambled,
                stream: pixel_stream(),
                reversed_index: sample.reverse_bits(),
                dimension: 0,
                open: 0,
                open_index: 0,
            },
            SamplerKind::Independent => Self {
                kind: Kind::Independent,
                stream: pixel_stream(),
                reversed_index: sample.reverse_bits(),
                dimension: 0,
                open: 0,
                open_index: 0,
            },
            SamplerKind::BlueNoise { log2_samples } => {
                let log2_samples = log2_samples.min(31);
                let pass = sample >> log2_samples;
                // 32 bits of index: the low ones count samples, the rest pixels of a tile; each tile and pass has its own stream.
                let place = (morton_2d(pixel.x, pixel.y) << log2_samples) | u64::from(sample & ((1 << log2_samples) - 1));
                let tile = morton_2d(pixel.x, pixel.y) >> (32 - log2_samples);
                let stream = hash_u64(hash_u64(seed) ^ hash_u64(tile << 32 | u64::from(pass)));
                Self { kind: Kind::Scrambled, stream, reversed_index: (place as u32).reverse_bits(), dimension: 0, open: 0, open_index: 0 }
            }
        }
    }

    /// The next dimension, in [0, 1).
    #[inline]
    pub fn next_1d(&mut self) -> f32 {
        let h = self.next_hash();
        match self.kind {
            Kind::Scrambled => {
                self.open = h;
                self.open_index = self.shuffled_index(h as u32);
                sobol_third_scrambled(self.open_index, (h.wrapping_mul(0x9fb2_1c65_1e98_df25) >> 32) as u32)
            }
            Kind::Independent => unit_f32((hash_u64(h ^ u64::from(self.reversed_index)) >> 32) as u32),
        }
    }

    /// The next dimension pair, in [0, 1)².
    #[inline]
    pub fn next_2d(&mut self) -> Vec2 {
        match self.kind {
            Kind::Scrambled => {
                let (h, index) = if self.open != 0 {
                    (self.open, self.open_index)
                } else {
                    let h = self.next_hash();
                    (h, self.shuffled_index(h as u32))
                };
                self.open = 0;
                sobol_2d_scrambled(index, (h >> 32) as u32, (h.wrapping_mul(0xd134_2543_de82_ef95) >> 32) as u32)
            }
            Kind::Independent => {
                let bits = hash_u64(self.next_hash() ^ u64::from(self.reversed_index));
                Vec2::new(unit_f32((bits >> 32) as u32), unit_f32(bits as u32))
            }
        }
    }

    /// Jumps to the first dimension of bounce `bounce` (0: the first surface), whatever was used before.
    #[inline]
    pub fn start_bounce(&mut self, bounce: u32) {
        self.set_dimension(Self::CAMERA_DIMENSIONS.wrapping_add(bounce.wrapping_mul(Self::BOUNCE_DIMENSIONS)));
    }

    /// Jumps to a dimension and forgets the last request. A request takes one dimension, a 2D request after a 1D one none.
    #[inline]
    pub fn set_dimension(&mut self, dimension: u32) {
        self.dimension = dimension;
        self.open = 0;
    }

    /// The random numbers of one of the `of` branches into which this sample divides from here on: over all samples of the pixel, branches are samples of a
    /// set `of` times as large.
    #[inline]
    pub fn branch(&self, branch: u32, of: u32) -> Self {
        let index = self.reversed_index.reverse_bits().wrapping_mul(of).wrapping_add(branch);
        Self { reversed_index: index.reverse_bits(), open: 0, ..self.clone() }
    }

    /// The dimension that the next request takes.
    pub fn dimension(&self) -> u32 {
        self.dimension
    }

    /// The index after an Owen scramble of its own, which decorrelates the sets of different dimensions.
    #[inline]
    fn shuffled_index(&self, seed: u32) -> u32 {
        scramble_reversed(self.reversed_index, seed).reverse_bits()
    }

    #[inline]
    fn next_hash(&mut self) -> u64 {
        let h = hash_u64(self.stream.wrapping_add(u64::from(self.dimension) << 32));
        self.dimension = self.dimension.wrapping_add(1);
        h
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::chi_square_p_value;

    const KINDS: [SamplerKind; 3] = [SamplerKind::Sobol, SamplerKind::Independent, SamplerKind::BlueNoise { log2_samples: 4 }];

    #[test]
    fn a_sample_can_be_replayed_alone_and_dimensions_are_stable() {
        for kind in KINDS {
            let mut a = Sampler::new(kind, 7, UVec2::new(12, 5), 3);
            let first = (a.next_1d(), a.next_2d());
            a.start_bounce(2);
            let bounce = a.next_2d();
            let mut b = Sampler::new(kind, 7, UVec2::new(12, 5), 3);
            b.start_bounce(2);
            assert_eq!(b.next_2d(), bounce);
            b.set_dimension(0);
            assert_eq!((b.next_1d(), b.next_2d()), first);
            let mut other = Sampler::new(kind, 8, UVec2::new(12, 5), 3);
            assert_ne!(other.next_1d(), first.0);
        }
    }

    #[test]
    fn branches_are_samples_of_a_larger_set() {
        for kind in KINDS {
            let sample = |number| {
                let mut sampler = Sampler::new(kind, 7, UVec2::new(12, 5), number);
                sampler.start_bounce(1);
                sampler.next_1d();
                sampler
            };
            let branch = sample(3).branch(1, 2).next_2d();
            assert_ne!(branch, sample(3).branch(0, 2).next_2d());
            if !matches!(kind, SamplerKind::BlueNoise { .. }) {
                let mut one = sample(7);
                one.set_dimension(one.dimension());
                assert_eq!(branch, one.next_2d());
            }
        }
        // Both branches of eight samples are one stratified set of sixteen.
        let mut cells = [0; 16];
        for (number, branch) in (0..8).flat_map(|number| [(number, 0), (number, 1)]) {
            let sampler = Sampler::new(SamplerKind::Sobol, 7, UVec2::new(12, 5), number);
            let p = sampler.branch(branch, 2).next_2d();
            cells[(p.x * 4.0) as usize * 4 + (p.y * 4.0) as usize] += 1;
        }
        assert_eq!(cells, [1; 16]);
    }

    #[test]
    fn values_lie_in_the_unit_interval() {
        for kind in KINDS {
            for sample in 0..1000 {
                let mut s = Sampler::new(kind, 1, UVec2::new(sample % 7, sample / 7), sample);
                for _ in 0..20 {
                    let (x, p) = (s.next_1d(), s.next_2d());
                    assert!((0.0..1.0).contains(&x) && (0.0..1.0).contains(&p.x) && (0.0..1.0).contains(&p.y));
                }
            }
        }
    }

    /// Joint histogram of two dimensions over pixels and samples, 16 × 16 cells.
    fn joint_p_value(kind: SamplerKind, dims: (u32, u32)) -> f64 {
        let mut counts = vec![0.0; 256];
        let n = 1 << 16;
        for i in 0..n {
            let mut s = Sampler::new(kind, 99, UVec2::new((i >> 4) & 63, i >> 10), i & 15);
            s.set_dimension(dims.0);
            let x = s.next_1d();
            s.set_dimension(dims.1);
            let y = s.next_1d();
            counts[(x * 16.0) as usize * 16 + (y * 16.0) as usize] += 1.0;
        }
        chi_square_p_value(&counts, &vec![f64::from(n) / 256.0; 256], 0)
    }

    #[test]
    fn dimensions_are_independent_of_each_other() {
        for kind in KINDS {
            for dims in [(0, 1), (1, 2), (0, 16), (3, 80), (16, 80)] {
                let p = joint_p_value(kind, dims);
                assert!(p > 1e-4, "{kind:?} dimensions {dims:?}: p = {p}");
            }
        }
    }

    #[test]
    fn planted_fault_a_dimension_is_not_independent_of_itself() {
        assert!(joint_p_value(SamplerKind::Sobol, (4, 4)) < 1e-12);
    }

    #[test]
    fn power_of_two_samples_of_a_pixel_are_stratified() {
        for kind in [SamplerKind::Sobol, SamplerKind::BlueNoise { log2_samples: 4 }] {
            for pixel in [UVec2::ZERO, UVec2::new(300, 17)] {
                let mut seen = [false; 16];
                for sample in 0..16 {
                    let mut s = Sampler::new(kind, 5, pixel, sample);
                    s.start_bounce(1);
                    let p = s.next_2d();
                    seen[(p.x * 4.0) as usize * 4 + (p.y * 4.0) as usize] = true;
                }
                assert!(seen.iter().all(|&s| s), "{kind:?}: 16 samples fill 4 × 4 strata");
            }
        }
    }

    /// RMS error over 64 pixels of ∫ sin(πx) y² √z of a 1D and a 2D request with `n` samples.
    fn integration_error(kind: SamplerKind, n: u32) -> f64 {
        let exact = 2.0 / std::f64::consts::PI / 3.0 * 2.0 / 3.0;
        let squared: f64 = (0..64)
            .map(|pixel| {
                let value = |i| {
                    let mut s = Sampler::new(kind, 21, UVec2::new(pixel, 3), i);
                    let (z, p) = (s.next_1d(), s.next_2d());
                    f64::from((std::f32::consts::PI * p.x).sin() * p.y * p.y * z.sqrt())
                };
                ((0..n).map(value).sum::<f64>() / f64::from(n) - exact).powi(2)
            })
            .sum();
        (squared / 64.0).sqrt()
    }

    #[test]
    fn sobol_converges_faster_than_independent_samples() {
        let ratio = |n| integration_error(SamplerKind::Sobol, n) / integration_error(SamplerKind::Independent, n);
        let (few, many) = (ratio(16), ratio(1024));
        assert!(few < 0.5 && many < 0.1, "error over that of independent samples: {few} with 16, {many} with 1024");
    }

    /// RMS error of ∫ over a step in the unit square after a 5 × 5 box blur; blue noise cancels among neighbours, white noise does not.
    fn blurred_error(kind: SamplerKind) -> f64 {
        const SIZE: usize = 96;
        const BLUR: usize = 5;
        let mut error = vec![0.0f64; SIZE * SIZE];
        for (i, e) in error.iter_mut().enumerate() {
            for sample in 0..4 {
                let p = Sampler::new(kind, 3, UVec2::new((i % SIZE) as u32, (i / SIZE) as u32), sample).next_2d();
                *e += if p.x + 0.5 * p.y < 0.75 { 0.25 } else { 0.0 };
            }
            *e -= 0.5;
        }
        let mut sum = 0.0;
        for y in 0..SIZE - BLUR {
            for x in 0..SIZE - BLUR {
                let blurred: f64 = (0..BLUR * BLUR).map(|i| error[(y + i / BLUR) * SIZE + x + i % BLUR]).sum();
                sum += (blurred / (BLUR * BLUR) as f64).powi(2);
            }
        }
        sum.sqrt() / (SIZE - BLUR) as f64
    }

    #[test]
    fn blue_noise_error_blurs_away_faster_than_white() {
        let (blue, sobol, white) = (
            blurred_error(SamplerKind::BlueNoise { log2_samples: 2 }),
            blurred_error(SamplerKind::Sobol),
            blurred_error(SamplerKind::Independent),
        );
        assert!(blue < 0.75 * sobol && sobol < 0.75 * white, "blue {blue}, sobol {sobol}, white {white}");
    }
}

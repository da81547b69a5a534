//! A plain sequential generator for tests, builders and shuffles; rendering uses [`crate::Sampler`].

use crate::bits::{hash_u64, unit_f32};
use glam::Vec2;

/// Sequential pseudo-random numbers, SplitMix64.    \[Steele14]
#[derive(Clone, Debug)]
pub struct Rng {
    state: u64,
}

impl Rng {
    /// The stream of this seed; streams of neighbouring seeds are independent.
    pub fn new(seed: u64) -> Self {
        Self { state: hash_u64(seed ^ 0x6b61_6a6f) }
    }

    /// The next 64 bits.
    #[inline]
    pub fn next_u64(&mut self) -> u64 {
        let out = hash_u64(self.state);
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        out
    }

    /// The next 32 bits.
    #[inline]
    pub fn next_u32(&mut self) -> u32 {
        (self.next_u64() >> 32) as u32
    }

    /// Uniform in [0, 1), 24 bits.
    #[inline]
    pub fn next_1d(&mut self) -> f32 {
        unit_f32(self.next_u32())
    }

    /// Uniform in [0, 1), 53 bits.
    #[inline]
    pub fn next_f64(&mut self) -> f64 {
        (self.next_u64() >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
    }

    /// Uniform in the unit square.
    #[inline]
    pub fn next_2d(&mut self) -> Vec2 {
        let bits = self.next_u64();
        Vec2::new(unit_f32((bits >> 32) as u32), unit_f32(bits as u32))
    }

    /// Uniform in 0..`n`, `n` > 0; the bias is below n / 2³².
    #[inline]
    pub fn below(&mut self, n: u32) -> u32 {
        ((u64::from(self.next_u32()) * u64::from(n)) >> 32) as u32
    }
}

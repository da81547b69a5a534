//! The nearest hits of a packet so far.

use super::{SIZE, crossing::Crossings, fold, greater};
use crate::{
    ray::{Hit, PrimitiveRef, Ray},
    traverse::Nearest,
};

/// As [`Nearest`], for each ray; of equally near hits the first by (instance, primitive).
pub(crate) struct NearestHits {
    t: [f32; SIZE],
    /// Weights of vertices 1 and 2, times `sum`: they are divided once, at the end.
    u: [f64; SIZE],
    v: [f64; SIZE],
    sum: [f64; SIZE],
    primitive: [u32; SIZE],
    instance: [u32; SIZE],
    /// All ones where there is a hit.
    found: [u32; SIZE],
}

impl NearestHits {
    #[inline(always)]
    pub fn before(rays: &[Ray; SIZE]) -> Self {
        let mut t = [0.0; SIZE];
        for i in 0..SIZE {
            t[i] = rays[i].t_max;
        }
        Self { t, u: [0.0; SIZE], v: [0.0; SIZE], sum: [1.0; SIZE], primitive: [0; SIZE], instance: [0; SIZE], found: [0; SIZE] }
    }

    /// How far each ray may still hit something; −∞ for one that is done.
    #[inline(always)]
    pub fn distances(&self) -> &[f32; SIZE] {
        &self.t
    }

    #[inline(always)]
    pub fn farthest(&self) -> f32 {
        fold(&self.t, greater)
    }

    pub fn is_found(&self, i: usize) -> bool {
        self.found[i] != 0
    }

    /// With `ANY`, whether there is a hit is all that is told.
    #[inline(always)]
    pub fn get<const ANY: bool>(&self, i: usize) -> Nearest {
        if ANY {
            return Nearest { found: self.found[i] != 0, ..Nearest::before(self.t[i]) };
        }
        let (u, v) = ((self.u[i] / self.sum[i]) as f32, (self.v[i] / self.sum[i]) as f32);
        Nearest { hit: Hit { t: self.t[i], u, v, primitive: self.primitive[i], instance: self.instance[i] }, found: self.found[i] != 0 }
    }

    pub fn set<const ANY: bool>(&mut self, i: usize, Nearest { hit, found }: Nearest) {
        self.t[i] = if ANY && found { f32::NEG_INFINITY } else { hit.t };
        (self.u[i], self.v[i], self.sum[i]) = (hit.u.into(), hit.v.into(), 1.0);
        (self.primitive[i], self.instance[i]) = (hit.primitive, hit.instance);
        self.found[i] = if found { u32::MAX } else { 0 };
    }

    /// Keeps those crossings of a triangle that are nearer than what was there and, where `ask` says so, accepted.
    #[inline(always)]
    pub(super) fn consider<const ANY: bool>(
        &mut self,
        PrimitiveRef { instance, primitive }: PrimitiveRef,
        crossings: &Crossings,
        ask: bool,
        accept: &mut impl FnMut(usize, &Hit) -> bool,
    ) {
        let mut better = [0; SIZE];
        for i in 0..SIZE {
            let before = (instance < self.instance[i]) | ((instance == self.instance[i]) & (primitive < self.primitive[i]));
            let nearer = (crossings.t[i] < self.t[i]) | ((crossings.t[i] == self.t[i]) & before);
            better[i] = if nearer { crossings.crossed[i] } else { 0 };
        }
        if ask {
            for (i, better) in better.iter_mut().enumerate().filter(|(_, better)| **better != 0) {
                let weight = |edge: f64| (edge / crossings.sum[i]) as f32;
                let (u, v) = (weight(crossings.v[i]), weight(crossings.w[i]));
                if !accept(i, &Hit { t: crossings.t[i], u, v, primitive, instance }) {
                    *better = 0;
                }
            }
        }
        let t = if ANY { [f32::NEG_INFINITY; SIZE] } else { crossings.t };
        for i in 0..SIZE {
            self.t[i] = f32::from_bits(blend(better[i], t[i].to_bits(), self.t[i].to_bits()));
            self.primitive[i] = blend(better[i], primitive, self.primitive[i]);
            self.instance[i] = blend(better[i], instance, self.instance[i]);
            self.found[i] |= better[i];
        }
        for i in 0..SIZE {
            self.u[i] = blend_f64(better[i], crossings.v[i], self.u[i]);
            self.v[i] = blend_f64(better[i], crossings.w[i], self.v[i]);
            self.sum[i] = blend_f64(better[i], crossings.sum[i], self.sum[i]);
        }
    }
}

/// `yes` where the mask is all ones, `no` where it is zero; arithmetic, so that it is done for all rays at once.
#[inline(always)]
fn blend(mask: u32, yes: u32, no: u32) -> u32 {
    (yes & mask) | (no & !mask)
}

#[inline(always)]
fn blend_f64(mask: u32, yes: f64, no: f64) -> f64 {
    let mask = mask as i32 as i64 as u64;
    f64::from_bits((yes.to_bits() & mask) | (no.to_bits() & !mask))
}
